/* test_app_noise.c - noise over the bus: what docs/reference/messages.md
 * says of ARM, FIRE, stop, time-out and reset. */
#include <math.h>
#include "firmware/plant/plant_report.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { SEED = 16777215, HOLD = 3 };
static struct bus bus;

static void arm(int channel, double deviation, double hold, double seed, double ramp_s)
{
    bus_arm(&bus, channel, ARM_NOISE, deviation);
    bus_arm(&bus, channel, ARM_NOISE_HOLD, hold);
    bus_arm(&bus, channel, ARM_NOISE_SEED, seed);
    bus_arm(&bus, channel, ARM_RAMP, ramp_s);
}

/* The page's words: the deviate of word k of SplitMix64 started at 2^32 input + seed. */
static double value(int channel, uint64_t k)
{
    return noise_deviate(noise_word(((uint64_t)channel << 32) + SEED, k));
}

/* An input at the end of the tick just run, in SI. */
static double input(const struct app *a, int channel)
{
    const struct plant *pl = &a->plant;
    return pl->segment.at[2][channel].value * scale_of(&pl->scale, pl->model->input_signal[channel].quantity);
}

/* Force and base noise from tick 40.5 on, ramped over 32 ticks, seen at each frame's end. */
TEST(app_noise_fire)
{
    struct app_config c = bus_config();
    c.substeps = BUS_TICKS;
    bus_start_running(&bus, &c);
    arm(RIG_FORCE, 8.0, HOLD, SEED, 2e-3);
    arm(RIG_BASE, 2.5e-8, 5.0, SEED, 2e-3);
    bus_fire(&bus, 1u << RIG_FORCE | 1u << RIG_BASE, false, 40, 128);
    bus_run(&bus, 2);
    check_near("before its instant, N", input(&bus.app, RIG_FORCE), 0.0, 0.0);
    bus_collect(&bus);
    check_int("REPLY to FIRE", bus_cause(&bus, WIRE_FIRE), CAUSE_OK);
    for (int i = 0; i < 12; i++) {
        bus_run(&bus, 1);
        uint64_t end = bus.app.plant.now.tick, cell = end / 5;
        double ramp = fmin(1.0, ((double)end - 40.5) / 32.0), part = (double)(end % 5) / 5.0;
        double from = value(RIG_BASE, cell), to = value(RIG_BASE, cell + 1);
        check_near("force at a frame's end, N", input(&bus.app, RIG_FORCE),
                   8.0 * ramp * value(RIG_FORCE, (end - 1) / HOLD), 1e-13);
        check_near("base, m", input(&bus.app, RIG_BASE), (double)2.5e-8f * ramp * (from + (to - from) * part),
                   1e-21);
    }
}

/* Fields that were not armed stay; noise and harmonic drive add up. */
TEST(app_noise_fields)
{
    bus_start_rig(&bus);
    arm(RIG_FORCE, 8.0, HOLD, SEED, 0.0);
    bus_fire(&bus, 1u << RIG_FORCE, false, 20, 0);
    bus_run(&bus, 3);
    bus_drive(&bus, RIG_FORCE, 2.0, 0.0, 0.0, 0.0);
    bus_fire(&bus, 1u << RIG_FORCE, false, 60, 0);
    bus_run(&bus, 3);
    uint64_t cell = (bus.app.plant.now.tick - 1) / HOLD;
    check_near("both, N", input(&bus.app, RIG_FORCE), 2.0 + 8.0 * value(RIG_FORCE, cell), 1e-13);
    bus_arm(&bus, RIG_FORCE, ARM_NOISE, 4.0);
    bus_fire(&bus, 1u << RIG_FORCE, false, 100, 0);
    bus_run(&bus, 3);
    cell = (bus.app.plant.now.tick - 1) / HOLD;
    check_near("another deviation, N", input(&bus.app, RIG_FORCE), 2.0 + 4.0 * value(RIG_FORCE, cell), 1e-13);
}

TEST(app_noise_refused)
{
    const struct {
        int field;
        double good, bad;
    } edge[] = {{ARM_NOISE, 9.6e9, 9.7e9},        {ARM_NOISE, 0.0, -1e-9},
                {ARM_NOISE, 1.0, (double)NAN},    {ARM_NOISE, 1.0, (double)INFINITY},
                {ARM_NOISE_HOLD, 65535, 65536},   {ARM_NOISE_HOLD, 1.0, 0.0},
                {ARM_NOISE_HOLD, 2.0, 2.5},       {ARM_NOISE_HOLD, 1.0, (double)NAN},
                {ARM_NOISE_SEED, SEED, SEED + 1}, {ARM_NOISE_SEED, 0.0, -1.0},
                {ARM_NOISE_SEED, 7.0, 0.25},      {ARM_NOISE_SEED, 7.0, (double)-INFINITY}};
    bus_start_rig(&bus);
    for (unsigned i = 0; i < sizeof edge / sizeof edge[0]; i++) {
        uint32_t range = bus.app.count[DIAG_RANGE];
        bus_arm(&bus, RIG_FORCE, (enum arm_field)edge[i].field, edge[i].good);
        bus_run(&bus, 1);
        check_int("taken at the edge: refusals", bus.app.count[DIAG_RANGE] - range, 0);
        bus_arm(&bus, RIG_FORCE, (enum arm_field)edge[i].field, edge[i].bad);
        bus_run(&bus, 1);
        check_int("refused beyond", bus.app.count[DIAG_RANGE] - range, 1);
        check_int("with cause range", bus_cause(&bus, WIRE_ARM + RIG_FORCE), CAUSE_RANGE);
        check_near("the value before stays", bus.app.mailbox.armed[RIG_FORCE].value[edge[i].field],
                   (double)(float)edge[i].good, 0.0);
    }
}

static void start_noise(void)
{
    bus_start_rig(&bus);
    arm(RIG_FORCE, 8.0, 1.0, SEED, 0.0);
    arm(RIG_BASE, 1e-8, 64.0, SEED, 0.0);
    bus_fire(&bus, 1u << RIG_FORCE | 1u << RIG_BASE, false, 20, 0);
    bus_run(&bus, 10);
    check_true("noise sounds",
               bus.app.plant.drive[RIG_FORCE].noise.active && bus.app.plant.drive[RIG_BASE].noise.active);
}

static bool silent(void)
{
    return !drive_active(&bus.app.plant.drive[RIG_FORCE]) && !drive_active(&bus.app.plant.drive[RIG_BASE]) &&
           bus.app.plant.segment.at[2][RIG_FORCE].value == 0.0 &&
           bus.app.plant.segment.at[2][RIG_BASE].value == 0.0;
}

TEST(app_noise_stop)
{
    start_noise();
    double base = input(&bus.app, RIG_BASE);
    bus_order_now(&bus, CONTROL_STOP);
    check_near("stop: its setting, N", noise_target(&bus.app.plant.drive[RIG_FORCE].noise).deviation, 0.0,
               0.0);
    check_near("plant time stands: the base too, m", input(&bus.app, RIG_BASE), base, 0.0);
    bus_next_session(&bus);
    bus_run(&bus, 1);
    bus_order_now(&bus, CONTROL_START);
    check_true("a frame later silent", silent());
    start_noise();
    bus_order(&bus, CONTROL_STOP);
    bus_silent(&bus, 1);
    bus_next_session(&bus);
    bus_enable(&bus, true);
    bus_order_now(&bus, CONTROL_RESET);
    check_true("reset: silent at once", silent());
    bus_order(&bus, CONTROL_START);
    bus_run(&bus, 100);
    check_near("and at rest", bus.app.plant.x[0], 1.0, 1e-14);
}

TEST(app_noise_timeout)
{
    start_noise();
    bus_set(&bus, SETTING_FIRST + SET_TIMEOUT_FRAMES, 20);
    bus_set(&bus, SETTING_FIRST + SET_REACTION, REACTION_RAMP);
    bus_set_now(&bus, SETTING_FIRST + SET_REACTION_RAMP_S, 0.01);
    bus_silent(&bus, 20 + 6);
    uint64_t end = bus.app.plant.now.tick;
    check_near("ramp: after 6 of 10 frames, N", input(&bus.app, RIG_FORCE),
               8.0 * 0.4 * value(RIG_FORCE, end - 1), 1e-13);
    bus_silent(&bus, 4);
    check_true("after 10: silent", silent());
    start_noise();
    bus_set(&bus, SETTING_FIRST + SET_TIMEOUT_FRAMES, 20);
    bus_set_now(&bus, SETTING_FIRST + SET_REACTION, REACTION_HOLD);
    bus_silent(&bus, 100);
    check_near("hold: it goes on, N", input(&bus.app, RIG_FORCE),
               8.0 * value(RIG_FORCE, bus.app.plant.now.tick - 1), 1e-13);
}

/* Hash of a plant after 200 frames with noise fired at this tick. */
static uint64_t hash_of(double seed, uint64_t tick)
{
    bus_start_rig(&bus);
    arm(RIG_FORCE, 8.0, 4.0, seed, 0.0);
    bus_fire(&bus, 1u << RIG_FORCE, false, tick, 0);
    bus_run(&bus, 200);
    return plant_hash(&bus.app.plant);
}

TEST(app_noise_same)
{
    uint64_t hash = hash_of(1.0, 40);
    static struct app snapshot;
    double force = input(&bus.app, RIG_FORCE);
    check_hex("the same commands", hash_of(1.0, 40), hash);
    snapshot = bus.app;
    bus_run(&bus, 50);
    if (!plant_run(&snapshot.plant, 50 * BUS_TICKS))
        check_true("the snapshot stays finite", 0);
    check_hex("a snapshot goes on the same", plant_hash(&snapshot.plant), plant_hash(&bus.app.plant));
    check_is("another seed, another hash", hash_of(2.0, 40), !=, hash);
    check_is("another instant, another motion", hash_of(1.0, 80), !=, hash);
    check_near("but the same force, N", input(&bus.app, RIG_FORCE), force, 0.0);
}
