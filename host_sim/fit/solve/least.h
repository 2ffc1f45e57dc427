/* least.h - least squares by Levenberg and Marquardt, with bounds. */
#ifndef HOST_SIM_FIT_LEAST_H
#define HOST_SIM_FIT_LEAST_H

#include <stdbool.h>
#include "host_sim/fit/solve/matrix.h"

/* An unknown whose slopes are below this share of the largest ones stays: they are rounding. */
#define LEAST_UNSEEN 1e-5

struct least {
    int m, n; /* residuals and unknowns, n <= MATRIX_MAX */
    void *context;
    /* Writes the residuals r[m] at u[n], already with their weights; the cost is what is to become small, the
     * sum of their squares or a robust one. Infinite: u is not allowed. */
    double (*residuals)(void *context, const double *u, double *r);
    /* Their slopes at the u of the last call: a[i * n + k]. */
    void (*slopes)(void *context, const double *u, double *a);
    double low[MATRIX_MAX], high[MATRIX_MAX];
    int steps;      /* at most */
    double smaller; /* a step that makes the cost smaller by less than this share is the last */
};

/* u becomes a minimum near u. Returns its cost; infinite without memory. *steps are those that were taken. */
double least_squares(const struct least *l, double *u, int *steps);

#endif
