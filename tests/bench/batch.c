/* batch.c - entries of the benchmark for the cost of a trajectory in a batch.
 *
 * Trajectory 0 is the case itself and gives the error. The others have its parameters and start with small
 * changes, so that their contacts do not switch in step. */
#include "tests/bench/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/batch/batch_rk4.h"
#include "host_sim/batch/batch_taylor.h"

enum { TRAJECTORIES = 1024 };
#define TWO_PI 6.283185307179586477

struct context {
    const struct problem *b;
    struct batch_taylor series;
    struct batch_rk4 rk;
    struct drive begin[MODEL_INPUTS]; /* drives of batch_rk4 before it ran */
    void *memory, *start;             /* the batch, and its copy from before it ran */
    size_t bytes;
    double *samples;
    double tol; /* tolerance of batch_taylor; 0: batch_rk4 */
    int steps;
};

static const char *run_batch(struct context *c)
{
    if (c->tol > 0.0)
        return batch_taylor(&c->series, c->tol, c->b->n_out, c->samples);
    memcpy(c->rk.drive, c->begin, sizeof c->rk.drive);
    return batch_rk4(&c->rk, c->steps, c->b->n_out, c->samples);
}

static void run(void *context, double (*out)[EQUATION_STATES])
{
    struct context *c = context;
    memcpy(c->memory, c->start, c->bytes);
    const char *why = run_batch(c);
    for (int k = 0; k < c->b->n_out; k++) {
        out[k][0] = why ? (double)NAN : c->samples[2 * k * TRAJECTORIES];
        out[k][1] = why ? (double)NAN : c->samples[(2 * k + 1) * TRAJECTORIES];
    }
}

static void release(void *context)
{
    struct context *c = context;
    free(c->memory);
    free(c->start);
    free(c->samples);
    free(c);
}

/* Trajectory i of the case; a change of up to 5 % in the first drive and in the start. */
static void trajectory(const struct problem *b, int i, struct batch_trajectory *t, double *p)
{
    const struct model *m = b->c->model;
    struct scale scale;
    struct input u[MODEL_INPUTS] = {{0.0, 0.0}};
    double si[MODEL_PARAMETERS], change = i % 97 / 97.0 * 0.05;
    *t = (struct batch_trajectory){.model = m, .p = p, .interval = b->interval};
    m->from_paper(b->paper, si, t->drive);
    m->prepare(si, p, &scale);
    t->drive[0].amplitude *= 1.0 + change;
    for (int k = 0; k < m->n_inputs; k++) {
        u[k].value = t->drive[k].amplitude * cos(t->drive[k].phase);
        u[k].rate = -t->drive[k].amplitude * t->drive[k].omega * sin(t->drive[k].phase);
    }
    m->state_from_paper(p, u, b->c->state, t->x);
    t->x[0] *= 1.0 - change;
}

static const char *set_taylor(struct context *c)
{
    const char *why = NULL;
    batch_taylor_init(&c->series, TRAJECTORIES, c->memory);
    for (int i = 0; i < TRAJECTORIES && !why; i++) {
        struct batch_trajectory t;
        double p[MODEL_DERIVED];
        trajectory(c->b, i, &t, p);
        why = batch_taylor_set(&c->series, i, &t);
    }
    return why;
}

static const char *set_rk4(struct context *c)
{
    struct drive_setting drive[MODEL_INPUTS] = {{0.0, 0.0, 0.0, 0}};
    struct batch_trajectory t;
    double p[MODEL_DERIVED], step = c->b->interval / c->steps;
    trajectory(c->b, 0, &t, p);
    for (int k = 0; k < t.model->n_inputs; k++)
        drive[k] =
            (struct drive_setting){0.0, t.drive[k].omega * step / TWO_PI, t.drive[k].phase / TWO_PI, 0};
    const char *why = batch_rk4_init(&c->rk, TRAJECTORIES, t.model, drive, c->memory);
    for (int i = 0; i < TRAJECTORIES && !why; i++) {
        trajectory(c->b, i, &t, p);
        struct batch_rk4_lane lane = {p, step, {0.0}, {t.x[0], t.x[1]}};
        for (int k = 0; k < t.model->n_inputs; k++)
            lane.amplitude[k] = t.drive[k].amplitude;
        why = batch_rk4_set(&c->rk, i, &lane);
    }
    return why;
}

/* The models' states to eta and its rate, which the equation has. */
static void convert(void *context, double (*out)[EQUATION_STATES])
{
    const struct context *c = context;
    struct batch_trajectory t;
    double p[MODEL_DERIVED], touch[2];
    trajectory(c->b, 0, &t, p);
    for (int k = 0; k < c->b->n_out; k++) {
        batch_taylor_state(&t, c->b->interval * (k + 1), 0.0, 0.0, touch); /* where eta and its rate are 0 */
        out[k][0] -= touch[0];
        out[k][1] -= touch[1];
    }
}

static void add(struct bench *bench, double tol, int steps)
{
    const struct problem *b = &bench->problem;
    struct context *c = bench_alloc(sizeof *c);
    c->b = b;
    c->tol = tol;
    c->steps = steps;
    c->bytes = tol > 0.0 ? batch_taylor_bytes(TRAJECTORIES) : batch_rk4_bytes(TRAJECTORIES);
    c->memory = bench_alloc(c->bytes);
    c->start = bench_alloc(c->bytes);
    c->samples = bench_alloc(2 * TRAJECTORIES * (size_t)b->n_out * sizeof *c->samples);
    if (tol > 0.0 ? set_taylor(c) : set_rk4(c)) { /* refused: too few steps */
        release(c);
        return;
    }
    memcpy(c->start, c->memory, c->bytes);
    memcpy(c->begin, c->rk.drive, sizeof c->begin);
    struct entry *e = bench_add(bench, tol > 0.0 ? "batch_taylor" : "batch_rk4", "1024 trajectories",
                                tol > 0.0 ? tol : steps);
    e->side = SIDE_BATCH;
    e->trajectories = TRAJECTORIES;
    e->run = run;
    e->convert = tol > 0.0 ? NULL : convert;
    e->release = release;
    e->context = c;
}

void batch_add(struct bench *bench)
{
    const struct problem *b = &bench->problem;
    if (!b->c->model->hertz_form || b->held)
        return;
    for (int i = 2; i < 20; i++)
        add(bench, bench_tolerance(i), 0);
    for (int steps = 32; steps <= 1024; steps *= 2)
        add(bench, 0.0, steps * b->c->stride);
}
