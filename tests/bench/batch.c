/* batch.c - entries of the benchmark for the cost of a trajectory in a batch.
 *
 * Trajectory 0 is the case itself and gives the error. The others have its parameters and start with small
 * changes, so that their contacts do not switch in step. */
#include "tests/bench/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/batch/batch_taylor.h"
#include "host_sim/batch/batch_taylor_set.h"

enum { TRAJECTORIES = 1024 };

struct context {
    const struct problem *b;
    struct batch_taylor series;
    void *memory, *start; /* the batch, and its copy from before it ran */
    size_t bytes;
    double *samples;
    double tol;
};

static void run(void *context, double (*out)[EQUATION_STATES])
{
    struct context *c = context;
    memcpy(c->memory, c->start, c->bytes);
    const char *why = batch_taylor(&c->series, c->tol, c->b->n_out, c->samples);
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

static void add(struct bench *bench, double tol)
{
    const struct problem *b = &bench->problem;
    struct context *c = bench_alloc(sizeof *c);
    c->b = b;
    c->tol = tol;
    c->bytes = batch_taylor_bytes(TRAJECTORIES);
    c->memory = bench_alloc(c->bytes);
    c->start = bench_alloc(c->bytes);
    c->samples = bench_alloc(2 * TRAJECTORIES * (size_t)b->n_out * sizeof *c->samples);
    if (set_taylor(c)) {
        release(c);
        return;
    }
    memcpy(c->start, c->memory, c->bytes);
    struct entry *e = bench_add(bench, "batch_taylor", "1024 trajectories", tol);
    e->side = SIDE_BATCH;
    e->trajectories = TRAJECTORIES;
    e->run = run;
    e->convert = NULL;
    e->release = release;
    e->context = c;
}

void batch_add(struct bench *bench)
{
    const struct problem *b = &bench->problem;
    if (!b->c->model->hertz_form || b->held)
        return;
    for (int i = 2; i < 20; i++)
        add(bench, bench_tolerance(i));
}
