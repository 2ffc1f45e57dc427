/* plan.c - see plan.h. */
#include "host_sim/fit/plan.h"
#include "host_sim/fit/solve/unknown.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/fit/solve/problem.h"

int plan_fill(struct fit_setup *s, const double *u, double noise)
{
    struct problem p = {s, PROBLEM_PLAIN};
    double *residual = calloc((size_t)s->n_residuals + 1, sizeof *residual);
    bool good = residual && isfinite(problem_residuals(&p, u, residual));
    int all = 0, lost = 0;
    free(residual);
    for (int c = 0; c < s->data.n; c++)
        for (int i = 0; good && i < s->data.curve[c].n; i++) {
            struct curve_point *x = &s->data.curve[c].point[i];
            const struct follow_point *at = &s->point[c][i].at;
            x->re = at->orbit.re;
            x->im = at->orbit.im;
            unknown_measure(s, u, x->frequency_Hz, &x->re, &x->im);
            x->sigma = at->found ? noise * sqrt(x->re * x->re + x->im * x->im) : HUGE_VAL;
            lost += !at->found;
            all++;
        }
    return good && lost < all ? lost : -1;
}

/* The information of the slopes a[m][n] is added to that of the fit. */
static bool add_information(const struct fit_setup *s, const struct fit_result *r, const double *a, int m,
                            double sd[FIT_UNKNOWNS])
{
    double information[MATRIX_MAX][MATRIX_MAX], copy[MATRIX_MAX][MATRIX_MAX];
    for (int i = 0; i < s->n; i++)
        for (int k = 0; k < s->n; k++) {
            information[i][k] = 0.0;
            for (int d = 0; d < s->n; d++)
                information[i][k] += r->v[i][d] * r->v[k][d] * r->s[d] * r->s[d];
            for (int row = 0; row < m; row++)
                information[i][k] += a[row * s->n + i] * a[row * s->n + k];
        }
    for (int k = 0; k < s->n; k++) {
        double unit[MATRIX_MAX] = {0.0};
        unit[k] = 1.0;
        memcpy(copy, information, sizeof copy);
        if (!matrix_solve(s->n, copy, unit) || !(unit[k] > 0.0))
            return false;
        sd[k] = sqrt(unit[k]);
    }
    return true;
}

/* The share of noise of the curve that was measured. */
static double noise_of(const struct curve *c)
{
    double sum = 0.0;
    for (int i = 0; i < c->n; i++)
        sum += c->point[i].sigma / sqrt(c->point[i].re * c->point[i].re + c->point[i].im * c->point[i].im);
    return sum / c->n;
}

bool plan_further(struct fit_setup *s, const struct fit_result *r, int c, double amplitude,
                  double sd[FIT_UNKNOWNS])
{
    struct fit_setup further = *s;
    struct curve *curve = &further.data.curve[0];
    struct problem p = {&further, PROBLEM_PLAIN};
    *curve = s->data.curve[c];
    curve->amplitude = amplitude;
    curve->point = calloc((size_t)curve->n, sizeof *curve->point);
    further.point[0] = calloc((size_t)curve->n, sizeof *further.point[0]);
    further.data.n = further.n_active = 1;
    further.records.n = 0;
    further.smooth[0] = false;
    further.n_residuals = 2 * curve->n;
    double *a = calloc((size_t)(2 * curve->n * s->n), sizeof *a);
    bool good = curve->point && further.point[0] && a;
    if (good)
        memcpy(curve->point, s->data.curve[c].point, (size_t)curve->n * sizeof *curve->point);
    good = good && plan_fill(&further, r->u, noise_of(&s->data.curve[c])) >= 0;
    if (good)
        problem_slopes(&p, r->u, a);
    good = good && add_information(s, r, a, 2 * curve->n, sd);
    free(curve->point);
    free(further.point[0]);
    free(a);
    return good;
}
