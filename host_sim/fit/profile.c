/* profile.c - see profile.h. */
#include "host_sim/fit/profile.h"

#include <math.h>
#include <string.h>
#include "host_sim/cli/clock.h"
#include "host_sim/fit/levers.h"
#include "host_sim/fit/solve/problem.h"
#include "host_sim/fit/solve/unknown.h"

enum { MIDDLE = PROFILE_POINTS / 2 };
static const double rise_95 = 3.8414588; /* quantile of chi^2 with one degree of freedom */
static const double rise_two = 4.0;      /* a parabola, two standard deviations off */

/* Unknown k moves by `step`, and the others as the slopes at the minimum have them follow. */
static void go(const struct fit_setup *s, const struct fit_result *r, int k, double step, double *u)
{
    for (int i = 0; i < s->n; i++)
        u[i] += r->covariance[i][k] / r->covariance[k][k] * step;
}

/* The rise of chi^2 where unknown k is held at u[k], and the others are fitted from u; u becomes their place.
 * NaN: u[k] is outside of its range, or the user stopped it. */
static double rise_at(struct fit_setup *s, const struct fit_result *r, int k, double *u)
{
    const struct fit_unknown *x = &s->unknown[k];
    int steps;
    if (u[k] < unknown_u(x, x->min) || u[k] > unknown_u(x, x->max))
        return (double)NAN;
    s->held = x;
    double chi2 = problem_solve(s, PROBLEM_PLAIN, u, &steps);
    s->held = NULL;
    return clock_interrupted() ? (double)NAN : fmax(chi2 - r->chi2, 0.0) / levers_widening(s);
}

/* From the middle outwards, each point from the one before. */
static void walk(struct fit_setup *s, const struct fit_result *r, struct profile *p, int by)
{
    double u[FIT_UNKNOWNS];
    memcpy(u, r->u, sizeof u);
    for (int i = MIDDLE + by; i >= 0 && i < PROFILE_POINTS; i += by) {
        go(s, r, p->unknown, (double)PROFILE_REACH * r->sd[p->unknown] * by / MIDDLE, u);
        p->u[i] = u[p->unknown];
        p->rise[i] = rise_at(s, r, p->unknown, u);
        if (isnan(p->rise[i]))
            return;
    }
}

/* Where the root of the rise crosses that of 95 %, in straight lines between points. */
static bool find_crossing(const struct profile *p, int by, double *u)
{
    for (int i = MIDDLE + by; i >= 0 && i < PROFILE_POINTS; i += by) {
        double inner = sqrt(p->rise[i - by]), outer = sqrt(p->rise[i]), level = sqrt(rise_95);
        if (!(outer >= level))
            continue;
        *u = p->u[i - by] + (p->u[i] - p->u[i - by]) * (level - inner) / (outer - inner);
        return true;
    }
    return false;
}

bool profile_find(struct fit_setup *s, const struct fit_result *r, int k, struct profile *p)
{
    *p = (struct profile){.unknown = k};
    for (int i = 0; i < PROFILE_POINTS; i++)
        p->rise[i] = p->u[i] = (double)NAN;
    p->u[MIDDLE] = r->u[k];
    p->rise[MIDDLE] = 0.0;
    walk(s, r, p, -1);
    walk(s, r, p, 1);
    p->crossed[0] = find_crossing(p, -1, &p->low);
    p->crossed[1] = find_crossing(p, 1, &p->high);
    return !clock_interrupted();
}

/* How many standard deviations off, on this side, chi^2 has risen by that of two; 2 where half of it is there
 * at two. */
static double find_two(struct fit_setup *s, const struct fit_result *r, int k, int by)
{
    double u[FIT_UNKNOWNS], before = 0.0;
    memcpy(u, r->u, sizeof u);
    for (int off = 2; off <= PROFILE_FAR; off++) {
        go(s, r, k, (off > 2 ? by : 2 * by) * r->sd[k], u);
        double rise = rise_at(s, r, k, u), root = sqrt(rise);
        if (off == 2 && !(rise < 0.5 * rise_two)) /* outside of its range, too: that is judged by itself */
            return 2.0;
        if (isnan(rise))
            break;
        if (rise >= rise_two)
            return off - (root - 2.0) / (root - before);
        before = root;
    }
    return HUGE_VAL;
}

double profile_widening(struct fit_setup *s, const struct fit_result *r, int k)
{
    return 0.5 * fmax(find_two(s, r, k, -1), find_two(s, r, k, 1));
}
