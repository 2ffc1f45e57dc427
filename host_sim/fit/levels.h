/* levels.h - before anything is measured: which response curves would tell the unknowns, and how well. */
#ifndef HOST_SIM_FIT_LEVELS_H
#define HOST_SIM_FIT_LEVELS_H

#include "host_sim/fit/fit.h"

/* Prints a table: standard deviations from a curve at each of some drives, and from the smallest with each
 * larger one. 0, or the exit status after a line. */
int levels_tell(struct fit_setup *s);

#endif
