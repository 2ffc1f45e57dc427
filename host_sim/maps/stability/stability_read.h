/* stability_read.h - the command line of contactplant stability: map, step, axes, and the columns of its
 * rows. */
#ifndef HOST_SIM_STABILITY_READ_H
#define HOST_SIM_STABILITY_READ_H

#include "host_sim/maps/stability/stability.h"

/* The command line into *s. 0, or the exit status after a line. */
int stability_read(struct stability *s);

#endif
