/* batch_root.h - the first sign change of a series, four trajectories at once. */
#ifndef HOST_SIM_BATCH_ROOT_H
#define HOST_SIM_BATCH_ROOT_H

#include "host_sim/batch/batch_series.h"

struct batch_root {
    quad at;
    mask found, residual; /* residual: found, but not converged; not found: at is the end */
};

/* The first x in (0, end] where sign * a turns from negative to not negative; b must be its slope. A
 * series that starts at exactly 0 is taken as having left zero: that root does not count. */
void batch_series_root(const struct batch_series *s, double sign, const quad *end, struct batch_root *root);

#endif
