/* exact_tables.c - method exact at start: what it refuses, the regimes' systems, the responses over a whole tick. */
#include "firmware/exact_series.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include "models/elementary.h"

enum { SQUARINGS = 12 };

struct square {
    double m[MODEL_STATES][MODEL_STATES];
};

/* The largest |entry|; a NaN is kept. */
static double norm(const struct square *a, int n)
{
    double max = 0.0;
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n; k++) {
            if (!(fabs(a->m[i][k]) <= max))
                max = fabs(a->m[i][k]);
        }
    }
    return max;
}

static void square_of(const struct square *a, int n, struct square *b)
{
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n; k++) {
            b->m[i][k] = 0.0;
            for (int j = 0; j < n; j++)
                b->m[i][k] += a->m[i][j] * a->m[j][k];
        }
    }
}

/* The largest |eigenvalue| as norm(A^N)^(1/N) with N = 2^12 (Gelfand): from above, 0.3 % at most for the plants here,
 * and no eigenvalue problem that could fail. Each power is scaled to norm 1; the logarithms add up. */
static double spectral_radius(const struct square *a, int n)
{
    struct square b, c = *a;
    double log = 0.0, weight = 1.0;
    for (int s = 0;; s++) {
        double size = norm(&c, n);
        if (!(size > 0.0))
            return size; /* nilpotent, or NaN */
        log += weight * logarithm(size);
        if (s == SQUARINGS)
            break;
        for (int i = 0; i < n; i++)
            for (int k = 0; k < n; k++)
                b.m[i][k] = c.m[i][k] / size;
        square_of(&b, n, &c);
        weight *= 0.5;
    }
    return exponential(log + weight * logarithm((double)n));
}

/* Velocities in units that make the matrix balanced: v = unit w, position' = unit w, w' = (a x)/unit + ... */
static double rate_of(const struct linear *l, int n)
{
    struct square a;
    double stiffest = 0.0;
    int half = n / 2;
    for (int i = half; i < n; i++)
        for (int k = 0; k < half; k++)
            stiffest = fabs(l->a[i][k]) > stiffest ? fabs(l->a[i][k]) : stiffest;
    double unit = stiffest > 0.0 ? sqrt(stiffest) : 1.0;
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n; k++) {
            double up = i < half && k >= half ? unit : 1.0;
            double down = i >= half && k < half ? unit : 1.0;
            a.m[i][k] = l->a[i][k] * up / down;
        }
    }
    return spectral_radius(&a, n);
}

/* position' = velocity and nothing else */
static bool second_order(const struct model *m, const struct linear *l)
{
    int half = m->n_states / 2;
    double other = 0.0;
    for (int i = 0; i < half; i++) {
        for (int k = 0; k < 2 * half; k++)
            other += fabs(l->a[i][k] - (k == half + i ? 1.0 : 0.0));
        for (int k = 0; k < m->n_inputs; k++)
            other += fabs(l->b[i][k]) + fabs(l->b_rate[i][k]);
        other += fabs(l->c[i]);
    }
    return other == 0.0;
}

/* Rates at unit velocities are the gaps' coefficients, without rounding. False when a gap follows anything but one
 * position. */
static bool find_gaps(const struct model *m, const double *p, struct exact_gap *gap)
{
    struct input u[MODEL_INPUTS] = {{0.0, 0.0}}, g[MODEL_CONTACTS];
    double x[MODEL_STATES] = {0.0}, other = 0.0;
    int half = m->n_states / 2, found = 0;
    m->gap(p, u, x, g);
    for (int c = 0; c < m->n_contacts; c++)
        gap[c] = (struct exact_gap){g[c].value, 0.0, 0};
    for (int k = 0; k < half; k++) {
        x[half + k] = 1.0;
        m->gap(p, u, x, g);
        x[half + k] = 0.0;
        for (int c = 0; c < m->n_contacts; c++) {
            if (g[c].rate != 0.0)
                gap[c] = (struct exact_gap){gap[c].constant, g[c].rate, k}, found++;
        }
    }
    for (int i = 0; i < m->n_inputs; i++) {
        u[i] = (struct input){1.0, 1.0};
        m->gap(p, u, x, g);
        u[i] = (struct input){0.0, 0.0};
        for (int c = 0; c < m->n_contacts; c++)
            other += fabs(g[c].value - gap[c].constant) + fabs(g[c].rate);
    }
    return found == m->n_contacts && other == 0.0;
}

const char *exact_refuse(const struct model *m, const double *p, double h, double tol)
{
    struct linear l;
    struct exact_gap gap[MODEL_CONTACTS];
    (void)tol;
    if (!m->linear)
        return "exact is for piecewise linear models: this one is not";
    if (m->n_states % 2 != 0)
        return "exact needs a model in second-order form";
    if (m->n_contacts > 0 && !find_gaps(m, p, gap))
        return "exact needs gaps that follow one position each";
    for (unsigned regime = 0; regime < 1u << m->n_contacts; regime++) {
        memset(&l, 0, sizeof l);
        if (!m->linear(p, regime, &l))
            continue;
        if (!second_order(m, &l))
            return "exact needs a model in second-order form";
        if (!(h * rate_of(&l, m->n_states) <= EXACT_LIMIT))
            return "step too coarse for exact: the fastest mode of some contact regime times step is above "
                   "2.1 "
                   "rad, and a contact could close and open unseen; use a step below a third of that mode's "
                   "period";
    }
    return NULL;
}

static void take_system(const struct model *m, const struct linear *l, struct exact_regime *r)
{
    int half = m->n_states / 2;
    for (int i = 0; i < half; i++) {
        for (int k = 0; k < 2 * half; k++)
            r->a[k][i] = l->a[half + i][k];
        for (int k = 0; k < m->n_inputs; k++) {
            r->b[k][i] = l->b[half + i][k];
            r->b_rate[k][i] = l->b_rate[half + i][k];
            r->follows_rate[k] += fabs(r->b_rate[k][i]);
        }
        r->c[i] = l->c[half + i];
    }
    r->rate = rate_of(l, m->n_states);
    r->reach = r->rate > 0.0 ? EXACT_LIMIT / r->rate : DBL_MAX;
}

/* The region of its positions: an open contact has a gap above zero, a closed one below. */
static void find_walls(const struct model *m, const struct exact_gap *gap, unsigned regime,
                       struct exact_regime *r)
{
    for (int k = 0; k < EXACT_LANES; k++)
        r->below[k] = -DBL_MAX, r->above[k] = DBL_MAX;
    for (int c = 0; c < m->n_contacts; c++) {
        double wall = -gap[c].constant / gap[c].slope;
        bool closed = (regime >> c) & 1u;
        double *below = &r->below[gap[c].position], *above = &r->above[gap[c].position];
        if ((gap[c].slope > 0.0) == closed)
            *above = wall < *above ? wall : *above;
        else
            *below = wall > *below ? wall : *below;
    }
}

/* y = the change of the state over a tick, from x. */
static void respond(struct exact *w, const struct exact_regime *r, const struct model *m,
                    const struct excitation *e, const double *x, double *y)
{
    int order = exact_order(exact_reach(r, e, m->n_inputs, w->h));
    exact_expand(w, r, m, e, w->h, order, x);
    exact_change(w, m->n_states, order, 1.0, y);
}

/* What the input alone does from rest: the response with it, less that of the constant terms. */
static void respond_to_wave(struct exact *w, const struct exact_regime *r, const struct model *m, int i,
                            const struct wave *wave, double *y)
{
    static const double at_zero[MODEL_STATES] = {0.0};
    struct exact_regime without = *r;
    struct excitation e;
    memset(&e, 0, sizeof e);
    memset(without.c, 0, sizeof without.c);
    e.active = 1u << i;
    e.wave[i] = *wave;
    respond(w, &without, m, &e, at_zero, y);
}

void exact_tune(struct exact *w, struct exact_regime *r, const struct model *m, int i, double omega)
{
    respond_to_wave(w, r, m, i, &(struct wave){.amplitude = 1.0, .cosine = 1.0, .omega = omega},
                    r->cosine[i]);
    respond_to_wave(w, r, m, i, &(struct wave){.amplitude = 1.0, .sine = -1.0, .omega = omega}, r->sine[i]);
    r->omega[i] = omega;
}

static void fill(struct exact *w, struct exact_regime *r, const struct model *m)
{
    struct excitation silent;
    struct exact_regime without = *r;
    double x[MODEL_STATES] = {0.0};
    memset(&silent, 0, sizeof silent);
    memset(without.c, 0, sizeof without.c);
    respond(w, r, m, &silent, x, r->rest);
    for (int k = 0; k < m->n_states; k++) {
        x[k] = 1.0;
        respond(w, &without, m, &silent, x, r->whole[k]);
        x[k] = 0.0;
    }
    for (int i = 0; i < m->n_inputs; i++) {
        respond_to_wave(w, r, m, i, &(struct wave){.offset = 1.0, .cosine = 1.0}, r->offset[i]);
        respond_to_wave(w, r, m, i, &(struct wave){.slope = 1.0, .cosine = 1.0}, r->slope[i]);
        exact_tune(w, r, m, i, 0.0);
    }
}

void exact_prepare(const struct model *m, const double *p, double h, double tol, double *work)
{
    struct exact *w = (struct exact *)(void *)work;
    struct linear l;
    (void)tol;
    w->h = h;
    if (m->n_contacts > 0)
        (void)find_gaps(m, p, w->gap);
    for (unsigned regime = 0; regime < 1u << m->n_contacts; regime++) {
        struct exact_regime *r = &w->regime[regime];
        memset(r, 0, sizeof *r);
        memset(&l, 0, sizeof l);
        if (!m->linear(p, regime, &l))
            continue;
        take_system(m, &l, r);
        find_walls(m, w->gap, regime, r);
        if (h <= r->reach)
            fill(w, r, m);
    }
}
