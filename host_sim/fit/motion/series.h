/* series.h - the motion of a plant from a state, at equal times, free or under the drive of a record. */
#ifndef HOST_SIM_FIT_SERIES_H
#define HOST_SIM_FIT_SERIES_H

#include "host_sim/fit/data/record.h"
#include "host_sim/fit/motion/orbit.h"

/* The output y[n] of the record's times from the state x, under `gain` times its drive; its tone has this
 * phase. False: the plant escapes, or is refused. */
bool series_run(const struct orbit_task *t, const struct record *r, const double *x, double gain,
                double phase_rad, double *y);

#endif
