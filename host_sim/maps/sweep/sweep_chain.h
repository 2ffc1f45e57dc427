/* sweep_chain.h - a chain of points: takes its steps, follows what else they can lead to, writes and resumes
 * rows. */
#ifndef HOST_SIM_SWEEP_CHAIN_H
#define HOST_SIM_SWEEP_CHAIN_H

#include "host_sim/maps/sweep/sweep.h"

/* compute, ends and resume of jobs.h for chain `job`; context is the struct sweep. */
bool sweep_chain(void *context, int job, FILE *rows);
bool sweep_chain_ends(void *context, int job, const char *row);
size_t sweep_resume(void *context, int job, const char *rows);

/* The chain of row i. Each value of the family is two chains, up and down. */
int sweep_chain_of(const struct rows_table *t, const struct sweep_result *row, int i);

#endif
