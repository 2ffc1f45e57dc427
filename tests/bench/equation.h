/* equation.h - the plants as a peer's user writes them: right-hand sides in the units that suit a solver
 * best.
 *
 * One Hertzian contact, in the relative coordinate, so that a moving base is a force:
 *
 *     eta'' = f0 + f1 cos(w1 t + phase1) + f2 cos(w2 t) - c eta' - k eta - b (1 + r cos(w2 t)) eta_+^{3/2}
 *
 * And the shaft on two gap bearings, lengths in gaps, times in sqrt(m/kL).
 *
 * A solver that locates contacts may lock the regime: then the force goes on smoothly behind the switch,
 * and a step that ends there keeps its order. */
#ifndef TESTS_BENCH_EQUATION_H
#define TESTS_BENCH_EQUATION_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum { EQUATION_STATES = 6, EQUATION_CONTACTS = 4 };

struct equation {
    int n, n_contacts;
    bool locked;
    unsigned closed; /* while locked: bit i, contact i is closed */
    double held;     /* sampled force, constant from one sample to the next */
    double w1;
    /* one Hertzian contact */
    double c, k, b, r, f0, f1, phase1, f2, w2;
    /* shaft: mass, damper, support by mass; contact spring; force on the middle mass is f1 cos(w1 t) */
    double mass[3], damper[3], support[3], spring;
    double time_unit; /* in the paper's time */
    double length_unit;
};

/* Cosine of |x| <= 1e5 rad within 4e-16, inline: what a user does who knows that libm's call takes as long as
 * the rest of a right-hand side. x is reduced to r within a quarter turn of a multiple n of pi, whose sign is
 * the lowest bit of n. Then cos r = 1 + z Q(z), z = r^2; Q interpolates at Chebyshev nodes, within 2e-17. */
static inline double equation_cosine(double x)
{
    const double round = 0x1.8p52; /* added: rounds to an integer, which stands in the lowest bits */
    double shifted = x * 0.31830988618379067 + round, n = shifted - round;
    double r = (x - n * 0x1.921fb544p+1) - n * 0x1.0b4611a626331p-33; /* pi: 33 + 53 bits */
    double z = r * r, z2 = z * z;
    double low =
        (-0.5 + z * 0.04166666666666634) + z2 * (-0.0013888888888860694 + z * 2.4801587292441663e-05);
    double high = (-2.755731776674132e-07 + z * 2.08766308298722e-09) +
                  z2 * (-1.1464688686901012e-11 + z * 4.6276610380051693e-14);
    double cosine = 1.0 + z * (low + (z2 * z2) * high);
    uint64_t turned, bits;
    memcpy(&turned, &shifted, sizeof turned);
    memcpy(&bits, &cosine, sizeof bits);
    bits ^= turned << 63;
    memcpy(&cosine, &bits, sizeof cosine);
    return cosine;
}

static inline double equation_hertz_force(const struct equation *e, double eta)
{
    if (!e->locked)
        eta = eta > 0.0 ? eta : 0.0;
    else if (!e->closed)
        return 0.0;
    return eta * sqrt(fabs(eta));
}

static inline void equation_hertz(const struct equation *e, double t, const double *y, double *dy)
{
    double drive = e->f0 + e->held, stiffness = e->b;
    if (e->f1 != 0.0)
        drive += e->f1 * equation_cosine(e->w1 * t + e->phase1);
    if (e->w2 != 0.0) {
        double fast = equation_cosine(e->w2 * t);
        drive += e->f2 * fast;
        stiffness *= 1.0 + e->r * fast;
    }
    dy[0] = y[1];
    dy[1] = ((drive - e->k * y[0]) - e->c * y[1]) - stiffness * equation_hertz_force(e, y[0]);
}

/* How far x is beyond the gap on either side; positive side is contact `bit`, negative side the next. */
static inline double equation_over(const struct equation *e, double x, int bit)
{
    if (e->locked) {
        unsigned side = e->closed >> bit;
        return ((side & 1u) ? x - 1.0 : 0.0) + ((side & 2u) ? x + 1.0 : 0.0);
    }
    return (x > 1.0 ? x - 1.0 : 0.0) + (x < -1.0 ? x + 1.0 : 0.0);
}

static inline void equation_shaft(const struct equation *e, double t, const double *y, double *dy)
{
    double bend = (y[0] + y[2]) - 2.0 * y[1];
    double drive = e->f1 != 0.0 ? e->held + e->f1 * equation_cosine(e->w1 * t) : e->held;
    double f0 = -e->damper[0] * y[3] - e->support[0] * y[0] - bend - e->spring * equation_over(e, y[0], 0);
    double f1 = drive - e->damper[1] * y[4] + 2.0 * bend;
    double f2 = -e->damper[2] * y[5] - e->support[2] * y[2] - bend - e->spring * equation_over(e, y[2], 2);
    dy[0] = y[3];
    dy[1] = y[4];
    dy[2] = y[5];
    dy[3] = f0 / e->mass[0];
    dy[4] = f1 / e->mass[1];
    dy[5] = f2 / e->mass[2];
}

/* Overlap of contact i, > 0 when closed, and its rate. */
static inline double equation_overlap(const struct equation *e, const double *y, int i, double *rate)
{
    int body = i < 2 ? 0 : 2;
    double side = (i & 1) ? -1.0 : 1.0;
    if (e->n == 2) {
        *rate = y[1];
        return y[0];
    }
    *rate = side * y[3 + body];
    return side * y[body] - 1.0;
}

static inline unsigned equation_regime(const struct equation *e, const double *y)
{
    unsigned closed = 0;
    double rate;
    for (int i = 0; i < e->n_contacts; i++)
        closed |= (unsigned)(equation_overlap(e, y, i, &rate) > 0.0) << i;
    return closed;
}

#endif
