/* basin_map.h - plants of one scene side by side, period after period of their drives, in search of what they settle on.
 *
 * The forcing period is that of the slowest drive; the others turn a whole number of times in it. A period is `steps` ticks.
 * All plants begin at phase 0 of the drives and have the same inputs ever after, so that these are made once for all, by a
 * struct plant that stands still. A lane is what a plant has besides, and after any number of ticks it has the bits of a plant
 * by itself: plant_init with a tick of basin_map_tick_s, plant_scene_begin, plant_set_state, and plant_run. */
#ifndef HOST_SIM_BASIN_MAP_H
#define HOST_SIM_BASIN_MAP_H

#include "firmware/plant/plant.h"
#include "models/scenes/scenes.h"

/* A driven plant; model units, but for what is said to be SI. */
struct basin_plant {
    struct scene scene;
    const struct model *model;
    double si[MODEL_PARAMETERS];            /* SI */
    struct harmonic si_drive[MODEL_INPUTS]; /* SI */
    double p[MODEL_DERIVED];
    struct scale scale;
    struct harmonic drive[MODEL_INPUTS]; /* omega per model time */
    double turns[MODEL_INPUTS];          /* of each drive in a forcing period, whole */
    double period;                       /* model time */
    double period_s;                     /* SI */
    const struct method *method;         /* not auto */
    bool
        series; /* settles by batch_taylor (host_sim/batch/batch_taylor.h); `method` is taylor and measures */
    double tol;
    int steps;      /* of the method in a period while a motion settles */
    int observable; /* output whose peak is of interest */
};

struct basin_map {
    const struct basin_plant *plant;
    int steps;
    int periods;         /* in `tick` */
    struct plant begin;  /* at phase 0 */
    struct plant lead;   /* stands still: its drives are everybody's */
    step_function *step; /* of the method */
    double *fresh;       /* scratch memory of `begin`, [n_work] */
    size_t n_work;
    struct segment *tick; /* [periods][steps]: those that come next */
};

/* What a plant has of its own. */
struct basin_lane {
    double x[MODEL_STATES]; /* at phase 0 */
    unsigned regime;
    double *work; /* [map->n_work], of the caller */
};

/* What a motion does, summed over ticks, and its extremes at them. */
struct basin_sum {
    double ticks;
    double time; /* model time */
    double open; /* of it without any contact; 0 for a model that has none */
    double switches;
    double peak; /* of the observable */
    double x[MODEL_STATES], square[MODEL_STATES], high[MODEL_STATES], low[MODEL_STATES];
};

enum basin_status { BASIN_GOOD, BASIN_ESCAPED, BASIN_UNLOCATED };

/* Beyond this many units of the contact a motion has escaped. */
#define BASIN_LIMIT 1e6

/* A scene without noise: all but method, series, tol and steps. NULL, or why its slowest drive gives no forcing period. */
const char *basin_map_read(struct basin_plant *plant, const struct scene *s);

/* NULL, or why the slowest of plant->drive gives no forcing period; fills turns and period. */
const char *basin_map_period(struct basin_plant *plant);

/* Seconds of a tick, `steps` of them in a forcing period. */
double basin_map_tick_s(const struct basin_plant *plant, int steps);

/* Which contacts are closed under inputs u (bit i: contact i), and whether the sizes of the states are together within BASIN_LIMIT. */
unsigned basin_map_regime(const struct basin_plant *plant, const struct input *u, const double *x);
bool basin_map_inside(const struct basin_plant *plant, const double *x);

/* All at phase 0, the first periods in the table. `steps` are the caller's business: the method is not asked whether it takes them, and
 * a drive needs DRIVE_TICKS_MIN. NULL, or why there is none: no memory, or a word of plant_init. */
const char *basin_map_start(struct basin_map *map, const struct basin_plant *plant, int steps);
void basin_map_end(struct basin_map *map);

/* The first periods in the table once more, and those after the ones that are there. */
void basin_map_rewind(struct basin_map *map);
void basin_map_next(struct basin_map *map);

/* A plant in state x that nothing has happened to, at the table's first period. */
void basin_lane_start(const struct basin_map *map, struct basin_lane *lane, const double *x);

/* Another state while it runs, as plant_set_state; u: the inputs there. */
void basin_lane_set(const struct basin_map *map, struct basin_lane *lane, const struct input *u,
                    const double *x);

/* Of nothing yet; and a tick's end, the inputs and state there. Times and switches are added by whoever cuts the tick. */
void basin_sum_start(struct basin_sum *sum);
void basin_sum_add(struct basin_sum *sum, const struct basin_plant *plant, const struct input *u,
                   const double *x);

/* The k-th period of the table; sum: NULL, or what is added to. Else than after BASIN_GOOD x stays where the period began.
 * BASIN_ESCAPED: the plant stopped (plant_run), or the sizes of the states are together beyond BASIN_LIMIT after a tick.
 * BASIN_UNLOCATED: a switch that the plant counts as `budget` or `residual` (struct plant_counts). */
enum basin_status basin_lane_advance(const struct basin_map *map, int k, struct basin_lane *lane,
                                     struct basin_sum *sum);

#endif
