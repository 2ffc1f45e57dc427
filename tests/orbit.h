/* orbit.h - free undamped vibrations with contact loss that return to their start after one period known in closed form:
 * the error of a method across touchdown and lift-off without a reference solution.
 *
 * ORBIT_HERTZ: the Hertz rig, eta'' = (2/3) (1 - eta_+^{3/2}), released at eta = ORBIT_ETA: one contact a period. Its
 * period is flight 3 v0 and a quadrature of the energy. ORBIT_GAP: x'' = -x - kappa over(x, 1) between two gap springs,
 * ORBIT_KAPPA, ORBIT_SPEED at x = 0: two contacts a period, sines throughout. */
#ifndef TESTS_ORBIT_H
#define TESTS_ORBIT_H

#include <stdint.h>
#include "firmware/plant.h"
#include "tests/bench/classical.h"

enum orbit_kind { ORBIT_HERTZ, ORBIT_GAP };
#define ORBIT_ETA   3.0
#define ORBIT_KAPPA 400.0
#define ORBIT_SPEED 1.5

struct orbit {
    const struct model *model;
    double si[MODEL_PARAMETERS];
    double start[2], period, size[2]; /* size: what errors of position and velocity are relative to */
    double omega;                     /* of the closed contact, at rest on it */
    struct classical free;            /* the same motion for classical methods */
};

/* How to run along one. */
struct orbit_way {
    const char *name;
    classical_step *step;        /* or NULL, and then: */
    const struct method *method; /* the whole plant, step guard overridden */
    double tol;
};

/* Period of the free Hertz rig, eta_max > (5/2)^{2/3}; *speed is that at touchdown. */
double orbit_hertz_period(double eta_max, double *speed);

/* Released at `phase` of the way from lift-off to touchdown, in [0, 1). */
void orbit_make(struct orbit *o, enum orbit_kind kind, double phase);

/* Error after one period in n steps: the larger of both states', relative to their size. NaN when refused. */
double orbit_error(const struct orbit *o, const struct orbit_way *w, int n);

/* One such error at a random phase with a random number of steps within 10 % of n; *h_omega is the step's. */
double orbit_draw(enum orbit_kind kind, const struct orbit_way *w, double n, uint64_t *seed, double *h_omega);

/* Contact force and its slope of the free Hertz rig. */
double orbit_hertz_force(const void *context, double t, double x);
double orbit_hertz_slope(const void *context, double t, double x);

#endif
