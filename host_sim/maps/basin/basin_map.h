/* basin_map.h - the plants of a basin map: one scene at phase 0 of its drives, in many states, period after
 * period until they settle.
 *
 * The forcing period is that of the slowest drive; the others turn a whole number of times in it. A period
 * has `steps` ticks. One plant is prepared: plant_init with a tick of basin_map_tick_s, plant_scene_begin.
 * All begin as its copies. */
#ifndef HOST_SIM_BASIN_MAP_H
#define HOST_SIM_BASIN_MAP_H

#include "firmware/plant/plant.h"
#include "models/scenes/scenes.h"

/* A driven plant; model units, except where SI is written. */
struct basin_plant {
    struct scene scene;
    const struct model *model;
    double si[MODEL_PARAMETERS];            /* SI */
    struct harmonic si_drive[MODEL_INPUTS]; /* SI */
    double p[MODEL_DERIVED];
    struct scale scale;
    struct harmonic drive[MODEL_INPUTS]; /* omega per model time */
    double turns[MODEL_INPUTS];          /* whole turns of each drive in a forcing period */
    struct input begin[MODEL_INPUTS];    /* the drives at phase 0 */
    double period;                       /* model time */
    double period_s;                     /* SI */
    const struct method *method;         /* not auto */
    /* Motions settle by batch_taylor (host_sim/batch/batch_taylor.h), and are measured by `method`, which
     * is taylor. */
    bool series;
    double tol;
    int steps;      /* in a period, while a motion settles */
    int observable; /* the output whose peak is measured */
};

struct basin_map {
    const struct basin_plant *plant;
    int steps;
    struct plant begin; /* at phase 0 */
    double *fresh;      /* scratch memory of `begin`, [n_scratch] */
    size_t n_scratch;
};

enum basin_status { BASIN_GOOD, BASIN_ESCAPED, BASIN_UNLOCATED };

/* A motion has escaped beyond this many units of the contact. */
#define BASIN_LIMIT 1e6

/* Reads a scene without noise: all but method, series, tol and steps. NULL, or why its slowest drive gives
 * no forcing period. */
const char *basin_map_read(struct basin_plant *plant, const struct scene *s);

/* Fills turns and period from the drives. NULL, or why the slowest drive gives no forcing period. */
const char *basin_map_period(struct basin_plant *plant);

/* Seconds of a tick, with `steps` ticks in a forcing period. */
double basin_map_tick_s(const struct basin_plant *plant, int steps);

/* Is the sum of the states' sizes within BASIN_LIMIT? */
bool basin_map_inside(const struct basin_plant *plant, const double *x);

/* Prepares a plant. The caller has asked the method whether it takes `steps`; a drive needs DRIVE_TICKS_MIN a
 * period. NULL, or why there is none: no memory, or a refusal of plant_init. */
const char *basin_map_start(struct basin_map *map, const struct basin_plant *plant, int steps);
void basin_map_end(struct basin_map *map);

/* A fresh plant in state x, with scratch memory of its own, [map->n_scratch]. */
void basin_map_place(const struct basin_map *map, const double *x, struct plant *pl, double *scratch);

/* Runs a plant through a forcing period; look: NULL, or called at the end of each tick. BASIN_ESCAPED: the
 * plant stopped, or left BASIN_LIMIT after a tick. BASIN_UNLOCATED: a switch that a plant counts as `budget`
 * or `residual`. After both the state is where the period began, and nothing looked from there on. */
enum basin_status basin_map_advance(const struct basin_map *map, struct plant *pl, plant_look *look,
                                    void *who);

#endif
