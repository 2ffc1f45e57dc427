/* test_reference.c - every stored trajectory at 4096 steps per slow period (the rig) or contact period.
 *
 * rig_trajectories.txt and model_trajectories.txt in tests/data: multi-precision results made without this
 * code, trusted to 1e-15. At this step rk4 is off by 7e-8 at most where contact is lost (order 2.5 at the
 * Hertz kink) and by 3e-10 elsewhere. 1e-6 catches any error of a model. It leaves room for another
 * compiler's rounding times the growth (at most 4e5) of a chaotic case. */
#include "tests/unit/test.h"

#include "models/hertz_rig.h"
#include "tests/fixture/paper.h"
#include "tests/fixture/trajectory.h"

/* Steps per contact period: the slow period of the rig is 1/omega of them. */
static double steps_per_period(const struct trajectory *r)
{
    return r->model == &hertz_rig ? 4096.0 * r->paper[paper_index(r->model, "omega")] : 4096.0;
}

static void check_case(const struct trajectory *r)
{
    struct trajectory_errors worst = trajectory_run(r, &rk4, 0.0, NULL, steps_per_period(r));
    trajectory_check(r, "", &worst, 1e-6, 1e-5, 1e-5);
}

TEST(reference_trajectories)
{
    trajectory_all(check_case);
}
