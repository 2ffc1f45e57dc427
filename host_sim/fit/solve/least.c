/* least.c - see least.h. */
#include "host_sim/fit/solve/least.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TRIES = 12 };
static const double longest = 0.7; /* length of a step, in each unknown */
static const double done = 1e-7;   /* a shorter step is none */

struct work {
    double *r, *a; /* residuals and slopes; a becomes U S */
    double s[MATRIX_MAX], v[MATRIX_MAX][MATRIX_MAX];
    double size[MATRIX_MAX]; /* size of the columns of a: their unit */
};

static bool make_room(const struct least *l, struct work *w)
{
    w->r = calloc((size_t)l->m + 1, sizeof *w->r);
    w->a = calloc((size_t)(l->m + 1) * (size_t)l->n, sizeof *w->a);
    return w->r && w->a;
}

/* Columns of unit size, and their singular directions. One that is rounding becomes 0: its unknown stays. */
static void decompose(const struct least *l, struct work *w)
{
    double most = 0.0;
    for (int k = 0; k < l->n; k++) {
        double sum = 0.0;
        for (int i = 0; i < l->m; i++)
            sum += w->a[i * l->n + k] * w->a[i * l->n + k];
        w->size[k] = sqrt(sum);
        most = fmax(most, w->size[k]);
    }
    for (int k = 0; k < l->n; k++) {
        bool seen = w->size[k] > LEAST_UNSEEN * most;
        w->size[k] = seen ? w->size[k] : 1.0;
        for (int i = 0; i < l->m; i++)
            w->a[i * l->n + k] = seen ? w->a[i * l->n + k] / w->size[k] : 0.0;
    }
    matrix_singular(l->m, l->n, w->a, w->s, w->v);
}

/* The damped step from here. */
static void find_step(const struct least *l, const struct work *w, double damping, double *step)
{
    for (int i = 0; i < l->n; i++)
        step[i] = 0.0;
    for (int k = 0; k < l->n; k++) {
        double along = 0.0, below = w->s[k] * w->s[k] + damping;
        for (int i = 0; i < l->m; i++)
            along += w->a[i * l->n + k] * w->r[i];
        for (int i = 0; i < l->n; i++)
            step[i] -= below > 0.0 ? w->v[i][k] * along / below / w->size[i] : 0.0;
    }
}

/* Shortened, and inside the bounds. Returns its largest component. */
static double apply(const struct least *l, const double *u, const double *step, double *to)
{
    double most = 0.0, moved = 0.0;
    for (int i = 0; i < l->n; i++)
        most = fmax(most, fabs(step[i]));
    double factor = most > longest ? longest / most : 1.0;
    for (int i = 0; i < l->n; i++) {
        to[i] = fmin(fmax(u[i] + factor * step[i], l->low[i]), l->high[i]);
        moved = fmax(moved, fabs(to[i] - u[i]));
    }
    return moved;
}

/* One step with less damping, or shorter ones until the cost falls. False: it does not. */
static bool improve(const struct least *l, struct work *w, double *u, double *cost, double *damping)
{
    double to[MATRIX_MAX], step[MATRIX_MAX], was = *cost;
    double *there = calloc((size_t)l->m + 1, sizeof *there);
    bool better = false;
    for (int i = 0; there && i < TRIES && !better; i++) {
        find_step(l, w, *damping, step);
        if (apply(l, u, step, to) < done)
            break;
        double now = l->residuals(l->context, to, there);
        better = now < was;
        *damping = better ? 0.1 * *damping : fmax(10.0 * *damping, 1e-6);
        if (better) {
            *cost = now;
            memcpy(u, to, (size_t)l->n * sizeof *u);
            memcpy(w->r, there, (size_t)l->m * sizeof *there);
        }
    }
    free(there);
    return better && was - *cost > l->smaller * was;
}

double least_squares(const struct least *l, double *u, int *steps)
{
    struct work w;
    double damping = 1e-3, cost = HUGE_VAL;
    *steps = 0;
    if (make_room(l, &w)) {
        cost = l->residuals(l->context, u, w.r);
        for (bool better = isfinite(cost); better && *steps < l->steps; ++*steps) {
            l->slopes(l->context, u, w.a);
            decompose(l, &w);
            better = improve(l, &w, u, &cost, &damping);
        }
        (void)l->residuals(l->context, u, w.r);
    }
    free(w.r);
    free(w.a);
    return cost;
}
