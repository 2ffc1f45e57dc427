/* work_rungs.h - one tick of each model by each method, for tests/bench/cost/instructions.c to count on the host: what contactplant choose
 * ranks by (host_sim/choose/choose_cost.c). One drive sounds, contact is kept, 128 ticks in a period of the eigenfrequency; by taylor 2
 * too, for what its long series cost, and a few at a loose tolerance for its short ones. Where it costs more, once more with an input
 * that is no force. */
#ifndef TESTS_WORK_RUNGS_H
#define TESTS_WORK_RUNGS_H

#include "tests/bench/cost/work_pieces.h"

enum { WORK_RUNGS = 116 };
extern const struct work_piece work_rung[WORK_RUNGS];

/* Makes ready for calls of work_rung[i].once; NULL, or what went wrong. After the calls: did all of them go well? */
const char *work_rungs_setup(int i);
int work_rungs_good(void);

/* Pieces that taylor has begun since then. */
double work_rungs_series(void);

#endif
