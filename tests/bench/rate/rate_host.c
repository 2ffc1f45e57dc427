/* rate_host.c - the error of each case and setting of rate_cases.h, in lines of "CASE METHOD STEPS TOLERANCE
 * ERROR"; those that a method's guard refuses are left out.
 *
 * Error: worst displacement over the ends of periods, relative to the largest deviation from rest; for tips,
 * the lock-in amplitude over the first 100 periods of the lever. Reference: taylor at 1e-12, for the shaft
 * exact; for tips with the same ticks, whose number the lock-in's sums depend on (4e-5 at 64 a period). */
#include <math.h>
#include <stdio.h>
#include "models/shaft_bearing.h"
#include "tests/bench/rate/rate_cases.h"

enum { REFERENCE_STEPS = 1000, REFERENCE_TOLERANCE = 12, PERIODS_MAX = 100 };

static struct rate_run run, quiet;

/* Displacements at the ends of periods; a tip's amplitude. False: refused, or not finite. */
static bool observe(const struct rate_case *c, const struct rate_setting *s, double *x)
{
    if (rate_start(&run, c, s, false))
        return false;
    for (int i = 0; i < c->periods; i++) {
        if (!rate_advance(&run, c, (uint32_t)s->steps))
            return false;
        x[i] = c->lever ? 0.0 : run.plant.x[0];
    }
    if (c->lever)
        x[0] = run.amplitude;
    return true;
}

static double rest_of(const struct rate_case *c)
{
    quiet = run;
    plant_reset(&quiet.plant);
    return c->lever ? 0.0 : quiet.plant.x[0];
}

static bool refer(const struct rate_case *c, int steps, double *truth)
{
    bool shaft = c->model == &shaft_bearing;
    const struct rate_setting s = {shaft ? &exact : &taylor, steps, shaft ? 0 : REFERENCE_TOLERANCE};
    return observe(c, &s, truth);
}

/* The errors of a case; false when there is no reference. */
static bool compare(const struct rate_case *c)
{
    static double truth[PERIODS_MAX], x[PERIODS_MAX];
    int n = c->lever ? 1 : c->periods;
    if (!refer(c, REFERENCE_STEPS, truth))
        return false;
    double rest = rest_of(c), largest = 0.0;
    for (int k = 0; k < n; k++)
        largest = fmax(largest, fabs(truth[k] - rest));
    for (int k = 0; k < RATE_SETTINGS; k++) {
        struct rate_setting s = rate_setting(c, k);
        double error = 0.0;
        if (!observe(c, &s, x) || (c->lever && !refer(c, s.steps, truth)))
            continue;
        for (int j = 0; j < n; j++)
            error = fmax(error, fabs(x[j] - truth[j]) / largest);
        printf("%s %s %d %d %.2e\n", c->name, s.method->name, s.steps, s.tolerance, error);
    }
    return true;
}

int main(void)
{
    for (int i = 0; i < RATE_CASES; i++) {
        if (!compare(&rate_case[i])) {
            fprintf(stderr, "rate_host: %s: no reference\n", rate_case[i].name);
            return 1;
        }
    }
    return 0;
}
