/* test_app_timeout.c - heartbeats stop: what each reaction does to drives, state and plant time, in which
 * frame, and how a new session takes over. */
#include <string.h>
#include "firmware/plant/plant_report.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { TIMEOUT = 20 };
static struct bus bus;

/* A drive of 16 N and a held sample of 8 N; the last heartbeat is the frame just run. */
static void start_reaction(enum reaction reaction)
{
    bus_start_rig(&bus);
    bus_set(&bus, SETTING_FIRST + SET_TIMEOUT_FRAMES, TIMEOUT);
    bus_set(&bus, SETTING_FIRST + SET_REACTION, reaction);
    bus_set(&bus, SETTING_FIRST + SET_REACTION_RAMP_S, 0.015625); /* 250 ticks */
    bus_drive(&bus, RIG_FORCE, 16.0, 100.0, 0.0, 0.0);
    bus_fire(&bus, 1, false, 20, 0);
    bus_stream(&bus, RIG_FAST_FORCE, 2, 8.0);
    bus_run(&bus, 10);
}

static void recover(enum plant_state expected, unsigned faults)
{
    check_near("STATUS: time-out fault",
               (double)((unsigned)bus_value(&bus, WIRE_STATUS, STATUS_FAULTS) & FAULT_TIMEOUT), FAULT_TIMEOUT,
               0);
    bus_run(&bus, 1);
    check_true("the old session does not come back", !bus.app.enabled);
    bus.session = 2;
    memset(bus.counter, 0, sizeof bus.counter);
    bus_run(&bus, 11);
    check_true("a new one does", bus.app.enabled);
    check_int("a new one does", bus.app.session, 2);
    check_near("STATUS: reaction none", bus_value(&bus, WIRE_STATUS, STATUS_REACTION), REACTION_NONE, 0);
    check_near("STATUS: state", bus_value(&bus, WIRE_STATUS, STATUS_STATE), expected, 0);
    check_near("STATUS: session", bus_value(&bus, WIRE_STATUS, SESSION), 2, 0);
    check_int("faults stay latched", bus.app.faults, faults);
    bus_order(&bus, CONTROL_PAUSE);
    bus_order(&bus, CONTROL_RESET);
    bus_order(&bus, CONTROL_START);
    bus_run(&bus, 3);
    check_int("until a reset", bus.app.faults, 0);
    check_int("and it runs", bus.app.state, STATE_RUNNING);
    bus_stream(&bus, RIG_FORCE, bus.app.plant.now.tick / BUS_TICKS, 1.0);
    bus_run(&bus, 1);
    check_near("commands are taken: sample, N", bus.app.plant.drive[0].sample * 64.0, 1.0, 1e-12);
}

TEST(app_timeout_frame)
{
    start_reaction(REACTION_ZERO);
    bus_silent(&bus, TIMEOUT);
    check_int("TIMEOUT frames without heartbeat: time-outs", bus.app.count[DIAG_TIMEOUTS], 0);
    check_is("drive sounds", bus.app.plant.drive[0].amplitude, !=, 0.0);
    bus_enable(&bus, true);
    bus_silent(&bus, TIMEOUT + 1);
    check_int("a heartbeat in the last frame of grace saves it", bus.app.count[DIAG_TIMEOUTS], 0);
    bus_silent(&bus, 1);
    check_int("one frame more: time-outs", bus.app.count[DIAG_TIMEOUTS], 1);
    check_near("the reaction runs in that frame: drive, N", bus.app.plant.drive[0].amplitude, 0.0, 0.0);
    bus_silent(&bus, 500);
    check_int("and once only", bus.app.count[DIAG_TIMEOUTS], 1);
    /* A heartbeat with a stale echo is no heartbeat. */
    start_reaction(REACTION_ZERO);
    double old = (double)bus.app.frame;
    for (int i = 0; i < 80; i++) {
        bus_command(&bus, WIRE_ENABLE, (double[WIRE_FIELDS]){0, 1, old});
        bus_silent(&bus, 1);
    }
    check_int("the same ENABLE over and over: time-outs", bus.app.count[DIAG_TIMEOUTS], 1);
}

TEST(app_timeout_hold)
{
    start_reaction(REACTION_HOLD);
    bus_silent(&bus, 200);
    uint64_t silent = plant_hash(&bus.app.plant);
    check_int("state", bus.app.state, STATE_RUNNING);
    check_near("STATUS: reaction", bus_value(&bus, WIRE_STATUS, STATUS_REACTION), REACTION_HOLD, 0);
    check_int("tick: plant time goes on", (int64_t)bus.app.plant.now.tick, 210 * BUS_TICKS);
    uint32_t missed = bus.app.count[DIAG_STREAM_MISSED];
    check_int("a stream without session misses nothing", missed, 7 + TIMEOUT);
    recover(STATE_RUNNING, FAULT_TIMEOUT);
    start_reaction(REACTION_HOLD);
    bus_run(&bus, 200);
    check_hex("the plant is the same as with heartbeats", silent, plant_hash(&bus.app.plant));
}

TEST(app_timeout_ramp)
{
    start_reaction(REACTION_RAMP);
    bus_silent(&bus, TIMEOUT);
    double a0 = bus.app.plant.drive[0].amplitude * 64.0;
    for (int i = 1; i <= 15; i++) {
        bus_silent(&bus, 1);
        double left = 1.0 - i * BUS_TICKS / 250.0;
        if (i % 5 == 0 && i < 15) {
            check_near("drive, N", bus.app.plant.drive[0].amplitude * 64.0, a0 * left, 1e-12);
            check_near("sample, N", bus.app.plant.drive[1].sample * 64.0, 8.0 * left, 1e-12);
        }
    }
    bus_silent(&bus, 1);
    check_true("both are silent 250 ticks after the frame of the reaction",
               !drive_active(&bus.app.plant.drive[0]) && !drive_active(&bus.app.plant.drive[1]));
    check_int("state: the plant goes on", bus.app.state, STATE_RUNNING);
    bus_silent(&bus, 10);
    check_near("STATUS: reaction", bus_value(&bus, WIRE_STATUS, STATUS_REACTION), REACTION_RAMP, 0);
    recover(STATE_RUNNING, FAULT_TIMEOUT);
}

TEST(app_timeout_zero)
{
    start_reaction(REACTION_ZERO);
    bus_silent(&bus, TIMEOUT + 1);
    check_true("silent at the end of the frame",
               !drive_active(&bus.app.plant.drive[0]) && !drive_active(&bus.app.plant.drive[1]));
    check_int("state: the plant rings on", bus.app.state, STATE_RUNNING);
    check_int("tick: so does the frame of the reaction", (int64_t)bus.app.plant.now.tick,
              (10 + TIMEOUT + 1) * BUS_TICKS);
    bus_silent(&bus, 3000);
    check_near("and comes to rest: position", bus.app.plant.x[0], 1.0, 1e-12);
    recover(STATE_RUNNING, FAULT_TIMEOUT);
    /* One tick is all it takes. */
    struct app_config c = bus_config();
    c.substeps = 1024;
    bus_start_running(&bus, &c);
    bus_set(&bus, SETTING_FIRST + SET_REACTION, REACTION_ZERO);
    bus_stream(&bus, RIG_FORCE, 1, 64e-3);
    bus_run(&bus, 3);
    struct plant alone = bus.app.plant;
    bus_silent(&bus, 101);
    if (!plant_run(&alone, 100 * 1024))
        check_true("alone: finite", 0);
    plant_sample(&alone, RIG_FORCE, 0.0, 1);
    if (!plant_run(&alone, 1024))
        check_true("alone: finite", 0);
    check_bits("position as of a plant whose sample ramps to 0 over one tick", bus.app.plant.x[0],
               alone.x[0]);
    check_bits("velocity", bus.app.plant.x[1], alone.x[1]);
}

TEST(app_timeout_freeze)
{
    start_reaction(REACTION_FREEZE);
    bus_silent(&bus, TIMEOUT);
    uint64_t hash = plant_hash(&bus.app.plant);
    int64_t tick = (int64_t)bus.app.plant.now.tick;
    bus_silent(&bus, 100);
    check_int("state", bus.app.state, STATE_FROZEN);
    check_int("plant time stands in the frame of the reaction", (int64_t)bus.app.plant.now.tick, tick);
    check_hex("state and drives stand", plant_hash(&bus.app.plant), hash);
    check_near("SYNC goes on: frame", bus_value(&bus, WIRE_SYNC, SYNC_FRAME),
               (double)(uint16_t)(bus.app.frame - 1), 0);
    bus_forget(&bus);
    bus_silent(&bus, 20);
    check_int("no MOTION while plant time stands", bus_count(&bus, WIRE_MOTION), 0);
    recover(STATE_FROZEN, FAULT_TIMEOUT);
    /* Not running, nothing to freeze. */
    const struct app_config c = bus_config();
    bus_start(&bus, &c);
    bus_run(&bus, 1);
    bus_set_now(&bus, SETTING_FIRST + SET_REACTION, REACTION_FREEZE);
    bus_silent(&bus, 101);
    check_int("from ready: state", bus.app.state, STATE_READY);
    /* A stop is stronger. */
    start_reaction(REACTION_FREEZE);
    bus_silent(&bus, TIMEOUT + 1);
    bus_control(&bus, CONTROL_STOP, 0);
    bus_silent(&bus, 1);
    check_int("STOP while frozen: state", bus.app.state, STATE_STOPPED);
    check_near("drive on its way to, N", drive_target(&bus.app.plant.drive[0]).amplitude, 0.0, 0.0);
}
