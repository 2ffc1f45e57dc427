/* choose_refuse.h - refusals of a reduced model before any run of it, one row each: by linear theory, and
 * by what the truth has shown. */
#ifndef HOST_SIM_CHOOSE_REFUSE_H
#define HOST_SIM_CHOOSE_REFUSE_H

#include "host_sim/choose/choose_steps.h"

/* The tests that run nothing but what the truth has shown; fills predicted and refused. */
void choose_refuse(const struct search *o, struct choose_verdict *v);

#endif
