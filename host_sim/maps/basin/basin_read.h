/* basin_read.h - the command line of contactplant basin: plant, method, steps and starts. */
#ifndef HOST_SIM_BASIN_READ_H
#define HOST_SIM_BASIN_READ_H

#include "host_sim/maps/basin/basin.h"

/* The command line into *b: scene, method, starts, columns, identity. 0, or the exit status after a line. */
int basin_read(struct basin *b);

#endif
