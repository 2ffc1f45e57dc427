/* basin_map.c - see basin_map.h. */
#include "host_sim/basin_map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "models/elementary.h"

static const double whole = 1e-9;       /* of a turn, by which a drive may miss */
static const double turns_max = 1000.0; /* of the fastest drive in a forcing period */

static bool sounds(const struct harmonic *d)
{
    return (d->amplitude < 0.0 || d->amplitude > 0.0) && d->omega > 0.0;
}

const char *basin_map_period(struct basin_plant *b)
{
    double slowest = (double)INFINITY;
    for (int i = 0; i < b->model->n_inputs; i++)
        if (sounds(&b->drive[i]))
            slowest = fmin(slowest, b->drive[i].omega);
    if (!isfinite(slowest))
        return "nothing drives it, and attractors are told by the drive's period; give it a [drive]";
    for (int i = 0; i < b->model->n_inputs; i++) {
        double turns = sounds(&b->drive[i]) ? b->drive[i].omega / slowest : 0.0;
        b->turns[i] = round(turns);
        if (fabs(turns - b->turns[i]) > whole * turns || turns > turns_max)
            return "its drives share no period; give frequencies that are whole multiples of the lowest, to "
                   "1000 times";
    }
    b->period = 2.0 * ELEMENTARY_PI / slowest;
    return NULL;
}

/* Input i over tick k of n. */
static void set_wave(const struct basin_plant *b, int i, int k, int n, struct wave *w)
{
    double turns = b->drive[i].phase / (2.0 * ELEMENTARY_PI);
    double begin = fmod(b->turns[i] * k, n) / n;
    *w = (struct wave){.amplitude = b->drive[i].amplitude,
                       .omega = b->turns[i] * 2.0 * ELEMENTARY_PI / b->period};
    cos_sin_turns(turns_of(begin) + turns_of(turns), &w->cosine, &w->sine);
}

static void set_tick(const struct basin_plant *b, int k, int n, struct excitation *e)
{
    *e = (struct excitation){.length = b->period / n};
    for (int i = 0; i < b->model->n_inputs; i++) {
        e->wave[i].cosine = 1.0;
        if (!(b->drive[i].amplitude < 0.0) && !(b->drive[i].amplitude > 0.0))
            continue;
        e->active |= 1u << i;
        set_wave(b, i, k, n, &e->wave[i]);
        for (int j = 0; j < 3; j++)
            wave_at(&e->wave[i], 0.5 * j * e->length, &e->at[j][i]);
    }
}

static unsigned regime_of(const struct basin_plant *b, const struct input *u, const double *x)
{
    struct input gap[MODEL_CONTACTS];
    unsigned regime = 0;
    b->model->gap(b->p, u, x, gap);
    for (int i = 0; i < b->model->n_contacts; i++)
        regime |= (unsigned)(gap[i].value < 0.0) << i;
    return regime;
}

/* A method may make its tables at the first tick in a regime: so that no motion sees the difference, there was one. */
static void warm(const struct basin_map *map)
{
    const struct basin_plant *b = map->plant;
    for (unsigned regime = 0; regime < 1u << b->model->n_contacts; regime++) {
        double x[MODEL_STATES];
        struct crossing c = {0.0, 0, 0};
        b->model->rest(b->p, x);
        (void)b->method->bind(b->model)(b->model, b->p, map->work, map->tick, regime, x, &c);
    }
}

bool basin_map_start(struct basin_map *map, const struct basin_plant *b, int steps)
{
    *map = (struct basin_map){.plant = b, .steps = steps};
    map->work = calloc(b->method->n_work(b->model) + 1, sizeof *map->work);
    map->tick = calloc((size_t)steps, sizeof *map->tick);
    if (!map->work || !map->tick) {
        basin_map_end(map);
        return false;
    }
    for (int k = 0; k < steps; k++)
        set_tick(b, k, steps, &map->tick[k]);
    if (b->method->prepare)
        b->method->prepare(b->model, b->p, b->period / steps, b->tol, map->work);
    warm(map);
    return true;
}

void basin_map_end(struct basin_map *map)
{
    free(map->work);
    free(map->tick);
    map->work = NULL;
    map->tick = NULL;
}

static bool inside(const struct basin_plant *b, const double *x)
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

static void add(struct basin_sum *sum, const struct basin_plant *b, const struct input *u, const double *x)
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

/* One tick, cut at its switches. */
static enum basin_status advance_tick(const struct basin_map *map, step_function *step,
                                      const struct excitation *tick, unsigned *regime, double *x,
                                      struct basin_sum *sum)
{
    const struct basin_plant *b = map->plant;
    const struct excitation *e = tick;
    struct excitation rest;
    for (int piece = 0; piece < BASIN_PIECES; piece++) {
        struct crossing c = {0.0, 0, 0};
        enum step_status status = step(b->model, b->p, map->work, e, *regime, x, &c);
        if (sum && *regime == 0)
            sum->open += status == STEP_END ? e->length : c.done;
        if (status == STEP_END)
            return inside(b, x) ? BASIN_GOOD : BASIN_ESCAPED;
        if (status == STEP_NOT_FINITE || !inside(b, x))
            return BASIN_ESCAPED;
        if (c.residual)
            return BASIN_UNLOCATED;
        if (e == tick)
            rest = *tick;
        excitation_tail(&rest, b->model->n_inputs, c.done);
        e = &rest;
        if (status == STEP_SWITCH)
            *regime ^= 1u << c.contact;
        if (sum)
            sum->switches += status == STEP_SWITCH;
    }
    return BASIN_UNLOCATED;
}

enum basin_status basin_map_advance(const struct basin_map *map, double *x, struct basin_sum *sum)
{
    const struct basin_plant *b = map->plant;
    step_function *step = b->method->bind(b->model);
    unsigned regime = regime_of(b, map->tick[0].at[0], x);
    for (int k = 0; k < map->steps; k++) {
        const struct excitation *tick = &map->tick[k];
        enum basin_status status = advance_tick(map, step, tick, &regime, x, sum);
        if (status != BASIN_GOOD)
            return status;
        if (sum)
            add(sum, b, tick->at[2], x);
    }
    return BASIN_GOOD;
}
