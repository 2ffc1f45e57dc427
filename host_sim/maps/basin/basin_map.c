/* basin_map.c - plants of one scene side by side through the periods of their drives. */
#include "host_sim/maps/basin/basin_map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "firmware/plant/plant_scene.h"
#include "host_sim/maps/maps.h"
#include "models/math/elementary.h"

enum { TICKS = 256 /* at most, in a table of several periods */ };

static const double whole = 1e-9;       /* turns by which a drive may miss a whole number */
static const double turns_max = 1000.0; /* most turns of the fastest drive in a forcing period */

const char *basin_map_period(struct basin_plant *b)
{
    double slowest = (double)INFINITY;
    for (int i = 0; i < b->model->n_inputs; i++)
        if (maps_sounds(&b->drive[i]))
            slowest = fmin(slowest, b->drive[i].omega);
    if (!isfinite(slowest))
        return "nothing drives it, and attractors are told by the drive's period; give it a [drive]";
    for (int i = 0; i < b->model->n_inputs; i++) {
        double turns = maps_sounds(&b->drive[i]) ? b->drive[i].omega / slowest : 0.0;
        b->turns[i] = round(turns);
        if (fabs(turns - b->turns[i]) > whole * turns || turns > turns_max)
            return "its drives share no period; give frequencies that are whole multiples of the lowest, to "
                   "1000 times";
    }
    b->period = 2.0 * ELEMENTARY_PI / slowest;
    return NULL;
}

const char *basin_map_read(struct basin_plant *b, const struct scene *s)
{
    *b = (struct basin_plant){.scene = *s, .model = s->model, .observable = (int)s->observable};
    scenes_resolve(s, b->si, b->si_drive);
    b->model->prepare(b->si, b->p, &b->scale);
    for (int i = 0; i < b->model->n_inputs; i++) {
        b->drive[i] = b->si_drive[i];
        b->drive[i].amplitude /= scale_of(&b->scale, b->model->input_signal[i].quantity);
        b->drive[i].omega *= b->scale.time_s;
    }
    const char *why = basin_map_period(b);
    for (int i = 0; i < b->model->n_inputs && !why; i++)
        if (b->turns[i] == 1.0)
            b->period_s = 2.0 * ELEMENTARY_PI / b->si_drive[i].omega;
    return why;
}

double basin_map_tick_s(const struct basin_plant *b, int steps)
{
    return b->period_s / steps;
}

unsigned basin_map_regime(const struct basin_plant *b, const struct input *u, const double *x)
{
    struct input gap[MODEL_CONTACTS];
    unsigned regime = 0;
    b->model->gap(b->p, u, x, gap);
    for (int i = 0; i < b->model->n_contacts; i++)
        regime |= (unsigned)(gap[i].value < 0.0) << i;
    return regime;
}

/* The step of a method that leaves the state where it is. */
static enum step_status stay(const struct model *m, const double *p, double *scratch, const struct segment *e,
                             unsigned regime, double *x, struct crossing *c)
{
    (void)m, (void)p, (void)scratch, (void)e, (void)regime, (void)x, (void)c;
    return STEP_END;
}

static step_function *bind_stay(const struct model *m)
{
    return (void)m, stay;
}

static const char *begin(struct basin_map *map)
{
    const struct basin_plant *b = map->plant;
    struct plant_config c = {.model = b->model,
                             .si = b->si,
                             .method = b->method,
                             .tick_s = basin_map_tick_s(b, map->steps),
                             .dilation = 1.0,
                             .tol = b->tol,
                             .force = true, /* the caller has asked the method */
                             .no_ledger = true,
                             .scratch = map->fresh};
    const char *why = plant_init(&map->begin, &c);
    if (why)
        return why;
    plant_scene_begin(&map->begin, &b->scene, b->si, b->si_drive);
    map->standstill = rk4; /* which needs no scratch memory */
    map->standstill.bind = bind_stay;
    c.method = &map->standstill;
    why = plant_init(&map->ahead, &c);
    if (why)
        return why;
    plant_scene_begin(&map->ahead, &b->scene, b->si, b->si_drive);
    basin_map_rewind(map);
    return NULL;
}

const char *basin_map_start(struct basin_map *map, const struct basin_plant *b, int steps)
{
    *map = (struct basin_map){.plant = b, .steps = steps, .periods = steps < TICKS ? TICKS / steps : 1};
    map->n_scratch = b->method->n_scratch(b->model);
    map->fresh = calloc(map->n_scratch + 1, sizeof *map->fresh);
    map->tick = calloc((size_t)map->periods * (size_t)steps, sizeof *map->tick);
    const char *why = map->fresh && map->tick ? begin(map) : "out of memory";
    if (why)
        basin_map_end(map);
    return why;
}

void basin_map_end(struct basin_map *map)
{
    free(map->fresh);
    free(map->tick);
    map->fresh = NULL;
    map->tick = NULL;
}

void basin_map_rewind(struct basin_map *map)
{
    map->lead = map->ahead;
    basin_map_next(map);
}

void basin_map_next(struct basin_map *map)
{
    for (int k = 0; k < map->periods * map->steps; k++) {
        bool good = plant_run(&map->lead, 1);
        ASSERT(good);
        map->tick[k] = map->lead.segment;
    }
}

void basin_lane_set(const struct basin_map *map, struct basin_lane *lane, const struct input *u,
                    const double *x)
{
    memcpy(lane->x, x, sizeof lane->x);
    lane->regime = basin_map_regime(map->plant, u, x);
}

void basin_lane_start(const struct basin_map *map, struct basin_lane *lane, const double *x)
{
    if (map->n_scratch > 0)
        memcpy(lane->scratch, map->fresh, map->n_scratch * sizeof *lane->scratch);
    basin_lane_set(map, lane, map->begin.segment.at[2], x);
}

bool basin_map_inside(const struct basin_plant *b, const double *x)
{
    double size = 0.0;
    for (int i = 0; i < b->model->n_states; i++)
        size += fabs(x[i]);
    return size <= BASIN_LIMIT;
}

void basin_sum_start(struct basin_sum *sum)
{
    *sum = (struct basin_sum){.peak = -(double)INFINITY};
    for (int i = 0; i < MODEL_STATES; i++) {
        sum->high[i] = -(double)INFINITY;
        sum->low[i] = (double)INFINITY;
    }
}

/* Adds a piece of a tick, as the plant does. */
static void add_time(struct basin_sum *sum, const struct basin_plant *b, unsigned regime, double length)
{
    sum->time += length;
    if (regime == 0 && b->model->n_contacts > 0)
        sum->open += length;
}

void basin_sum_add(struct basin_sum *sum, const struct basin_plant *b, const struct input *u, const double *x)
{
    double out[MODEL_OUTPUTS];
    b->model->output(b->p, u, x, out);
    sum->peak = fmax(sum->peak, out[b->observable]);
    sum->ticks += 1.0;
    for (int i = 0; i < b->model->n_states; i++) {
        sum->x[i] += x[i];
        sum->square[i] += x[i] * x[i];
        sum->high[i] = fmax(sum->high[i], x[i]);
        sum->low[i] = fmin(sum->low[i], x[i]);
    }
}

/* One tick, cut at its switches as in firmware/plant/plant.c. A plant would run through the rest after
 * PLANT_PIECES - 1 pieces; here the motion counts as unlocated. */
static enum basin_status advance_tick(const struct basin_map *map, const struct segment *tick,
                                      struct basin_lane *lane, struct basin_sum *sum)
{
    const struct basin_plant *b = map->plant;
    const struct segment *e = tick;
    struct segment rest;
    for (int piece = 1; piece < PLANT_PIECES; piece++) {
        struct crossing c = {0.0, 0, 0, 0.0};
        enum step_status status =
            map->begin.step(b->model, map->begin.p, lane->scratch, e, lane->regime, lane->x, &c);
        if (sum)
            add_time(sum, b, lane->regime, status == STEP_END ? e->length : c.done);
        if (status == STEP_END)
            return basin_map_inside(b, lane->x) ? BASIN_GOOD : BASIN_ESCAPED;
        if (status == STEP_NOT_FINITE)
            return BASIN_ESCAPED;
        if (status == STEP_SWITCH && c.residual)
            return BASIN_UNLOCATED;
        if (e == tick)
            rest = *tick;
        segment_tail(&rest, b->model->n_inputs, c.done);
        e = &rest;
        if (status == STEP_SWITCH)
            lane->regime ^= 1u << c.contact;
        if (sum)
            sum->switches += status == STEP_SWITCH;
    }
    return BASIN_UNLOCATED;
}

enum basin_status basin_lane_advance(const struct basin_map *map, int k, struct basin_lane *lane,
                                     struct basin_sum *sum)
{
    const struct segment *tick = &map->tick[k * map->steps];
    double from[MODEL_STATES];
    memcpy(from, lane->x, sizeof from);
    for (int j = 0; j < map->steps; j++) {
        enum basin_status status = advance_tick(map, &tick[j], lane, sum);
        if (status != BASIN_GOOD) {
            memcpy(lane->x, from, sizeof from);
            return status;
        }
        if (sum)
            basin_sum_add(sum, map->plant, tick[j].at[2], lane->x);
    }
    return BASIN_GOOD;
}
