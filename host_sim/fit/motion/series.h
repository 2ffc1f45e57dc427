/* series.h - the motion of a plant from a state, at equal times, free or under a drive in straight lines. */
#ifndef HOST_SIM_FIT_SERIES_H
#define HOST_SIM_FIT_SERIES_H

#include "host_sim/fit/motion/orbit.h"

/* The output y[n] from the state x, step_s apart. u[n]: the drive at these times, or NULL. False: the plant
 * escapes, or is refused. */
bool series_run(const struct orbit_task *t, const double *x, double step_s, int n, const double *u,
                double *y);

#endif
