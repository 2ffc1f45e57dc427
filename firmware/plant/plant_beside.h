/* plant_beside.h - several plants of one model side by side: their quiet ticks in one run.
 *
 * The ticks of a plant are a chain of operations that wait for each other; those of several plants are
 * independent. host_sim/beside/ has the functions that do so; boards run one plant. */
#ifndef FIRMWARE_PLANT_BESIDE_H
#define FIRMWARE_PLANT_BESIDE_H

#include "firmware/plant/plant.h"

enum { SIDES = 8 }; /* plants side by side; a multiple of PLANT_LANES */

/* Ticks of one of several plants, in its block from a certain one on, as for run_function. */
struct plant_side {
    struct plant *pl;
    const struct method_block *b;
    const struct input (*at)[MODEL_INPUTS];
    double (*x)[MODEL_STATES];
};

/* Moves SIDES plants of one model by up to n ticks, behind ledger_begin of each. The first one that some of
 * them may not take to its end is the last; `stopped` has these, bit i for side i, which stand before it.
 * Books the ticks and counts their times, and returns how many they are. One plant may stand at several
 * sides.
 */
typedef uint32_t plant_sides_function(const struct plant_side *side, uint32_t n, unsigned *stopped);

/* The function for plants like this one of which no input but these sounds, by the method that it has now.
 * NULL: it goes alone. */
typedef plant_sides_function *plant_bind_sides(const struct plant *pl, unsigned active);

/* The run of one of several plants. */
struct plant_run {
    struct plant *pl;
    uint64_t to;      /* tick */
    plant_look *look; /* NULL, or with the others as in plant_run_seen */
    plant_look_ticks *several;
    void *who;
    bool good; /* as plant_run would return it */
};

/* Runs n plants, at most SIDES, each from the start of a tick: to the bits of plant_run or plant_run_seen.
 * Quiet ticks of those of the first one's model go side by side, which costs less. */
void plant_run_beside(struct plant_run *r, uint32_t n, plant_bind_sides *bind);

#endif
