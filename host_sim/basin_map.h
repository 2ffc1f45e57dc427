/* basin_map.h - the stroboscopic map of a driven plant: its state at phase 0 to that one forcing period later.
 *
 * The forcing period is that of the slowest drive; the others turn a whole number of times in it. A period is `steps` ticks
 * of a method through the seam of firmware/method.h, switches located. The ticks' excitations are the same in every period,
 * to the last bit, and nothing is carried over: a state determines all that follows. */
#ifndef HOST_SIM_BASIN_MAP_H
#define HOST_SIM_BASIN_MAP_H

#include "firmware/method.h"

/* A driven plant; model units. */
struct basin_plant {
    const struct model *model;
    double p[MODEL_DERIVED];
    struct scale scale;
    struct harmonic drive[MODEL_INPUTS]; /* omega per model time */
    double turns[MODEL_INPUTS];          /* of each drive in a forcing period, whole */
    double period;                       /* model time */
    const struct method *method;         /* not auto */
    bool series; /* settles by batch_taylor (host_sim/batch_taylor.h); `method` is taylor and measures */
    double tol;
    int steps;      /* of the method in a period while a motion settles */
    int observable; /* output whose peak is of interest */
};

struct basin_map {
    const struct basin_plant *plant;
    int steps;
    double *work;
    struct excitation *tick; /* [steps] */
};

/* What a motion does, summed over ticks, and its extremes at them. */
struct basin_sum {
    double ticks;
    double open; /* model time without any contact */
    double switches;
    double peak; /* of the observable */
    double x[MODEL_STATES], square[MODEL_STATES], high[MODEL_STATES], low[MODEL_STATES];
};

enum basin_status { BASIN_GOOD, BASIN_ESCAPED, BASIN_UNLOCATED };

/* Beyond this many units of the contact a motion has escaped. */
#define BASIN_LIMIT 1e6

/* NULL, or why the plant's slowest drive gives no forcing period; fills turns and period. */
const char *basin_map_period(struct basin_plant *plant);

/* False: no memory. */
bool basin_map_start(struct basin_map *map, const struct basin_plant *plant, int steps);
void basin_map_end(struct basin_map *map);

/* Of nothing yet. */
void basin_sum_start(struct basin_sum *sum);

/* x a period on; sum: NULL, or what is added to. BASIN_ESCAPED: x left the finite numbers or BASIN_LIMIT.
 * BASIN_UNLOCATED: more than BASIN_PIECES switches in a tick, or one whose root kept a residual. */
enum { BASIN_PIECES = 64 };
enum basin_status basin_map_advance(const struct basin_map *map, double *x, struct basin_sum *sum);

#endif
