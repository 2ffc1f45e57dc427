/* random_read.h - the command line of contactplant random: times, range, bins, and the columns of its
 * rows. */
#ifndef HOST_SIM_RANDOM_READ_H
#define HOST_SIM_RANDOM_READ_H

#include "host_sim/maps/random/random.h"

/* The command line into *r. 0, or the exit status after a line. */
int random_read(struct random_runs *r);

#endif
