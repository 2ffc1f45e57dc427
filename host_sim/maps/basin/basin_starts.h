/* basin_starts.h - starts spread over a box by Latin hypercube (McKay, Beckman & Conover 1979).
 *
 * Each side of the box is cut into n strata. Each stratum of each side holds exactly one start, at a
 * random place. The generator is noise_word (firmware/plant/noise.h) with sequences of its own: it has the
 * same bits everywhere, and depends on seed, n and the start's number only. */
#ifndef HOST_SIM_BASIN_STARTS_H
#define HOST_SIM_BASIN_STARTS_H

#include <stdbool.h>
#include <stdint.h>
#include "models/model.h"

struct basin_box {
    double low[MODEL_STATES], high[MODEL_STATES];
};

struct basin_starts {
    int n, n_states;
    uint32_t seed;
    struct basin_box box;
    int32_t *stratum; /* [n_states][n] */
};

/* False: no memory. */
bool basin_starts_make(struct basin_starts *s, int n, int n_states, uint32_t seed,
                       const struct basin_box *box);
void basin_starts_free(struct basin_starts *s);

/* Start i into x. */
void basin_starts_get(const struct basin_starts *s, int i, double *x);

#endif
