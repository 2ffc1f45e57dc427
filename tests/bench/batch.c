/* batch.c - what a trajectory costs in a batch: entries of the benchmark beside everything else.
 *
 * Trajectory 0 is the case itself and gives the error. The others have its parameters and start with small changes, so that
 * their contacts do not switch in step. */
#include "tests/bench/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/batch.h"

enum { TRAJECTORIES = 1024 };

struct context {
    const struct problem *b;
    struct batch batch;
    void *memory, *start; /* the batch, and what it was before it ran */
    double *samples;
    double tol; /* of batch_taylor; 0: batch_rk4 */
    int steps;
};

static void run(void *context, double (*out)[EQUATION_STATES])
{
    struct context *c = context;
    int n = c->batch.n;
    memcpy(c->memory, c->start, batch_bytes(n));
    const char *why = c->tol > 0.0 ? batch_taylor(&c->batch, c->tol, c->b->n_out, c->samples)
                                   : batch_rk4(&c->batch, c->steps, c->b->n_out, c->samples);
    for (int k = 0; k < c->b->n_out; k++) {
        out[k][0] = why ? (double)NAN : c->samples[2 * k * n];
        out[k][1] = why ? (double)NAN : c->samples[(2 * k + 1) * n];
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
static const char *set(struct context *c, int i)
{
    const struct problem *b = c->b;
    const struct model *m = b->c->model;
    struct scale scale;
    struct input u[MODEL_INPUTS] = {{0.0, 0.0}};
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], change = i % 97 / 97.0 * 0.05;
    struct batch_trajectory t = {.model = m, .p = p, .interval = b->interval};
    m->from_paper(b->paper, si, t.drive);
    m->prepare(si, p, &scale);
    t.drive[0].amplitude *= 1.0 + change;
    for (int k = 0; k < m->n_inputs; k++) {
        u[k].value = t.drive[k].amplitude * cos(t.drive[k].phase);
        u[k].rate = -t.drive[k].amplitude * t.drive[k].omega * sin(t.drive[k].phase);
    }
    m->state_from_paper(p, u, b->c->state, t.x);
    t.x[0] *= 1.0 - change;
    return batch_set(&c->batch, i, &t);
}

static void add(struct bench *bench, double tol, int steps)
{
    const struct problem *b = &bench->problem;
    struct context *c = bench_alloc(sizeof *c);
    struct entry *e = bench_add(bench, tol > 0.0 ? "batch_taylor" : "batch_rk4", "1024 trajectories",
                                tol > 0.0 ? tol : steps);
    c->b = b;
    c->tol = tol;
    c->steps = steps;
    c->memory = bench_alloc(batch_bytes(TRAJECTORIES));
    c->start = bench_alloc(batch_bytes(TRAJECTORIES));
    c->samples = bench_alloc(2 * TRAJECTORIES * (size_t)b->n_out * sizeof *c->samples);
    batch_init(&c->batch, TRAJECTORIES, c->memory);
    for (int i = 0; i < TRAJECTORIES; i++)
        set(c, i);
    memcpy(c->start, c->memory, batch_bytes(TRAJECTORIES));
    e->side = SIDE_BATCH;
    e->trajectories = TRAJECTORIES;
    e->run = run;
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
