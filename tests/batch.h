/* batch.h - trajectories for batches, in the papers' parameters, for tests. */
#ifndef TESTS_BATCH_H
#define TESTS_BATCH_H

#include "host_sim/batch_taylor.h"

/* One trajectory with what it points to. */
struct batch_one {
    struct batch_trajectory t;
    double p[MODEL_DERIVED];
};

/* The inputs at this time, by libm. */
void batch_inputs(const struct batch_trajectory *t, double time, struct input *u);

/* A trajectory with these paper parameters; the papers' sets are dimensionless. */
void batch_of_paper(struct batch_one *o, const struct model *m, const double *paper, const double *state,
                    double interval);

/* A rig with every drive, a rolling contact or a repulsive tip; smooth, or thrown off its contact. */
void batch_random(uint64_t *seed, struct batch_one *o);

double batch_between(uint64_t *seed, double a, double b);

/* Memory for n, to be freed. */
void *batch_make(struct batch_taylor *b, int n);

/* Into place i; a refusal is a failed check. */
void batch_put(struct batch_taylor *b, int i, struct batch_one *o);

/* What a batch returned: a refusal is a failed check. */
void batch_ran(const char *why);

#endif
