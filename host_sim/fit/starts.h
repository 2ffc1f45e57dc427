/* starts.h - the best fit of many starts, and whether they agree. */
#ifndef HOST_SIM_FIT_STARTS_H
#define HOST_SIM_FIT_STARTS_H

#include "host_sim/fit/fit.h"

struct fit_result {
    double u[FIT_UNKNOWNS];
    double chi2;
    int n_numbers; /* residuals that are numbers: one or two of a point */
    /* The weighted slopes there: singular values, the largest first, and directions. */
    double s[MATRIX_MAX], v[MATRIX_MAX][MATRIX_MAX];
    double sd[FIT_UNKNOWNS]; /* standard deviation of u */
    double covariance[FIT_UNKNOWNS][FIT_UNKNOWNS];
    double weak[FIT_UNKNOWNS]; /* the direction that is known least, of length 1; 0 for hidden unknowns */
    int starts, agree,
        worse; /* starts; that ended here; in a worse minimum. Others ended elsewhere, as well */
    bool interrupted;
};

/* Fits. False: no start has a plant that runs. */
bool starts_fit(struct fit_setup *s, struct fit_result *r);

/* The unknown that the weakest direction moves most. */
int starts_weakest(const struct fit_setup *s, const struct fit_result *r);

/* The standard deviation of unknown k becomes so many times wider, and the covariance follows. */
void starts_widen(const struct fit_setup *s, struct fit_result *r, int k, double factor);

/* Singular values, covariance and standard deviations of the plain form at r->u; s->point is that of r->u. */
bool starts_spread(struct fit_setup *s, struct fit_result *r);

#endif
