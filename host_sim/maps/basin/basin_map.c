/* basin_map.c - plants of one scene through the periods of their drives. */
#include "host_sim/maps/basin/basin_map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/maps/maps.h"
#include "host_sim/scene/plant_of_scene.h"
#include "models/math/elementary.h"

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
    scenes_inputs(b->model, &b->scale, b->si_drive, b->begin);
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

static const char *begin(struct basin_map *map)
{
    const struct basin_plant *b = map->plant;
    struct plant_config c =
        plant_config_of_real_scene(&b->scene, b->si, basin_map_tick_s(b, map->steps), map->fresh);
    c.method = b->method;
    c.tol = b->tol;
    c.force = true; /* the caller has asked the method */
    c.no_ledger = true;
    return plant_of_scene(&map->begin, &c, &b->scene, b->si_drive);
}

const char *basin_map_start(struct basin_map *map, const struct basin_plant *b, int steps)
{
    *map = (struct basin_map){.plant = b, .steps = steps};
    map->n_scratch = b->method->n_scratch(b->model);
    map->fresh = calloc(map->n_scratch + 1, sizeof *map->fresh);
    const char *why = map->fresh ? begin(map) : "out of memory";
    if (why)
        basin_map_end(map);
    return why;
}

void basin_map_end(struct basin_map *map)
{
    free(map->fresh);
    map->fresh = NULL;
}

void basin_map_place(const struct basin_map *map, const double *x, struct plant *pl, double *scratch)
{
    *pl = map->begin;
    pl->scratch = scratch;
    memcpy(scratch, map->fresh, map->n_scratch * sizeof *scratch);
    plant_set_state(pl, x);
}

bool basin_map_inside(const struct basin_plant *b, const double *x)
{
    double size = 0.0;
    for (int i = 0; i < b->model->n_states; i++)
        size += fabs(x[i]);
    return size <= BASIN_LIMIT;
}

/* A look at a plant until it goes wrong. */
struct watched {
    const struct basin_plant *b;
    enum basin_status status;
    plant_look *look;
    void *who;
};

static void watch(void *who, const struct plant *pl)
{
    struct watched *w = who;
    if (w->status != BASIN_GOOD)
        return;
    if (pl->counts.budget + pl->counts.residual > 0)
        w->status = BASIN_UNLOCATED;
    else if (!basin_map_inside(w->b, pl->x))
        w->status = BASIN_ESCAPED;
    else if (w->look)
        w->look(w->who, pl);
}

enum basin_status basin_map_advance(const struct basin_map *map, struct plant *pl, plant_look *look,
                                    void *who)
{
    struct watched w = {map->plant, BASIN_GOOD, look, who};
    double from[MODEL_STATES];
    memcpy(from, pl->x, sizeof from);
    bool good = plant_run_seen(pl, (uint64_t)map->steps, watch, NULL, &w);
    if (!good && w.status == BASIN_GOOD)
        w.status = pl->counts.budget + pl->counts.residual > 0 ? BASIN_UNLOCATED : BASIN_ESCAPED;
    if (w.status != BASIN_GOOD)
        memcpy(pl->x, from, sizeof from);
    return w.status;
}
