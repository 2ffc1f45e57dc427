/* test_reference.c - every stored trajectory at 4096 steps per slow period (the rig) or contact period.
 *
 * rig_trajectories.txt and model_trajectories.txt in tests/data: multi-precision results made without this
 * code, trusted to 1e-15. At this step rk4 is off by 7e-8 at most where contact is lost (order 2.5 at the
 * Hertz kink) and by 3e-10 elsewhere. 1e-6 catches any error of a model. It leaves room for another
 * compiler's rounding times the growth (at most 4e5) of a chaotic case. */
#include "tests/unit/test.h"

#include <stdio.h>
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
    char text[128];
    snprintf(text, sizeof text, "%s: worst state error over its column's maximum", r->name);
    check_below(text, worst.state, 1e-6);
    if (r->n_events_total >= 0) {
        snprintf(text, sizeof text, "%s: contact switches", r->name);
        check_int(text, worst.n_events, r->n_events_total);
    }
    if (r->n_events_total > 0) {
        snprintf(text, sizeof text, "%s: worst switch instant error, model time", r->name);
        check_below(text, worst.time, 1e-5);
        snprintf(text, sizeof text, "%s: worst gap speed error at a switch, model units", r->name);
        check_below(text, worst.speed, 1e-5);
        check_int("switches of the wrong kind", worst.kinds, 0);
    }
}

TEST(reference_trajectories)
{
    check_int("reference cases of the rig", trajectory_each("tests/data/rig_trajectories.txt", check_case),
              10);
    check_int("reference cases of the other models",
              trajectory_each("tests/data/model_trajectories.txt", check_case), 18);
}
