/* sweep_read.h - the command line of contactplant sweep: ranges, harmonics, periods, and the columns of
 * its rows. */
#ifndef HOST_SIM_SWEEP_READ_H
#define HOST_SIM_SWEEP_READ_H

#include "host_sim/maps/sweep/sweep.h"

/* The command line into *s. 0, or the exit status after a line. */
int sweep_read(struct sweep *s);

#endif
