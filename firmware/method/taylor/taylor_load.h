/* taylor_load.h - the inputs of a plant as constants, slopes and tones: the load of method taylor. */
#ifndef FIRMWARE_TAYLOR_LOAD_H
#define FIRMWARE_TAYLOR_LOAD_H

#include "firmware/method/method.h"
#include "models/check.h"

enum { TAYLOR_LANES = 4 };

/* A lane gets value u + rate u' + acceleration u'' from an input. */
struct taylor_term {
    int lane;
    double value, rate, acceleration;
};

/* Every lane: base + its terms; those of input i from term[first[i]] to before term[first[i + 1]]. */
struct taylor_lanes {
    double damping, stiffness;
    double base[TAYLOR_LANES];
    int first[MODEL_INPUTS + 1];
    struct taylor_term term[MODEL_INPUTS * TAYLOR_LANES];
};

/* One frequency in one lane: p(t) + t tp(t), where p' = omega q, q' = -omega p, and so for tp, tq; values at
 * t = 0. */
struct taylor_tone {
    double omega, p, q, tp, tq;
    int lane;
};

/* The tone that a term makes of a wave:
 *   u = (A + G t) C,  u' = G C - omega (A + G t) S,  u'' = -omega^2 (A + G t) C - 2 omega G S,
 * and c C + s S is a p with q = s C - c S. */
ALWAYS_INLINE struct taylor_tone taylor_tone_of(const struct taylor_term *term, const struct wave *w)
{
    double omega = w->omega, cosine = w->cosine, sine = w->sine;
    struct taylor_tone t = {.omega = omega, .lane = term->lane};
    double even = term->value - term->acceleration * (omega * omega), odd = omega * term->rate;
    double c = even * w->amplitude, s = -odd * w->amplitude;
    if (w->growth != 0.0) {
        double tc = even * w->growth, ts = -odd * w->growth;
        c += term->rate * w->growth;
        s -= 2.0 * omega * term->acceleration * w->growth;
        t.tp = tc * cosine + ts * sine;
        t.tq = ts * cosine - tc * sine;
    }
    t.p = c * cosine + s * sine;
    t.q = s * cosine - c * sine;
    return t;
}

/* The lanes as functions of time from one instant on: constant + slope t + tones. */
struct taylor_load {
    double damping, stiffness;
    double constant[TAYLOR_LANES], slope[TAYLOR_LANES];
    unsigned varies;  /* bit l: lane l is not constant */
    unsigned ramping; /* bit l: lane l has a slope or a growing amplitude */
    int n_tones;
    struct taylor_tone tone[MODEL_INPUTS * TAYLOR_LANES];
};

/* The lanes of a model that has one of the two forms; empty where it has neither. */
void taylor_lanes_of(const struct model *m, const double *p, struct taylor_lanes *lanes);

/* The load from the start of a segment on. Inputs of one frequency share a tone. */
void taylor_load_begin(struct taylor_load *load, const struct taylor_lanes *lanes, const struct segment *e);

/* Moves the load to an instant `s` later. */
void taylor_load_move(struct taylor_load *load, double s);

#endif
