/* problem_curves.h - residuals of response curves, part of a problem. */
#ifndef HOST_SIM_FIT_PROBLEM_CURVES_H
#define HOST_SIM_FIT_PROBLEM_CURVES_H

#include "host_sim/fit/solve/problem.h"

/* Curves that count in this form. */
int problem_curves(const struct problem *p);

/* Residuals, two for a point, and the cost; slopes of all unknowns. */
double problem_curves_residuals(const struct problem *p, const double *u, double *r);
void problem_curves_slopes(const struct problem *p, const double *u, double *a);

/* How far point i of a curve is from this motion, in standard deviations. */
double problem_curves_miss(const struct fit_setup *s, const double *u, const struct curve *c, int i,
                           const struct follow_point *at);

#endif
