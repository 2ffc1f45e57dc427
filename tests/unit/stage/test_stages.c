/* test_stages.c - actuators and sensors of a plant on a bus:
 * closed forms, both readings by name, refusals, reset, copies. */
#include <complex.h>
#include <math.h>
#include <string.h>
#include "firmware/plant/plant_report.h"
#include "firmware/stage/stages.h"
#include "models/afm_tip.h"
#include "tests/fixture/bus.h"
#include "tests/fixture/imaginary.h"
#include "tests/unit/test.h"

#define PI 3.14159265358979323846

static struct bus bus;
static struct stages stages, kept;
static struct app kept_app;

static struct app_config config(void)
{
    struct app_config c = bus_config();
    c.stage_calls = &stages_for_plants;
    c.stages = &stages;
    return c;
}

static void start(void)
{
    const struct app_config c = config();
    bus_start_running(&bus, &c);
    bus_run(&bus, 3);
}

static unsigned index_of(int slot, int setting)
{
    return SETTING_FIRST + SET_STAGE + (unsigned)(STAGE_SETTINGS * slot + setting);
}

/* Settings of one slot as one set; returns the cause. */
static int set(int slot, const double (*value)[2], int n)
{
    struct staged staged = {{0}, {0.0}};
    for (int i = 0; i < n; i++) {
        bus_write(&bus, index_of(slot, (int)value[i][0]), value[i][1]);
        staged_put(&staged, index_of(slot, (int)value[i][0]), value[i][1]);
    }
    bus_commit(&bus, &staged, COMMIT_NOW);
    bus_run(&bus, 1);
    return bus_cause(&bus, WIRE_PARAM_COMMIT);
}
#define SET(slot, ...)                                                                                       \
    set(slot, (const double[][2]){__VA_ARGS__},                                                              \
        (int)(sizeof((const double[][2]){__VA_ARGS__}) / sizeof(double[2])))
#define BEFORE(input)                                                                                        \
    {                                                                                                        \
        STAGE_AT, 1.0 + (input)                                                                              \
    }
#define BEHIND(output)                                                                                       \
    {                                                                                                        \
        STAGE_AT, 1.0 + MODEL_INPUTS + (output)                                                              \
    }

static double output(int i)
{
    double out[MODEL_OUTPUTS];
    plant_output(&bus.app.plant, out);
    return out[i];
}

static double force_now(void)
{
    const struct plant *pl = &bus.app.plant;
    return pl->segment.at[2][RIG_FORCE].value * pl->scale.force_N;
}

static void one_tick(void)
{
    check_true("a tick", plant_run(&bus.app.plant, 1));
}

/* ---- actuators ---- */

/* A force that steps by 5 N comes through the amplifier's resonance as its closed form says, in each tick. */
TEST(stages_actuator)
{
    const double f = 300.0, zeta = 0.125, omega = 2.0 * PI * f, damped = omega * sqrt(1.0 - zeta * zeta);
    double worst = 0.0;
    start();
    check_int("taken", SET(0, {STAGE_SET_RESONANCE, f}, {STAGE_SET_DAMPING, zeta}, BEFORE(RIG_FORCE)),
              CAUSE_OK);
    plant_sample(&bus.app.plant, RIG_FORCE, 5.0, 0);
    for (int i = 1; i <= 1000; i++) {
        double t = i * bus.app.plant.tick_s;
        one_tick();
        double closed = 5.0 - 5.0 * exp(-zeta * omega * t) *
                                  (cos(damped * t) + zeta / sqrt(1.0 - zeta * zeta) * sin(damped * t));
        double off = fabs(force_now() - closed);
        worst = off > worst ? off : worst;
    }
    check_below("force, N", worst, 1e-12);
}

/* Gain 2 on 5 N gives the rest of 10 N, and the ledger
 * balances although the input jumps when the stage comes in. */
TEST(stages_static)
{
    double rest[2];
    for (int k = 0; k < 2; k++) {
        start();
        if (k == 1)
            check_int("taken", SET(3, {STAGE_SET_GAIN, 2.0}, BEFORE(RIG_FORCE)), CAUSE_OK);
        plant_sample(&bus.app.plant, RIG_FORCE, k == 0 ? 10.0 : 5.0, 0);
        bus_run(&bus, 3000);
        rest[k] = output(2);
        if (k == 0)
            check_int("a gain on a force that stands", SET(0, {STAGE_SET_GAIN, 1.5}, BEFORE(RIG_FORCE)),
                      CAUSE_OK);
        bus_run(&bus, 200);
        check_int("no fault", bus.app.faults, 0);
    }
    check_near("penetration, m", rest[1], rest[0], 1e-15);
}

/* An actuated base moves without a jump, and its work is booked. */
TEST(stages_base)
{
    double largest = 0.0, before = 0.0;
    start();
    check_int("taken", SET(0, {STAGE_SET_LAG, 500.0}, {STAGE_SET_RESONANCE, 900.0}, BEFORE(RIG_BASE)),
              CAUSE_OK);
    bus_drive(&bus, RIG_BASE, 5e-7, 120.0, 0.0, 0.05);
    bus_fire(&bus, 1u << RIG_BASE, false, bus.app.plant.now.tick + 20, 0);
    for (int i = 0; i < 3000; i++) {
        const struct plant *pl = &bus.app.plant;
        bus_run(&bus, 1);
        double base = pl->segment.at[2][RIG_BASE].value * pl->scale.length_m;
        largest = fabs(base - before) > largest ? fabs(base - before) : largest;
        before = base;
    }
    check_above("the base moves, m a frame", largest, 1e-7);
    check_int("no fault, so the energies balance", bus.app.faults, 0);
}

/* Off again: the drive is the input as before, and the
 * plant's bits are those of a plant that has no stages. */
TEST(stages_off)
{
    struct app_config few = config();
    few.model = &afm_tip;
    few.dilation = 2000.0;
    bus_start_running(&bus, &few);
    bus_run(&bus, 3);
    check_int("an input that the tip has not", SET(0, BEFORE(MODEL_INPUTS - 1)), CAUSE_RANGE);
    check_int("its last one", SET(0, BEFORE(afm_tip.n_inputs - 1)), CAUSE_OK);
    const struct app_config bare = bus_config();
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        if (k == 0) {
            start();
            check_int("on", SET(0, {STAGE_SET_GAIN, 3.0}, BEFORE(RIG_FORCE)), CAUSE_OK);
            check_int("off", SET(0, {STAGE_AT, 0.0}), CAUSE_OK);
        } else {
            bus_start_running(&bus, &bare);
            bus_run(&bus, 5);
        }
        check_true("none is on", !bus.app.plant.staged);
        bus_drive(&bus, RIG_FORCE, 30.0, 215.0, 0.0, 0.01);
        bus_fire(&bus, 1u << RIG_FORCE, false, 160, 0);
        bus_run(&bus, 200);
        hash[k] = plant_hash(&bus.app.plant);
    }
    check_hex("state", hash[0], hash[1]);
}

/* Times are those of the real plant: under a dilation of
 * 8 an element takes eight times as many bus seconds. */
TEST(stages_dilation)
{
    double end[2];
    for (int k = 0; k < 2; k++) {
        struct app_config c = config();
        c.dilation = k == 0 ? 1.0 : 8.0;
        c.frame_s = k == 0 ? 1e-3 : 8e-3;
        bus_start_running(&bus, &c);
        bus_run(&bus, 3);
        check_int("taken", SET(0, {STAGE_SET_LAG, 40.0}, BEFORE(RIG_FORCE)), CAUSE_OK);
        plant_sample(&bus.app.plant, RIG_FORCE, 5.0, 0);
        for (int i = 0; i < 50; i++)
            one_tick();
        end[k] = force_now();
    }
    check_near("force after 50 ticks, N", end[1], end[0], 1e-14);
    check_near("the lag's own", end[0], 5.0 * (1.0 - exp(-2.0 * PI * 40.0 * 50.0 * 1e-3 / 16.0)), 1e-13);
}

/* ---- sensors ---- */

/* MOTION has the sensor's value, the plant the truth: a gain, and a delay of one frame. */
TEST(stages_sensor)
{
    double truth = 0.0, lsb;
    int wrong = 0;
    start();
    check_int("taken", SET(1, {STAGE_SET_GAIN, -2.0}, {STAGE_SET_DELAY, 16.0}, BEHIND(0)), CAUSE_OK);
    bus_drive(&bus, RIG_FORCE, 20.0, 215.0, 0.0, 0.01);
    bus_fire(&bus, 1u << RIG_FORCE, false, bus.app.plant.now.tick + 20, 0);
    lsb = bus.scene.lsb[0];
    for (int i = 0; i < 300; i++) {
        bus_forget(&bus);
        bus_run(&bus, 1);
        double said = bus_value(&bus, WIRE_MOTION, MOTION_DISPLACEMENT);
        wrong += i > 0 && fabs(said + 2.0 * truth) > 0.51 * lsb;
        truth = output(0);
    }
    check_int("frames that differ", wrong, 0);
    check_near("by name the truth", plant_read(&bus.app.plant, "displacement"), output(0), 0.0);
    check_near("and the sensor", plant_read(&bus.app.plant, "stage_1"), stages.result[1], 0.0);
    check_true("it is late", plant_read(&bus.app.plant, "stage_1") != -2.0 * output(0));
}

/* Two sensors of memoryless elements: each reads its own output of the same tick. */
TEST(stages_two_sensors)
{
    start();
    check_int("taken", SET(0, {STAGE_SET_GAIN, -2.0}, BEHIND(0)), CAUSE_OK);
    check_int("taken", SET(2, {STAGE_SET_GAIN, 0.5}, BEHIND(1)), CAUSE_OK);
    plant_drive(&bus.app.plant, RIG_FORCE, 20.0, 215.0, 0.0, 0.0);
    for (int i = 0; i < 20; i++) {
        one_tick();
        check_near("displacement", stages.result[0], -2.0 * output(0), 0.0);
        check_near("velocity", stages.result[2], 0.5 * output(1), 0.0);
    }
    check_true("which move", output(0) != 0.0 && output(1) != 0.0);
}

/* Two lock-in slots, one on the output and one on its sensor: the sensor has its gain and its delay. */
TEST(stages_lockin)
{
    start();
    check_int("taken", SET(2, {STAGE_SET_GAIN, 0.5}, {STAGE_SET_DELAY, 4.5}, BEHIND(1)), CAUSE_OK);
    bus_set(&bus, SETTING_FIRST + SET_LOCKIN_OUTPUT, 1.0);
    bus_set(&bus, SETTING_FIRST + SET_LOCKIN_OUTPUT + 2, MODEL_OUTPUTS + 2.0);
    bus_set(&bus, SETTING_FIRST + SET_LOCKIN_HARMONIC + 2, 1.0);
    bus_drive(&bus, RIG_FORCE, 2.0, 100.0, 0.0, 0.01);
    bus_fire(&bus, 1u << RIG_FORCE, false, bus.app.plant.now.tick + 20, 0);
    bus_run(&bus, 1000);
    const struct lockin_result *truth = &bus.app.lockin.slot[0].result,
                               *sensor = &bus.app.lockin.slot[2].result;
    const double lag = 2.0 * PI * 100.0 * 1e-3 / 16.0, half = cos(0.5 * lag);
    check_int("windows", truth->number > 3 && sensor->number == truth->number, 1);
    check_near("amplitude", sensor->amplitude / truth->amplitude, 0.5 * half, 1e-9);
    check_near("phase, rad", sensor->phase - truth->phase, -4.5 * lag, 1e-9);
}

/* The shaker's amplifier has a resonance of 2 kHz, the velocity pick-up noise of a stated density. Welch's
 * estimate of sensor less truth, in bands, within 4 standard errors. */
TEST(stages_rig)
{
    enum { POINTS = 64, SEGMENTS = 1500, BANDS = 6 };
    const double density = 3e-7;
    static double power[BANDS + 1];
    start();
    check_int("amplifier",
              SET(0, {STAGE_SET_RESONANCE, 2000.0}, {STAGE_SET_DAMPING, 0.25}, {STAGE_SET_CLIP, 60.0},
                  BEFORE(RIG_FORCE)),
              CAUSE_OK);
    check_int("pick-up", SET(1, {STAGE_SET_NOISE, density}, BEHIND(1)), CAUSE_OK);
    plant_drive(&bus.app.plant, RIG_FORCE, 20.0, 215.0, 0.0, 0.0);
    double rate = 1.0 / bus.app.plant.tick_s;
    for (int k = 0; k < SEGMENTS; k++) {
        double y[POINTS];
        for (int i = 0; i < POINTS; i++) {
            (void)!plant_run(&bus.app.plant, 1);
            y[i] = stages.result[1] - output(1);
        }
        for (int j = 1; j <= BANDS; j++) {
            double complex sum = 0.0;
            for (int i = 0; i < POINTS; i++)
                sum += y[i] * cexp(-i_unit * 2.0 * PI * 5 * j * i / POINTS);
            power[j] += 2.0 * creal(sum * conj(sum)) / (rate * POINTS) / SEGMENTS;
        }
    }
    for (int j = 1; j <= BANDS; j++)
        check_near("density in a band", power[j] / (density * density), 1.0, 4.0 / sqrt(SEGMENTS));
    check_near("the amplifier's gain at 215 Hz", bus.app.plant.segment.active & 1u, 1.0, 0.0);
}

/* ---- refusals, faults, reset ---- */

TEST(stages_refused)
{
    start();
    check_int("an output that the rig has not", SET(0, BEHIND(5)), CAUSE_RANGE);
    check_int("no damping", SET(0, {STAGE_SET_RESONANCE, 100.0}, {STAGE_SET_DAMPING, 0.0}, BEFORE(0)),
              CAUSE_RANGE);
    check_int("taken", SET(0, BEFORE(0)), CAUSE_OK);
    check_int("two at one signal", SET(1, BEFORE(0)), CAUSE_RANGE);
    check_int("half a place", SET(1, {STAGE_AT, 1.5}), CAUSE_INCOMPLETE);
    check_int("the write of it", bus_cause(&bus, WIRE_PARAM_WRITE), CAUSE_RANGE);
    bus_set_now(&bus, SETTING_FIRST + SET_LOCKIN_OUTPUT, MODEL_OUTPUTS + 1.0);
    check_int("lock-in on a stage that is off", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_RANGE);
    bus_set_now(&bus, SETTING_FIRST + SET_LOCKIN_OUTPUT, MODEL_OUTPUTS);
    check_int("on one that is on", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_OK);
    check_int("a stage that is read stays", SET(0, {STAGE_AT, 0.0}), CAUSE_RANGE);
    struct app_config few = config();
    few.model = &afm_tip;
    few.dilation = 2000.0;
    bus_start_running(&bus, &few);
    bus_run(&bus, 3);
    check_int("an input that the tip has not", SET(0, BEFORE(MODEL_INPUTS - 1)), CAUSE_RANGE);
    check_int("its last one", SET(0, BEFORE(afm_tip.n_inputs - 1)), CAUSE_OK);
    const struct app_config bare = bus_config();
    bus_start_running(&bus, &bare);
    check_int("an image without stages", SET(0, BEFORE(0)), CAUSE_RANGE);
}

/* Beyond what a model bears the plant stops with a latched fault, and no NaN is seen. */
TEST(stages_beyond)
{
    start();
    check_int("taken", SET(0, {STAGE_SET_GAIN, 1e9}, BEFORE(RIG_FORCE)), CAUSE_OK);
    plant_sample(&bus.app.plant, RIG_FORCE, 1e6, 0);
    bus_run(&bus, 3);
    check_int("latched", bus.app.faults, FAULT_NOT_FINITE);
    check_near("the input stays, N", force_now(), 0.0, 0.0);
    for (int i = 0; i < bus.app.plant.model->n_outputs; i++)
        check_true("finite", isfinite(output(i)));
}

/* A RESET brings the stages to rest; another setting
 * leaves them as they are; a change of one begins it anew. */
TEST(stages_reset)
{
    start();
    check_int("taken", SET(0, {STAGE_SET_LAG, 5.0}, BEFORE(RIG_FORCE)), CAUSE_OK);
    plant_sample(&bus.app.plant, RIG_FORCE, 5.0, 0);
    bus_run(&bus, 20);
    double moved = stages.result[0];
    bus_set(&bus, SETTING_FIRST + SET_HASH_EVERY, 77.0);
    check_int("another stage", SET(1, {STAGE_SET_LAG, 5.0}, BEFORE(RIG_FAST_FORCE)), CAUSE_OK);
    check_near("goes on", stages.result[0], 5.0 - (5.0 - moved) * exp(-2.0 * PI * 5.0 * 1e-3), 1e-12);
    check_int("itself", SET(0, {STAGE_SET_LAG, 6.0}), CAUSE_OK);
    check_near("settled anew where its drive is", stages.result[0], 5.0, 1e-12);
    plant_sample(&bus.app.plant, RIG_FORCE, 8.0, 0);
    bus_run(&bus, 1);
    check_is("on its way", stages.result[0], <, 6.0);
    bus_set_now(&bus, SETTING_FIRST + SET_SENSOR_SEED, 7.0);
    check_near("another seed begins it anew", stages.result[0], 8.0, 1e-12);
    plant_sample(&bus.app.plant, RIG_FORCE, 5.0, 0);
    bus_order(&bus, CONTROL_STOP);
    bus_silent(&bus, 1);
    bus_next_session(&bus);
    bus_enable(&bus, true);
    bus_order_now(&bus, CONTROL_RESET);
    check_near("after a reset", stages.result[0], 0.0, 0.0);
}

/* A copy of the app and of its stages goes on with equal
 * bits and an equal hash; the stages' state is in the hash. */
TEST(stages_snapshot)
{
    start();
    check_int("actuator",
              SET(0, {STAGE_SET_CREEP, 0.02}, {STAGE_SET_RESONANCE, 400.0}, {STAGE_SET_DELAY, 3.5},
                  BEFORE(RIG_FORCE)),
              CAUSE_OK);
    check_int("sensor", SET(1, {STAGE_SET_NOISE, 1e-9}, {STAGE_SET_LAG, 900.0}, BEHIND(0)), CAUSE_OK);
    plant_drive(&bus.app.plant, RIG_FORCE, 20.0, 215.0, 0.0, 0.0);
    bus_run(&bus, 50);
    kept_app = bus.app;
    kept = stages;
    bus_run(&bus, 50);
    uint64_t once = plant_hash(&bus.app.plant);
    bus.app.plant = kept_app.plant;
    stages = kept;
    check_true("50 frames", plant_run(&bus.app.plant, 50 * 16));
    check_hex("hash", plant_hash(&bus.app.plant), once);
    stages.stage[0].element[1].x[3] += 1e-12;
    check_true("the stages' state is in the hash", plant_hash(&bus.app.plant) != once);
}
