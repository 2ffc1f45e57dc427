/* taylor_short.h - loads and limits of the short series of method taylor, each over one tick: of a Hertzian
 * contact (taylor_short.c) or of a cubic force (taylor_short_cubic.c). Time is in ticks, so that the
 * coefficients are the terms themselves. */
#ifndef FIRMWARE_TAYLOR_SHORT_H
#define FIRMWARE_TAYLOR_SHORT_H

#include <math.h>
#include "firmware/method/taylor/taylor.h"
#include "firmware/method/taylor/taylor_load.h"

/* Order of a force at most: the coordinate has two orders more. */
enum { TAYLOR_SHORT_LAST = 12 };

/* The load over the tick: lane l, order n, in whole pairs, and tones may begin at the first order too. */
struct taylor_short_load {
    double lane[2][TAYLOR_SHORT_LAST + 4];
    bool modulated; /* lane 1 is not constant */
};

/* The tone p, q: p' = turn q, q' = -turn p, so p'' = -turn^2 p; two orders at once. */
ALWAYS_INLINE void taylor_short_add_tone(double p, double q, double turn, int last, double *lane)
{
    taylor_pair z = {p, turn * q}, square = taylor_both(turn * turn);
    TAYLOR_UNROLL
    for (int n = 0; n <= last; n += 2) {
        taylor_pair_put(&lane[n], taylor_pair_at(&lane[n]) + z);
        z *= square * (taylor_pair){-1.0 / ((n + 1) * (n + 2)), -1.0 / ((n + 2) * (n + 3))};
    }
}

/* Adds one term of an input over a tick of length h. */
ALWAYS_INLINE void taylor_short_add_term(const struct taylor_term *term, const struct wave *w, double h,
                                         int last, double *lane)
{
    lane[0] += term->value * w->offset + term->rate * w->slope;
    lane[1] += term->value * w->slope * h;
    if (w->amplitude == 0.0 && w->growth == 0.0)
        return;
    struct taylor_tone t = taylor_tone_of(term, w);
    taylor_short_add_tone(t.p, t.q, t.omega * h, last, lane);
    if (w->growth != 0.0)
        taylor_short_add_tone(t.tp * h, t.tq * h, t.omega * h, last, lane + 1);
}

/* Input i over a tick of length h: what it has in the first n_lanes lanes. */
ALWAYS_INLINE void taylor_short_add_wave(const struct taylor_lanes *lanes, int i, const struct wave *w,
                                         double h, int n_lanes, int last, struct taylor_short_load *load)
{
    int end = lanes->first[i + 1];
    for (int k = lanes->first[i]; k < end; k++) {
        const struct taylor_term *term = &lanes->term[k];
        int l = n_lanes > 1 ? term->lane : 0;
        load->modulated |= l == 1;
        taylor_short_add_term(term, w, h, last, load->lane[l]);
    }
}

/* The first n_lanes lanes, one or two, to order `last`, of these inputs; they must have no others. */
ALWAYS_INLINE void taylor_short_load(const struct taylor_lanes *lanes, const struct segment *e,
                                     unsigned active, int n_lanes, int last, struct taylor_short_load *load)
{
    TAYLOR_UNROLL
    for (int l = 0; l < n_lanes; l++) {
        TAYLOR_UNROLL
        for (int n = 0; n < last + 4; n += 2)
            taylor_pair_put(&load->lane[l][n], taylor_both(0.0));
        load->lane[l][0] = lanes->base[l];
    }
    load->modulated = false;
    for (int i = 0; active != 0; i++, active >>= 1)
        if (active & 1u)
            taylor_short_add_wave(lanes, i, &e->wave[i], e->length, n_lanes, last, load);
}

/* The number of the input that multiplies powers of x, or that none or more than one does. */
enum { TAYLOR_MODULATED_NOT = -1, TAYLOR_MODULATED_MORE = -2 };
ALWAYS_INLINE int taylor_modulating(const struct taylor_lanes *lanes, unsigned active)
{
    int which = TAYLOR_MODULATED_NOT;
    for (int i = 0; active != 0; i++, active >>= 1) {
        int end = lanes->first[i + 1];
        if ((active & 1u) && end > lanes->first[i] && lanes->term[end - 1].lane > 0)
            which = which == TAYLOR_MODULATED_NOT ? i : TAYLOR_MODULATED_MORE;
    }
    return which;
}

/* More ticks than this in a unit of time share what one piece is allowed: under a fast drive their errors add
 * up. */
#define TAYLOR_SHORT_MANY 32.0

/* The error of the rate, relative where eta is large, that a series may leave at the end of a tick of length
 * h. */
ALWAYS_INLINE double taylor_short_allowed(const struct taylor *t, double h)
{
    double size = fabs(t->eta), share = TAYLOR_SHORT_MANY * h;
    return t->allowed_short * (size > 1.0 ? size : 1.0) * (share < 1.0 ? share : 1.0);
}

/* Likewise for a long series, to tell whether that would be cheaper. */
ALWAYS_INLINE double taylor_long_allowed(const struct taylor *t)
{
    double size = fabs(t->eta);
    return t->allowed * (size > 1.0 ? size : 1.0);
}

/* Instead of a piece: the whole segment by one series of order 8, 10 or 12, for a Hertzian contact. `brief`
 * then says whether that was worth it. False when no such series holds that far or a contact switches; the
 * motion is unchanged. */
bool taylor_short(struct taylor *t, const struct segment *e);

/* After this piece, is one short series per step sufficient and cheaper? */
bool taylor_is_brief(const struct taylor *t, const struct segment *e);

#endif
