/* random_law.h - the stationary motion of one degree of freedom under white noise, in closed form.
 *
 *   x'' + c x' + V'(x) = f(t),  R(s) = 2 pi Phi delta(s):   p(x, v) = C exp{-(c/(pi Phi)) (v^2/2 + V(x))}
 *
 * so v has the variance pi Phi/c whatever V, and level z is crossed upwards sigma_v p(z)/sqrt(2 pi) times
 * per time (Rice). With a Hertzian contact this is Nayak 1972 eq. 68 and 91, with a linear force Gaussian.
 * V and c are those of the model's hertz_form or polynomial_form. Noise held for T has Phi = sigma^2 T/(2
 * pi), taken at the eigenfrequency: times sinc^2(w T/2); between steps the velocity's variance is smaller
 * by c T/3 (docs/reference/random_input.md). */
#ifndef HOST_SIM_RANDOM_LAW_H
#define HOST_SIM_RANDOM_LAW_H

#include "models/scenes/scenes.h"

enum { RANDOM_LAW_POINTS = 20000 };

struct random_law {
    const struct model *model;
    double p[MODEL_DERIVED];
    double damping, cold;                /* c, c/(pi Phi) */
    double speed;                        /* standard deviation of the velocity, between steps */
    double rest, bottom;                 /* position and potential at rest */
    double from, to;                     /* where the density ends */
    double below[RANDOM_LAW_POINTS + 1]; /* distribution function at the points from `from` to `to` */
    double norm;
    double offset, gain; /* observable = offset + gain x, SI */
    bool clipped;        /* observable = offset where x < 0: a penetration */
    double time_s;
};

/* Finds the law of the scene's observable. NULL, or why there is none. */
const char *random_law_of(const struct scene *s, struct random_law *l);

/* Share of time that the observable is above a level, and its up-crossings of the level per time. */
double random_law_above(const struct random_law *l, double level);
double random_law_crossing(const struct random_law *l, double level);

/* Mean and variance of the observable. */
void random_law_moments(const struct random_law *l, double *mean, double *variance);

/* Share of time out of contact and touchdowns per time; NaN for a model without contact. */
double random_law_open(const struct random_law *l);
double random_law_touches(const struct random_law *l);

#endif
