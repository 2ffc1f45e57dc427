/* plan.h - the gain of a further response curve, before it is measured. */
#ifndef HOST_SIM_FIT_PLAN_H
#define HOST_SIM_FIT_PLAN_H

#include "host_sim/fit/starts.h"

/* The standard deviations of the unknowns at r->u, had curve c been measured at this drive, too, with noise
 * of the same share of its amplitude. False: that plant does not run, or its motion has no period. */
bool plan_further(struct fit_setup *s, const struct fit_result *r, int c, double amplitude,
                  double sd[FIT_UNKNOWNS]);

/* Gives the points of all curves what the plant gives at u, with this noise; a point without a stable motion
 * of the drive's period does not count. Returns how many those are; -1: that plant does not run, or has no
 * such motion at all. */
int plan_fill(struct fit_setup *s, const double *u, double noise);

#endif
