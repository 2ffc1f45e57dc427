/* test_app_refusals.c - configurations and commands that
 * the app refuses, and instants at which two troubles meet. */
#include <string.h>
#include "firmware/app/session.h"
#include "firmware/stage/stages.h"
#include "models/afm_tip.h"
#include "models/reduced/shaft_mode.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { SECOND = 1 << 1, FOURTH = 1 << 3 };
static struct bus bus;

static void refused(const struct app_config *c, const char *part)
{
    static struct app app;
    const char *why = app_init(&app, c, &bus.wires.port[0].hal);
    check_contains(part, why, part);
}

TEST(app_refusals_config)
{
    static struct stages stages;
    double setting[SETTINGS];
    struct app_config c = bus_config();
    c.frame_s = 1e-7;
    refused(&c, "frame period");
    c = bus_config();
    c.substeps = 4097;
    refused(&c, "substeps outside");
    c.substeps = 0;
    refused(&c, "substeps outside");
    c.substeps = 1;
    refused(&c, "step too coarse");
    c = bus_config();
    c.setting = setting;
    for (int i = 0; i < SETTINGS; i++)
        setting[i] = setting_initial(i, c.model, c.frame_s);
    setting[SET_TIMEOUT_FRAMES] = 0.5;
    refused(&c, "a setting is outside its range");
    setting[SET_TIMEOUT_FRAMES] = 100.0;
    setting[SET_AGE_LIMIT_FRAMES] = setting[SET_STATUS_EVERY] + 3.0;
    refused(&c, "age_limit_frames");
    setting[SET_AGE_LIMIT_FRAMES] = setting[SET_STATUS_EVERY] + 4.0;
    bus_start(&bus, &c);
    check_near("taken: age limit", bus.app.setting[SET_AGE_LIMIT_FRAMES], 14.0, 0.0);
    c.stage_calls = &stages_for_plants;
    c.stages = &stages;
    setting[SET_STAGE + STAGE_AT] = setting[SET_STAGE + STAGE_SETTINGS + STAGE_AT] = 1.0 + RIG_FORCE;
    refused(&c, "two stages at one signal");
    setting[SET_STAGE + STAGE_AT] = 1.0 + RIG_BASE;
    bus_start(&bus, &c);
    check_true("taken: two signals", bus.app.plant.staged);
}

static void start_with(const struct model *m)
{
    struct app_config c = bus_config();
    c.model = m;
    c.substeps = 64;
    bus_start_running(&bus, &c);
    bus_run(&bus, 1);
    bus_forget(&bus);
}

static int set(unsigned setting, double value)
{
    bus_set_now(&bus, SETTING_FIRST + setting, value);
    return bus_cause(&bus, WIRE_PARAM_COMMIT);
}

/* Inside their own ranges, but not together with the model or with each other. */
TEST(app_refusals_settings)
{
    start_with(&shaft_bearing);
    check_int("lock-in on input 3 of a model with three", set(SET_LOCKIN_CHANNEL, 3.0), CAUSE_RANGE);
    check_int("on input 2", set(SET_LOCKIN_CHANNEL, 2.0), CAUSE_OK);
    check_int("lock-in on output 10 of ten", set(SET_LOCKIN_OUTPUT, 10.0), CAUSE_RANGE);
    check_int("age limit below status_every + 4", set(SET_AGE_LIMIT_FRAMES, 13.0), CAUSE_RANGE);
    check_near("in force as before", bus.app.setting[SET_AGE_LIMIT_FRAMES], 50.0, 0.0);
}

TEST(app_refusals_inputs)
{
    start_with(&shaft_bearing);
    bus_drive(&bus, 1, 1.0, 10.0, 0.0, 0.0);
    bus_fire(&bus, SECOND | FOURTH, false, bus.app.plant.now.tick + 640, 0);
    bus_stream(&bus, 3, 20, 1.0);
    bus_run(&bus, 1);
    check_int("FIRE on an input the model lacks", bus_cause(&bus, WIRE_FIRE), CAUSE_UNKNOWN);
    check_int("STREAM to it", bus_cause(&bus, WIRE_STREAM + 3), CAUSE_UNKNOWN);
    check_int("nothing waits", bus.app.mailbox.n_fires + bus.app.mailbox.n_samples, 0);
    bus_fire(&bus, SECOND, false, bus.app.plant.now.tick + 640, 0);
    bus_run(&bus, 1);
    check_int("what was armed is still armed", bus_cause(&bus, WIRE_FIRE), CAUSE_OK);
}

static int control(enum control_operation operation, double argument)
{
    bus_control(&bus, operation, argument);
    bus_run(&bus, 1);
    return bus_cause(&bus, WIRE_CONTROL);
}

TEST(app_refusals_control)
{
    start_with(&hertz_rig);
    bus_order_now(&bus, CONTROL_PAUSE);
    check_int("step 5 frames", control(CONTROL_STEP, 5.0), CAUSE_OK);
    check_int("another step meanwhile", control(CONTROL_STEP, 1.0), CAUSE_STATE);
    check_int("run until, meanwhile", control(CONTROL_RUN_UNTIL, (double)bus.app.plant.now.tick + 640.0),
              CAUSE_STATE);
    check_int("no such operation", control(CONTROL_OPERATIONS, (double)bus.app.frame), CAUSE_UNKNOWN);
    bus_set(&bus, SETTING_FIRST + SET_REACTION, REACTION_FREEZE);
    bus_run(&bus, 5);
    bus_silent(&bus, 110);
    check_int("silence freezes a paused plant too", bus.app.state, STATE_FROZEN);
    session_fault(&bus.app, FAULT_OVERRUN);
    bus.session = 2;
    memset(bus.counter, 0, sizeof bus.counter);
    bus_enable(&bus, true);
    bus_run(&bus, 1);
    check_int("start in a fault", control(CONTROL_START, (double)bus.app.frame), CAUSE_STATE);
    check_int("pause in a fault", control(CONTROL_PAUSE, (double)bus.app.frame), CAUSE_STATE);
    check_int("the fault stays", bus.app.state, STATE_FAULT);
}

static int capture(unsigned operation)
{
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, operation, 0, 1});
    bus_run(&bus, 1);
    return bus_cause(&bus, WIRE_CAPTURE);
}

TEST(app_refusals_capture)
{
    start_with(&hertz_rig);
    check_int("arm", capture(CAPTURE_ARM), CAUSE_OK);
    check_int("no such operation", capture(CAPTURE_OPERATIONS), CAUSE_UNKNOWN);
    check_int("still armed", bus.app.capture.state, CAPTURE_ARMED);
    check_int("stop", capture(CAPTURE_STOP), CAUSE_OK);
    check_int("idle", bus.app.capture.state, CAPTURE_IDLE);
    check_int("nothing to trigger", capture(CAPTURE_TRIGGER), CAUSE_STATE);
}

/* The parameter belongs to the reduced model alone; between the FIRE and its instant the plant climbs. The
 * drive is fired all the same, the set is refused and counted, as a write of now would be. */
TEST(app_refusals_fire_after_climb)
{
    static const struct watch_limits limits = {0, -1e-3, 1e-3};
    struct app_config c = bus_config();
    struct staged set_of_mode = {{0}, {0}};
    c.model = &shaft_bearing_mode;
    c.substeps = 64;
    c.promote = &shaft_bearing;
    c.watch = &limits;
    bus_start_running(&bus, &c);
    bus_run(&bus, 1);
    staged_put(&set_of_mode, SHAFT_PARAMETERS, 1.0);
    bus_write(&bus, SHAFT_PARAMETERS, 1.0);
    bus_commit(&bus, &set_of_mode, COMMIT_WITH_FIRE);
    bus_drive(&bus, 0, 1.0, 10.0, 0.0, 0.0);
    double counter = bus.counter[WIRE_FIRE];
    bus_fire(&bus, 1, true, bus.app.plant.now.tick + 640, 0);
    bus_run(&bus, 1);
    check_int("FIRE", bus_cause(&bus, WIRE_FIRE), CAUSE_OK);
    plant_set_state(&bus.app.plant, (double[]){-5.0, 0.0});
    bus_run(&bus, 1);
    check_string("climbed", bus.app.plant.model->name, shaft_bearing.name);
    uint32_t refusals = bus.app.count[DIAG_RANGE];
    bus_run(&bus, 10);
    check_int("nothing of it fired", bus.app.count[DIAG_FIRE_APPLIED], 0);
    check_int("its set refused", bus.app.count[DIAG_RANGE] - refusals, 1);
    check_int("told", bus_cause(&bus, WIRE_FIRE), CAUSE_RANGE);
    check_near("of this FIRE", bus_value(&bus, WIRE_REPLY, REPLY_COUNTER), counter, 0.0);
    check_true("the drive is silent", !drive_active(&bus.app.plant.drive[0]));
    bus_commit(&bus, &set_of_mode, COMMIT_WITH_FIRE);
    bus_arm(&bus, 0, ARM_AMPLITUDE, 1.0);
    bus_fire(&bus, 1, true, bus.app.plant.now.tick + 640, 0);
    bus_run(&bus, 1);
    check_int("the set is gone", bus_cause(&bus, WIRE_FIRE), CAUSE_INCOMPLETE);
}

/* A fire cuts its tick in two; the first half leaves the plant's bounds. */
TEST(app_refusals_trouble_before_fire)
{
    start_with(&hertz_rig);
    uint64_t tick = bus.app.plant.now.tick + 64 + 5;
    bus_drive(&bus, 0, 1.0, 100.0, 0.0, 0.0);
    bus_fire(&bus, 1, false, tick, 128);
    bus_run(&bus, 1);
    check_int("FIRE waits", bus.app.mailbox.n_fires, 1);
    check_true("to the tick before it", plant_advance(&bus.app.plant, (struct instant){tick, 0}));
    bus.app.plant.x[0] = 2.0 * PLANT_STATE_LIMIT;
    bus_run(&bus, 1);
    check_int("stopped", bus.app.state, STATE_FAULT);
    check_int("at the tick before the fire", (int64_t)(bus.app.plant.now.tick - tick), 0);
    check_int("which was not applied", bus.app.count[DIAG_FIRE_APPLIED], 0);
    check_int("and is forgotten", bus.app.mailbox.n_fires, 0);
}

/* Frames to be made up are waiting when a PAUSE and a STEP come: the step ends where it said. */
TEST(app_refusals_step_after_skip)
{
    start_with(&hertz_rig);
    check_int("policy", set(SET_OVERRUN_POLICY, OVERRUN_SKIP), CAUSE_OK);
    int64_t tick = (int64_t)bus.app.plant.now.tick;
    check_int("five frames missed: one call is due", app_overrun(&bus.app, 5), 1);
    bus_order(&bus, CONTROL_PAUSE);
    bus_control(&bus, CONTROL_STEP, 2.0);
    bus_run(&bus, 1);
    check_int("STEP", bus_cause(&bus, WIRE_CONTROL), CAUSE_OK);
    check_int("two frames were run", (int64_t)bus.app.plant.now.tick - tick, 2 * 64);
    bus_run(&bus, 3);
    check_int("and no more", (int64_t)bus.app.plant.now.tick - tick, 2 * 64);
}
