/* problem_records.c - residuals of records in time and their slopes, see problem.h. The states in which
 * records begin are unknowns, too: position from rest, and velocity. */
#include "host_sim/fit/solve/problem_records.h"
#include "host_sim/fit/solve/unknown.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "host_sim/fit/motion/linear.h"
#include "host_sim/fit/motion/series.h"
#include "models/math/elementary.h"

static const double nudge = 1e-4;  /* step of u, for slopes */
static const double far_off = 0.5; /* share of the motion: a point so far off weighs half */
static const double ring_accuracy =
    1e-3; /* accuracy of the frequency that is seen without a plant; the decay has 30 times that */

static const struct record *record_of(const struct problem *p, int i)
{
    return &p->s->records.record[i];
}

int problem_records_size(const struct problem *p)
{
    int m = 0;
    for (int i = 0; i < p->s->records.n; i++)
        m += p->form != PROBLEM_LINEAR                     ? record_of(p, i)->n
             : p->s->data.n || record_of(p, i)->input >= 0 ? 0
                                                           : 2;
    return m;
}

/* The plant of record i, and the state in which the record begins. */
static bool set_up(const struct problem *p, int i, const double *u, struct orbit_task *t, double *x)
{
    const struct record *r = record_of(p, i);
    double unit[MODEL_STATES];
    int which;
    *t = p->s->task;
    t->input = r->input < 0 ? 0 : r->input;
    t->output = r->output;
    for (int k = 0; k < p->s->n; k++)
        if (p->s->unknown[k].kind == FIT_PARAMETER)
            t->si[p->s->unknown[k].index] = unknown_value(&p->s->unknown[k], u[k]);
    if (plant_check(t->model, t->si, &which))
        return false;
    orbit_rest(t, x, unit);
    for (int k = 0; k < p->s->n; k++)
        if (p->s->unknown[k].index == i &&
            (p->s->unknown[k].kind == FIT_POSITION || p->s->unknown[k].kind == FIT_VELOCITY))
            x[p->s->unknown[k].kind - FIT_POSITION] += unknown_value(&p->s->unknown[k], u[k]);
    return true;
}

/* Frequency and decay against those that are seen without a plant. */
static double compare_ring(const struct record *r, const struct orbit_task *t, double *residual)
{
    double frequency, decay;
    if (!linear_ring(t, &frequency, &decay))
        return HUGE_VAL;
    residual[0] = logarithm(frequency / r->frequency_Hz) / ring_accuracy;
    residual[1] = logarithm(decay / r->decay_per_s) / (30.0 * ring_accuracy);
    return residual[0] * residual[0] + residual[1] * residual[1];
}

/* Gain of the force, of the sensor and offset. */
static double factor_of(const struct fit_setup *s, const double *u, enum fit_kind kind, double without)
{
    for (int k = 0; k < s->n; k++)
        if (s->unknown[k].kind == kind)
            return unknown_value(&s->unknown[k], u[k]);
    return without;
}

/* The phase of the record's tone at its begin. */
static double phase_of(const struct fit_setup *s, const double *u, int i)
{
    for (int k = 0; k < s->n; k++)
        if (s->unknown[k].kind == FIT_PHASE && s->unknown[k].index == i)
            return unknown_value(&s->unknown[k], u[k]);
    return s->records.record[i].tone.phase_rad;
}

/* The motion as it is measured: y[n]. */
static bool simulate(const struct problem *p, int i, const double *u, double *y)
{
    const struct record *r = record_of(p, i);
    double x[MODEL_STATES];
    struct orbit_task t;
    if (!set_up(p, i, u, &t, x))
        return false;
    bool good = series_run(&t, r, x, factor_of(p->s, u, FIT_GAIN_FORCE, 1.0), phase_of(p->s, u, i), y);
    double sensor = factor_of(p->s, u, FIT_GAIN_SENSOR, 1.0), offset = factor_of(p->s, u, FIT_OFFSET, 0.0);
    for (int k = 0; k < r->n; k++)
        y[k] = sensor * y[k] + offset;
    return good;
}

/* The weight of a residual, and its part of a robust cost. */
static double weigh(const struct record *r, double residual, double *cost)
{
    double scale = far_off * r->size / r->noise, off = residual * residual / (scale * scale);
    *cost += scale * scale * logarithm(1.0 + off);
    return 1.0 / sqrt(1.0 + off);
}

static double residuals_of(const struct problem *p, int i, const double *u, double *residual)
{
    const struct record *r = record_of(p, i);
    double cost = 0.0;
    if (!simulate(p, i, u, residual))
        return HUGE_VAL;
    for (int k = 0; k < r->n; k++) {
        residual[k] = isnan(r->y[k]) ? 0.0 : (residual[k] - r->y[k]) / r->noise;
        if (p->form == PROBLEM_ROBUST)
            residual[k] *= weigh(r, residual[k], &cost);
        else
            cost += residual[k] * residual[k];
    }
    return cost;
}

double problem_records_residuals(const struct problem *p, const double *u, double *r)
{
    double cost = 0.0;
    for (int i = 0; i < p->s->records.n && isfinite(cost); i++) {
        struct orbit_task t;
        double x[MODEL_STATES];
        if (p->form != PROBLEM_LINEAR) {
            cost += residuals_of(p, i, u, r);
            r += record_of(p, i)->n;
        } else if (!p->s->data.n && record_of(p, i)->input < 0) {
            cost += set_up(p, i, u, &t, x) ? compare_ring(record_of(p, i), &t, r) : HUGE_VAL;
            r += 2;
        }
    }
    return cost;
}

/* Column k of record i, with the weights at u. */
static bool slope(const struct problem *p, int i, const double *u, int k, double *low, double *high,
                  double *a)
{
    const struct record *r = record_of(p, i);
    double v[FIT_UNKNOWNS], unused = 0.0;
    memcpy(v, u, (size_t)p->s->n * sizeof *v);
    v[k] = u[k] - nudge;
    bool good = simulate(p, i, v, low);
    v[k] = u[k] + nudge;
    good = good && simulate(p, i, v, high);
    for (int j = 0; j < r->n; j++) {
        double residual = (0.5 * (low[j] + high[j]) - r->y[j]) / r->noise;
        double weight = p->form == PROBLEM_ROBUST ? weigh(r, residual, &unused) : 1.0;
        a[j * p->s->n + k] =
            good && !isnan(r->y[j]) ? weight * (high[j] - low[j]) / (2.0 * nudge * r->noise) : 0.0;
    }
    return good;
}

void problem_records_slopes(const struct problem *p, const double *u, double *a)
{
    for (int i = 0; i < p->s->records.n; i++) {
        int n = record_of(p, i)->n;
        double *low = calloc((size_t)n, sizeof *low), *high = calloc((size_t)n, sizeof *high);
        for (int k = 0; low && high && k < p->s->n; k++)
            (void)slope(p, i, u, k, low, high, a);
        free(low);
        free(high);
        a += n * p->s->n;
    }
}
