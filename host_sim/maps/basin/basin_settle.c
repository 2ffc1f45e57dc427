/* basin_settle.c - starts that settle side by side in a batch kernel. */
#include "host_sim/maps/basin/basin_settle.h"

#include <stdlib.h>
#include <string.h>
#include "host_sim/batch/batch_rk4.h"
#include "host_sim/batch/batch_taylor.h"

/* Starts side by side. A start that has settled leaves; the others continue in a smaller batch. */
struct herd {
    const struct basin_plant *b;
    const struct plant *begin; /* the plant at phase 0 */
    const struct basin_patience *s;
    double (*x)[MODEL_STATES];
    struct basin_motion *motion;
    struct basin_repeat *repeat; /* [n] */
    int *left;                   /* [n_left] starts that are still under way */
    int n_left;
    struct drive drive[MODEL_INPUTS]; /* drives of batch_rk4, with amplitude 1, once it has begun */
    bool begun;
    void *memory;
    double *samples; /* [BASIN_CHUNK][2][n_left], states */
};

/* How a trajectory of the batch ended. */
struct fate {
    int64_t periods;
    enum basin_status status;
};

/* Makes a batch of the starts that are left. Its drives continue. */
static const char *init_rk4(struct herd *h, struct batch_rk4 *batch)
{
    struct drive_setting drive[MODEL_INPUTS];
    for (int i = 0; i < h->b->model->n_inputs; i++)
        drive[i] = drive_target(&h->begin->drive[i]);
    const char *why = batch_rk4_init(batch, h->n_left, h->b->model, drive, h->memory);
    if (h->begun)
        memcpy(batch->drive, h->drive, sizeof h->drive);
    h->begun = true;
    return why;
}

static const char *run_rk4(struct herd *h, struct fate *fate)
{
    struct batch_rk4 batch;
    struct batch_rk4_lane lane = {.p = h->begin->p, .step = h->begin->h};
    const char *why = init_rk4(h, &batch);
    for (int i = 0; i < h->b->model->n_inputs; i++)
        lane.amplitude[i] = h->begin->drive[i].amplitude;
    for (int k = 0; k < h->n_left && !why; k++) {
        memcpy(lane.x, h->x[h->left[k]], sizeof lane.x);
        why = batch_rk4_set(&batch, k, &lane);
    }
    if (!why)
        why = batch_rk4(&batch, h->b->steps, BASIN_CHUNK, h->samples);
    for (int k = 0; k < h->n_left && !why; k++)
        fate[k] = (struct fate){batch_rk4_intervals(&batch, k),
                                batch_rk4_good(&batch, k) ? BASIN_GOOD : BASIN_ESCAPED};
    memcpy(h->drive, batch.drive, sizeof h->drive);
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
        why = batch_taylor(&batch, b->tol, BASIN_CHUNK, h->samples);
    for (int k = 0; k < n && !why; k++) {
        fate[k] = (struct fate){batch.intervals[k],
                                batch.status[k] == BATCH_ESCAPED ? BASIN_ESCAPED : BASIN_UNLOCATED};
        for (int j = 0; j < BASIN_CHUNK; j++) {
            double *at = &h->samples[2 * j * n + k], x[2];
            batch_taylor_state(&t, 0.0, at[0], at[n], x);
            at[0] = x[0];
            at[n] = x[1];
        }
    }
    return why;
}

/* Goes through the samples of trajectory k of the batch: true when its motion is known. */
static bool look(struct herd *h, int k, const struct fate *fate)
{
    int i = h->left[k], n = h->n_left;
    struct basin_motion *m = &h->motion[i];
    for (int j = 0; j < BASIN_CHUNK && m->periods < h->s->bound; j++) {
        if (j >= fate->periods) {
            basin_motion_fail(m, fate->status);
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

bool basin_settle_batched(const struct basin_plant *b)
{
    return b->model->hertz_form && (b->series || b->method == &rk4_unlocated);
}

const char *basin_settle(const struct basin_map *map, const struct basin_patience *s, int n,
                         double (*x)[MODEL_STATES], struct basin_motion *motion)
{
    const struct basin_plant *b = map->plant;
    struct herd h = {.b = b, .begin = &map->begin, .s = s, .x = x, .motion = motion, .n_left = n};
    const char *why = "out of memory";
    struct fate *fate = calloc((size_t)n, sizeof *fate);
    h.repeat = calloc((size_t)n, sizeof *h.repeat);
    h.left = calloc((size_t)n, sizeof *h.left);
    h.memory = malloc(b->series ? batch_taylor_bytes(n) : batch_rk4_bytes(n));
    h.samples = malloc((size_t)n * 2 * BASIN_CHUNK * sizeof *h.samples);
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
