/* test_app_stale.c - old, repeated, late and misplaced
 * frames change nothing; the queue that survives an outage. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/plant/plant_report.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { STALL_FRAMES = 10000, QUEUE = 500 };
static struct bus bus;

/* No frame of a queue may change this: drives, everything that waits, state and regime of the plant. */
struct rest {
    struct drive drive[MODEL_INPUTS];
    struct mailbox mailbox;
    double x[MODEL_STATES], si[MODEL_PARAMETERS], setting[SETTINGS];
    struct instant now;
    int state, enabled;
};

static struct rest rest_of(const struct app *a)
{
    struct rest r;
    memset(&r, 0, sizeof r);
    memcpy(r.drive, a->plant.drive, sizeof r.drive);
    memcpy(&r.mailbox, &a->mailbox, sizeof r.mailbox);
    memcpy(r.x, a->plant.x, sizeof r.x);
    memcpy(r.si, a->plant.si, sizeof r.si);
    memcpy(r.setting, a->setting, sizeof r.setting);
    r.now.tick = a->plant.now.tick;
    r.now.fraction = a->plant.now.fraction;
    r.state = a->state;
    r.enabled = a->enabled;
    return r;
}

/* The frames that a controller at work would have sent in the stall: heartbeats, samples, drives, fires,
 * parameters. */
static int queue_up(struct frame queue[QUEUE], uint64_t frame0, uint64_t tick0)
{
    static const double field[ARM_FIELDS] = {30.0, 200.0, 0.5, 0.01};
    struct staged set = {{0}, {0}};
    int n = 0;
    staged_put(&set, RIG_MASS, 3.0);
    for (int i = 0; n + 12 <= QUEUE; i++) {
        uint64_t ahead =
            (uint64_t)i * STALL_FRAMES / (QUEUE / 12); /* some name the present, some the future */
        bus_encode(&bus, WIRE_ENABLE, (double[WIRE_FIELDS]){0, 1, (double)(frame0 + (uint64_t)i)},
                   &queue[n++]);
        bus_encode(&bus, WIRE_CONTROL,
                   (double[WIRE_FIELDS]){0, CONTROL_START, 255 - CONTROL_START, (double)frame0}, &queue[n++]);
        bus_encode(&bus, WIRE_CONTROL, (double[WIRE_FIELDS]){0, CONTROL_STEP, 255 - CONTROL_STEP, 100},
                   &queue[n++]);
        for (unsigned k = 0; k < ARM_FIELDS; k++)
            bus_encode(&bus, WIRE_ARM, (double[WIRE_FIELDS]){0, k, field[k]}, &queue[n++]);
        bus_encode(&bus, WIRE_PARAM_WRITE, (double[WIRE_FIELDS]){0, RIG_MASS, 3.0}, &queue[n++]);
        bus_encode(&bus, WIRE_PARAM_COMMIT, (double[WIRE_FIELDS]){0, 1, i % 2, staged_crc(&set)},
                   &queue[n++]);
        bus_encode(&bus, WIRE_FIRE,
                   (double[WIRE_FIELDS]){0, 1, i % 2, 0, (double)(tick0 + ahead * BUS_TICKS)}, &queue[n++]);
        bus_encode(&bus, WIRE_STREAM, (double[WIRE_FIELDS]){0, (double)(uint16_t)(frame0 + ahead), 40.0},
                   &queue[n++]);
        bus_encode(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_ARM, 0, 0}, &queue[n++]);
    }
    return n;
}

static void outage(enum reaction reaction, enum plant_state expected)
{
    static struct frame queue[QUEUE];
    bus_start_rig(&bus);
    bus_set(&bus, SETTING_FIRST + SET_REACTION, reaction);
    bus_drive(&bus, RIG_FORCE, 10.0, 180.0, 0.0, 0.01);
    bus_fire(&bus, 1, false, 160, 7);
    bus_run(&bus, 200);
    int n = queue_up(queue, bus.app.frame, bus.app.plant.now.tick);
    bus_silent(&bus, 5000);
    bus_forget(&bus);
    bus_silent(&bus, STALL_FRAMES - 5000);
    bus_forget(&bus);
    check_int("state after the time-out", bus.app.state, expected);
    struct rest before = rest_of(&bus.app);
    for (int i = 0; i < n; i++)
        bus_put(&bus, &queue[i]);
    bus_forget(&bus);
    /* A frame during which plant time cannot move, so that before and after must be equal bit by bit. */
    enum plant_state was = bus.app.state;
    bus.app.state = STATE_STOPPED;
    bus_silent(&bus, 2); /* 256 frames of reception each */
    check_int("queue taken in: none of it waits at the hal", bus.wires.port[0].n, 0);
    check_int("nothing changed the state", bus.app.state, STATE_STOPPED);
    bus.app.state = was;
    struct rest after = rest_of(&bus.app);
    check_bytes("drives, mailbox, parameters, settings and plant are the same bytes", &before, &after,
                sizeof before);
    int refused = (int)(bus.app.count[DIAG_SESSION] + bus.app.count[DIAG_STALE]);
    check_int("every frame of the queue refused, none taken", refused, n);
    check_int("no session", bus.app.enabled, 0);
    /* And a new session does not bring any of it back. */
    bus.session = 2;
    memset(bus.counter, 0, sizeof bus.counter);
    bus_run(&bus, 3);
    check_int("a new session opens with an empty mailbox",
              bus.app.mailbox.n_fires + bus.app.mailbox.n_samples + bus.app.mailbox.armed[0].given, 0);
}

TEST(app_outage_queue)
{
    static const char *const name[] = {"hold", "ramp", "zero", "freeze"};
    for (int r = REACTION_HOLD; r <= REACTION_FREEZE; r++) {
        printf("      reaction %s\n", name[r]);
        outage((enum reaction)r, r == REACTION_FREEZE ? STATE_FROZEN : STATE_RUNNING);
    }
    /* An outage shorter than the time-out: the session goes on, but what named the past is late. */
    bus_start_rig(&bus);
    bus_run(&bus, 10);
    bus_drive(&bus, RIG_FORCE, 10.0, 180.0, 0.0, 0.0);
    bus_run(&bus, 1);
    struct frame fire, sample;
    uint64_t tick = bus.app.plant.now.tick;
    bus_encode(&bus, WIRE_FIRE, (double[WIRE_FIELDS]){0, 1, 0, 0, (double)(tick + 5)}, &fire);
    bus_encode(&bus, WIRE_STREAM, (double[WIRE_FIELDS]){0, (double)(tick / BUS_TICKS + 1), 40.0}, &sample);
    bus_silent(&bus, 60);
    bus_put(&bus, &fire);
    bus_put(&bus, &sample);
    bus_run(&bus, 20);
    check_int("after 60 frames of silence: late commands", bus.app.count[DIAG_LATE], 2);
    check_true("drive silent", !drive_active(&bus.app.plant.drive[RIG_FORCE]));
}

/* The plant itself stood still (a stopped process, a machine that slept): plant and bus frames are where they
 * were, so nothing of the queue names the past. `missed` frames, told before the queue is received. */
static void standstill(enum overrun_policy policy, uint32_t missed)
{
    static struct frame queue[QUEUE];
    bus_start_rig(&bus);
    bus_set(&bus, SETTING_FIRST + SET_OVERRUN_POLICY, policy);
    bus_set(&bus, SETTING_FIRST + SET_REACTION, REACTION_FREEZE);
    bus_run(&bus, 20);
    int n = queue_up(queue, bus.app.frame, bus.app.plant.now.tick);
    uint32_t due = app_overrun(&bus.app, missed);
    struct rest before = rest_of(&bus.app);
    for (int i = 0; i < n; i++)
        bus_put(&bus, &queue[i]);
    bus_silent(&bus, (int)due + 1); /* 256 frames of reception each */
    check_int("queue taken in: none of it waits at the hal", bus.wires.port[0].n, 0);
    struct rest after = rest_of(&bus.app);
    check_bytes("nothing of it changed drives, mailbox, parameters, settings or plant", &before, &after,
                sizeof before);
    check_int("refused", bus.app.count[DIAG_SESSION] + bus.app.count[DIAG_STALE], n);
    check_int("time-outs", bus.app.count[DIAG_TIMEOUTS], 1);
    check_int("state", bus.app.state, policy == OVERRUN_STOP ? STATE_FAULT : STATE_FROZEN);
    check_int("frames slipped", bus.app.count[DIAG_FRAMES_SLIPPED], missed);
}

TEST(app_outage_of_plant)
{
    static const char *const name[] = {"catch up", "skip", "freeze", "stop"};
    for (int policy = OVERRUN_CATCH_UP; policy <= OVERRUN_STOP; policy++) {
        printf("      the plant stands still for 10 s, then for as long as a time-out: %s\n", name[policy]);
        standstill((enum overrun_policy)policy, STALL_FRAMES);
        standstill((enum overrun_policy)policy, 100);
    }
}

TEST(app_repeated)
{
    struct frame f;
    bus_start_rig(&bus);
    bus_run(&bus, 1);
    bus_encode(&bus, WIRE_ARM, (double[WIRE_FIELDS]){0, ARM_AMPLITUDE, 5.0}, &f);
    for (int i = 0; i < 4; i++)
        bus_put(&bus, &f);
    bus_run(&bus, 1);
    check_int("one frame four times: repeated", bus.app.count[DIAG_REPEATED], 3);
    bus.counter[WIRE_PARAM_READ] = 11;
    bus_command(&bus, WIRE_PARAM_READ, (double[WIRE_FIELDS]){0, 50});
    bus_run(&bus, 1);
    check_near("a REPLY names the session", bus_value(&bus, WIRE_REPLY, SESSION), 1, 0);
    check_near("the counter of its command", bus_value(&bus, WIRE_REPLY, REPLY_COUNTER), 11, 0);
    check_near("and its index", bus_value(&bus, WIRE_REPLY, REPLY_INDEX), 50, 0);
    check_near("nothing is late about it", bus_value(&bus, WIRE_REPLY, REPLY_TICKS_LATE), 65535, 0);
    bus_fire(&bus, 1, false, bus.app.plant.now.tick, 0);
    bus_put(&bus, &f);
    bus_run(&bus, 1);
    check_int("and once more behind its FIRE: nothing armed", bus.app.mailbox.armed[0].given, 0);
    /* Gaps: 1 to 13 frames lost between two that arrive; every counter distance is taken. */
    uint32_t lost = bus.app.count[DIAG_LOST], expected = 0;
    for (unsigned gap = 1; gap <= 13; gap++) {
        bus.counter[WIRE_ARM] = (uint8_t)((bus.counter[WIRE_ARM] + gap) % WIRE_COUNTER_STATES);
        bus_arm(&bus, 0, ARM_AMPLITUDE, 1.0 + gap);
        bus_run(&bus, 1);
        expected += gap;
        if (bus.app.mailbox.armed[0].value[ARM_AMPLITUDE] != 1.0 + gap)
            check_near("frame behind the gap is taken", bus.app.mailbox.armed[0].value[ARM_AMPLITUDE],
                       1.0 + gap, 0);
    }
    check_int("lost frames counted", bus.app.count[DIAG_LOST] - lost, expected);
}

TEST(app_late_horizon)
{
    const int64_t offset[] = {-1,         -1000,      0, 1, 5000 * BUS_TICKS, 5000 * BUS_TICKS + 1,
                              2000000000, -2000000000};
    const int cause[] = {CAUSE_LATE, CAUSE_LATE,  CAUSE_OK,    CAUSE_OK,
                         CAUSE_OK,   CAUSE_STALE, CAUSE_STALE, CAUSE_LATE};
    for (int i = 0; i < 8; i++) {
        bus_start_rig(&bus);
        bus_run(&bus, 100);
        bus_arm(&bus, 0, ARM_AMPLITUDE, 1.0);
        bus_forget(&bus);
        bus_fire(&bus, 1, false, bus.app.plant.now.tick + (uint64_t)offset[i], 0);
        bus_run(&bus, 1);
        printf("      FIRE %lld ticks from now\n", (long long)offset[i]);
        check_int("cause", bus_cause(&bus, WIRE_FIRE), cause[i]);
        if (offset[i] == -1000)
            check_near("ticks late in the answer", bus_value(&bus, WIRE_REPLY, REPLY_TICKS_LATE), 1000, 0);
        if (offset[i] == -2000000000)
            check_near("more than the field holds: not available",
                       bus_value(&bus, WIRE_REPLY, REPLY_TICKS_LATE), 65535, 0);
        check_int("refused leaves it armed", bus.app.mailbox.armed[0].given, cause[i] == CAUSE_OK ? 0 : 1);
    }
    bus_forget(&bus);
    bus_stream(&bus, 0, bus.app.plant.now.tick / BUS_TICKS + 64, 1.0);
    bus_run(&bus, 1);
    check_int("STREAM 64 frames ahead: taken", bus_count(&bus, WIRE_REPLY), 0);
    bus_stream(&bus, 0, bus.app.plant.now.tick / BUS_TICKS + 65, 1.0);
    bus_run(&bus, 1);
    check_int("STREAM 65 frames ahead, horizon 5000", bus_cause(&bus, WIRE_STREAM), CAUSE_STALE);
    bus_set_now(&bus, SETTING_FIRST + SET_HORIZON_FRAMES, 10);
    bus_forget(&bus);
    bus_stream(&bus, 0, bus.app.plant.now.tick / BUS_TICKS + 10, 1.0);
    bus_run(&bus, 1);
    check_int("STREAM 10 frames ahead, horizon 10: taken", bus_count(&bus, WIRE_REPLY), 0);
    bus_stream(&bus, 0, bus.app.plant.now.tick / BUS_TICKS + 11, 1.0);
    bus_run(&bus, 1);
    check_int("STREAM 11 frames ahead", bus_cause(&bus, WIRE_STREAM), CAUSE_STALE);
    bus_fire(&bus, 1, false, bus.app.plant.now.tick + 10 * BUS_TICKS + 1, 0);
    bus_run(&bus, 1);
    check_int("FIRE one tick beyond the horizon", bus_cause(&bus, WIRE_FIRE), CAUSE_STALE);
}

/* Ages are counted in bus frames: they go on while plant time stands. */
TEST(app_age_while_frozen)
{
    bus_start_rig(&bus);
    bus_run(&bus, 5);
    bus_order_now(&bus, CONTROL_PAUSE);
    uint64_t tick = bus.app.plant.now.tick;
    struct frame old;
    bus_encode(&bus, WIRE_CONTROL,
               (double[WIRE_FIELDS]){0, CONTROL_START, 255 - CONTROL_START, (double)bus.app.frame}, &old);
    bus_run(&bus, 60);
    check_int("plant tick while paused", (int64_t)bus.app.plant.now.tick, (int64_t)tick);
    bus_put(&bus, &old);
    bus_run(&bus, 1);
    check_int("a START queued for 60 frames of standing plant time", bus_cause(&bus, WIRE_CONTROL),
              CAUSE_STALE);
    check_int("state", bus.app.state, STATE_PAUSED);
    bus_silent(&bus, 100);
    check_int("time-outs after 100 frames without a heartbeat", bus.app.count[DIAG_TIMEOUTS], 0);
    bus_silent(&bus, 1);
    check_int("and after 101, while paused", bus.app.count[DIAG_TIMEOUTS], 1);
}

/* Whatever waits is gone after stop, reset, the end of a
 * session and every time-out: its tick comes, nothing moves. */
TEST(app_forgets)
{
    const char *const how[] = {"stop", "reset", "disable", "time-out hold", "time-out freeze"};
    for (int i = 0; i < 5; i++) {
        const struct app_config c = bus_config();
        bus_start_running(&bus, &c);
        bus_set(&bus, SETTING_FIRST + SET_REACTION, i == 4 ? REACTION_FREEZE : REACTION_HOLD);
        bus_run(&bus, 2);
        bus_drive(&bus, RIG_FORCE, 10.0, 100.0, 0.0, 0.0);
        bus_fire(&bus, 1, false, 3000, 0);
        bus_stream(&bus, RIG_FORCE, 3000 / BUS_TICKS, 5.0);
        bus_drive(&bus, RIG_FAST_FORCE, 10.0, 100.0, 0.0, 0.0);
        if (i == 1)
            bus_order_now(&bus, CONTROL_PAUSE);
        if (i < 2)
            bus_order(&bus, i == 0 ? CONTROL_STOP : CONTROL_RESET);
        if (i == 2)
            bus_enable(&bus, false);
        bus_silent(&bus, i > 2 ? 101 : 1);
        if (i != 1)
            bus_next_session(&bus);
        bus_run(&bus, 1);
        bus_forget(&bus);
        bus_fire(&bus, 2, false, bus.app.plant.now.tick + 100, 0);
        bus_run(&bus, 1);
        printf("      %s\n", how[i]);
        check_true("what was armed before does not fire", bus_cause(&bus, WIRE_FIRE) == CAUSE_INCOMPLETE ||
                                                              bus_cause(&bus, WIRE_FIRE) == CAUSE_STATE);
        bus_order(&bus, CONTROL_START);
        bus_run(&bus, 400);
        check_above("tick of the forgotten fire has passed", (double)bus.app.plant.now.tick, 3000);
        check_near("mass at rest: velocity, m/s", plant_read(&bus.app.plant, "velocity"), 0.0, 1e-15);
        check_int("fires applied", bus.app.count[DIAG_FIRE_APPLIED], 0);
        check_int("samples applied", bus.app.count[DIAG_STREAM_APPLIED], 0);
    }
}

TEST(app_bad_frames)
{
    struct frame f, bad;
    bus_start_rig(&bus);
    bus_run(&bus, 3);
    struct rest before = rest_of(&bus.app);
    uint32_t received = bus.app.count[DIAG_FRAMES_RECEIVED];
    bus_encode(&bus, WIRE_ARM, (double[WIRE_FIELDS]){0, ARM_AMPLITUDE, 5.0}, &f);
    for (int length = 0; length < 8; length++) {
        bad = f;
        bad.length = (uint8_t)length;
        bus_put(&bus, &bad);
    }
    for (int bit = 0; bit < 64; bit++) {
        bad = f;
        bad.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
        bus_put(&bus, &bad);
    }
    bad = f;
    bad.data[1] |= 0x0F;
    bad.data[0] = wire_crc8(bad.id, bad.data, 8);
    bus_put(&bus, &bad);
    for (uint32_t kind = 0x0F; kind < WIRE_KINDS; kind++) { /* no command, or what only a plant says */
        bad = f;
        bad.id = 0x200 + kind;
        bad.data[0] = wire_crc8(bad.id, bad.data, 8);
        bus_put(&bus, &bad);
    }
    bad = f;
    bad.id = 0x240 + WIRE_ARM; /* the neighbour's */
    bus_put(&bus, &bad);
    bad = f;
    bad.flags = FRAME_EXTENDED;
    bus_put(&bus, &bad);
    const float wrong[] = {NAN, INFINITY, -INFINITY, 3e38f};
    for (int i = 0; i < 4; i++) {
        for (unsigned kind = WIRE_STREAM; kind < WIRE_ARM + 4; kind++)
            bus_command(&bus, kind, (double[WIRE_FIELDS]){0, kind < WIRE_ARM ? 3 : i, (double)wrong[i]});
        bus_write(&bus, RIG_MASS, (double)wrong[i]);
        bus_write(&bus, SETTING_FIRST + SET_TIMEOUT_FRAMES, (double)wrong[i]);
    }
    bus.app.state = STATE_PAUSED;
    bus_silent(&bus, 1);
    bus.app.state = STATE_RUNNING;
    struct rest after = rest_of(&bus.app);
    check_bytes("nothing changed", &before, &after, sizeof before);
    check_int("length", bus.app.count[DIAG_LENGTH], 8);
    check_int("checksum", bus.app.count[DIAG_CRC], 64);
    check_int("counter 15", bus.app.count[DIAG_COUNTER_INVALID], 1);
    check_int("identifiers that are no command", bus.app.count[DIAG_UNKNOWN_ID], 0x40 - WIRE_COMMANDS);
    check_int("values out of range or not finite", bus.app.count[DIAG_RANGE], 4 * 10);
    check_int("received, foreign identifiers not counted", bus.app.count[DIAG_FRAMES_RECEIVED] - received,
              8 + 64 + 1 + (0x40 - 0x0F) + 40);
}
