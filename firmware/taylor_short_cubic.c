/* taylor_short_cubic.c - one tick of a cubic force by a series of low order, read once at its end; see taylor_short.h.
 *
 * In the deviation z from where the tick begins (taylor_shift) it takes fewer products than the 3/2 power of a Hertzian
 * contact, and there is no switch to look out for. */
#include "firmware/taylor_short.h"

/* Orders, one after the other until the tolerance is met. */
enum { FIRST = 6, SECOND = 8, THIRD = 11, ORDER = 14, LAST = ORDER - 2 };
STATIC_ASSERT((int)LAST <= (int)TAYLOR_SHORT_LAST, taylor_short_load_reaches);

/* Terms of the rate, of size s, fall off like s k^n/n!, k the angle of a tick: the tail at FIRST is s k^5/4!; a long series
 * ends where s (x k)^15/14! is the tolerance, after x ticks. That is less than MANY_CUBIC (taylor_short.c) where
 * tail^3 > EASY tolerance s^2. */
#define EASY 3.6e-7

/* Terms over a tick: z of the deviation, u = n z of its rate, z^2 and z^3; b of the force but for b[0], which is in the load;
 * damping and square of the tick in its units. */
struct terms {
    double b[TAYLOR_LANES], damping, square;
    double z[ORDER + 1], u[ORDER + 1], z2[LAST + 1], z3[LAST + 1];
};

/* What the terms from the second on add up to. */
struct sums {
    double change, speed;
};

/* The terms of orders from + 1 to `order`, added up; returns the last two of the rate. */
ALWAYS_INLINE double expand(const double *g, int from, int order, struct terms *t, struct sums *sums)
{
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
        t->u[n + 2] = (a * t->square - t->damping * t->u[n + 1]) * (1.0 / (n + 1));
        t->z[n + 2] = t->u[n + 2] * (1.0 / (n + 2));
        sums->change += t->z[n + 2];
        sums->speed += t->u[n + 2];
    }
    return fabs(t->u[order]) + fabs(t->u[order - 1]);
}

/* The powers of x have a load too. */
static bool is_modulated(const struct taylor_lanes *lanes, unsigned active)
{
    for (int i = 0; active != 0; i++, active >>= 1) {
        int end = (int)lanes->first[i + 1];
        if ((active & 1u) && end > (int)lanes->first[i] && lanes->term[end - 1].lane > 0.0)
            return true;
    }
    return false;
}

bool taylor_short_cubic(struct taylor *t, const struct excitation *e)
{
    struct taylor_short_load load;
    struct terms terms;
    struct sums sums = {0.0, 0.0};
    const double *g = load.lane[0];
    double h = e->length;
    t->brief = 0.0;
    if (h == 0.0 || is_modulated(&t->lanes, e->active))
        return false;
    taylor_short_load(&t->lanes, e, 1, LAST, &load);
    taylor_shift(t->lanes.base, t->eta, terms.b);
    load.lane[0][0] += terms.b[0] - t->lanes.base[0];
    terms.square = h * h;
    terms.damping = t->lanes.damping * h;
    terms.z[1] = terms.u[1] = t->rate * h;
    double most = taylor_short_allowed(t) * h, tail = expand(g, 1, FIRST, &terms, &sums);
    double u1 = terms.u[1], u2 = terms.u[2];
    bool brief = tail * tail * tail > EASY * most * (u1 * u1 + u2 * u2);
    if (tail > most) {
        tail = expand(g, FIRST, SECOND, &terms, &sums);
        t->count.further += SECOND - FIRST;
        if (tail > most) {
            tail = expand(g, SECOND, THIRD, &terms, &sums);
            t->count.further += THIRD - SECOND;
            if (tail > most) {
                tail = expand(g, THIRD, ORDER, &terms, &sums);
                t->count.further += ORDER - THIRD;
            }
        }
    }
    if (!(tail <= most))
        return false;
    t->brief = brief ? 1.0 : 0.0;
    t->count.brief += 1.0;
    t->eta += terms.z[1] + sums.change;
    t->rate += sums.speed * (1.0 / h);
    t->root = -1.0;
    t->kind = TAYLOR_NONE;
    return true;
}
