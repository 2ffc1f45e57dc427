/* hash_run.h - one fixed run that passes through everything: the same bits on every compiler, level and target, or the
 * build is wrong. */
#ifndef TESTS_HASH_RUN_H
#define TESTS_HASH_RUN_H

#include "firmware/plant.h"

/* The runs whose last line is in tests/data/hash.txt. */
enum { HASH_RUNS = 6 };
extern const char *const hash_runs[HASH_RUNS];

/* name: METHOD[:shaft], the rig unless it says shaft, which is also what `exact` gets; or `arithmetic`, the operations
 * one by one (tests/arithmetic.h). Calls `line` after each block of 1000 ticks. NULL, or why it stopped. *pl and work[METHOD_WORK] are the
 * caller's; what was counted is in pl->counts. */
const char *hash_run(struct plant *pl, double *work, const char *name,
                     void (*line)(uint64_t tick, uint64_t hash));

#endif
