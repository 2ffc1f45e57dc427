/* simulate_read.h - the command line of contactplant simulate. */
#ifndef HOST_SIM_SIMULATE_READ_H
#define HOST_SIM_SIMULATE_READ_H

#include "host_sim/simulate/simulate.h"

/* Units, parameters, drives, initial state and times from r->o, for r->model. 0, or the exit status after
 * a line. */
int simulate_read(struct simulation *r);

/* The harmonic inputs at a time, model units. */
void simulate_inputs(const struct simulation *r, double t, struct input *u);

/* A line about `text` on stderr; the exit status. */
int simulate_misuse(const struct simulation *r, const char *text, const char *reason);

#endif
