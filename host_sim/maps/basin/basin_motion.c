/* basin_motion.c - the starts of a block settle side by side; then their motions and growth are measured. */
#include "host_sim/maps/basin/basin_motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/maps/basin/basin_settle.h"

static const double small = 1e-6; /* distance of two neighbours, over 1 + size */

const char *const basin_outcome_name[] = {"settled", "unsettled", "escaped", "trouble", NULL};

/* ---- plants side by side ---- */

/* A start under way, and the sums over its motion. */
struct start {
    struct basin_motion *m;
    struct basin_lane lane, neighbour;
    struct basin_repeat repeat;
    struct basin_sum sum;
    int period; /* forcing periods of the present stage so far */
    double logarithm, slope;
};

/* All starts of a block. Each stage begins at phase 0. */
struct block {
    const struct basin_patience *s;
    int n;
    struct start *start;
    int *left; /* [n] starts that are still under way */
    double *scratch;
};

/* Runs a start through the k-th period of the map's table: true when its stage is over. */
typedef bool period_function(const struct basin_map *map, int k, const struct basin_patience *s,
                             struct start *a);

/* A stage, for all starts of the block that have an attractor. */
static void walk(struct block *b, struct basin_map *map, period_function *period)
{
    int n = 0;
    for (int i = 0; i < b->n; i++)
        if (b->start[i].m->outcome == BASIN_SETTLED || b->start[i].m->outcome == BASIN_UNSETTLED)
            b->left[n++] = i;
    for (basin_map_rewind(map); n > 0; basin_map_next(map)) {
        int stay = 0;
        for (int i = 0; i < n; i++) {
            bool done = false;
            for (int k = 0; k < map->periods && !done; k++)
                done = period(map, k, b->s, &b->start[b->left[i]]);
            if (!done)
                b->left[stay++] = b->left[i];
        }
        n = stay;
    }
}

/* ---- settling ---- */

static bool settle_period(const struct basin_map *map, int k, const struct basin_patience *s, struct start *a)
{
    struct basin_motion *m = a->m;
    enum basin_status status = basin_lane_advance(map, k, &a->lane, NULL);
    if (status != BASIN_GOOD) {
        basin_motion_fail(m, status);
        return true;
    }
    m->periods++;
    m->period = basin_repeat_see(&a->repeat, a->lane.x, map->plant->model->n_states, s->repeat);
    if (m->period > 0)
        m->outcome = BASIN_SETTLED;
    return m->period > 0 || m->periods == s->bound;
}

static void settle(struct block *b, struct basin_map *map, double (*x)[MODEL_STATES])
{
    for (int i = 0; i < b->n; i++) {
        basin_lane_start(map, &b->start[i].lane, x[i]);
        basin_repeat_start(&b->start[i].repeat, x[i], map->plant->model->n_states);
    }
    walk(b, map, settle_period);
    for (int i = 0; i < b->n; i++)
        memcpy(x[i], b->start[i].lane.x, sizeof x[i]);
}

/* ---- measuring ---- */

static void take_sum(const struct basin_sum *sum, int n, struct basin_motion *m)
{
    m->open = sum->open / sum->time;
    m->peak = sum->peak;
    for (int i = 0; i < n; i++) {
        m->mean[i] = sum->x[i] / sum->ticks;
        m->rms[i] = sqrt(sum->square[i] / sum->ticks);
    }
}

/* Means over one period of a settled motion, or BASIN_WANDER forcing periods of another one. */
static bool measure_period(const struct basin_map *fine, int k, const struct basin_patience *s,
                           struct start *a)
{
    enum basin_status status = basin_lane_advance(fine, k, &a->lane, &a->sum);
    (void)s;
    if (status != BASIN_GOOD)
        basin_motion_fail(a->m, status);
    if (status != BASIN_GOOD || ++a->period < (a->m->period > 0 ? a->m->period : BASIN_WANDER))
        return status != BASIN_GOOD;
    take_sum(&a->sum, fine->plant->model->n_states, a->m);
    return true;
}

static void measure(struct block *b, struct basin_map *fine)
{
    for (int i = 0; i < b->n; i++) {
        struct start *a = &b->start[i];
        a->period = 0;
        basin_sum_start(&a->sum);
        basin_lane_start(fine, &a->lane, a->m->end);
    }
    walk(b, fine, measure_period);
}

/* Runs a plant and its neighbour through a period, then moves the neighbour back to its distance. Tells
 * the logarithm of the growth in between. */
static enum basin_status stretch(const struct basin_map *map, int k, struct start *a, double *logarithm)
{
    int n = map->plant->model->n_states;
    const double *x = a->lane.x;
    double y[MODEL_STATES] = {0.0};
    enum basin_status status = basin_lane_advance(map, k, &a->lane, NULL);
    if (status == BASIN_GOOD)
        status = basin_lane_advance(map, k, &a->neighbour, NULL);
    if (status != BASIN_GOOD)
        return status;
    double d = fmax(basin_distance(x, a->neighbour.x, n), 1e-300), wanted = small * (1.0 + basin_size(x, n));
    for (int i = 0; i < n; i++)
        y[i] = x[i] + (a->neighbour.x[i] - x[i]) * (wanted / d);
    basin_lane_set(map, &a->neighbour, map->tick[(k + 1) * map->steps - 1].at[2], y);
    *logarithm = log(d / wanted);
    return BASIN_GOOD;
}

/* Growth is the slope, by least squares, of the sum of logarithms over the periods: single ones swing. */
static bool grow_period(const struct basin_map *map, int k, const struct basin_patience *s, struct start *a)
{
    int periods = a->m->period > 0 ? BASIN_GROWTH_SETTLED : BASIN_GROWTH_UNSETTLED;
    double one;
    enum basin_status status = stretch(map, k, a, &one);
    (void)s;
    if (status != BASIN_GOOD) {
        basin_motion_fail(a->m, status);
        return true;
    }
    a->logarithm += one;
    a->slope += a->period < 0 ? 0.0 : (a->period - 0.5 * (periods - 1)) * a->logarithm;
    if (++a->period < periods)
        return false;
    a->m->growth = a->slope * 12.0 / (periods * ((double)periods * periods - 1.0));
    return true;
}

static void measure_growth(struct block *b, struct basin_map *map)
{
    int n = map->plant->model->n_states;
    for (int i = 0; i < b->n; i++) {
        struct start *a = &b->start[i];
        const double *x = a->m->end;
        double y[MODEL_STATES] = {0.0};
        for (int j = 0; j < n; j++)
            y[j] = x[j] + small * (1.0 + basin_size(x, n)) / (j + 1); /* no direction of a symmetry */
        a->period = -BASIN_GROWTH_SKIP;
        a->logarithm = a->slope = 0.0;
        basin_lane_start(map, &a->lane, x);
        basin_lane_start(map, &a->neighbour, y);
    }
    walk(b, map, grow_period);
}

static const char *find(struct block *b, struct basin_map *map, struct basin_map *fine,
                        double (*x)[MODEL_STATES], struct basin_motion *motion)
{
    for (int i = 0; i < b->n; i++) {
        motion[i] = (struct basin_motion){.outcome = BASIN_UNSETTLED};
        b->start[i] = (struct start){.m = &motion[i],
                                     .lane.scratch = &b->scratch[2 * (size_t)i * map->n_scratch],
                                     .neighbour.scratch = &b->scratch[(2 * (size_t)i + 1) * map->n_scratch]};
    }
    if (basin_settle_batched(map->plant)) {
        const char *why = basin_settle(map, b->s, b->n, x, motion);
        if (why)
            return why;
    } else {
        settle(b, map, x);
    }
    for (int i = 0; i < b->n; i++)
        memcpy(motion[i].end, x[i], sizeof motion[i].end);
    measure(b, fine);
    measure_growth(b, map);
    return NULL;
}

const char *basin_motion_find(const struct basin_plant *b, const struct basin_patience *s, int n,
                              double (*x)[MODEL_STATES], struct basin_motion *motion)
{
    struct basin_map map, fine = {.plant = NULL};
    struct block block = {.s = s, .n = n};
    const char *why = basin_map_start(&map, b, b->steps);
    if (!why)
        why = basin_map_start(&fine, b, b->steps > BASIN_FINE ? b->steps : BASIN_FINE);
    block.start = calloc((size_t)n, sizeof *block.start);
    block.left = calloc((size_t)n, sizeof *block.left);
    block.scratch = calloc(2 * (size_t)n * map.n_scratch + 1, sizeof *block.scratch);
    if (!why)
        why = block.start && block.left && block.scratch ? find(&block, &map, &fine, x, motion)
                                                         : "out of memory";
    free(block.start);
    free(block.left);
    free(block.scratch);
    basin_map_end(&map);
    basin_map_end(&fine);
    return why;
}
