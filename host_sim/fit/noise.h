/* noise.h - the standard deviation of data that do not say it, from how residuals differ from point to point.
 *
 * Neighbours share what a wrong model leaves, so that their difference is noise (von Neumann 1941). No
 * measurement is taken to be better than NOISE_LEAST of its amplitude. */
#ifndef HOST_SIM_FIT_NOISE_H
#define HOST_SIM_FIT_NOISE_H

#include "host_sim/fit/fit.h"

#define NOISE_LEAST   1e-3
#define NOISE_ASSUMED 1e-2 /* until there are residuals */

/* Points without a standard deviation get NOISE_ASSUMED of their amplitude; s->noise_known. */
void noise_assume(struct fit_setup *s);

/* Where the noise is not known: puts what residuals r[s->n_residuals] say in the place of what was assumed,
 * for each curve and record by itself. */
void noise_estimate(struct fit_setup *s, const double *r);

#endif
