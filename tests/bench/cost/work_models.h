/* work_models.h - ticks of each model by each method, for tests/bench/cost/instructions.c to count on the
 * host. contactplant choose ranks by these counts (host_sim/choose/choose_counts.h, made by costs.c).
 *
 * One drive sounds, contact is kept, 128 ticks are in a period of the eigenfrequency. taylor is also
 * counted with 2 ticks a period, for its long series, and with a few at a loose tolerance, for its short
 * ones. Where an input that is no force costs more, it is counted too. */
#ifndef TESTS_WORK_MODELS_H
#define TESTS_WORK_MODELS_H

#include "firmware/method/method.h"
#include "tests/bench/cost/work_pieces.h"

enum { WORK_MODELS = 121 };
extern const struct work_piece work_model[WORK_MODELS];

/* Ticks a period. Short series serve where long ones would reach less than four ticks, and a tick is no
 * longer than the contact deep. */
enum {
    FINE = 128,
    COARSE = 2,
    SHORT = 7,
    SHORT_TIP = 5,
    /* FINE, and: noise, new or held over 64 ticks; a lever with four modes, in contact, both; the contact
     * lost in each tick, under one drive or two */
    NOISY = FINE + 1,
    HELD,
    MODES,
    NEAR,
    NEAR_MODES,
    SWITCHING,
    SWITCHING_TWO
};

/* The model, method, input and period of each. */
extern const struct work_kind {
    const struct model *model;
    const struct method *method;
    int input, period;
} work_kind[WORK_MODELS];

/* Ticks in a call of work_model[i].once: a run of a frame's length, or one where each begins anew. */
int work_models_ticks(int i);

/* Makes ready for calls of work_model[i].once; NULL, or what went wrong. After the calls: did all of them
 * go well? */
const char *work_models_setup(int i);
int work_models_good(void);

/* Pieces that taylor has begun since then. */
double work_models_series(void);

#endif
