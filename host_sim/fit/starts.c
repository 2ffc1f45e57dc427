/* starts.c - see starts.h.
 *
 * The first start is that of the linear form. The smallest curve leaves one direction of the unknowns nearly
 * free, for a rig the one that keeps its linear stiffness. Fits begin at the best places along this line, and
 * beside them. */
#include "host_sim/fit/starts.h"
#include "host_sim/fit/solve/unknown.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/cli/clock.h"
#include "host_sim/fit/levers.h"
#include "host_sim/fit/noise.h"
#include "host_sim/fit/solve/problem_levers.h"
#include "host_sim/fit/progress.h"
#include "host_sim/fit/sequence.h"

enum { LINE = 41, LINE_UNSEEN = 9, MINIMA = 4 };
static const double line_most = 2.3; /* a factor of 10 */
static const double line_least = 0.05;
static const double line_unseen = 1.4; /* a factor of 4 */
static const double unseen = 1e-6;     /* share of the largest slope: rounding */
static const double deviations = 20.0; /* deviations of the weak direction, along the line */
static const double beside = 0.2;      /* further starts, from the best place */
static const double narrow_sd = 10.0;
static const double passed_by = 0.1; /* cost and every unknown: two fits that have come to one place */
static const double same_u = 1.0;    /* in standard deviations: one minimum */
static const double same_chi2 = 4.0; /* another minimum as good, to two standard deviations */

/* Lengths on which the smallest curve does not depend, as gaps that it does not close: all of them together.
 */
static bool unseen_direction(const struct fit_setup *s, int m, const double *a, double *direction)
{
    double most = 0.0;
    bool any = false;
    for (int i = 0; i < m * s->n; i++)
        most = fmax(most, fabs(a[i]));
    for (int k = 0; k < s->n && m; k++) {
        bool seen = s->unknown[k].kind != FIT_PARAMETER || strcmp(s->unknown[k].unit, "m") != 0;
        for (int i = 0; i < m && !seen; i++)
            seen = fabs(a[i * s->n + k]) > unseen * most;
        direction[k] = !seen;
        any = any || !seen;
    }
    return any;
}

/* The direction in which the smallest curve says least, its largest component 1. Returns how far to look, at
 * *points places. */
static double weak_direction(struct fit_setup *s, const double *u, double *direction, int *points)
{
    struct problem p = {s, PROBLEM_LINEAR};
    double value[MATRIX_MAX], v[MATRIX_MAX][MATRIX_MAX], most = 0.0;
    int m = problem_size(s, PROBLEM_LINEAR), n = s->n;
    double *a = calloc((size_t)m * (size_t)n + 1, sizeof *a);
    if (!a)
        return 0.0;
    problem_slopes(&p, u, a);
    if (unseen_direction(s, m, a, direction)) {
        free(a);
        *points = LINE_UNSEEN;
        return line_unseen;
    }
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

/* Up to MINIMA of the best places along the line, the best first, into place[]. Returns how many. */
static int search_line(struct fit_setup *s, const double *u, double (*place)[FIT_UNKNOWNS])
{
    struct problem p = {s, PROBLEM_ROBUST};
    double direction[FIT_UNKNOWNS] = {0.0}, cost[LINE], at[LINE][FIT_UNKNOWNS];
    int points = LINE;
    double reach = weak_direction(s, u, direction, &points);
    double *r = calloc((size_t)s->n_residuals + 1, sizeof *r);
    int n = 0;
    for (int i = 0; r && i < points; i++) {
        for (int k = 0; k < s->n; k++)
            at[i][k] = u[k] + reach * direction[k] * (2.0 * i / (points - 1) - 1.0);
        adjust_starts(s, at[i]);
        cost[i] = problem_residuals(&p, at[i], r);
        progress_tell(s, "looks for starts", i + 1, points);
    }
    for (bool found = r; found && n < MINIMA;) {
        int best = -1;
        for (int i = 0; i < points; i++) {
            bool low = isfinite(cost[i]) && (i == 0 || !(cost[i - 1] < cost[i])) &&
                       (i == points - 1 || !(cost[i + 1] < cost[i]));
            best = low && (best < 0 || cost[i] < cost[best]) ? i : best;
        }
        found = best >= 0;
        if (found) {
            memcpy(place[n++], at[best], sizeof at[best]);
            for (int i = best > 0 ? best - 1 : 0; i <= best + 1 && i < points; i++)
                cost[i] = i == best ? HUGE_VAL : cost[i];
        }
    }
    free(r);
    return n;
}

/* Further starts: each unknown of the best place is moved one way or the other. A lever's resonance is
 * narrow: there the move is no longer than some standard deviations. */
static void add_beside(struct fit_setup *s, double (*place)[FIT_UNKNOWNS], int n)
{
    struct fit_result r = {.chi2 = 0.0};
    memcpy(r.u, place[0], sizeof r.u);
    bool narrow = s->levers.n && starts_spread(s, &r);
    for (int i = n; i < FIT_STARTS; i++)
        for (int k = 0; k < s->n; k++) {
            double by = narrow ? fmin(beside, narrow_sd * r.sd[k]) : beside;
            double moved = place[0][k] + ((i - n) >> k & 1 ? -by : by);
            place[i][k] = s->unknown[k].kind == FIT_PARAMETER ? moved : place[0][k];
        }
}

/* The largest axis of the covariance of the unknowns that are told. */
static void find_weak(const struct fit_setup *s, struct fit_result *r)
{
    double a[FIT_UNKNOWNS * FIT_UNKNOWNS], value[MATRIX_MAX], v[MATRIX_MAX][MATRIX_MAX];
    for (int i = 0; i < s->n; i++)
        for (int k = 0; k < s->n; k++)
            a[i * s->n + k] =
                fit_is_hidden(&s->unknown[i]) || fit_is_hidden(&s->unknown[k]) ? 0.0 : r->covariance[i][k];
    matrix_singular(s->n, s->n, a, value, v);
    for (int k = 0; k < s->n; k++)
        r->weak[k] = v[k][0];
}

bool starts_spread(struct fit_setup *s, struct fit_result *r)
{
    struct problem p = {s, PROBLEM_PLAIN};
    double *a = calloc((size_t)(s->n_residuals + 1) * (size_t)s->n, sizeof *a);
    if (!a)
        return false;
    problem_slopes(&p, r->u, a);
    problem_levers_widen(s, a);
    matrix_singular(s->n_residuals, s->n, a, r->s, r->v);
    free(a);
    for (int i = 0; i < s->n; i++)
        for (int k = 0; k < s->n; k++) {
            r->covariance[i][k] = 0.0;
            for (int d = 0; d < s->n; d++)
                r->covariance[i][k] += r->v[i][d] * r->v[k][d] / fmax(r->s[d] * r->s[d], 1e-24);
        }
    for (int k = 0; k < s->n; k++)
        r->sd[k] = sqrt(r->covariance[k][k]);
    find_weak(s, r);
    return true;
}

/* The ends of the starts so far. */
struct ends {
    double robust[FIT_STARTS], passed[FIT_STARTS][FIT_UNKNOWNS]; /* cost and place of the robust form */
    double chi2[FIT_STARTS];
    int best; /* or -1 */
};

/* The start before i that has come by the same place, or -1. */
static int came_by(const struct fit_setup *s, const struct ends *e, int i)
{
    for (int b = 0; b < i; b++) {
        double off = fabs(e->robust[b] - e->robust[i]);
        for (int k = 0; k < s->n; k++)
            off = fmax(off, fabs(e->passed[b][k] - e->passed[i][k]));
        if (off < passed_by)
            return b;
    }
    return -1;
}

/* The fit from place i: curves enter in the order of their drives. One that comes by an earlier one's place
 * ends with that, and one that is worse than the best fit even in the robust form ends there. */
static double fit_from(struct fit_setup *s, struct ends *e, int i, double (*place)[FIT_UNKNOWNS])
{
    int steps, all = s->data.n;
    for (s->n_active = all < 2 ? all : 2; s->n_active <= all; s->n_active++)
        e->robust[i] = problem_solve(s, PROBLEM_ROBUST, place[i], &steps);
    s->n_active = all;
    memcpy(e->passed[i], place[i], sizeof e->passed[i]);
    int before = came_by(s, e, i);
    if (before >= 0) {
        memcpy(place[i], place[before], sizeof place[i]);
        return e->chi2[before];
    }
    if (e->best >= 0 && e->robust[i] > e->chi2[e->best] + same_chi2)
        return e->robust[i];
    return problem_solve(s, PROBLEM_PLAIN, place[i], &steps);
}

/* Which of the ends agree with the best one, by its own spread. */
static void compare_ends(const struct fit_setup *s, struct fit_result *r, double (*end)[FIT_UNKNOWNS],
                         const double *chi2)
{
    for (int i = 0; i < r->starts; i++) {
        double off = 0.0;
        for (int k = 0; k < s->n; k++)
            off = fmax(off, fabs(end[i][k] - r->u[k]) / r->sd[k]);
        r->agree += off < same_u;
        r->worse += off >= same_u && chi2[i] > r->chi2 + same_chi2;
    }
}

/* Fits from every place until the user stops: the fit that was going on then is none. */
static void fit_all(struct fit_setup *s, struct fit_result *r, struct ends *e, double (*place)[FIT_UNKNOWNS])
{
    e->best = -1;
    for (; r->starts < FIT_STARTS; r->starts++) {
        int i = r->starts;
        e->chi2[i] = fit_from(s, e, i, place);
        if (clock_interrupted())
            break;
        if (isfinite(e->chi2[i]) && (e->best < 0 || e->chi2[i] < e->chi2[e->best]))
            e->best = i;
        progress_tell(s, "fits from start", i + 1, FIT_STARTS);
    }
    r->interrupted = r->starts < FIT_STARTS;
    s->task.to_the_end = true;
}

/* The motions, residuals and spread of the result. */
static bool look(struct fit_setup *s, struct fit_result *r)
{
    struct problem p = {s, PROBLEM_PLAIN};
    double *residual = calloc((size_t)s->n_residuals + 1, sizeof *residual);
    int steps;
    if (!residual)
        return false;
    memset(s->smooth, 0, sizeof s->smooth);
    (void)problem_residuals(&p, r->u, residual);
    noise_estimate(s, residual);
    if (!s->noise_known && !r->interrupted)
        (void)problem_solve(s, PROBLEM_PLAIN, r->u, &steps);
    r->chi2 = problem_residuals(&p, r->u, residual);
    free(residual);
    return starts_spread(s, r);
}

bool starts_fit(struct fit_setup *s, struct fit_result *r)
{
    double u[FIT_UNKNOWNS], place[FIT_STARTS][FIT_UNKNOWNS];
    struct ends e;
    int steps;
    *r = (struct fit_result){.chi2 = HUGE_VAL};
    for (int k = 0; k < s->n; k++)
        u[k] = unknown_u(&s->unknown[k], s->unknown[k].start);
    s->n_active = s->data.n;
    if (s->levers.n)
        levers_start(s, u);
    else
        (void)problem_solve(s, PROBLEM_LINEAR, u, &steps);
    memcpy(place[0], u, sizeof place[0]);
    int n = s->levers.n ? 1 : search_line(s, u, place);
    if (!n)
        return false;
    add_beside(s, place, n);
    fit_all(s, r, &e, place);
    if (e.best < 0)
        return false;
    memcpy(r->u, place[e.best], sizeof r->u);
    double before = e.chi2[e.best];
    if (!look(s, r))
        return false;
    for (int i = 0; i < r->starts; i++)
        e.chi2[i] *= before > 0.0 ? r->chi2 / before : 1.0;
    compare_ends(s, r, place, e.chi2);
    struct sequence q;
    for (int k = 0; sequence_nth(s, k, &q); k++)
        for (int i = 0; i < q.n; i++)
            r->n_numbers += sequence_counts(s, &q, i);
    return true;
}
