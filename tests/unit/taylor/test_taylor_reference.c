/* test_taylor_reference.c - taylor along the stored trajectories of every plant that it has a series for.
 *
 * tests/data: multi-precision results made without this code, trusted to 1e-15. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include "tests/fixture/trajectory.h"

static double scratch[METHOD_SCRATCH];

static void check_at(const struct trajectory *r, double steps)
{
    struct trajectory_errors worst = trajectory_run(r, &taylor, 1e-12, scratch, steps);
    char text[160];
    double growth = fmax(r->growth, 1.0);
    snprintf(text, sizeof text, "%s, %g ticks a period: worst state error over its column's maximum", r->name,
             steps);
    check_below(text, worst.state, growth * 1e-11);
    if (r->n_events_total >= 0) {
        snprintf(text, sizeof text, "%s: contact switches", r->name);
        check_int(text, worst.n_events, r->n_events_total);
    }
    if (r->n_events_total > 0) {
        snprintf(text, sizeof text, "%s: worst switch instant error, model time", r->name);
        check_below(text, worst.time, growth * 1e-11);
        snprintf(text, sizeof text, "%s: worst gap speed error at a switch, model units", r->name);
        check_below(text, worst.speed, growth * 1e-10); /* accelerations are up to 50 */
        check_int("switches of the wrong kind", worst.kinds, 0);
    }
    check_int("roots that did not converge, budgets reached", worst.residual + worst.budget, 0);
}

static void check_case(const struct trajectory *r)
{
    if (!r->model->hertz_form && !r->model->polynomial_form)
        return;
    check_at(r, 21.3);
    check_at(r, 120.0);
}

/* Every trajectory, long ticks with several series each and short ones that reuse them. */
TEST(taylor_reference)
{
    check_int("cases of the rig", trajectory_each("tests/data/rig_trajectories.txt", check_case), 10);
    check_int("cases of the other models", trajectory_each("tests/data/model_trajectories.txt", check_case),
              18);
}

/* Slope of log10(error) over log10(tol), least squares over tol = 1e-4 .. 1e-12. */
static void check_slope(const struct trajectory *r)
{
    double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, ratio = 0.0, growth = fmax(r->growth, 1.0);
    char text[160];
    int n = 0;
    if ((!r->model->hertz_form && !r->model->polynomial_form) || r->growth > 100.0)
        return;
    for (int k = 4; k <= 12; k++, n++) {
        double error = trajectory_run(r, &taylor, pow(10.0, -k), scratch, 21.3).state, y = log10(error);
        sx += -k;
        sy += y;
        sxx += (double)k * k;
        sxy += -k * y;
        ratio = fmax(ratio, error * pow(10.0, k));
    }
    snprintf(text, sizeof text, "%s: slope of error over tolerance", r->name);
    check_near(text, (n * sxy - sx * sy) / (n * sxx - sx * sx), 1.0, 0.2);
    snprintf(text, sizeof text, "%s: worst error over tolerance and growth", r->name);
    check_below(text, ratio / growth, 30.0);
}

TEST(taylor_tolerance)
{
    trajectory_each("tests/data/rig_trajectories.txt", check_slope);
    trajectory_each("tests/data/model_trajectories.txt", check_slope);
}
