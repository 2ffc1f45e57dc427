/* basin_motion.c - see basin_motion.h. */
#include "host_sim/basin_motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/batch_rk4.h"
#include "host_sim/batch_taylor.h"
#include "models/elementary.h"

enum { CHUNK = 32, /* periods of a batch between two looks at it */ RETURNS = 3 };
static const double small = 1e-6; /* distance of the growth, of 1 + size */

const char *const basin_outcome_name[BASIN_OUTCOMES] = {"settled", "unsettled", "escaped", "trouble"};

static double size_of(const double *x, int n)
{
    double size = 0.0;
    for (int i = 0; i < n; i++)
        size = fmax(size, fabs(x[i]));
    return size;
}

static double distance(const double *a, const double *b, int n)
{
    double d = 0.0;
    for (int i = 0; i < n; i++)
        d = fmax(d, fabs(a[i] - b[i]));
    return d;
}

void basin_repeat_start(struct basin_repeat *r, const double *x, int n)
{
    memcpy(r->reference, x, (size_t)n * sizeof *x);
    r->since = r->period = 0;
}

/* The smallest divisor of the period after which it was nearly back too. */
static int shortest(const struct basin_repeat *r, double near)
{
    for (int k = 1; k < r->period; k++)
        if (r->period % k == 0 && r->apart[k] <= BASIN_DIVISOR * near)
            return k;
    return r->period;
}

int basin_repeat_see(struct basin_repeat *r, const double *x, int n, double tolerance)
{
    double near = tolerance * (1.0 + size_of(x, n)), apart = distance(r->reference, x, n);
    r->since++;
    if (r->since <= BASIN_PERIODS)
        r->apart[r->since] = apart;
    if (r->period == 0 && apart <= near)
        r->period = r->since;
    if (r->period > 0 && apart <= near && r->since == RETURNS * r->period)
        return shortest(r, near);
    bool missed = r->period > 0 ? r->since % r->period == 0 && !(apart <= near) : r->since == BASIN_PERIODS;
    if (missed)
        basin_repeat_start(r, x, n);
    return 0;
}

static void fail(struct basin_motion *m, enum basin_status status)
{
    m->outcome = status == BASIN_ESCAPED ? BASIN_GONE : BASIN_TROUBLE;
    m->period = 0;
}

/* ---- settling ---- */

static void settle(const struct basin_map *map, const struct basin_patience *s, double *x,
                   struct basin_motion *m)
{
    int n = map->plant->model->n_states;
    struct basin_repeat r;
    basin_repeat_start(&r, x, n);
    for (m->periods = 1; m->periods <= s->bound; m->periods++) {
        enum basin_status status = basin_map_advance(map, x, NULL);
        if (status != BASIN_GOOD) {
            fail(m, status);
            return;
        }
        m->period = basin_repeat_see(&r, x, n, s->repeat);
        if (m->period > 0) {
            m->outcome = BASIN_SETTLED;
            return;
        }
    }
    m->periods = s->bound;
}

/* Starts side by side. Those that are told leave; the others go on in a smaller batch. */
struct herd {
    const struct basin_plant *b;
    const struct basin_patience *s;
    double (*x)[MODEL_STATES];
    struct basin_motion *motion;
    struct basin_repeat *repeat; /* [n] */
    int *left;                   /* [n_left] which are still under way */
    int n_left;
    void *memory;
    double *samples; /* [CHUNK][2][n_left], states */
};

/* What became of a trajectory of the batch. */
struct fate {
    int64_t periods;
    enum basin_status status;
};

static const char *run_rk4(struct herd *h, struct fate *fate)
{
    const struct basin_plant *b = h->b;
    struct batch_rk4 batch;
    struct drive_setting drive[MODEL_INPUTS];
    struct batch_rk4_lane lane = {.p = b->p, .step = b->period / b->steps};
    for (int i = 0; i < b->model->n_inputs; i++) {
        const struct harmonic *d = &b->drive[i];
        lane.amplitude[i] = d->amplitude;
        drive[i] =
            (struct drive_setting){d->amplitude, b->turns[i] / b->steps, d->phase / (2.0 * ELEMENTARY_PI), 0};
    }
    const char *why = batch_rk4_init(&batch, h->n_left, b->model, drive, h->memory);
    batch.again = true;
    for (int k = 0; k < h->n_left && !why; k++) {
        memcpy(lane.x, h->x[h->left[k]], sizeof lane.x);
        why = batch_rk4_set(&batch, k, &lane);
    }
    if (!why)
        why = batch_rk4(&batch, b->steps, CHUNK, h->samples);
    for (int k = 0; k < h->n_left && !why; k++)
        fate[k] = (struct fate){batch_rk4_intervals(&batch, k),
                                batch_rk4_good(&batch, k) ? BASIN_GOOD : BASIN_ESCAPED};
    return why;
}

static const char *run_taylor(struct herd *h, struct fate *fate)
{
    const struct basin_plant *b = h->b;
    struct batch_taylor batch;
    struct batch_trajectory t = {.model = b->model, .p = b->p, .interval = b->period};
    const char *why = NULL;
    int n = h->n_left;
    memcpy(t.drive, b->drive, sizeof t.drive);
    batch_taylor_init(&batch, n, h->memory);
    for (int k = 0; k < n && !why; k++) {
        memcpy(t.x, h->x[h->left[k]], sizeof t.x);
        why = batch_taylor_set(&batch, k, &t);
    }
    if (!why)
        why = batch_taylor(&batch, b->tol, CHUNK, h->samples);
    for (int k = 0; k < n && !why; k++) {
        fate[k] = (struct fate){batch.intervals[k],
                                batch.status[k] == BATCH_ESCAPED ? BASIN_ESCAPED : BASIN_UNLOCATED};
        for (int j = 0; j < CHUNK; j++) {
            double *at = &h->samples[2 * j * n + k], x[2];
            batch_taylor_state(&t, 0.0, at[0], at[n], x);
            at[0] = x[0];
            at[n] = x[1];
        }
    }
    return why;
}

/* Trajectory k of the batch through its samples: true when it is told. */
static bool look(struct herd *h, int k, const struct fate *fate)
{
    int i = h->left[k], n = h->n_left;
    struct basin_motion *m = &h->motion[i];
    for (int j = 0; j < CHUNK && m->periods < h->s->bound; j++) {
        if (j >= fate->periods) {
            fail(m, fate->status);
            return true;
        }
        m->periods++;
        h->x[i][0] = h->samples[2 * j * n + k];
        h->x[i][1] = h->samples[(2 * j + 1) * n + k];
        m->period = basin_repeat_see(&h->repeat[i], h->x[i], 2, h->s->repeat);
        if (m->period > 0) {
            m->outcome = BASIN_SETTLED;
            return true;
        }
    }
    return m->periods == h->s->bound;
}

static const char *run_herd(struct herd *h, struct fate *fate)
{
    while (h->n_left > 0) {
        const char *why = h->b->series ? run_taylor(h, fate) : run_rk4(h, fate);
        int stay = 0;
        if (why)
            return why;
        for (int k = 0; k < h->n_left; k++) {
            if (!look(h, k, &fate[k]))
                h->left[stay++] = h->left[k];
        }
        h->n_left = stay;
    }
    return NULL;
}

static const char *settle_batch(const struct basin_plant *b, const struct basin_patience *s, int n,
                                double (*x)[MODEL_STATES], struct basin_motion *motion)
{
    struct herd h = {.b = b, .s = s, .x = x, .motion = motion, .n_left = n};
    const char *why = "no memory";
    struct fate *fate = calloc((size_t)n, sizeof *fate);
    h.repeat = calloc((size_t)n, sizeof *h.repeat);
    h.left = calloc((size_t)n, sizeof *h.left);
    h.memory = malloc(b->series ? batch_taylor_bytes(n) : batch_rk4_bytes(n));
    h.samples = malloc((size_t)n * 2 * CHUNK * sizeof *h.samples);
    if (fate && h.repeat && h.left && h.memory && h.samples) {
        for (int i = 0; i < n; i++) {
            h.left[i] = i;
            basin_repeat_start(&h.repeat[i], x[i], 2);
        }
        why = run_herd(&h, fate);
    }
    free(fate);
    free(h.repeat);
    free(h.left);
    free(h.memory);
    free(h.samples);
    return why;
}

/* ---- measuring ---- */

static void take_sum(const struct basin_sum *sum, int n, double time, struct basin_motion *m)
{
    m->open = sum->open / time;
    m->peak = sum->peak;
    for (int i = 0; i < n; i++) {
        m->mean[i] = sum->x[i] / sum->ticks;
        m->rms[i] = sqrt(sum->square[i] / sum->ticks);
    }
}

/* Means over a whole period of a settled motion, or over a while of another one. */
static enum basin_status measure(const struct basin_map *fine, const double *x0, struct basin_motion *m)
{
    struct basin_sum sum;
    double x[MODEL_STATES];
    int periods = m->period > 0 ? m->period : BASIN_WANDER;
    memcpy(x, x0, sizeof x);
    basin_sum_start(&sum);
    for (int i = 0; i < periods; i++) {
        enum basin_status status = basin_map_advance(fine, x, &sum);
        if (status != BASIN_GOOD)
            return status;
    }
    take_sum(&sum, fine->plant->model->n_states, periods * fine->plant->period, m);
    return BASIN_GOOD;
}

/* x and a neighbour a period on, and the neighbour back to its distance: the logarithm of what it had become. */
static enum basin_status stretch(const struct basin_map *map, double *x, double *y, double *logarithm)
{
    int n = map->plant->model->n_states;
    enum basin_status status = basin_map_advance(map, x, NULL);
    if (status == BASIN_GOOD)
        status = basin_map_advance(map, y, NULL);
    if (status != BASIN_GOOD)
        return status;
    double d = fmax(distance(x, y, n), 1e-300), wanted = small * (1.0 + size_of(x, n));
    for (int i = 0; i < n; i++)
        y[i] = x[i] + (y[i] - x[i]) * (wanted / d);
    *logarithm = log(d / wanted);
    return BASIN_GOOD;
}

/* The slope, by least squares, of the sum of logarithms over the periods: the distance itself swings. */
static enum basin_status measure_growth(const struct basin_map *map, const double *x0, struct basin_motion *m)
{
    double x[MODEL_STATES], y[MODEL_STATES], sum = 0.0, slope = 0.0, one;
    int n = map->plant->model->n_states;
    int periods = m->period > 0 ? BASIN_GROWTH_SETTLED : BASIN_GROWTH_UNSETTLED;
    memcpy(x, x0, sizeof x);
    for (int i = 0; i < n; i++)
        y[i] = x[i] + small * (1.0 + size_of(x, n)) / (i + 1); /* no symmetry's own direction */
    for (int i = -BASIN_GROWTH_SKIP; i < periods; i++) {
        enum basin_status status = stretch(map, x, y, &one);
        if (status != BASIN_GOOD)
            return status;
        sum += one;
        slope += i < 0 ? 0.0 : (i - 0.5 * (periods - 1)) * sum;
    }
    m->growth = slope * 12.0 / (periods * ((double)periods * periods - 1.0));
    return BASIN_GOOD;
}

static void measure_all(const struct basin_map *map, const struct basin_map *fine, const double *x,
                        struct basin_motion *m)
{
    memcpy(m->end, x, sizeof m->end);
    if (m->outcome == BASIN_GONE || m->outcome == BASIN_TROUBLE)
        return;
    enum basin_status status = measure(fine, x, m);
    if (status == BASIN_GOOD)
        status = measure_growth(map, x, m);
    if (status != BASIN_GOOD)
        fail(m, status);
}

const char *basin_motion_find(const struct basin_plant *b, const struct basin_patience *s, int n,
                              double (*x)[MODEL_STATES], struct basin_motion *motion)
{
    struct basin_map map = {.plant = NULL}, fine = {.plant = NULL};
    bool batched = b->model->hertz_form && (b->series || b->method == &rk4);
    const char *why = NULL;
    for (int i = 0; i < n; i++)
        motion[i] = (struct basin_motion){.outcome = BASIN_UNSETTLED};
    if (!basin_map_start(&map, b, b->steps) ||
        !basin_map_start(&fine, b, b->steps > BASIN_FINE ? b->steps : BASIN_FINE))
        why = "no memory";
    if (!why && batched)
        why = settle_batch(b, s, n, x, motion);
    for (int i = 0; i < n && !why; i++) {
        if (!batched)
            settle(&map, s, x[i], &motion[i]);
        measure_all(&map, &fine, x[i], &motion[i]);
    }
    basin_map_end(&map);
    basin_map_end(&fine);
    return why;
}
