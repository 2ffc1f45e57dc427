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
    char how[40];
    double growth = fmax(r->growth, 1.0);
    snprintf(how, sizeof how, ", %g ticks a period", steps);
    trajectory_check(r, how, &worst, growth * 1e-11, growth * 1e-11,
                     growth * 1e-10); /* accelerations up to 50 */
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
    trajectory_all(check_case);
}

/* Slope of log10(error) over log10(tol), least squares over tol = 1e-4 .. 1e-12. */
static void check_slope(const struct trajectory *r)
{
    double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, ratio = 0.0, growth = fmax(r->growth, 1.0);
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
    check_near(check_name("%s: slope of error over tolerance", r->name),
               (n * sxy - sx * sy) / (n * sxx - sx * sx), 1.0, 0.2);
    check_below(check_name("%s: worst error over tolerance and growth", r->name), ratio / growth, 30.0);
}

TEST(taylor_tolerance)
{
    trajectory_all(check_slope);
}
