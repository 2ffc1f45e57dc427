/* problem_levers.h - residuals of spectra and force curves of a lever, part of a problem.
 *
 * A spectrum's residual is the root of its deviance, so that their least squares are the largest likelihood
 * (Whittle 1953). A number of a force curve is compared with the nearer one of the lever's rests. */
#ifndef HOST_SIM_FIT_PROBLEM_LEVERS_H
#define HOST_SIM_FIT_PROBLEM_LEVERS_H

#include "host_sim/fit/solve/problem.h"

/* Residuals of all lever data in this form; they and their cost; slopes (not of the linear form). */
int problem_levers_size(const struct problem *p);
double problem_levers_residuals(const struct problem *p, const double *u, double *r);
void problem_levers_slopes(const struct problem *p, const double *u, double *a);

/* The slopes of the plain form with the weights of numbers that are not independent. */
void problem_levers_widen(const struct fit_setup *s, double *a);

/* Number i of data d, where the unknowns are u, on side d->side[i] (find: on the nearer one). */
double problem_levers_value(const struct fit_setup *s, struct lever_data *d, const double *u, int i,
                            bool find);

#endif
