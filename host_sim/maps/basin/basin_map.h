/* basin_map.h - plants of one scene side by side, period after period of their drives, until they settle.
 *
 * The forcing period is that of the slowest drive; the others turn a whole number of times in it. A period
 * has `steps` ticks. All plants begin at phase 0 of the drives and have the same inputs from then on. A
 * struct plant that stands still makes these inputs once for all. A lane is the rest of a plant: state,
 * regime, scratch memory. After any number of ticks it has the bits of a plant by itself: plant_init with
 * a tick of basin_map_tick_s, plant_scene_begin, plant_set_state, plant_run. */
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
    int periods; /* that `tick` has room for */
    struct method standstill;
    struct plant begin; /* at phase 0 */
    struct plant lead;  /* stands still, and makes the inputs of all lanes */
    struct plant ahead; /* `lead` at phase 0, to begin again from */
    double *fresh;      /* scratch memory of `begin`, [n_scratch] */
    size_t n_scratch;
    struct segment *tick; /* [periods][steps]: the inputs that come next */
};

/* A plant without its inputs. */
struct basin_lane {
    double x[MODEL_STATES]; /* at phase 0 */
    unsigned regime;
    double *scratch; /* [map->n_scratch], the caller's */
};

/* Sums over the ticks of a motion, and its extremes at them. */
struct basin_sum {
    double ticks;
    double time; /* model time */
    double open; /* part of it without any contact; 0 for a model that has none */
    double switches;
    double peak; /* the observable's peak */
    double x[MODEL_STATES], square[MODEL_STATES], high[MODEL_STATES], low[MODEL_STATES];
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

/* Which contacts are closed under inputs u (bit i: contact i). Is the sum of the states' sizes within
 * BASIN_LIMIT? */
unsigned basin_map_regime(const struct basin_plant *plant, const struct input *u, const double *x);
bool basin_map_inside(const struct basin_plant *plant, const double *x);

/* Makes a map at phase 0, with the first periods in its table. The caller has asked the method whether it
 * takes `steps`; a drive needs DRIVE_TICKS_MIN a period. NULL, or why there is none: no memory, or a
 * refusal of plant_init. */
const char *basin_map_start(struct basin_map *map, const struct basin_plant *plant, int steps);
void basin_map_end(struct basin_map *map);

/* Puts the first periods into the table again; the periods that follow those in the table. */
void basin_map_rewind(struct basin_map *map);
void basin_map_next(struct basin_map *map);

/* A fresh plant in state x, at the table's first period. */
void basin_lane_start(const struct basin_map *map, struct basin_lane *lane, const double *x);

/* Sets the state while it runs, like plant_set_state; u: the inputs there. */
void basin_lane_set(const struct basin_map *map, struct basin_lane *lane, const struct input *u,
                    const double *x);

/* An empty sum; and the addition of a tick's end, with the inputs and state there. The code that cuts the
 * tick adds times and switches. */
void basin_sum_start(struct basin_sum *sum);
void basin_sum_add(struct basin_sum *sum, const struct basin_plant *plant, const struct input *u,
                   const double *x);

/* Runs a lane through the k-th period of the table, and adds to the sum, unless it is NULL. x stays where
 * the period began except after BASIN_GOOD. BASIN_ESCAPED: the plant stopped, or left BASIN_LIMIT after a
 * tick. BASIN_UNLOCATED: a switch that a plant counts as `budget` or `residual` (struct plant_counts). */
enum basin_status basin_lane_advance(const struct basin_map *map, int k, struct basin_lane *lane,
                                     struct basin_sum *sum);

#endif
