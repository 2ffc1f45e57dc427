/* test_plant_no_ledger.c - a plant without a ledger beside one
 * with it: scene by scene the same motion, to the last bit. */

#include <math.h>
#include <string.h>
#include "firmware/app/plant_scene.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "host_sim/scene/scene_check.h"
#include "models/scenes/scenes_table.h"
#include "tests/unit/test.h"

enum { TICKS = 4000 };

/* At the start of the scene. False: the method refuses. */
static bool begin(const struct scene *s, const struct method *method, double tol, bool no_ledger,
                  double *scratch, struct plant *pl)
{
    static double event_x[2][PLANT_EVENTS][MODEL_STATES];
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    scenes_resolve(s, si, drive);
    const struct plant_config c = {.model = s->model,
                                   .si = si,
                                   .method = method,
                                   .tick_s = scene_check_step(s),
                                   .dilation = 1.0,
                                   .tol = tol,
                                   .no_ledger = no_ledger,
                                   .scratch = scratch};
    if (plant_init(pl, &c))
        return false;
    pl->event_x = event_x[no_ledger];
    plant_scene_begin(pl, s, si, drive);
    return true;
}

/* Events that tell something else, their peak forces left out. */
static int events_differ(struct plant *a, struct plant *b)
{
    struct event e, f;
    int n = 0;
    while (plant_take_event(a, &e)) {
        bool both = plant_take_event(b, &f);
        n += !both || e.tick != f.tick || e.contact != f.contact || e.touch != f.touch ||
             memcmp(&e.fraction, &f.fraction, sizeof e.fraction) ||
             memcmp(&e.speed, &f.speed, sizeof e.speed) || memcmp(e.x, f.x, sizeof a->x);
    }
    return n + plant_take_event(b, &f);
}

/* All but the books. */
static bool differ(const struct plant *a, const struct plant *b)
{
    double output[2][MODEL_OUTPUTS] = {{0.0}};
    plant_output(a, output[0]);
    plant_output(b, output[1]);
    return memcmp(a->x, b->x, sizeof a->x) || memcmp(output[0], output[1], sizeof output[0]) ||
           memcmp(a->segment.at, b->segment.at, sizeof a->segment.at) ||
           memcmp(&a->counts, &b->counts, sizeof a->counts) || instant_compare(a->now, b->now) ||
           a->regime != b->regime || memcmp(&a->loss_time, &b->loss_time, sizeof a->loss_time) ||
           memcmp(&a->total_time, &b->total_time, sizeof a->total_time);
}

TEST(plant_no_ledger)
{
    static struct plant with, without;
    static double scratch[2][METHOD_SCRATCH];
    uint32_t switches = 0;
    int runs = 0, different = 0, events = 0;
    double booked = 0.0;
    for (int i = 0; i < 4 * SCENES; i++) {
        const struct scene *s = &scenes_table[i / 4].scene;
        const struct method *const methods[4] = {&auto_method, &rk4, &auto_method, &adams},
                                   *method = methods[i % 4];
        double tol = i % 4 < 2 ? 0.0 : 1e-3;
        if (!begin(s, method, tol, false, scratch[0], &with) ||
            !begin(s, method, tol, true, scratch[1], &without))
            continue;
        bool on = true;
        for (uint64_t k = 0, n; k < TICKS && on; k += n) {
            n = 1 + k % 17; /* single ticks and blocks */
            on = plant_run(&with, n);
            different += plant_run(&without, n) != on || differ(&with, &without);
            events += events_differ(&with, &without);
        }
        switches += with.counts.switches;
        booked += without.ledger.gross;
        runs++;
    }
    check_above("runs of the scenes, by auto, rk4 and adams", runs, SCENES);
    check_above("contact switches in them", switches, 1000.0);
    check_int("ticks after which a plant without a ledger is another", different, 0);
    check_int("events that it tells otherwise", events, 0);
    check_near("energy in its books", booked, 0.0, 0.0);
}
