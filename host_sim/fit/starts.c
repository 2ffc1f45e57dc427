/* starts.c - see starts.h.
 *
 * Fits begin at the places that places.c finds, and then beside the best end of these. */
#include "host_sim/fit/starts.h"
#include "host_sim/fit/solve/unknown.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/cli/clock.h"
#include "host_sim/fit/noise.h"
#include "host_sim/fit/places.h"
#include "host_sim/fit/solve/problem_levers.h"
#include "host_sim/fit/progress.h"
#include "host_sim/fit/sequence.h"
#include "host_sim/fit/thin.h"

static const double beside = 0.2;    /* further starts, from the best end of the first ones */
static const double close_by = 0.05; /* the last one, where no second start has ended there */
static const double narrow_sd = 10.0;
static const double passed_by = 0.1;   /* cost and every unknown: two fits that have come to one place */
static const double worse_by = 10.0;   /* times the best cost of some points: no second fit follows */
static const double same_u = 1.0;      /* in standard deviations: one minimum */
static const double same_place = 1e-3; /* and so near it is one plant, however narrow its minimum is */
static const double same_chi2 = 4.0;   /* another minimum as good, to two standard deviations */

/* Further starts: each unknown of the best end is moved one way or the other. A lever's resonance is narrow:
 * there the move is no longer than some standard deviations. */
static void add_beside(struct fit_setup *s, double (*place)[FIT_UNKNOWNS], const double *end, int n)
{
    struct fit_result r = {.chi2 = 0.0};
    memcpy(r.u, end, sizeof r.u);
    bool narrow = s->levers.n && starts_spread(s, &r);
    for (int i = n; i < FIT_STARTS; i++)
        for (int k = 0; k < s->n; k++) {
            double by = narrow ? fmin(beside, narrow_sd * r.sd[k]) : beside;
            double moved = r.u[k] + ((i - n) >> k & 1 ? -by : by);
            place[i][k] = s->unknown[k].kind == FIT_PARAMETER ? moved : r.u[k];
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

int starts_weakest(const struct fit_setup *s, const struct fit_result *r)
{
    int most = 0;
    for (int k = 1; k < s->n; k++)
        most = fabs(r->weak[k]) > fabs(r->weak[most]) ? k : most;
    return most;
}

/* The spread of the others at a given value of unknown k stays as it is. */
void starts_widen(const struct fit_setup *s, struct fit_result *r, int k, double factor)
{
    double column[FIT_UNKNOWNS], square = r->covariance[k][k];
    for (int i = 0; i < s->n; i++)
        column[i] = r->covariance[i][k];
    for (int a = 0; a < s->n; a++)
        for (int b = 0; b < s->n; b++)
            r->covariance[a][b] += (factor * factor - 1.0) * column[a] * column[b] / square;
    for (int i = 0; i < s->n; i++)
        r->sd[i] = sqrt(r->covariance[i][i]);
    find_weak(s, r);
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
    int best;              /* or -1 */
    struct fit_setup *few; /* with some points, for a first fit; or NULL */
    double few_cost[FIT_STARTS], few_end[FIT_STARTS][FIT_UNKNOWNS];
};

/* The largest difference of two places. */
static double apart(const struct fit_setup *s, const double *a, const double *b)
{
    double off = 0.0;
    for (int k = 0; k < s->n; k++)
        off = fmax(off, fabs(a[k] - b[k]));
    return off;
}

/* The start before i that has come by the same place, or -1. */
static int came_by(const struct fit_setup *s, const double *cost, double (*passed)[FIT_UNKNOWNS], int i)
{
    for (int b = 0; b < i; b++)
        if (fabs(cost[b] - cost[i]) < passed_by && apart(s, passed[b], passed[i]) < passed_by)
            return b;
    return -1;
}

/* Start i ends where start b did. */
static double end_with(struct ends *e, int i, int b, double (*place)[FIT_UNKNOWNS])
{
    e->robust[i] = e->robust[b];
    memcpy(e->passed[i], e->passed[b], sizeof e->passed[i]);
    memcpy(place[i], place[b], sizeof place[i]);
    return e->chi2[b];
}

/* A first fit to some points. True: it shows where start i ends, at cost *chi2. */
static bool fit_few(const struct fit_setup *s, struct ends *e, int i, double (*place)[FIT_UNKNOWNS],
                    double *chi2)
{
    int steps;
    e->few_cost[i] = problem_solve(e->few, PROBLEM_ROBUST, place[i], &steps);
    memcpy(e->few_end[i], place[i], sizeof e->few_end[i]);
    int before = came_by(s, e->few_cost, e->few_end, i);
    bool hopeless =
        e->best >= 0 && e->few_cost[i] > fmax(worse_by * e->few_cost[e->best], e->chi2[e->best] + same_chi2);
    if (before >= 0)
        *chi2 = end_with(e, i, before, place);
    else if (hopeless)
        *chi2 = e->robust[i] = e->few_cost[i];
    if (hopeless)
        memcpy(e->passed[i], place[i], sizeof e->passed[i]);
    return before >= 0 || hopeless;
}

/* The fit from place i: curves enter in the order of their drives. One that comes by an earlier one's place
 * ends with that. One that is worse than the best fit even in the robust form ends there, unless it is near.
 */
static double fit_from(struct fit_setup *s, struct ends *e, int i, double (*place)[FIT_UNKNOWNS])
{
    int steps, all = s->data.n;
    double chi2;
    if (e->few && fit_few(s, e, i, place, &chi2))
        return chi2;
    for (s->n_active = all < 2 || e->few ? all : 2; s->n_active <= all; s->n_active++)
        e->robust[i] = problem_solve(s, PROBLEM_ROBUST, place[i], &steps);
    s->n_active = all;
    memcpy(e->passed[i], place[i], sizeof e->passed[i]);
    int before = came_by(s, e->robust, e->passed, i);
    if (before >= 0)
        return end_with(e, i, before, place);
    if (e->best >= 0 && e->robust[i] > e->chi2[e->best] + same_chi2 &&
        apart(s, place[i], place[e->best]) > passed_by)
        return e->robust[i];
    return problem_solve(s, PROBLEM_PLAIN, place[i], &steps);
}

/* Which of the ends agree with the best one: by its own spread, or as the same plant. */
static void compare_ends(const struct fit_setup *s, struct fit_result *r, double (*end)[FIT_UNKNOWNS],
                         const double *chi2)
{
    for (int i = 0; i < r->starts; i++) {
        double off = 0.0;
        for (int k = 0; k < s->n; k++)
            off = fmax(off, fabs(end[i][k] - r->u[k]) / fmax(r->sd[k], same_place / same_u));
        r->agree += off < same_u;
        r->worse += off >= same_u && chi2[i] > r->chi2 + same_chi2;
    }
}

/* No second one of the n ends so far is at the best one. */
static bool is_alone(const struct fit_setup *s, const struct ends *e, double (*place)[FIT_UNKNOWNS], int n)
{
    bool alone = e->best >= 0;
    for (int i = 0; i < n; i++)
        alone = alone && (i == e->best || apart(s, place[i], place[e->best]) > passed_by);
    return alone;
}

/* Behind the first n places: those of what the best end does not see, or beside it. */
static void add_further(struct fit_setup *s, struct ends *e, double (*place)[FIT_UNKNOWNS], int n)
{
    double end[FIT_UNKNOWNS];
    memcpy(end, place[e->best < 0 ? 0 : e->best], sizeof end);
    if (e->few)
        n += places_unseen(e->few, end, FIT_STARTS - n < PLACES ? FIT_STARTS - n : PLACES, &place[n]);
    add_beside(s, place, end, n);
}

/* Fits from the first n places and beside them until the user stops: the fit that was going on then is none.
 */
static void fit_all(struct fit_setup *s, struct fit_result *r, struct ends *e, double (*place)[FIT_UNKNOWNS],
                    int n)
{
    for (; r->starts < FIT_STARTS; r->starts++) {
        int i = r->starts;
        if (i == n)
            add_further(s, e, place, n);
        if (i == FIT_STARTS - 1 && is_alone(s, e, place, i))
            for (int k = 0; k < s->n; k++)
                place[i][k] = place[e->best][k] + (s->unknown[k].kind == FIT_PARAMETER ? close_by : 0.0);
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
    double place[FIT_STARTS][FIT_UNKNOWNS];
    struct fit_setup few;
    struct ends e = {.best = -1};
    *r = (struct fit_result){.chi2 = HUGE_VAL};
    int n = places_find(s, &few, place);
    e.few = few.n ? &few : NULL;
    if (n)
        fit_all(s, r, &e, place, n);
    if (few.n)
        thin_free(&few);
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
