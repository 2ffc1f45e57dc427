/* test_app_time.c - plant time under command: steps, run
 * until, pause, snapshot, overruns; two plants on one bus. */
#include <stdio.h>
#include <string.h>
#include "firmware/plant/plant_report.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

static struct bus bus, other;

/* Bouncing, with a second change and samples waiting: much that could go wrong. */
static void start_driven(struct bus *b)
{
    const struct app_config c = bus_config();
    bus_start_running(b, &c);
    bus_drive(b, RIG_FORCE, 16.0, 215.0, 0.0, 0.02);
    bus_fire(b, 1, false, 2 * BUS_TICKS + 3, 7);
    bus_drive(b, RIG_FAST_FORCE, 8.0, 1100.0, 0.0, 0.01);
    bus_fire(b, 2, false, 60 * BUS_TICKS + 9, 200);
    bus_stream(b, RIG_FORCE, 40, 3.0);
    bus_stream(b, RIG_BASE, 70, 1e-7);
    bus_run(b, 10);
    bus_forget(b);
}

static uint64_t hash_straight(int frames)
{
    start_driven(&bus);
    bus_run(&bus, frames);
    return plant_hash(&bus.app.plant);
}

TEST(app_time_steps)
{
    uint64_t straight = hash_straight(100);
    int64_t tick = (int64_t)bus.app.plant.now.tick;
    const int steps[] = {1, 7, 100};
    for (int i = 0; i < 3; i++) {
        start_driven(&bus);
        bus_order_now(&bus, CONTROL_PAUSE);
        for (int done = 0; done < 100; done += steps[i]) {
            int n = done + steps[i] > 100 ? 100 - done : steps[i];
            bus_control(&bus, CONTROL_STEP, n);
            bus_run(&bus, n + 2);
        }
        printf("      100 frames in steps of %d\n", steps[i]);
        check_int("tick", (int64_t)bus.app.plant.now.tick, tick);
        check_hex("hash", plant_hash(&bus.app.plant), straight);
        check_int("state", bus.app.state, STATE_PAUSED);
    }
    bus_control(&bus, CONTROL_STEP, 5);
    bus_control(&bus, CONTROL_STEP, 5);
    bus_run(&bus, 1);
    check_int("a step while one is going on", bus_cause(&bus, WIRE_CONTROL), CAUSE_STATE);
    bus_run(&bus, 10);
    check_int("the first one ends where it said", (int64_t)bus.app.plant.now.tick, tick + 5 * BUS_TICKS);
    bus_control(&bus, CONTROL_STEP, 0);
    bus_run(&bus, 1);
    check_int("a step of nothing", bus_cause(&bus, WIRE_CONTROL), CAUSE_RANGE);
    bus_control(&bus, CONTROL_STEP, 50);
    bus_run(&bus, 3);
    bus_order(&bus, CONTROL_PAUSE);
    bus_run(&bus, 20);
    check_int("PAUSE ends a step", (int64_t)bus.app.plant.now.tick, tick + 8 * BUS_TICKS);
    bus_control(&bus, CONTROL_STEP, 50);
    bus_run(&bus, 3);
    bus_silent(&bus, 120);
    check_int("so does a time-out", (int64_t)bus.app.plant.now.tick, tick + (8 + 50) * BUS_TICKS);
}

TEST(app_time_until)
{
    uint64_t straight = hash_straight(100);
    uint64_t tick = bus.app.plant.now.tick;
    start_driven(&bus);
    bus_order_now(&bus, CONTROL_PAUSE);
    bus_control(&bus, CONTROL_RUN_UNTIL, (double)tick);
    bus_run(&bus, 150);
    check_int("tick", (int64_t)bus.app.plant.now.tick, (int64_t)tick);
    check_hex("hash as straight on", plant_hash(&bus.app.plant), straight);
    const struct {
        int64_t from_now;
        int cause;
    } until[] = {
        {0, CAUSE_LATE}, {-BUS_TICKS, CAUSE_LATE}, {BUS_TICKS + 1, CAUSE_RANGE}, {BUS_TICKS, CAUSE_OK}};
    for (int i = 0; i < 4; i++) {
        bus_control(&bus, CONTROL_RUN_UNTIL, (double)(bus.app.plant.now.tick + (uint64_t)until[i].from_now));
        bus_run(&bus, 3);
        printf("      %lld ticks from now\n", (long long)until[i].from_now);
        check_int("cause", bus_cause(&bus, WIRE_CONTROL), until[i].cause);
    }
    check_int("one frame on", (int64_t)bus.app.plant.now.tick, (int64_t)tick + BUS_TICKS);
}

/* In lockstep every step is dated, however rare SYNC is; MOTION goes by plant frames, not by bus frames. */
TEST(app_time_telemetry)
{
    start_driven(&bus);
    bus_set(&bus, SETTING_FIRST + SET_SYNC_EVERY, 10000);
    bus_set(&bus, SETTING_FIRST + SET_MOTION_EVERY, 7);
    bus_set(&bus, SETTING_FIRST + SET_CONTACT_EVERY, 0); /* it would bring its own SYNC */
    bus_order(&bus, CONTROL_PAUSE);
    bus_run(&bus, 5);
    bus_forget(&bus);
    bus_control(&bus, CONTROL_STEP, 6);
    bus_run(&bus, 20);
    check_int("SYNC in six steps", bus_count(&bus, WIRE_SYNC), 6);
    check_near("the last one: tick", bus_value(&bus, WIRE_SYNC, SYNC_TICK), (double)bus.app.plant.now.tick,
               0);
    bus_order(&bus, CONTROL_START);
    bus_forget(&bus);
    int wrong = 0;
    for (int i = 0; i < 70; i++) {
        int before = bus_count(&bus, WIRE_MOTION);
        bus_run(&bus, 1);
        bool due = bus.app.plant.now.tick / BUS_TICKS % 7 == 0;
        wrong += bus_count(&bus, WIRE_MOTION) - before != due;
    }
    check_int("MOTION in 70 frames, motion_every 7", bus_count(&bus, WIRE_MOTION), 10);
    check_int("not at the seventh plant frame", wrong, 0);
}

/* Frames that arrive while plant time stands are taken: they wait for their instant. */
TEST(app_time_pause)
{
    uint64_t straight = hash_straight(100);
    bus_start_rig(&bus);
    bus_order(&bus, CONTROL_PAUSE);
    bus_run(&bus, 20);
    bus_drive(&bus, RIG_FORCE, 16.0, 215.0, 0.0, 0.02);
    bus_fire(&bus, 1, false, 2 * BUS_TICKS + 3, 7);
    bus_run(&bus, 30);
    bus_drive(&bus, RIG_FAST_FORCE, 8.0, 1100.0, 0.0, 0.01);
    bus_fire(&bus, 2, false, 60 * BUS_TICKS + 9, 200);
    bus_run(&bus, 60);
    bus_stream(&bus, RIG_FORCE, 40, 3.0);
    bus_stream(&bus, RIG_BASE, 70, 1e-7);
    bus_run(&bus, 40);
    check_int("tick while paused", (int64_t)bus.app.plant.now.tick, 0);
    check_hex("plant at rest while paused: state", bus.app.plant.regime, 1);
    bus_order(&bus, CONTROL_START);
    bus_run(&bus, 110);
    check_hex("commands given while paused: hash", plant_hash(&bus.app.plant), straight);
}

TEST(app_time_snapshot)
{
    static struct app snapshot;
    static float memory[BUS_CAPTURE];
    static struct message telemetry[4000];
    start_driven(&bus);
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_ARM, 0, 0});
    bus_write(&bus, RIG_MASS, 5.0);
    bus_run(&bus, 30);
    snapshot = bus.app;
    memcpy(memory, bus.capture, sizeof memory);
    uint8_t counter[WIRE_COMMANDS];
    memcpy(counter, bus.counter, sizeof counter);
    bus_forget(&bus);
    bus_run(&bus, 100);
    int n = bus.n_seen;
    uint64_t hash = plant_hash(&bus.app.plant);
    memcpy(telemetry, bus.seen, (size_t)n * sizeof telemetry[0]);
    bus.app = snapshot;
    memcpy(bus.capture, memory, sizeof memory);
    memcpy(bus.counter, counter, sizeof counter);
    bus_forget(&bus);
    bus_run(&bus, 100);
    int differ = 0;
    for (int i = 0; i < n; i++) {
        const double *v = bus.seen[i].value;
        bool timing = bus.seen[i].kind == WIRE_HEALTH && v[0] >= DIAG_COMPUTE_MAX_US;
        differ += !timing && memcmp(&telemetry[i], &bus.seen[i], sizeof telemetry[i]) != 0;
    }
    check_int("messages", bus.n_seen, n);
    check_int("of them different after restoring", differ, 0);
    check_hex("hash", plant_hash(&bus.app.plant), hash);
}

static void overrun(enum overrun_policy policy, uint32_t missed, struct bus *b)
{
    start_driven(b);
    bus_set(b, SETTING_FIRST + SET_OVERRUN_POLICY, policy);
    bus_run(b, 1);
    bus_forget(b);
    uint32_t due = app_overrun(&b->app, missed);
    check_int("frames due", due, policy == OVERRUN_CATCH_UP ? (missed < 100 ? missed : 100) + 1 : 1);
    for (uint32_t i = 0; i < due; i++)
        bus_run(b, 1);
}

TEST(app_time_overrun)
{
    static const char *const name[] = {"catch up", "skip", "freeze", "stop"};
    const int frames_of_plant[] = {11 + 30, 11 + 30, 11, 11};
    uint64_t straight = (start_driven(&bus), bus_run(&bus, 1), bus_run(&bus, 30), plant_hash(&bus.app.plant));
    for (int policy = OVERRUN_CATCH_UP; policy <= OVERRUN_STOP; policy++) {
        printf("      %s: 29 frames missed\n", name[policy]);
        overrun((enum overrun_policy)policy, 29, &bus);
        int plant_frames = frames_of_plant[policy] + (policy == OVERRUN_FREEZE);
        check_int("bus frame: keeps pace in every case", (int64_t)bus.app.frame, 1 + 11 + 30);
        check_int("plant tick", (int64_t)bus.app.plant.now.tick, plant_frames * BUS_TICKS);
        check_int("overruns", bus.app.count[DIAG_OVERRUNS], 1);
        check_int("frames missed", bus.app.count[DIAG_FRAMES_MISSED], 29);
        check_int("frames slipped", bus.app.count[DIAG_FRAMES_SLIPPED], policy < OVERRUN_FREEZE ? 0 : 29);
        check_near("OVERRUN: missed", bus_value(&bus, WIRE_OVERRUN, OVERRUN_MISSED), 29, 0);
        check_near("OVERRUN: the frame that came late", bus_value(&bus, WIRE_OVERRUN, OVERRUN_FRAME), 12, 0);
        check_int("MOTION messages", bus_count(&bus, WIRE_MOTION),
                  policy == OVERRUN_CATCH_UP ? 30 : policy != OVERRUN_STOP);
        check_int("state", bus.app.state, policy == OVERRUN_STOP ? STATE_FAULT : STATE_RUNNING);
        check_int("fault", bus.app.faults, policy == OVERRUN_STOP ? FAULT_OVERRUN : 0);
        if (policy <= OVERRUN_SKIP)
            check_hex("hash as without the overrun", plant_hash(&bus.app.plant), straight);
        if (policy == OVERRUN_STOP) {
            check_is("drives on their way to zero", drive_target(&bus.app.plant.drive[0]).amplitude, ==, 0.0);
            check_int("nothing waits", bus.app.mailbox.n_fires + bus.app.mailbox.n_samples, 0);
        }
    }
    check_int("no frame missed: one is due, nothing counted", app_overrun(&bus.app, 0), 1);
    check_int("overruns", bus.app.count[DIAG_OVERRUNS], 1);
}

/* A stall of 5 s: 100 frames are made up, the rest slips; and the command age is not fooled. */
TEST(app_time_overrun_limit)
{
    for (int policy = OVERRUN_CATCH_UP; policy <= OVERRUN_SKIP; policy++) {
        start_driven(&bus);
        bus_set(&bus, SETTING_FIRST + SET_OVERRUN_POLICY, policy);
        bus_set_now(&bus, SETTING_FIRST + SET_REACTION, REACTION_HOLD);
        int64_t tick = (int64_t)bus.app.plant.now.tick, frame = (int64_t)bus.app.frame;
        uint32_t due = app_overrun(&bus.app, 5000);
        bus_silent(&bus, (int)due);
        printf("      policy %d, 5000 frames missed\n", policy);
        check_int("plant tick: 101 frames on", (int64_t)bus.app.plant.now.tick - tick, 101 * BUS_TICKS);
        check_int("bus frame", (int64_t)bus.app.frame - frame, 5001);
        check_int("slipped", bus.app.count[DIAG_FRAMES_SLIPPED], 4900);
        check_int("heartbeats are 5 s old: time-outs", bus.app.count[DIAG_TIMEOUTS], 1);
    }
}

/* More than OVERRUN can say: 65535 are told, counted and taken, not what is left of them in 16 bits. */
TEST(app_time_overrun_longest)
{
    start_driven(&bus);
    uint64_t frame = bus.app.frame;
    bus_silent(&bus, (int)app_overrun(&bus.app, 65536 + 7));
    check_near("OVERRUN: missed", bus_value(&bus, WIRE_OVERRUN, OVERRUN_MISSED), 65535, 0);
    check_int("frames missed", bus.app.count[DIAG_FRAMES_MISSED], 65535);
    check_int("bus frames gone by", (int64_t)(bus.app.frame - frame), 65536);
    check_int("time-outs", bus.app.count[DIAG_TIMEOUTS], 1);
    bus_silent(&bus, (int)app_overrun(&bus.app, 1000));
    check_int("without a session an overrun ends none: time-outs", bus.app.count[DIAG_TIMEOUTS], 1);
}

/* A frame echoed before a short absence of the plant is as fresh as it was, in the first frame after it
 * and no longer. */
static void echo_over(uint32_t missed, uint32_t stale, uint32_t stale_later)
{
    start_driven(&bus);
    bus_set(&bus, SETTING_FIRST + SET_OVERRUN_POLICY, OVERRUN_SKIP);
    bus_run(&bus, 2);
    double seen = (double)bus.app.frame;
    uint32_t before = bus.app.count[DIAG_STALE];
    check_int("calls due", app_overrun(&bus.app, missed), 1);
    bus_command(&bus, WIRE_ENABLE, (double[WIRE_FIELDS]){0, 1, seen});
    bus_silent(&bus, 1);
    check_int("stale", bus.app.count[DIAG_STALE] - before, stale);
    bus_command(&bus, WIRE_ENABLE, (double[WIRE_FIELDS]){0, 1, seen});
    bus_silent(&bus, 1);
    check_int("stale in the frame after", bus.app.count[DIAG_STALE] - before, stale_later);
    check_int("time-outs", bus.app.count[DIAG_TIMEOUTS], 0);
}

TEST(app_time_overrun_echo)
{
    echo_over(20, 0, 0); /* within age_limit_frames, 50 */
    echo_over(99, 0, 1);
}

/* Plant time that is stepped by command stops where the command said, overrun or not. */
TEST(app_time_overrun_stepping)
{
    for (int policy = OVERRUN_CATCH_UP; policy <= OVERRUN_FREEZE; policy++) {
        start_driven(&bus);
        bus_set(&bus, SETTING_FIRST + SET_OVERRUN_POLICY, policy);
        bus_order_now(&bus, CONTROL_PAUSE);
        int64_t tick = (int64_t)bus.app.plant.now.tick;
        bus_control(&bus, CONTROL_STEP, 10);
        bus_run(&bus, 2);
        for (uint32_t due = app_overrun(&bus.app, 30); due > 0; due--)
            bus_run(&bus, 1);
        bus_run(&bus, 20);
        printf("      policy %d, STEP 10 and 30 frames missed\n", policy);
        check_int("frames of plant time", ((int64_t)bus.app.plant.now.tick - tick) / BUS_TICKS, 10);
    }
}

/* A plant that skips every other frame has no turn in the even ones, so in none that is a multiple of 10.
 * Messages that are due every so many frames come nevertheless, and as often. */
TEST(app_time_overrun_reports)
{
    static const struct {
        const char *name;
        unsigned kind;
        int every;
    } told[] = {{"STATUS", WIRE_STATUS, 10},
                {"LEDGER", WIRE_LEDGER, 10},
                {"HEALTH", WIRE_HEALTH, 4},
                {"EVENT_SUMMARY", WIRE_EVENT_SUMMARY, 100},
                {"MOTION", WIRE_MOTION, 6}};
    start_driven(&bus);
    bus_set(&bus, SETTING_FIRST + SET_OVERRUN_POLICY, OVERRUN_SKIP);
    bus_set(&bus, SETTING_FIRST + SET_HEALTH_EVERY, 4);
    bus_set(&bus, SETTING_FIRST + SET_MOTION_EVERY, 6);
    bus_run(&bus, bus.app.frame % 2 ? 1 : 2); /* from here on its turns come in odd frames */
    bus_forget(&bus);
    uint64_t frame = bus.app.frame;
    uint32_t due = 0;
    for (int i = 0; i < 300; i++) {
        due += app_overrun(&bus.app, 1);
        bus_run(&bus, 1);
    }
    check_int("calls due", due, 300);
    check_int("bus frames", (int64_t)(bus.app.frame - frame), 600);
    for (size_t i = 0; i < sizeof told / sizeof told[0]; i++)
        check_near(told[i].name, bus_count(&bus, told[i].kind), 600.0 / told[i].every, 1.0);
}

/* The counts of EVENT_SUMMARY are not lost where the bus has no room for it. */
TEST(app_time_summary_waits)
{
    double touchdowns = 0.0;
    start_driven(&bus);
    bus_set(&bus, SETTING_FIRST + SET_SUMMARY_EVERY, 10);
    for (int i = 0; i < 40; i++) {
        bus.wires.port[0].tx_limit = i % 4 < 3 ? 0 : UINT32_MAX; /* no room for 30 of each 40 frames */
        bus_run(&bus, 10);
        for (int k = 0; k < bus.n_seen; k++)
            touchdowns +=
                bus.seen[k].kind == WIRE_EVENT_SUMMARY ? bus.seen[k].value[SUMMARY_TOUCHDOWNS] : 0.0;
        bus_forget(&bus);
    }
    check_above("switches", bus.app.plant.counts.switches, 20);
    check_near("touchdowns told, and those of the next summary", touchdowns + bus.app.telemetry.touchdowns,
               bus.app.plant.counts.switches / 2, 0.0);
}

/* Another app on a third port, with its own base; both controllers hear everything. */
TEST(app_two_plants)
{
    struct app_config c = bus_config(), d = bus_config();
    d.base_id = 0x240;
    start_driven(&bus);
    bus_run(&bus, 200);
    uint64_t alone = plant_hash(&bus.app.plant);

    bus_start(&bus, &c);
    loopback_init(&bus.wires, 3, LOOPBACK_RING);
    bus_start(&other, &d);
    if (app_init(&bus.app, &c, &bus.wires.port[0].hal) || app_init(&other.app, &d, &bus.wires.port[2].hal))
        check_true("both start", 0);
    struct bus *const b[2] = {&bus, &other};
    for (int i = 0; i < 211; i++) {
        for (int k = 0; k < 2; k++) {
            struct frame f;
            b[k]->session = (uint8_t)(1 + 6 * k);
            other.app.session = other.app.enabled ? 7 : 6;
            bus_encode(b[k], WIRE_ENABLE, (double[WIRE_FIELDS]){0, 1, (double)b[k]->app.frame}, &f);
            bus_put(&bus, &f);
            if (i == 1) {
                bus_encode(b[k], WIRE_CONTROL,
                           (double[WIRE_FIELDS]){0, CONTROL_START, 255 - CONTROL_START, 1}, &f);
                bus_put(&bus, &f);
            }
        }
        if (i == 1) { /* the first plant as in start(), the other one in its own way */
            bus_drive(&bus, RIG_FORCE, 16.0, 215.0, 0.0, 0.02);
            bus_fire(&bus, 1, false, 2 * BUS_TICKS + 3, 7);
            bus_drive(&bus, RIG_FAST_FORCE, 8.0, 1100.0, 0.0, 0.01);
            bus_fire(&bus, 2, false, 60 * BUS_TICKS + 9, 200);
            bus_stream(&bus, RIG_FORCE, 40, 3.0);
            bus_stream(&bus, RIG_BASE, 70, 1e-7);
            struct frame f;
            bus_encode(&other, WIRE_STREAM, (double[WIRE_FIELDS]){0, 5, -7.0}, &f);
            bus_put(&bus, &f);
        }
        app_frame(&bus.app);
        app_frame(&other.app);
        bus_collect(&bus);
    }
    check_hex("the first plant is as if alone: hash", plant_hash(&bus.app.plant), alone);
    check_near("the other took its own sample, N", other.app.plant.drive[0].sample * 64.0, -7.0, 1e-12);
    check_int("sessions", bus.app.session * 16 + other.app.session, 0x17);
    check_int("refused, all causes, first",
              bus.app.count[DIAG_SESSION] + bus.app.count[DIAG_UNKNOWN_ID] + bus.app.count[DIAG_CRC], 0);
    check_int("refused, all causes, other",
              other.app.count[DIAG_SESSION] + other.app.count[DIAG_UNKNOWN_ID] + other.app.count[DIAG_CRC],
              0);
    check_int("frames counted as received by the other: its own", other.app.count[DIAG_FRAMES_RECEIVED], 213);
}

TEST(app_extended)
{
    struct app_config c = bus_config();
    c.base_id = 0x18DA0040;
    c.extended = true;
    bus_start_running(&bus, &c);
    bus_run(&bus, 5);
    check_int("29-bit identifiers: state", bus.app.state, STATE_RUNNING);
    check_int("telemetry is heard", bus_count(&bus, WIRE_MOTION), 5);
    bus.scene.extended = false;
    bus_order_now(&bus, CONTROL_STOP);
    check_int("the same number with 11 bits is not ours", bus.app.state, STATE_RUNNING);
    const struct {
        const char *what;
        uint32_t base;
        bool extended, good;
    } base[] = {{"0x7C0", 0x7C0, false, true},
                {"0x800", 0x800, false, false},
                {"0x220", 0x220, false, false},
                {"0x1FFFFFC0", 0x1FFFFFC0, true, true},
                {"2^29", 0x20000000, true, false}};
    for (int i = 0; i < 5; i++) {
        c.base_id = base[i].base;
        c.extended = base[i].extended;
        check_int(base[i].what, app_init(&bus.app, &c, &bus.wires.port[0].hal) == NULL, base[i].good);
    }
}

/* The bound on frames that are made up holds for all that are due, not for each absence. */
TEST(app_time_overrun_again)
{
    start_driven(&bus);
    bus_run(&bus, 1);
    check_int("60 frames missed: due", app_overrun(&bus.app, 60), 61);
    bus_run(&bus, 1);
    check_int("60 more before the second of them: due", app_overrun(&bus.app, 60), 101);
    check_int("slipped", bus.app.count[DIAG_FRAMES_SLIPPED], 19);
}

/* An ENABLE that waited through a long absence of the plant opens no session; one that is sent then does. */
TEST(app_time_overrun_enable)
{
    const struct app_config c = bus_config();
    for (int longer = 0; longer < 2; longer++) {
        bus_start(&bus, &c);
        bus_silent(&bus, 5);
        int timeout = (int)bus.app.setting[SET_TIMEOUT_FRAMES];
        bus_enable(&bus, true);
        (void)!app_overrun(&bus.app, (uint32_t)(longer ? timeout : timeout / 4));
        bus_silent(&bus, 1);
        check_int(longer ? "no session after a long absence" : "a session after a short one", bus.app.enabled,
                  !longer);
    }
    bus_enable(&bus, true);
    bus_silent(&bus, 1);
    check_int("a session by an ENABLE of now", bus.app.enabled, 1);
}
