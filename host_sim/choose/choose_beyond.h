/* choose_beyond.h - how far a reduced model of the shaft is good when its drives grow. */
#ifndef HOST_SIM_CHOOSE_BEYOND_H
#define HOST_SIM_CHOOSE_BEYOND_H

#include "host_sim/choose/choose_steps.h"

/* How far the chosen reduced model of a shaft is good. It and the full model run with all drives larger
 * and larger, up to four times, until the error passes the tolerance; a chaotic motion is taken as it is.
 * Returns the last factor before, and the reach of these runs. */
double choose_beyond(const struct choose_certificate *c, double reach[2]);

#endif
