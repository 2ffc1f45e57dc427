/* test_plant_bounds.c - the ends of what a plant is given:
 * the last value that is taken, the first that is not. */
#include "tests/unit/test.h"

#include "firmware/plant/plant.h"
#include "firmware/plant/plant_change.h"
#include "models/hertz_rig.h"
#include "tests/fixture/assertion.h"

/* The answer of plant_init; a step that the method would refuse is run by force. */
static const char *said(double tick_s, double dilation)
{
    static struct plant pl;
    const struct plant_config c = {
        .model = &hertz_rig, .method = &rk4, .tick_s = tick_s, .dilation = dilation, .force = true};
    const char *why = plant_init(&pl, &c);
    return why ? why : "taken";
}

TEST(plant_bounds)
{
    static const char tick[] = "tick outside 1e-12..1e6 s", dilation[] = "dilation outside 1e-6..1e9";
    check_string("tick 1e-12 s", said(1e-12, 1.0), "taken");
    check_string("tick 0.999e-12 s", said(0.999e-12, 1.0), tick);
    check_string("tick 1e6 s", said(1e6, 1.0), "taken");
    check_string("tick 1.001e6 s", said(1.001e6, 1.0), tick);
    check_string("dilation 1e-6", said(1e-6, 1e-6), "taken");
    check_string("dilation 0.999e-6", said(1e-6, 0.999e-6), dilation);
    check_string("dilation 1e9", said(1e-6, 1e9), "taken");
    check_string("dilation 1.001e9", said(1e-6, 1.001e9), dilation);
}

/* The default rig at 65536 ticks a second: times and frequencies in ticks are exact. */
enum { TICK_RATE = 65536 };
static struct plant rig;

static void start_at_bound(const struct model *m)
{
    const struct plant_config c = {
        .model = m, .method = &rk4, .tick_s = 1.0 / TICK_RATE, .dilation = 1.0, .force = true};
    check_no_error("a plant", plant_init(&rig, &c));
}

struct harmonic_call {
    double frequency_Hz, ramp_s;
};

static void call_drive(const void *argument)
{
    const struct harmonic_call *c = argument;
    plant_drive(&rig, RIG_FORCE, 1.0, c->frequency_Hz, 0.0, c->ramp_s);
}

static void check_refused(const char *name, double frequency_Hz, double ramp_s)
{
    const struct harmonic_call c = {frequency_Hz, ramp_s};
    check_true(name, assertion_fails(call_drive, &c));
}

/* Up to half the tick rate, and to 9e18/65536 ticks: 9e18 parts
 * of a tick are the most that 63 bits hold in round numbers. */
TEST(plant_bounds_drive)
{
    const double ticks = 9e18 / TICK_FRACTIONS, below = ticks - 1.0;
    start_at_bound(&hertz_rig);
    plant_drive(&rig, RIG_FORCE, 1.0, 0.0, 0.0, 0.0);
    check_int("a ramp of 0 s is one tick", (int64_t)drive_corner(&rig.drive[RIG_FORCE]), TICK_FRACTIONS);
    plant_drive(&rig, RIG_FORCE, 1.0, TICK_RATE / 2 - 1, 0.0, below / TICK_RATE);
    check_int("the longest ramp, 1/65536 tick", (int64_t)drive_corner(&rig.drive[RIG_FORCE]),
              (int64_t)below * TICK_FRACTIONS);
    check_near("just below half the tick rate, turns a tick",
               drive_target(&rig.drive[RIG_FORCE]).turns_per_tick, 0.5 - 1.0 / TICK_RATE, 0.0);
    check_refused("half the tick rate", TICK_RATE / 2, 0.0);
    check_refused("a negative frequency", -1.0, 0.0);
    check_refused("a longer ramp", 100.0, ticks / TICK_RATE);
    check_refused("a negative ramp", 100.0, -1.0 / TICK_RATE);
}

static void call_noise(const void *argument)
{
    const struct noise_setting *s = argument;
    plant_noise(&rig, RIG_FORCE, s->deviation, s->hold, s->seed, 0.0);
}

TEST(plant_bounds_noise)
{
    const struct noise_setting negative = {-1.0, 1, 1}, long_hold = {1.0, NOISE_HOLD_MAX + 1, 1};
    start_at_bound(&hertz_rig);
    plant_noise(&rig, RIG_FORCE, 0.0, NOISE_HOLD_MAX, 7, 0.0);
    check_int("the longest hold, ticks", noise_target(&rig.drive[RIG_FORCE].noise).hold, NOISE_HOLD_MAX);
    check_true("a longer one is refused", assertion_fails(call_noise, &long_hold));
    check_true("so is a negative deviation", assertion_fails(call_noise, &negative));
    plant_noise(&rig, RIG_FORCE, 16.0, 3, 7, 2.0 / TICK_RATE);
    struct noise_setting to = noise_target(&rig.drive[RIG_FORCE].noise);
    check_near("16 N over the preload of 64 N", to.deviation, 0.25, 0.0);
    check_int("hold", to.hold, 3);
    check_int("seed", to.seed, 7);
    check_int("the ramp, 1/65536 tick", (int64_t)drive_corner(&rig.drive[RIG_FORCE]), 2 * TICK_FRACTIONS);
}

/* A model with as many parameters as there may be: the rig's own, and others that nobody uses. */
TEST(plant_bounds_parameters)
{
    struct parameter table[MODEL_PARAMETERS];
    struct model m = hertz_rig;
    double si[MODEL_PARAMETERS];
    int which, off = 0;
    for (int i = 0; i < MODEL_PARAMETERS; i++) {
        table[i] = (struct parameter){.name = "other", .min = i, .max = i + 1.0, .initial = i + 0.5};
        if (i < RIG_PARAMETERS)
            table[i] = hertz_rig.parameter[i];
    }
    m.n_parameters = MODEL_PARAMETERS;
    m.parameter = table;
    start_at_bound(&m);
    for (int i = 0; i < MODEL_PARAMETERS; i++) {
        off += rig.si[i] != table[i].initial;
        si[i] = table[i].initial;
    }
    check_int("defaults that are not the table's", off, 0);
    si[MODEL_PARAMETERS - 1] = MODEL_PARAMETERS;
    check_no_error("the last one at its end is taken", plant_change(&rig, si));
    check_near("and kept", rig.si[MODEL_PARAMETERS - 1], MODEL_PARAMETERS, 0.0);
    si[MODEL_PARAMETERS - 1] = MODEL_PARAMETERS + 1;
    check_error("beyond its end it is refused", plant_check(&m, si, &which));
    check_int("by its number", which, MODEL_PARAMETERS - 1);
}

/* A model without the base: what stands third in its table is none of its inputs. */
TEST(plant_bounds_inputs)
{
    struct model m = hertz_rig;
    start_at_bound(&m);
    check_true("noise of the base is straight", rig.drive[RIG_BASE].noise.straight);
    check_true("noise of a force is held", !rig.drive[RIG_FAST_FORCE].noise.straight);
    m.n_inputs = RIG_BASE;
    start_at_bound(&m);
    check_true("without a base nothing is", !rig.drive[RIG_BASE].noise.straight);
}
