/* taylor_short_cubic.c - one tick of a cubic force by a series of low order, read once at its end.
 *
 * It is in the deviation z from the start of the tick (taylor_shift). It takes fewer products than the 3/2
 * power of a Hertzian contact, and there is no switch to find. */
#include "firmware/method/taylor/taylor_short_cubic.h"

#include "firmware/method/taylor/taylor_load.h"
#include "firmware/method/taylor/taylor_short.h"

/* Orders, one after the other until the tolerance is met. */
enum { FIRST = 6, SECOND = 8, THIRD = 11, ORDER = 14, LAST = ORDER - 2 };
STATIC_ASSERT((int)LAST <= (int)TAYLOR_SHORT_LAST, taylor_short_load_reaches);

/* Terms of the rate, of size s, fall off like s k^n/n!, where k is the angle of a tick. So the tail at FIRST
 * is s k^5/4!. A long series ends after x ticks, where s (x k)^15/14! is the tolerance. That is less than
 * MANY_CUBIC (taylor_short.c) where tail^3 > EASY tolerance s^2. */
#define EASY           3.6e-7
#define EASY_MODULATED 3.9e-13 /* likewise for MANY_MODULATED */

/* Terms over a tick: z of the deviation, u = n z of its rate, z^2 and z^3. b is the force; b[0] is in the
 * load. m is the factor of the modulation, product its series. damping and square (of the tick) are in units
 * of the tick. */
struct terms {
    double b[TAYLOR_LANES], m[TAYLOR_LANES], damping, square;
    double z[ORDER + 1], u[ORDER + 1], z2[LAST + 1], z3[LAST + 1], product[LAST + 1];
};

/* The sums of the terms from the second on. */
struct sums {
    double change, speed;
};

/* The factor of the modulation at order n into product[n]; returns sum_{j=0..n} k_j product[n - j]. */
ALWAYS_INLINE double modulate(const double *k, int n, struct terms *t)
{
    double m = n > 0 ? t->m[1] * t->z[n] : t->m[0];
    if (n > 1)
        m += t->m[2] * t->z2[n];
    if (n > 2)
        m += t->m[3] * t->z3[n];
    t->product[n] = m;
    double sum = k[0] * m;
    TAYLOR_UNROLL
    for (int j = 1; j <= n; j++)
        sum += k[j] * t->product[n - j];
    return sum;
}

/* The terms of orders from + 1 to `order`, added up; returns the last two of the rate. */
ALWAYS_INLINE double expand(const struct taylor_short_load *load, bool modulated, int from, int order,
                            struct terms *t, struct sums *sums)
{
    const double *g = load->lane[0];
    TAYLOR_UNROLL
    for (int n = from - 1; n <= order - 2; n++) {
        double a = g[n];
        if (n > 0)
            a += t->b[1] * t->z[n];
        if (n > 1) {
            t->z2[n] = taylor_square(t->z, n);
            a += t->b[2] * t->z2[n];
        }
        if (n > 2) {
            t->z3[n] = taylor_cube(t->z, t->z2, n);
            a += t->b[3] * t->z3[n];
        }
        if (modulated)
            a += modulate(load->lane[1], n, t);
        t->u[n + 2] = (a * t->square - t->damping * t->u[n + 1]) * (1.0 / (n + 1));
        t->z[n + 2] = t->u[n + 2] * (1.0 / (n + 2));
        sums->change += t->z[n + 2];
        sums->speed += t->u[n + 2];
    }
    return fabs(t->u[order]) + fabs(t->u[order - 1]);
}

/* One order after the other until the tail is small enough; the last tail, and by `brief` whether it was
 * worth it. */
ALWAYS_INLINE double climb(struct taylor *t, const struct taylor_short_load *load, bool modulated, double h,
                           double most, struct terms *terms, struct sums *sums, bool *brief)
{
    double tail = expand(load, modulated, 1, FIRST, terms, sums), u1 = terms->u[1], u2 = terms->u[2];
    double worth = taylor_long_allowed(t) * h * (u1 * u1 + u2 * u2);
    *brief = tail * tail * tail > (modulated ? EASY_MODULATED : EASY) * worth;
    if (tail > most) {
        tail = expand(load, modulated, FIRST, SECOND, terms, sums);
        t->count.further += SECOND - FIRST;
        if (tail > most) {
            tail = expand(load, modulated, SECOND, THIRD, terms, sums);
            t->count.further += THIRD - SECOND;
            if (tail > most) {
                tail = expand(load, modulated, THIRD, ORDER, terms, sums);
                t->count.further += ORDER - THIRD;
            }
        }
    }
    return tail;
}

/* Lane 0 with everything but the modulation, which is lane 1; its factor into m. */
ALWAYS_INLINE void load_modulated(const struct taylor_lanes *lanes, const struct segment *e, int which,
                                  double eta, double *m, struct taylor_short_load *load)
{
    static const struct taylor_term itself = {1, 1.0, 0.0, 0.0};
    const struct wave *w = &e->wave[which];
    double products[TAYLOR_LANES] = {0.0};
    taylor_short_load(lanes, e, e->active & ~(1u << which), 1, LAST, load);
    TAYLOR_UNROLL
    for (int n = 0; n < LAST + 4; n += 2)
        taylor_pair_put(&load->lane[1][n], taylor_both(0.0));
    taylor_short_add_term(&itself, w, e->length, LAST, load->lane[1]);
    for (int k = lanes->first[which]; k < lanes->first[which + 1]; k++) {
        const struct taylor_term *term = &lanes->term[k];
        products[term->lane] = term->value;
        if (term->rate != 0.0)
            taylor_short_add_term(&(struct taylor_term){0, 0.0, term->rate, 0.0}, w, e->length, LAST,
                                  load->lane[0]);
    }
    taylor_shift(products, eta, m);
}

/* The tick under this load, m in its terms. */
ALWAYS_INLINE bool serve(struct taylor *t, double h, bool modulated, struct taylor_short_load *load,
                         struct terms *terms)
{
    struct sums sums = {0.0, 0.0};
    bool brief;
    taylor_shift(t->lanes.base, t->eta, terms->b);
    load->lane[0][0] += terms->b[0] - t->lanes.base[0];
    terms->square = h * h;
    terms->damping = t->lanes.damping * h;
    terms->z[1] = terms->u[1] = t->rate * h;
    double most = taylor_short_allowed(t, h) * h;
    if (!(climb(t, load, modulated, h, most, terms, &sums, &brief) <= most))
        return false;
    t->brief = brief;
    t->count.brief++;
    t->eta += terms->z[1] + sums.change;
    t->rate += sums.speed * (1.0 / h);
    t->root = -1.0;
    t->kind = TAYLOR_NONE;
    return true;
}

/* A function of its own, because inlined it would take registers from the plain one. */
NEVER_INLINE bool serve_modulated(struct taylor *t, const struct segment *e, int which)
{
    struct taylor_short_load load;
    struct terms terms;
    load_modulated(&t->lanes, e, which, t->eta, terms.m, &load);
    return serve(t, e->length, true, &load, &terms);
}

bool taylor_short_cubic(struct taylor *t, const struct segment *e)
{
    struct taylor_short_load load;
    struct terms terms;
    t->brief = false;
    int which = taylor_modulating(&t->lanes, e->active);
    if (e->length == 0.0 || which == TAYLOR_MODULATED_MORE)
        return false;
    if (which != TAYLOR_MODULATED_NOT)
        return serve_modulated(t, e, which);
    taylor_short_load(&t->lanes, e, e->active, 1, LAST, &load);
    return serve(t, e->length, false, &load, &terms);
}
