/* basin_repeat.h - tells when a motion has come back to where it was. */
#ifndef HOST_SIM_BASIN_REPEAT_H
#define HOST_SIM_BASIN_REPEAT_H

#include "host_sim/maps/basin/basin_motion.h"

/* The largest component of a state of n numbers; the largest difference of two states. */
double basin_size(const double *x, int n);
double basin_distance(const double *a, const double *b, int n);

void basin_repeat_start(struct basin_repeat *r, const double *x, int n);

/* Takes the next state: the period once it has come back three times, else 0. */
int basin_repeat_see(struct basin_repeat *r, const double *x, int n, double tolerance);

/* Marks a motion without an attractor. */
void basin_motion_fail(struct basin_motion *m, enum basin_status status);

#endif
