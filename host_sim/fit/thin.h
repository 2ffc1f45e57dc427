/* thin.h - a setup with fewer points and hasty motions, for a first look at many plants. */
#ifndef HOST_SIM_FIT_THIN_H
#define HOST_SIM_FIT_THIN_H

#include "host_sim/fit/fit.h"

/* *t becomes *s with the largest of three neighbours in each curve; records are those of *s. False: no
 * memory. */
bool thin(const struct fit_setup *s, struct fit_setup *t);

void thin_free(struct fit_setup *t);

#endif
