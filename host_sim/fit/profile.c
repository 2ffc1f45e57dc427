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

/* Unknown k moves by `step`, and the others as the slopes at the minimum have them follow. */
static void go(const struct fit_setup *s, const struct fit_result *r, int k, double step, double *u)
{
    for (int i = 0; i < s->n; i++)
        u[i] += r->covariance[i][k] / r->covariance[k][k] * step;
}

/* From the middle outwards, each point from the one before. */
static void walk(struct fit_setup *s, const struct fit_result *r, struct profile *p, int by)
{
    const struct fit_unknown *x = &s->unknown[p->unknown];
    double u[FIT_UNKNOWNS];
    int steps;
    memcpy(u, r->u, sizeof u);
    for (int i = MIDDLE + by; i >= 0 && i < PROFILE_POINTS; i += by) {
        go(s, r, p->unknown, (double)PROFILE_REACH * r->sd[p->unknown] * by / MIDDLE, u);
        p->u[i] = u[p->unknown];
        if (u[p->unknown] < unknown_u(x, x->min) || u[p->unknown] > unknown_u(x, x->max))
            return;
        s->held = &s->unknown[p->unknown];
        double chi2 = problem_solve(s, PROBLEM_PLAIN, u, &steps);
        s->held = NULL;
        if (clock_interrupted())
            return;
        p->rise[i] = fmax(chi2 - r->chi2, 0.0) / levers_widening(s);
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
