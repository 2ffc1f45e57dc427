/* problem.h - the residuals of a fit and their slopes, in three forms.
 *
 * PROBLEM_LINEAR: the plant linear about its rest, against the smallest curve. A residual is data over model
 * less 1, which is linear in mass, damping and stiffness, so that a start far away leads home, too.
 * PROBLEM_ROBUST: the plant itself along its branches, each point on the nearer one of its stable motions.
 * Points that are far off, as those on the wrong side of a jump, weigh little. PROBLEM_PLAIN: the same with
 * all points. */
#ifndef HOST_SIM_FIT_PROBLEM_H
#define HOST_SIM_FIT_PROBLEM_H

#include "host_sim/fit/fit.h"
#include "host_sim/fit/least.h"

enum problem_form { PROBLEM_LINEAR, PROBLEM_ROBUST, PROBLEM_PLAIN };

struct problem {
    struct fit_setup *s;
    enum problem_form form;
};

/* As struct least wants them; context is a struct problem. */
double problem_residuals(void *context, const double *u, double *r);
void problem_slopes(void *context, const double *u, double *a);

/* The least squares of this form, from u. */
double problem_solve(struct fit_setup *s, enum problem_form form, double *u, int *steps);

/* The plant of curve c where the unknowns are u. False: the model refuses it. */
bool problem_task(const struct fit_setup *s, int c, const double *u, struct orbit_task *t);

/* How far point i of a curve is from this motion, in standard deviations. */
double problem_miss(const struct fit_setup *s, const double *u, const struct curve *c, int i,
                    const struct follow_point *at);

/* Puts gain and delay of the measuring chain on a response of the plant. */
void problem_measure(const struct fit_setup *s, const double *u, double frequency_Hz, double *re, double *im);

#endif
