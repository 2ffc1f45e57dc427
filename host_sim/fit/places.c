/* places.c - see places.h.
 *
 * The linear form is cheap: it is tried at many places, and solved from the best. The smallest curves leave
 * one direction of the unknowns nearly free, for a rig the one that keeps its linear stiffness: fits begin at
 * the best places along this line. They see neither gaps that stay open nor what is behind these: there fits
 * begin at the best places of a grid over both. */
#include "host_sim/fit/places.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/fit/levers.h"
#include "host_sim/fit/progress.h"
#include "host_sim/fit/solve/problem.h"
#include "host_sim/fit/thin.h"
#include "host_sim/fit/solve/unknown.h"
#include "models/math/elementary.h"

enum { LINE = 41, LINEAR = 256, LINEAR_TRIED = 3, LINE_PLACES = 4, GRID = 64 };
static const double line_most = 2.3; /* a factor of 10 */
static const double line_least = 0.05;
static const double grid_reach = 1.1;  /* a factor of 3 to both sides */
static const double deviations = 20.0; /* deviations of the weak direction, along the line */
static const double far_better = 0.25; /* share of the cost: another minimum of the linear form is taken */

/* ---- grids ---- */

/* Point i of an even grid in d dimensions: fractions of i powers of 1/g, where g^(d+1) = g + 1 (Roberts
 * 2018). The unknowns that are chosen are moved from u by up to grid_reach to both sides. */
static void grid_point(const struct fit_setup *s, const double *u, const bool *chosen, int i, double *to)
{
    double g = 2.0, step = 1.0;
    int d = 0;
    for (int k = 0; k < s->n; k++)
        d += chosen[k];
    for (int round = 0; round < 60; round++)
        g = exponential(logarithm(1.0 + g) / (d + 1));
    for (int k = 0; k < s->n; k++) {
        to[k] = u[k];
        if (!chosen[k])
            continue;
        step /= g;
        double at = 0.5 + i * step;
        to[k] += grid_reach * (2.0 * (at - floor(at)) - 1.0);
    }
}

/* Puts a place into the best n by their cost, the best first. */
static void keep_best(int n, double *cost, double (*place)[FIT_UNKNOWNS], double now, const double *u)
{
    int i = n;
    for (; i > 0 && now < cost[i - 1]; i--)
        if (i < n) {
            cost[i] = cost[i - 1];
            memcpy(place[i], place[i - 1], sizeof place[i]);
        }
    if (i < n) {
        cost[i] = now;
        memcpy(place[i], u, sizeof place[i]);
    }
}

/* ---- the linear form ---- */

/* Parameters on which this form does not depend at u, as gaps that these curves do not close. How many. */
static int find_unseen(struct fit_setup *s, enum problem_form form, const double *u, bool *unseen)
{
    struct problem p = {s, form};
    int m = problem_size(s, form), n = 0;
    double *a = calloc((size_t)m * (size_t)s->n + 1, sizeof *a), *r = calloc((size_t)m + 1, sizeof *r);
    double square[FIT_UNKNOWNS] = {0.0}, most = 0.0;
    if (a && r && isfinite(problem_residuals(&p, u, r)))
        problem_slopes(&p, u, a);
    for (int k = 0; k < s->n; k++) {
        for (int i = 0; a && i < m; i++)
            square[k] += a[i * s->n + k] * a[i * s->n + k];
        most = fmax(most, square[k]);
    }
    for (int k = 0; k < s->n; k++) {
        unseen[k] = s->unknown[k].kind == FIT_PARAMETER && most > 0.0 &&
                    square[k] <= LEAST_UNSEEN * LEAST_UNSEEN * most;
        n += unseen[k];
    }
    free(a);
    free(r);
    return n;
}

/* The least squares of the linear form from u; of a plant with gaps, or from a far better place of the grid.
 */
static void solve_linear(struct fit_setup *s, double *u)
{
    struct problem p = {s, PROBLEM_LINEAR};
    double cost[LINEAR_TRIED], place[LINEAR_TRIED][FIT_UNKNOWNS], at[FIT_UNKNOWNS] = {0.0};
    bool seen[FIT_UNKNOWNS];
    int steps;
    int points = find_unseen(s, PROBLEM_LINEAR, u, seen) ? LINEAR : 0;
    for (int k = 0; k < s->n; k++)
        seen[k] = !seen[k] && s->unknown[k].kind == FIT_PARAMETER;
    double *r = calloc((size_t)problem_size(s, PROBLEM_LINEAR) + 1, sizeof *r);
    for (int i = 0; i < LINEAR_TRIED; i++)
        cost[i] = HUGE_VAL;
    for (int i = 0; r && i < points; i++) {
        grid_point(s, u, seen, i, at);
        keep_best(LINEAR_TRIED, cost, place, problem_residuals(&p, at, r), at);
    }
    free(r);
    double best = problem_solve(s, PROBLEM_LINEAR, u, &steps);
    for (int i = 0; i < LINEAR_TRIED && isfinite(cost[i]); i++) {
        double now = problem_solve(s, PROBLEM_LINEAR, place[i], &steps);
        if (now < far_better * best) {
            best = now;
            memcpy(u, place[i], sizeof place[i]);
        }
    }
}

/* The direction in which the smallest curves say least, its largest component 1. Returns how far to look. */
static double weak_direction(struct fit_setup *s, const double *u, double *direction)
{
    struct problem p = {s, PROBLEM_LINEAR};
    double value[MATRIX_MAX], v[MATRIX_MAX][MATRIX_MAX], most = 0.0;
    int m = problem_size(s, PROBLEM_LINEAR), n = s->n;
    double *a = calloc((size_t)m * (size_t)n + 1, sizeof *a);
    if (!a)
        return 0.0;
    problem_slopes(&p, u, a);
    int chain = 0;
    for (int k = 0; k < n; k++) {
        chain += s->unknown[k].kind != FIT_PARAMETER;
        for (int i = 0; i < m && s->unknown[k].kind != FIT_PARAMETER; i++)
            a[i * n + k] = 0.0;
    }
    matrix_singular(m, n, a, value, v);
    free(a);
    int weak = n - 1 - chain;
    if (weak < 0)
        return 0.0;
    for (int k = 0; k < n; k++)
        most = fmax(most, fabs(v[k][weak]));
    for (int k = 0; k < n; k++)
        direction[k] = v[k][weak] / most;
    return fmin(line_most, fmax(line_least, value[weak] > 0.0 ? deviations / value[weak] : line_most));
}

/* The states in which records begin, for a plant that is given. */
static void adjust_starts(struct fit_setup *s, double *u)
{
    int steps;
    s->only_starts = true;
    if (s->records.n)
        (void)problem_solve(s, PROBLEM_RECORDS, u, &steps);
    s->only_starts = false;
}

/* ---- places ---- */

/* The best places, up to `most`, of the grid over what is not seen, by some points of each curve. */
static int search_grid(struct fit_setup *few, const double *u, const bool *unseen, int most,
                       double (*place)[FIT_UNKNOWNS])
{
    struct problem p = {few, PROBLEM_ROBUST};
    double cost[PLACES], at[FIT_UNKNOWNS];
    int n = 0;
    for (int i = 0; i < most; i++)
        cost[i] = HUGE_VAL;
    double *r = calloc((size_t)few->n_residuals + 1, sizeof *r);
    for (int i = 0; r && i < GRID; i++) {
        grid_point(few, u, unseen, i, at);
        adjust_starts(few, at);
        keep_best(most, cost, place, problem_residuals(&p, at, r), at);
        progress_tell(few, "looks for starts", i + 1, GRID);
    }
    free(r);
    while (n < most && isfinite(cost[n]))
        n++;
    return n;
}

/* Up to LINE_PLACES of the best places along the line, the best first, into place[]. Returns how many. */
static int search_line(struct fit_setup *s, const double *u, double (*place)[FIT_UNKNOWNS])
{
    struct problem p = {s, PROBLEM_ROBUST};
    double direction[FIT_UNKNOWNS] = {0.0}, cost[LINE], at[LINE][FIT_UNKNOWNS];
    double reach = weak_direction(s, u, direction);
    double *r = calloc((size_t)s->n_residuals + 1, sizeof *r);
    int n = 0;
    for (int i = 0; r && i < LINE; i++) {
        for (int k = 0; k < s->n; k++)
            at[i][k] = u[k] + reach * direction[k] * (2.0 * i / (LINE - 1) - 1.0);
        adjust_starts(s, at[i]);
        cost[i] = problem_residuals(&p, at[i], r);
        progress_tell(s, "looks for starts", i + 1, LINE);
    }
    for (bool found = r; found && n < LINE_PLACES;) {
        int best = -1;
        for (int i = 0; i < LINE; i++) {
            bool low = isfinite(cost[i]) && (i == 0 || !(cost[i - 1] < cost[i])) &&
                       (i == LINE - 1 || !(cost[i + 1] < cost[i]));
            best = low && (best < 0 || cost[i] < cost[best]) ? i : best;
        }
        found = best >= 0;
        if (found) {
            memcpy(place[n++], at[best], sizeof at[best]);
            for (int i = best > 0 ? best - 1 : 0; i <= best + 1 && i < LINE; i++)
                cost[i] = i == best ? HUGE_VAL : cost[i];
        }
    }
    free(r);
    return n;
}

int places_find(struct fit_setup *s, struct fit_setup *few, double (*place)[FIT_UNKNOWNS])
{
    double u[FIT_UNKNOWNS];
    bool unseen[FIT_UNKNOWNS];
    few->n = 0;
    for (int k = 0; k < s->n; k++)
        u[k] = unknown_u(&s->unknown[k], s->unknown[k].start);
    s->n_active = s->data.n;
    if (s->levers.n) {
        levers_start(s, u);
        memcpy(place[0], u, sizeof place[0]);
        return 1;
    }
    solve_linear(s, u);
    if (!find_unseen(s, PROBLEM_LINEAR, u, unseen))
        return search_line(s, u, place);
    return thin(s, few) ? search_grid(few, u, unseen, PLACES, place) : 0;
}

int places_unseen(struct fit_setup *few, const double *u, int most, double (*place)[FIT_UNKNOWNS])
{
    bool unseen[FIT_UNKNOWNS];
    return find_unseen(few, PROBLEM_ROBUST, u, unseen) ? search_grid(few, u, unseen, most, place) : 0;
}
