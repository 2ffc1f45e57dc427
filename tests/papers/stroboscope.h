/* stroboscope.h - the stroboscopic map of a driven plant: its state at phase 0 to that one forcing period
 * later.
 *
 * The inputs of the ticks are equal in every period, to the last bit, and nothing is carried over. So a
 * state determines all that follows, as Newton's method on an orbit needs it. The plants of
 * host_sim/maps/basin/basin_map.h differ: their drives run on. */
#ifndef TESTS_PAPERS_STROBOSCOPE_H
#define TESTS_PAPERS_STROBOSCOPE_H

#include "host_sim/maps/basin/basin_map.h"

/* Over ticks: extremes of the states, switches, and model time without any contact. */
struct stroboscope_sum {
    double open, switches, high[MODEL_STATES], low[MODEL_STATES];
};

void stroboscope_sum_start(struct stroboscope_sum *sum);

struct stroboscope {
    const struct basin_plant *plant;
    int steps;
    double *scratch;
    struct segment *tick; /* [steps] */
};

/* False: no memory. */
bool stroboscope_start(struct stroboscope *map, const struct basin_plant *plant, int steps);
void stroboscope_end(struct stroboscope *map);

/* x a period on; sum: NULL, or what is added to. BASIN_ESCAPED: x left the finite numbers or
 * BASIN_LIMIT. BASIN_UNLOCATED: more than 64 switches in a tick, or one whose root kept a residual. */
enum basin_status stroboscope_advance(const struct stroboscope *map, double *x, struct stroboscope_sum *sum);

#endif
