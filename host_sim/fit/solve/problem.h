/* problem.h - the residuals of a fit and their slopes, in three forms.
 *
 * PROBLEM_LINEAR: the plant linear about its rest, against the curves of the smallest drive. A residual is
 * data over model less 1, which is linear in mass, damping and stiffness, so that a start far away leads
 * home, too. PROBLEM_ROBUST: the plant itself along its branches, each point on the nearer one of its stable
 * motions. Points that are far off, as those on the wrong side of a jump, weigh little. PROBLEM_PLAIN: the
 * same with all points. */
#ifndef HOST_SIM_FIT_PROBLEM_H
#define HOST_SIM_FIT_PROBLEM_H

#include "host_sim/fit/fit.h"
#include "host_sim/fit/solve/least.h"

enum problem_form { PROBLEM_LINEAR, PROBLEM_ROBUST, PROBLEM_PLAIN, PROBLEM_RECORDS };

struct problem {
    struct fit_setup *s;
    enum problem_form form;
};

/* Residuals of this form, of all curves that are active. */
int problem_size(struct fit_setup *s, enum problem_form form);

/* As struct least wants them; context is a struct problem. */
double problem_residuals(void *context, const double *u, double *r);
void problem_slopes(void *context, const double *u, double *a);

/* The least squares of this form, from u. */
double problem_solve(struct fit_setup *s, enum problem_form form, double *u, int *steps);

#endif
