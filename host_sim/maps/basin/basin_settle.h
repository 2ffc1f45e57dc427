/* basin_settle.h - starts that settle side by side in batch_taylor, which is a method of its own: its scalar
 * form is a batch of one. */
#ifndef HOST_SIM_BASIN_SETTLE_H
#define HOST_SIM_BASIN_SETTLE_H

#include "host_sim/maps/basin/basin_motion.h"

enum {
    BASIN_CHUNK = 32 /* periods of a batch before its samples are looked at; then the series begin again */
};

/* Finds outcome, period and periods of n motions, and the states x in which they end. NULL, or a reason. */
const char *basin_settle(const struct basin_plant *b, const struct basin_patience *s, int n,
                         double (*x)[MODEL_STATES], struct basin_motion *motion);

#endif
