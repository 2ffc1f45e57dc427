/* test_choose_out.c - the scene that choose writes is, run by simulate, the run that it certified:
 * tests/choose/choose_scenes.c has many. */
#include <string.h>
#include "models/scenes/scenes.h"
#include "tests/choose/choose_out.h"
#include "tests/unit/test.h"
#include "host_sim/choose/choose_search.h"

static void check_out(const char *preset, double tolerance, double over)
{
    static struct choose_certificate c;
    bool escaped;
    memset(&c, 0, sizeof c);
    c.title = preset;
    c.scene = scenes_find(preset)->scene;
    c.scene.tolerance = tolerance;
    c.scene.over = over;
    check_no_error(preset, choose_search(&c, NULL, &escaped));
    check_is(preset, c.choice, >=, 0);
    check_int("frames that simulate has with other bits", choose_out_differs(&c), 0);
}

/* Series whose coefficients go on from frame to frame, steps of rk4 and exact, located switches, noise,
 * and a slow bus. */
TEST(choose_out)
{
    check_out("rig", 1e-2, 0.5);
    check_out("kb-fig16", 1e-4, 100.0);
    check_out("nayak-fig10", 1e-3, 100.0);
    check_out("nayak-random", 1e-2, 100.0);
    check_out("shaft-fig12", 1e-4, 0.5);
    check_out("tip", 1e-3, 1e-4);
}
