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
        drive += e->f1 * cos(e->w1 * t + e->phase1);
    if (e->w2 != 0.0) {
        double fast = cos(e->w2 * t);
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
    double drive = e->f1 != 0.0 ? e->held + e->f1 * cos(e->w1 * t) : e->held;
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
