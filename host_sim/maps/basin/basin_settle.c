/* basin_settle.c - starts that settle side by side in batch_taylor. */
#include "host_sim/maps/basin/basin_settle.h"

#include <stdlib.h>
#include <string.h>
#include "host_sim/batch/batch_taylor.h"
#include "host_sim/batch/batch_taylor_set.h"
#include "host_sim/maps/basin/basin_repeat.h"

/* Starts side by side. A start that has settled leaves; the others continue in a smaller batch. */
struct herd {
    const struct basin_plant *b;
    const struct basin_patience *s;
    double (*x)[MODEL_STATES];
    struct basin_motion *motion;
    struct basin_repeat *repeat; /* [n] */
    int *left;                   /* [n_left] starts that are still under way */
    int n_left;
    void *memory;
    double *samples; /* [BASIN_CHUNK][2][n_left], states */
};

/* How a trajectory of the batch ended. */
struct fate {
    int64_t periods;
    enum basin_status status;
};

/* Makes a batch of the starts that are left, and runs it. */
static const char *run_batch(struct herd *h, struct fate *fate)
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
        const char *why = run_batch(h, fate);
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

const char *basin_settle(const struct basin_plant *b, const struct basin_patience *s, int n,
                         double (*x)[MODEL_STATES], struct basin_motion *motion)
{
    struct herd h = {.b = b, .s = s, .x = x, .motion = motion, .n_left = n};
    const char *why = "out of memory";
    struct fate *fate = calloc((size_t)n, sizeof *fate);
    h.repeat = calloc((size_t)n, sizeof *h.repeat);
    h.left = calloc((size_t)n, sizeof *h.left);
    h.memory = malloc(batch_taylor_bytes(n));
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
