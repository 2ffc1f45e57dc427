/* test_plants.c - frames of plants that share a clock: each
 * makes up by its own overrun policy what the process missed. */
#include <stdlib.h>
#include "host_sim/plants/plants.h"
#include "tests/fixture/silent_bus.h"
#include "tests/unit/test.h"

enum { CATCHER, SKIPPER, N };

static struct plants plants;

static void start_plants(void)
{
    static const double policy[N] = {OVERRUN_CATCH_UP, OVERRUN_SKIP};
    char why[SCENE_REASON] = "";
    plants.n = N;
    plants.one = calloc(N, sizeof *plants.one);
    for (int i = 0; i < N; i++) {
        struct scene_app *s = &plants.one[i].scene;
        check_true("a scene", scene_init(s, "rig", why));
        s->setting[SET_OVERRUN_POLICY] = policy[i];
        check_true(why, scene_start(s, &silent_bus, why));
        s->app.state = STATE_RUNNING;
    }
}

static void frame_of_all(void)
{
    for (int i = 0, n; i < N; i += n) {
        n = plants_together(&plants, i);
        plants_frames(&plants, i, n);
    }
}

static void check_frames(const char *name, int i, int frames, int due)
{
    const struct scene_app *s = &plants.one[i].scene;
    check_int(name, (int64_t)s->app.frame, frames);
    check_int("its plant frames", (int64_t)(s->app.plant.now.tick / s->config.substeps), frames);
    check_int("due", plants.one[i].due, due);
}

TEST(plants_overrun)
{
    start_plants();
    plants_begin(&plants, 1);
    frame_of_all();
    check_frames("on time: the first", CATCHER, 1, 0);
    check_frames("the second", SKIPPER, 1, 0);
    check_true("nothing is due", !plants_due(&plants));
    plants_begin(&plants, 4); /* three were missed */
    frame_of_all();
    check_frames("three missed: one catches up", CATCHER, 2, 3);
    check_frames("one goes over them at once", SKIPPER, 5, 0);
    plants_begin(&plants, 0); /* meanwhile none begins */
    frame_of_all();
    check_frames("catching up", CATCHER, 3, 2);
    check_frames("the other waits for its time", SKIPPER, 5, 0);
    plants_begin(&plants, 1); /* meanwhile one begins, which the other has on time */
    frame_of_all();
    check_frames("one more to catch up", CATCHER, 4, 2);
    check_frames("the other is on time", SKIPPER, 6, 0);
    check_int("and has missed no more", plants.one[SKIPPER].scene.app.count[DIAG_FRAMES_MISSED], 3);
    for (int k = 0; k < 2; k++) {
        plants_begin(&plants, 0);
        frame_of_all();
    }
    check_frames("caught up", CATCHER, 6, 0);
    plants_free(&plants);
}
