/* batch_taylor_set.h - set-up of a batch from its models, and its run by the kernels of this processor. */
#ifndef HOST_SIM_BATCH_TAYLOR_SET_H
#define HOST_SIM_BATCH_TAYLOR_SET_H

#include "host_sim/batch/batch_taylor.h"

/* Memory for n trajectories, and the batch in it: all at rest in a flight that nothing drives. */
size_t batch_taylor_bytes(int n);
void batch_taylor_init(struct batch_taylor *b, int n, void *memory);

/* NULL, or why this cannot be a trajectory of a batch: a model without the equation above, more tones than
 * it has, a number beyond BATCH_LIMIT. The state does not count. */
const char *batch_taylor_refuse(const struct batch_trajectory *t);

/* Trajectory i from now on. NULL, or why it cannot be one of a batch (then nothing is changed). */
const char *batch_taylor_set(struct batch_taylor *b, int i, const struct batch_trajectory *t);

/* The model's state from eta and its rate, `time` after time 0. */
void batch_taylor_state(const struct batch_trajectory *t, double time, double eta, double rate, double *x);

const char *batch_taylor(struct batch_taylor *b, double tol, int intervals, double *samples);

#endif
