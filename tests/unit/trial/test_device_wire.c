/* test_device_wire.c - a bench knows a controller's commands by the plant's echo of its samples. */
#include "host_sim/test/bench/device_wire.h"
#include "models/hertz_rig.h"
#include "tests/unit/test.h"

#include <stdio.h>
#include <string.h>

enum { FRAMES = 20 };
static struct bench_plant plant;
static struct device_wire wire;
static struct test_case wanted;

static void begin_plant(void)
{
    char why[SCENE_REASON];
    const int force = hertz_rig.n_outputs;
    const struct metric_setting set[] = {
        {.kind = METRIC_MAX, .signal = force, .to_s = 0.02},
        {.kind = METRIC_MAX, .signal = force, .from_s = 0.0095, .to_s = 0.02},
        {.kind = METRIC_MEAN, .signal = 0, .to_s = 0.02},
    };
    scene_free(&plant.scene);
    memset(&plant, 0, sizeof plant);
    memset(&wire, 0, sizeof wire);
    check_true("the rig", scene_init(&plant.scene, "hertz_rig", why) && scene_start(&plant.scene, NULL, why));
    plant.n = plant.n_judged = 3;
    for (int i = 0; i < 3; i++)
        measurement_begin(&plant.measurement[i], &set[i], plant.scene.app.plant.tick_s, false);
    wire.plant = &plant;
    wire.measures = wire.echoes = true;
    device_wire_begin(&wire, &wanted);
}

static void say(unsigned kind, unsigned counter, double a, double b, double c)
{
    struct message m = {.kind = (uint8_t)kind, .counter = (uint8_t)(counter % WIRE_COUNTER_STATES)};
    m.value[0] = a, m.value[1] = b, m.value[2] = c;
    device_wire_take(&wire, NULL, &m);
}

/* Frames whose sample is their number; without the echo of one, and without the packet of another. */
static void run(int no_echo, int no_packet)
{
    begin_plant();
    const unsigned substeps = plant.scene.config.substeps;
    for (unsigned i = 0; i <= FRAMES + 1; i++) {
        if ((int)i == no_packet)
            continue;
        say(WIRE_SYNC, i, i, i * substeps, 0.0);
        say(WIRE_MOTION, i, 1.0, 1e-6, 0.0);
        if ((int)i != no_echo)
            say(WIRE_STREAM_ECHO, i, (uint16_t)(i - 1), i, 0.0);
    }
}

static double value_of(int k)
{
    struct metric_value v = {.known = false};
    measurement_end(&plant.measurement[k], 0.02, 0, &v);
    return v.value;
}

TEST(device_wire_echo)
{
    run(-1, -1);
    check_true("all came: the command is judged",
               !plant.measurement[0].untold && !plant.measurement[1].untold);
    check_near("  its largest sample, N", value_of(0), 20.0, 0.0);
    run(7, -1);
    check_string("an echo is missing", plant.measurement[0].untold,
                 "an echo of its samples is missing: lost on the way, or its frame was skipped");
    check_true("  a window behind it is judged", !plant.measurement[1].untold);
    check_true("  and the outputs", !plant.measurement[2].untold);
    run(-1, 12);
    check_true("a packet is missing: no window around it is judged",
               plant.measurement[0].untold && plant.measurement[1].untold);
    check_true("  but the outputs are", !plant.measurement[2].untold);
    begin_plant();
    device_wire_deafen(&wire);
    check_string("a plant that does not echo", plant.measurement[0].untold,
                 "over UDP only the plant hears the controller, and it does not echo samples");
    check_true("  the outputs are judged", !plant.measurement[2].untold);
    scene_free(&plant.scene);
}
