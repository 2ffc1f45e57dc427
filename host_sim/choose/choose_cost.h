/* choose_cost.h - the cost of a step of the plant, in instructions that were counted once. So a scene gets
 * one answer on every machine. `make costs` writes the counts (choose_counts.h) from tests/data. */
#ifndef HOST_SIM_CHOOSE_COST_H
#define HOST_SIM_CHOOSE_COST_H

#include <stdbool.h>
#include "firmware/method/method.h"
#include "models/scenes/scenes.h"

enum {
    CHOOSE_METHODS = 6, /* methods that a model may be run by */
    CHOOSE_MACHINES = 5 /* the first is this host */
};
extern const struct method *const choose_method[CHOOSE_METHODS];

/* Is this method tried on that model? A lever takes modal alone: rk4 is its check. */
bool choose_takes(const struct model *m, int method);

struct choose_machine {
    const char *name;
    double ns[CHOOSE_METHODS]; /* assumed for an instruction of each method, the slow end; 0: not known */
};
extern const struct choose_machine choose_machine[CHOOSE_MACHINES];

/* Counts of a model's tick. First by each method, in the order of choose_method. Then by taylor with a long
 * series in nearly every tick, and with a short series in each. */
enum choose_count {
    COUNT_RK4,
    COUNT_FLOAT32,
    COUNT_TAYLOR,
    COUNT_EXACT,
    COUNT_UNLOCATED,
    COUNT_MODAL,
    COUNT_COARSE,
    COUNT_SHORT,
    COUNTS
};

/* Counts of the rig's tick by rk4: with noise new in each tick, with noise held for CHOOSE_HOLD ticks, with a
 * contact switch under one drive and under two. The switches are counted by rk4_unlocated as well. Then of
 * the lever's tick by modal: with four modes, in contact, both. */
enum choose_extra {
    EXTRA_NOISE,
    EXTRA_HELD,
    EXTRA_SWITCH,
    EXTRA_SWITCH_TWO,
    EXTRA_THROUGH,
    EXTRA_THROUGH_TWO,
    EXTRA_MODES,
    EXTRA_NEAR,
    EXTRA_NEAR_MODES,
    EXTRAS
};
#define CHOOSE_HOLD 64.0
extern const char *const choose_extra_name[EXTRAS]; /* in tests/data/instructions.txt */

/* Pieces of work that are counted on every machine, see tests/bench/cost/work_pieces.h. */
enum choose_piece {
    PIECE_RK4_TICK,
    PIECE_RK4_STEP,
    PIECE_FLOAT32_TICK,
    PIECE_TAYLOR_TICK,
    PIECE_EXACT_STEP,
    PIECE_DRIVE,
    PIECE_SERIES,
    PIECE_SERIES_LOST,
    PIECE_SWITCH,
    CHOOSE_PIECES
};
extern const char *const choose_piece_name[CHOOSE_PIECES]; /* in tests/data */

/* ---- choose_cost.c ---- */

/* A run's series by taylor, per step (struct taylor_tally), and the share of a lever's steps near the sample,
 * which modal cuts. */
struct choose_series {
    double time, regular, brief, further, near;
};

/* The cost of a step depends on these. */
struct choose_work {
    const struct scene *scene;
    int drives;                  /* that sound */
    bool moved;                  /* an input that is no force sounds */
    double switches;             /* a second of the real plant */
    struct choose_series series; /* per step, as a run had them; none before a run: the least possible cost */
};

/* Instructions of one step of the plant on a machine: method, ledger, drives, its share of contact
 * switches. NaN where the method does not take the model. */
double choose_cost_step(const struct choose_work *w, int method, int machine);

#endif
