/* read.h - the command line and the data of a fit. */
#ifndef HOST_SIM_READ_H
#define HOST_SIM_READ_H

#include "host_sim/fit/fit.h"

/* The command line and the data into *s. 0, or the exit status after a line. fit_free in any case. */
int fit_read(struct fit_setup *s);
void fit_free(struct fit_setup *s);

#endif
