/* problem_levers.c - see problem_levers.h. */
#include "host_sim/fit/solve/problem_levers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/fit/motion/lever_law.h"
#include "host_sim/fit/solve/unknown.h"
#include "models/afm_lever.h"

static const double nudge = 1e-4; /* step of u, for slopes */

/* The lever, and the numbers of its chain, where the unknowns are u. */
struct lever_at {
    double si[MODEL_PARAMETERS];
    double contact_m, baseline_m, white;
};

static void set_up(const struct fit_setup *s, const double *u, struct lever_at *at)
{
    memcpy(at->si, s->scene.value, sizeof at->si);
    at->contact_m = at->baseline_m = at->white = 0.0;
    for (int k = 0; k < s->n; k++) {
        double value = unknown_value(&s->unknown[k], u[k]);
        enum fit_kind kind = s->unknown[k].kind;
        at->contact_m = kind == FIT_CONTACT ? value : at->contact_m;
        at->baseline_m = kind == FIT_BASELINE ? value : at->baseline_m;
        at->white = kind == FIT_WHITE ? value : at->white;
        if (kind == FIT_PARAMETER)
            at->si[s->unknown[k].index] = value;
    }
}

/* The deflection on this side. On the way back the way out holds in contact, and up to the release. */
static bool rest_on(const struct lever_at *at, bool back, enum lever_side side, double base_m, double *x)
{
    if (side == LEVER_CONTACT)
        return lever_law_contact(at->si, back, base_m, x);
    bool good = lever_law_outside(at->si, back, base_m, x);
    return good && back && base_m + *x > at->si[LEVER_RELEASE] ? lever_law_outside(at->si, false, base_m, x)
                                                               : good;
}

static double deflection(const struct lever_at *at, struct lever_data *d, int i, bool find)
{
    double base = d->x[i] - at->contact_m, x[LEVER_SIDES], y = d->y[i] - at->baseline_m;
    if ((!find || d->sides_told[d->back[i]]) && d->side[i] != LEVER_SKIPPED) {
        (void)rest_on(at, d->back[i], (enum lever_side)d->side[i], base, &x[0]);
        return x[0] + at->baseline_m;
    }
    bool outside = rest_on(at, d->back[i], LEVER_OUTSIDE, base, &x[LEVER_OUTSIDE]);
    bool contact = rest_on(at, d->back[i], LEVER_CONTACT, base, &x[LEVER_CONTACT]);
    enum lever_side side =
        fabs(x[LEVER_CONTACT] - y) < fabs(x[LEVER_OUTSIDE] - y) ? LEVER_CONTACT : LEVER_OUTSIDE;
    side = outside && contact ? side : outside ? LEVER_OUTSIDE : LEVER_CONTACT;
    if (d->side[i] != LEVER_SKIPPED)
        d->side[i] = (uint8_t)side;
    return x[side] + at->baseline_m;
}

static double value_at(const struct lever_at *at, struct lever_data *d, int i, bool find)
{
    return d->kind == LEVER_SPECTRUM ? lever_law_density(at->si, at->white, d->x[i])
                                     : deflection(at, d, i, find);
}

double problem_levers_value(const struct fit_setup *s, struct lever_data *d, const double *u, int i,
                            bool find)
{
    struct lever_at at;
    set_up(s, u, &at);
    return value_at(&at, d, i, find);
}

static double residual_at(const struct lever_at *at, struct lever_data *d, int i, bool find)
{
    double model = value_at(at, d, i, find);
    if (d->side[i] == LEVER_SKIPPED)
        return 0.0;
    if (d->kind == LEVER_CURVE)
        return (model - d->y[i]) / d->sigma[d->side[i]];
    double x = d->y[i] / model, deviance = x - 1.0 - log(x);
    return copysign(sqrt(2.0 * fmax(deviance, 0.0)), 1.0 - x) / d->sigma[LEVER_OUTSIDE];
}

int problem_levers_size(const struct problem *p)
{
    int m = 0;
    for (int i = 0; i < p->s->levers.n && p->form != PROBLEM_LINEAR; i++)
        m += p->s->levers.data[i].n;
    return m;
}

double problem_levers_residuals(const struct problem *p, const double *u, double *r)
{
    struct lever_at at;
    double cost = 0.0;
    if (!problem_levers_size(p))
        return 0.0;
    set_up(p->s, u, &at);
    for (int j = 0; j < p->s->levers.n; j++)
        for (int i = 0; i < p->s->levers.data[j].n; i++) {
            if (orbit_stopped(&p->s->task))
                return HUGE_VAL;
            *r = residual_at(&at, &p->s->levers.data[j], i, !p->s->levers.sides_known);
            cost += *r * *r;
            r++;
        }
    return cost;
}

void problem_levers_slopes(const struct problem *p, const double *u, double *a)
{
    const struct fit_setup *s = p->s;
    double v[FIT_UNKNOWNS];
    if (!problem_levers_size(p))
        return;
    memcpy(v, u, (size_t)s->n * sizeof *v);
    for (int k = 0; k < s->n; k++) {
        struct lever_at below, above;
        double *to = a + k;
        v[k] = u[k] - nudge;
        set_up(s, v, &below);
        v[k] = u[k] + nudge;
        set_up(s, v, &above);
        v[k] = u[k];
        for (int j = 0; j < s->levers.n; j++)
            for (int i = 0; i < p->s->levers.data[j].n; i++) {
                struct lever_data *d = &p->s->levers.data[j];
                *to = (residual_at(&above, d, i, false) - residual_at(&below, d, i, false)) / (2.0 * nudge);
                to += s->n;
            }
    }
}

void problem_levers_widen(const struct fit_setup *s, double *a)
{
    int before = s->n_residuals;
    for (int j = 0; j < s->levers.n; j++)
        before -= s->levers.data[j].n;
    a += before * s->n;
    for (int j = 0; j < s->levers.n; j++) {
        const struct lever_data *d = &s->levers.data[j];
        for (int i = 0; i < d->n * s->n; i++)
            *a++ /= d->widen;
    }
}
