/* problem.c - see problem.h. */
#include "host_sim/fit/solve/problem_curves.h"
#include "host_sim/fit/solve/problem_levers.h"
#include "host_sim/fit/solve/problem_records.h"
#include "host_sim/fit/solve/unknown.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "models/math/elementary.h"

static const double nudge = 1e-4;              /* step of u, for slopes */
static const double rough = 1e-3, fine = 1e-9; /* share of the cost: the last step */

enum { STEPS_MOST = 40, STEPS_HASTY = 12 };

/* ---- residuals ---- */

/* The linear form takes the curves of the smallest drive, or else two numbers of each free motion. */
static int size_of(const struct problem *p)
{
    int m = 0;
    for (int c = 0; c < problem_curves(p); c++)
        m += 2 * p->s->data.curve[c].n;
    return m + problem_records_size(p) + problem_levers_size(p);
}

int problem_size(struct fit_setup *s, enum problem_form form)
{
    const struct problem p = {s, form};
    return size_of(&p);
}

double problem_residuals(void *context, const double *u, double *r)
{
    const struct problem *p = context;
    int levers = size_of(p) - problem_levers_size(p), records = levers - problem_records_size(p);
    double cost = problem_curves_residuals(p, u, r);
    if (isfinite(cost))
        cost += problem_records_residuals(p, u, r + records);
    if (isfinite(cost))
        cost += problem_levers_residuals(p, u, r + levers);
    return isfinite(cost) ? cost : HUGE_VAL;
}

/* ---- slopes ---- */

/* Those of the linear form, by differences. */
static void slopes_linear(struct problem *p, const double *u, double *a)
{
    int n = p->s->n, m = size_of(p);
    double *low = calloc((size_t)m, sizeof *low), *high = calloc((size_t)m, sizeof *high), v[FIT_UNKNOWNS];
    memcpy(v, u, (size_t)n * sizeof *v);
    for (int k = 0; low && high && k < n; k++) {
        v[k] = u[k] - nudge;
        double below = problem_residuals(p, v, low);
        v[k] = u[k] + nudge;
        double above = problem_residuals(p, v, high);
        v[k] = u[k];
        for (int i = 0; i < m; i++)
            a[i * n + k] = isfinite(below) && isfinite(above) ? (high[i] - low[i]) / (2.0 * nudge) : 0.0;
    }
    free(low);
    free(high);
}

/* This unknown does not move. */
static bool stays(const struct fit_setup *s, int k)
{
    return s->held == &s->unknown[k] || (s->only_starts && !fit_is_hidden(&s->unknown[k]));
}

void problem_slopes(void *context, const double *u, double *a)
{
    struct problem *p = context;
    int n = p->s->n, m = size_of(p), levers = m - problem_levers_size(p);
    int records = levers - problem_records_size(p);
    if (p->form == PROBLEM_LINEAR) {
        slopes_linear(p, u, a);
        return;
    }
    problem_curves_slopes(p, u, a);
    problem_records_slopes(p, u, a + records * n);
    problem_levers_slopes(p, u, a + levers * n);
    for (int k = 0; k < n; k++)
        for (int i = 0; i < m && stays(p->s, k); i++)
            a[i * n + k] = 0.0;
}

double problem_solve(struct fit_setup *s, enum problem_form form, double *u, int *steps)
{
    struct problem p = {s, form};
    struct least l = {.n = s->n,
                      .context = &p,
                      .residuals = problem_residuals,
                      .slopes = problem_slopes,
                      .steps = s->task.hasty ? STEPS_HASTY : STEPS_MOST,
                      .smaller = form == PROBLEM_ROBUST ? rough : fine};
    l.m = size_of(&p);
    for (int k = 0; k < s->n; k++) {
        l.low[k] = unknown_u(&s->unknown[k], s->unknown[k].min);
        l.high[k] = unknown_u(&s->unknown[k], s->unknown[k].max);
    }
    return least_squares(&l, u, steps);
}
