/* naive.c - a solver that a user writes in ten minutes: classical RK4, the right-hand side behind a
 * pointer, pow and cos. */
#include "tests/bench/bench.h"

#include <stdlib.h>
#include <string.h>

typedef void user_rhs(const struct equation *e, double t, const double *y, double *dy);

struct naive {
    const struct problem *b;
    int steps; /* from one input sample, or output, to the next */
    user_rhs *volatile rhs;
};

static void rhs_hertz(const struct equation *e, double t, const double *y, double *dy)
{
    double force = y[0] > 0.0 ? pow(y[0], 1.5) : 0.0;
    double stiffness = e->w2 != 0.0 ? e->b * (1.0 + e->r * cos(e->w2 * t)) : e->b;
    double drive = e->f0 + e->held;
    if (e->f1 != 0.0)
        drive += e->f1 * cos(e->w1 * t + e->phase1);
    if (e->f2 != 0.0)
        drive += e->f2 * cos(e->w2 * t);
    dy[0] = y[1];
    dy[1] = drive - e->k * y[0] - e->c * y[1] - stiffness * force;
}

static void rk4_step(const struct naive *c, const struct equation *e, double t, double h, double *y)
{
    double k1[EQUATION_STATES], k2[EQUATION_STATES], k3[EQUATION_STATES], k4[EQUATION_STATES],
        z[EQUATION_STATES];
    user_rhs *rhs = c->rhs;
    rhs(e, t, y, k1);
    for (int i = 0; i < e->n; i++)
        z[i] = y[i] + 0.5 * h * k1[i];
    rhs(e, t + 0.5 * h, z, k2);
    for (int i = 0; i < e->n; i++)
        z[i] = y[i] + 0.5 * h * k2[i];
    rhs(e, t + 0.5 * h, z, k3);
    for (int i = 0; i < e->n; i++)
        z[i] = y[i] + h * k3[i];
    rhs(e, t + h, z, k4);
    for (int i = 0; i < e->n; i++)
        y[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
}

static void run(void *context, double (*out)[EQUATION_STATES])
{
    const struct naive *c = context;
    const struct problem *b = c->b;
    struct equation e = b->eq;
    double y[EQUATION_STATES], h = b->interval / b->holds / c->steps;
    long step = 0;
    memcpy(y, b->y0, sizeof y);
    for (int k = 0; k < b->n_out; k++) {
        for (int j = 0; j < b->holds; j++) {
            if (b->held)
                e.held = b->held[k * b->holds + j];
            for (int i = 0; i < c->steps; i++, step++)
                rk4_step(c, &e, (double)step * h, h, y);
        }
        memcpy(out[k], y, sizeof y);
    }
}

void naive_add(struct bench *b)
{
    const struct problem *p = &b->problem;
    double calls = (double)p->n_out * p->holds;
    for (double n = p->held ? 1.0 : 16.0; n * calls <= 2e6; n *= 2.0) {
        struct naive *c = bench_alloc(sizeof *c);
        c->b = p;
        c->steps = (int)n;
        c->rhs = p->eq.n == 6 ? equation_shaft : rhs_hertz;
        struct entry *e = bench_add(b, "naive RK4 loop", "pow, cos", n);
        e->run = run;
        e->release = free;
        e->context = c;
    }
}
