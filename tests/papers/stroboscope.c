/* stroboscope.c - see stroboscope.h. */
#include "tests/papers/stroboscope.h"

#include <math.h>
#include <stdlib.h>
#include "models/math/elementary.h"

enum { PIECES = 64 };

/* Input i over tick k of n. */
static void set_wave(const struct basin_plant *b, int i, int k, int n, struct wave *w)
{
    double turns = b->drive[i].phase / (2.0 * ELEMENTARY_PI);
    double begin = fmod(b->turns[i] * k, n) / n;
    *w = (struct wave){.amplitude = b->drive[i].amplitude,
                       .omega = b->turns[i] * 2.0 * ELEMENTARY_PI / b->period};
    cos_sin_turns(turns_of(begin) + turns_of(turns), &w->cosine, &w->sine);
}

static void set_tick(const struct basin_plant *b, int k, int n, struct segment *e)
{
    *e = (struct segment){.length = b->period / n};
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

/* A method may make its tables at the first tick in a regime:
 * so that no motion sees the difference, there was one. */
static void warm(const struct stroboscope *map)
{
    const struct basin_plant *b = map->plant;
    for (unsigned regime = 0; regime < 1u << b->model->n_contacts; regime++) {
        double x[MODEL_STATES];
        struct crossing c = {0.0, 0, 0, 0.0};
        b->model->rest(b->p, x);
        (void)b->method->bind(b->model)(b->model, b->p, map->scratch, map->tick, regime, x, &c);
    }
}

bool stroboscope_start(struct stroboscope *map, const struct basin_plant *b, int steps)
{
    *map = (struct stroboscope){.plant = b, .steps = steps};
    map->scratch = calloc(b->method->n_scratch(b->model) + 1, sizeof *map->scratch);
    map->tick = calloc((size_t)steps, sizeof *map->tick);
    if (!map->scratch || !map->tick) {
        stroboscope_end(map);
        return false;
    }
    for (int k = 0; k < steps; k++)
        set_tick(b, k, steps, &map->tick[k]);
    if (b->method->prepare)
        b->method->prepare(b->model, b->p, b->period / steps, b->tol, map->scratch);
    warm(map);
    return true;
}

void stroboscope_end(struct stroboscope *map)
{
    free(map->scratch);
    free(map->tick);
    map->scratch = NULL;
    map->tick = NULL;
}

void stroboscope_sum_start(struct stroboscope_sum *sum)
{
    *sum = (struct stroboscope_sum){.open = 0.0};
    for (int i = 0; i < MODEL_STATES; i++) {
        sum->high[i] = -(double)INFINITY;
        sum->low[i] = (double)INFINITY;
    }
}

static void add_tick(struct stroboscope_sum *sum, const struct model *m, const double *x)
{
    for (int i = 0; i < m->n_states; i++) {
        sum->high[i] = fmax(sum->high[i], x[i]);
        sum->low[i] = fmin(sum->low[i], x[i]);
    }
}

/* Which contacts are closed under inputs u, bit i: contact i. */
static unsigned find_regime(const struct basin_plant *b, const struct input *u, const double *x)
{
    struct input gap[MODEL_CONTACTS];
    unsigned regime = 0;
    b->model->gap(b->p, u, x, gap);
    for (int i = 0; i < b->model->n_contacts; i++)
        regime |= (unsigned)(gap[i].value < 0.0) << i;
    return regime;
}

/* One tick, cut at its switches. */
static enum basin_status advance_tick(const struct stroboscope *map, step_function *step,
                                      const struct segment *tick, unsigned *regime, double *x,
                                      struct stroboscope_sum *sum)
{
    const struct basin_plant *b = map->plant;
    const struct segment *e = tick;
    struct segment rest;
    for (int piece = 0; piece < PIECES; piece++) {
        struct crossing c = {0.0, 0, 0, 0.0};
        enum step_status status = step(b->model, b->p, map->scratch, e, *regime, x, &c);
        if (sum && *regime == 0)
            sum->open += status == STEP_END ? e->length : c.done;
        if (status == STEP_END)
            return basin_map_inside(b, x) ? BASIN_GOOD : BASIN_ESCAPED;
        if (status == STEP_NOT_FINITE || !basin_map_inside(b, x))
            return BASIN_ESCAPED;
        if (c.residual)
            return BASIN_UNLOCATED;
        if (e == tick)
            rest = *tick;
        segment_tail(&rest, b->model->n_inputs, c.done);
        e = &rest;
        if (status == STEP_SWITCH)
            *regime ^= 1u << c.contact;
        if (sum)
            sum->switches += status == STEP_SWITCH;
    }
    return BASIN_UNLOCATED;
}

enum basin_status stroboscope_advance(const struct stroboscope *map, double *x, struct stroboscope_sum *sum)
{
    const struct basin_plant *b = map->plant;
    step_function *step = b->method->bind(b->model);
    unsigned regime = find_regime(b, map->tick[0].at[0], x);
    for (int k = 0; k < map->steps; k++) {
        const struct segment *tick = &map->tick[k];
        enum basin_status status = advance_tick(map, step, tick, &regime, x, sum);
        if (status != BASIN_GOOD)
            return status;
        if (sum)
            add_tick(sum, b->model, x);
    }
    return BASIN_GOOD;
}
