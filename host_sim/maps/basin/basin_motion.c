/* basin_motion.c - each start of a block settles; then its motion and growth are measured. */
#include "host_sim/maps/basin/basin_motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/maps/basin/basin_repeat.h"
#include "host_sim/maps/basin/basin_settle.h"

static const double small = 1e-6; /* distance of two neighbours, over 1 + size */

const char *const basin_outcome_name[] = {"settled", "unsettled", "escaped", "trouble", NULL};

/* Memory of a plant and its neighbour. */
struct pair {
    struct plant plant, neighbour;
    double *scratch[2];
};

/* ---- settling ---- */

/* From x to where it ends. */
static void settle(const struct basin_map *map, const struct basin_patience *s, struct pair *a, double *x,
                   struct basin_motion *m)
{
    int n = map->plant->model->n_states;
    struct basin_repeat repeat;
    enum basin_status status = BASIN_GOOD;
    basin_map_place(map, x, &a->plant, a->scratch[0]);
    basin_repeat_start(&repeat, x, n);
    while (m->period == 0 && m->periods < s->bound) {
        status = basin_map_advance(map, &a->plant, NULL, NULL);
        if (status != BASIN_GOOD)
            break;
        m->periods++;
        m->period = basin_repeat_see(&repeat, a->plant.x, n, s->repeat);
    }
    if (status != BASIN_GOOD)
        basin_motion_fail(m, status);
    else if (m->period > 0)
        m->outcome = BASIN_SETTLED;
    memcpy(x, a->plant.x, (size_t)n * sizeof *x);
}

/* ---- measuring ---- */

/* Sums over ticks. */
struct sums {
    int observable;
    double ticks, peak, x[MODEL_STATES], square[MODEL_STATES];
};

static void add_tick(void *who, const struct plant *pl)
{
    struct sums *sum = who;
    double out[MODEL_OUTPUTS];
    pl->model->output(pl->p, pl->segment.at[2], pl->x, out);
    sum->peak = fmax(sum->peak, out[sum->observable]);
    sum->ticks += 1.0;
    for (int i = 0; i < pl->model->n_states; i++) {
        sum->x[i] += pl->x[i];
        sum->square[i] += pl->x[i] * pl->x[i];
    }
}

/* Means over one period of a settled motion, or BASIN_WANDER forcing periods of another one. */
static enum basin_status measure(const struct basin_map *fine, struct pair *a, struct basin_motion *m)
{
    const struct plant *pl = &a->plant;
    struct sums sum = {.observable = fine->plant->observable, .peak = -(double)INFINITY};
    basin_map_place(fine, m->end, &a->plant, a->scratch[0]);
    for (int k = 0; k < (m->period > 0 ? m->period : BASIN_WANDER); k++) {
        enum basin_status status = basin_map_advance(fine, &a->plant, add_tick, &sum);
        if (status != BASIN_GOOD)
            return status;
    }
    m->open = pl->loss_time / pl->total_time;
    m->peak = sum.peak;
    for (int i = 0; i < pl->model->n_states; i++) {
        m->mean[i] = sum.x[i] / sum.ticks;
        m->rms[i] = sqrt(sum.square[i] / sum.ticks);
    }
    return BASIN_GOOD;
}

/* Runs a plant and its neighbour through a period, then moves the neighbour back to its distance. Tells
 * the logarithm of the growth in between. */
static enum basin_status stretch(const struct basin_map *map, struct pair *a, double *logarithm)
{
    int n = map->plant->model->n_states;
    const double *x = a->plant.x;
    double y[MODEL_STATES];
    enum basin_status status = basin_map_advance(map, &a->plant, NULL, NULL);
    if (status == BASIN_GOOD)
        status = basin_map_advance(map, &a->neighbour, NULL, NULL);
    if (status != BASIN_GOOD)
        return status;
    double d = fmax(basin_distance(x, a->neighbour.x, n), 1e-300), wanted = small * (1.0 + basin_size(x, n));
    for (int i = 0; i < n; i++)
        y[i] = x[i] + (a->neighbour.x[i] - x[i]) * (wanted / d);
    plant_set_state(&a->neighbour, y);
    *logarithm = log(d / wanted);
    return BASIN_GOOD;
}

/* Growth is the slope, by least squares, of the sum of logarithms over the periods: single ones swing. */
static enum basin_status measure_growth(const struct basin_map *map, struct pair *a, struct basin_motion *m)
{
    int n = map->plant->model->n_states;
    int periods = m->period > 0 ? BASIN_GROWTH_SETTLED : BASIN_GROWTH_UNSETTLED;
    double y[MODEL_STATES], one, logarithm = 0.0, slope = 0.0;
    for (int i = 0; i < n; i++)
        y[i] = m->end[i] + small * (1.0 + basin_size(m->end, n)) / (i + 1); /* no direction of a symmetry */
    basin_map_place(map, m->end, &a->plant, a->scratch[0]);
    basin_map_place(map, y, &a->neighbour, a->scratch[1]);
    for (int k = -BASIN_GROWTH_SKIP; k < periods; k++) {
        enum basin_status status = stretch(map, a, &one);
        if (status != BASIN_GOOD)
            return status;
        logarithm += one;
        slope += k < 0 ? 0.0 : (k - 0.5 * (periods - 1)) * logarithm;
    }
    m->growth = slope * 12.0 / (periods * ((double)periods * periods - 1.0));
    return BASIN_GOOD;
}

/* ---- one start after the other ---- */

static const char *find_motions(const struct basin_map *map, const struct basin_map *fine,
                                const struct basin_patience *s, struct pair *a, int n,
                                double (*x)[MODEL_STATES], struct basin_motion *motion)
{
    const char *why = NULL;
    for (int i = 0; i < n; i++)
        motion[i] = (struct basin_motion){.outcome = BASIN_UNSETTLED};
    if (map->plant->series)
        why = basin_settle(map->plant, s, n, x, motion);
    for (int i = 0; i < n && !why; i++) {
        struct basin_motion *m = &motion[i];
        if (!map->plant->series)
            settle(map, s, a, x[i], m);
        memcpy(m->end, x[i], sizeof m->end);
        if (m->outcome != BASIN_SETTLED && m->outcome != BASIN_UNSETTLED)
            continue;
        enum basin_status status = measure(fine, a, m);
        if (status == BASIN_GOOD)
            status = measure_growth(map, a, m);
        if (status != BASIN_GOOD)
            basin_motion_fail(m, status);
    }
    return why;
}

const char *basin_motion_find(const struct basin_plant *b, const struct basin_patience *s, int n,
                              double (*x)[MODEL_STATES], struct basin_motion *motion)
{
    struct basin_map map, fine = {.plant = NULL};
    struct pair a;
    const char *why = basin_map_start(&map, b, b->steps);
    if (!why)
        why = basin_map_start(&fine, b, b->steps > BASIN_FINE ? b->steps : BASIN_FINE);
    double *scratch = why ? NULL : calloc(2 * map.n_scratch + 1, sizeof *scratch);
    if (scratch) {
        a.scratch[0] = scratch;
        a.scratch[1] = scratch + map.n_scratch;
        why = find_motions(&map, &fine, s, &a, n, x, motion);
    } else if (!why) {
        why = "out of memory";
    }
    free(scratch);
    basin_map_end(&map);
    basin_map_end(&fine);
    return why;
}
