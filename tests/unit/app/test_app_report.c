/* test_app_report.c - the plant's messages: motion, events, floods, summaries, hash, latency, echoes, and
 * a bus that takes too little. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/plant/plant_report.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { MANY = 512 };
static struct bus bus;

/* A rig that bounces: 16 N near resonance. */
static void start_bouncing(struct plant *alone)
{
    bus_start_rig(&bus);
    bus_drive(&bus, RIG_FORCE, 16.0, 215.0, 0.0, 0.0);
    bus_fire(&bus, 1, false, BUS_TICKS, 0);
    bus_run(&bus, 2);
    *alone = bus.app.plant;
    bus_forget(&bus);
}

static void run_alone(struct plant *alone, uint64_t ticks)
{
    if (!plant_run(alone, ticks))
        check_true("alone: finite", 0);
}

TEST(app_report_motion)
{
    struct plant alone;
    double worst[4] = {0.0};
    start_bouncing(&alone);
    for (int i = 0; i < 300; i++) {
        double out[MODEL_OUTPUTS];
        const double *lsb = bus.app.scene.lsb;
        bus_run(&bus, 1);
        run_alone(&alone, BUS_TICKS);
        plant_output(&alone, out);
        for (int k = 0; k < 4; k++) {
            double told = bus_value(&bus, k < 2 ? WIRE_MOTION : WIRE_CONTACT, 1 + k % 2);
            worst[k] = fmax(worst[k], fabs(told - out[k]) / lsb[k]);
        }
        if (bus_value(&bus, WIRE_MOTION, MOTION_IN_CONTACT) != out[4])
            check_near("contact bit", bus_value(&bus, WIRE_MOTION, MOTION_IN_CONTACT), out[4], 0);
        if (bus_value(&bus, WIRE_SYNC, SYNC_TICK) != (double)alone.now.tick)
            check_near("SYNC: tick", bus_value(&bus, WIRE_SYNC, SYNC_TICK), (double)alone.now.tick, 0);
    }
    for (int k = 0; k < 4; k++)
        check_below("MOTION and CONTACT off the plant alone, in LSB", worst[k], 0.5 + 1e-6);
    check_int("MOTION messages in 300 frames", bus_count(&bus, WIRE_MOTION), 300);
}

TEST(app_report_events)
{
    static struct event expected[MANY];
    struct plant alone;
    int n = 0, i = 0, order = 0;
    double worst_time = 0.0, worst_speed = 0.0, worst_peak = 0.0;
    start_bouncing(&alone);
    for (int k = 0; k < 300; k++) {
        run_alone(&alone, BUS_TICKS);
        while (n < MANY && plant_take_event(&alone, &expected[n]))
            n++;
    }
    bus_run(&bus, 300);
    for (int k = 0; k < bus.n_seen && i < n; k++) {
        const struct message *m = &bus.seen[k], *d = m + 1;
        const struct event *e = &expected[i];
        if (m->kind != WIRE_EVENT_TIME)
            continue;
        order += d->kind != WIRE_EVENT_DATA || m->value[EVENT_TOUCH] != e->touch ||
                 d->value[EVENT_TOUCH] != e->touch;
        double time =
            m->value[EVENT_TIME_TICK] - (double)e->tick + m->value[EVENT_TIME_FRACTION] - e->fraction;
        worst_time = fmax(worst_time, fabs(time));
        worst_speed = fmax(worst_speed, fabs(d->value[EVENT_DATA_SPEED] - e->speed) / bus.app.scene.lsb[1]);
        worst_peak =
            fmax(worst_peak, fabs(d->value[EVENT_DATA_PEAK_FORCE] - e->peak_force) / bus.app.scene.lsb[3]);
        i++;
    }
    check_above("events of the plant alone", n, 20);
    check_int("events told", bus_count(&bus, WIRE_EVENT_TIME), n);
    check_int("pairs out of order or of the wrong sort", order, 0);
    check_below("time off, in 1/65536 tick", worst_time * 65536, 0.5 + 1e-9);
    check_below("speed off, in LSB", worst_speed, 0.5 + 1e-6);
    check_below("peak force off, in LSB", worst_peak, 0.5 + 1e-6);
    int touches = 0;
    for (int k = 0; k < n; k++)
        touches += expected[k].touch;
    bus_run(&bus, 1);
    double told = 0.0;
    for (int k = 0; k < bus.n_seen; k++)
        told += bus.seen[k].kind == WIRE_EVENT_SUMMARY ? bus.seen[k].value[SUMMARY_TOUCHDOWNS] : 0.0;
    check_is("touchdowns of the summaries are those told, but for the last window", told, <=, touches);
    check_is("touchdowns of the summaries are those told, but for the last window", told, >=, touches - 25);
}

/* A frame of a tenth of a second holds some forty switches:
 * the first events of a frame are told, all are accounted for. */
TEST(app_report_flood)
{
    struct app_config c = bus_config();
    c.frame_s = 0.1;
    c.substeps = 1600;
    bus_start_running(&bus, &c);
    bus_set(&bus, SETTING_FIRST + SET_EVENTS_PER_FRAME, 3);
    bus_set(&bus, SETTING_FIRST + SET_SUMMARY_EVERY, 1);
    bus_drive(&bus, RIG_FORCE, 16.0, 215.0, 0.0, 0.0);
    bus_fire(&bus, 1, false, 1600, 0);
    bus_run(&bus, 4);
    bus_forget(&bus);
    uint32_t switches = bus.app.plant.counts.switches, lost = bus.app.plant.counts.events_lost;
    int told = 0, most = 0;
    double kept_back = 0.0, touchdowns = 0.0;
    for (int i = 0; i < 10; i++) {
        bus_forget(&bus);
        bus_run(&bus, 1);
        int now = bus_count(&bus, WIRE_EVENT_TIME);
        told += now;
        most = now > most ? now : most;
        kept_back += bus_value(&bus, WIRE_EVENT_SUMMARY, SUMMARY_NOT_SENT);
        touchdowns += bus_value(&bus, WIRE_EVENT_SUMMARY, SUMMARY_TOUCHDOWNS);
    }
    int n = (int)(bus.app.plant.counts.switches - switches);
    lost = bus.app.plant.counts.events_lost - lost;
    check_above("switches in ten frames", n, 100);
    check_int("most told in a frame", most, 3);
    check_int("told + held back + overwritten", told + (int)kept_back + (int)lost, n);
    check_near("touchdowns + those overwritten, of all switches half", touchdowns, 0.5 * (n - (int)lost),
               5.0);
    bus_set_now(&bus, SETTING_FIRST + SET_EVENTS_PER_FRAME, 0);
    bus_forget(&bus);
    bus_run(&bus, 5);
    check_int("events_per_frame 0: none told",
              bus_count(&bus, WIRE_EVENT_TIME) + bus_count(&bus, WIRE_EVENT_DATA), 0);
}

/* Share of time apart: counted from the lift-offs and touchdowns that were told. */
TEST(app_report_summary)
{
    struct plant alone;
    start_bouncing(&alone);
    while (bus.app.frame % 100 != 1)
        bus_run(&bus, 1);
    bus_forget(&bus);
    bool apart = bus.app.plant.regime == 0;
    double left = (double)bus.app.plant.now.tick, begin = left, sum = 0.0;
    bus_run(&bus, 100);
    for (int i = 0; i < bus.n_seen; i++) {
        const struct message *m = &bus.seen[i];
        double at = m->value[EVENT_TIME_TICK] + m->value[EVENT_TIME_FRACTION];
        if (m->kind != WIRE_EVENT_TIME)
            continue;
        if (m->value[EVENT_TOUCH] != 0.0)
            sum += at - left;
        apart = m->value[EVENT_TOUCH] == 0.0;
        left = at;
    }
    double end = (double)bus.app.plant.now.tick;
    if (apart)
        sum += end - left;
    check_int("one summary in the window", bus_count(&bus, WIRE_EVENT_SUMMARY), 1);
    check_near("share of time apart", bus_value(&bus, WIRE_EVENT_SUMMARY, SUMMARY_LOSS), sum / (end - begin),
               1.0 / 65535);
    check_above("it is not nothing", sum / (end - begin), 0.05);
}

TEST(app_report_hash)
{
    struct plant alone;
    start_bouncing(&alone);
    bus_set(&bus, SETTING_FIRST + SET_HASH_EVERY, 10);
    while (bus_count(&bus, WIRE_HASH) < 20)
        bus_run(&bus, 1);
    run_alone(&alone, bus.app.plant.now.tick - alone.now.tick);
    check_near("HASH: low 48 bits of the hash of a plant alone", bus_value(&bus, WIRE_HASH, HASH_VALUE),
               (double)(plant_hash(&alone) & 0xFFFFFFFFFFFFu), 0.0);
}

TEST(app_report_latency)
{
    bus_start_rig(&bus);
    bus_set(&bus, SETTING_FIRST + SET_ECHO_EVERY, 1);
    bus_run(&bus, 3);
    bus.counter[WIRE_STREAM] = 9;
    bus_forget(&bus);
    bus_stream(&bus, RIG_FORCE, bus.app.plant.now.tick / BUS_TICKS + 4, 1.0);
    bus_run(&bus, 4);
    check_int("before the frame it names: no LATENCY", bus_count(&bus, WIRE_LATENCY), 0);
    bus_run(&bus, 3);
    check_int("one LATENCY", bus_count(&bus, WIRE_LATENCY), 1);
    check_near("of the STREAM", bus_value(&bus, WIRE_LATENCY, LATENCY_MESSAGE), WIRE_STREAM, 0);
    check_near("with this counter", bus_value(&bus, WIRE_LATENCY, LATENCY_COUNTER), 9, 0);
    check_near("applied so many ticks after it came", bus_value(&bus, WIRE_LATENCY, LATENCY_APPLY),
               4 * BUS_TICKS, 0);
    check_near("told so many ticks after", bus_value(&bus, WIRE_LATENCY, LATENCY_SEND), BUS_TICKS, 0);
}

TEST(app_report_echo)
{
    const double value[MODEL_INPUTS][ARM_FIELDS] = {{12.5, 150.0, 0.5, 0.5, 2.5, 1.0, 7.0},
                                                    {3.0, 800.0, -0.25, 0.5, 1.5, 65535.0, 16777215.0},
                                                    {1e-7, 900.0, 1.0, 0.5, 1e-9, 64.0, 1.0},
                                                    {0.125, 700.0, 2.0, 0.5, 0.01, 3.0, 123456.0}};
    const int turn = 4 * ARM_FIELDS + INFO_ITEMS;
    struct app_config c = bus_config();
    c.dilation = 4.0;
    bus_start_running(&bus, &c);
    for (int i = 0; i < MODEL_INPUTS; i++)
        for (int k = 0; k < ARM_FIELDS; k++)
            bus_arm(&bus, i, (enum arm_field)k, value[i][k]);
    bus_fire(&bus, 15, false, BUS_TICKS, 0);
    bus_set(&bus, SETTING_FIRST + SET_ECHO_EVERY, 1);
    bus_run(&bus, turn + 2);
    double told[MODEL_INPUTS][ARM_FIELDS] = {{0}};
    for (int i = 0; i < bus.n_seen; i++) {
        const double *v = bus.seen[i].value;
        if (bus.seen[i].kind == WIRE_DRIVE_ECHO)
            told[(int)v[DRIVE_ECHO_CHANNEL]][(int)v[DRIVE_ECHO_FIELD]] = v[DRIVE_ECHO_VALUE];
    }
    for (int i = 0; i < MODEL_INPUTS; i++) {
        for (int k = 0; k < ARM_FIELDS; k++)
            if (k != ARM_RAMP)
                check_near("DRIVE_ECHO over what was commanded", told[i][k] / value[i][k], 1.0, 2e-7);
        check_is("ramp: what is left of it, s", told[i][ARM_RAMP], <, 0.5);
        check_is("ramp: what is left of it, s", told[i][ARM_RAMP], >, 0.5 - 1e-3 * (turn + 2));
    }
    double zs = pow(64.0 / 3.4e9, 2.0 / 3.0), f0 = sqrt(1.5 * 64.0 / (6.5 * zs)) / 6.283185307179586;
    check_near("INFO: version", bus_item(&bus, WIRE_INFO, INFO_VERSION), WIRE_VERSION, 0);
    check_near("INFO: frame rate, Hz", bus_item(&bus, WIRE_INFO, INFO_FRAME_RATE_HZ), 1000, 0);
    check_near("INFO: substeps", bus_item(&bus, WIRE_INFO, INFO_SUBSTEPS), BUS_TICKS, 0);
    check_near("INFO: dilation", bus_item(&bus, WIRE_INFO, INFO_DILATION), 4, 0);
    check_near("INFO: f0 real, Hz", bus_item(&bus, WIRE_INFO, INFO_F0_REAL_HZ), f0, 1e-7 * f0);
    check_near("INFO: f0 on the bus, Hz", bus_item(&bus, WIRE_INFO, INFO_F0_BUS_HZ), f0 / 4.0, 1e-7 * f0);
}

TEST(app_report_health)
{
    const int fault[] = {HAL_DROPPED, HAL_FOREIGN, HAL_BUS_OFF, HAL_ERROR_PASSIVE, HAL_DOWN};
    const int counter[] = {DIAG_RX_DROPPED, DIAG_RX_FOREIGN, DIAG_BUS_OFF, DIAG_BUS_PASSIVE, DIAG_BUS_DOWN};
    const struct app_config c = bus_config();
    for (int i = 0; i < 5; i++) {
        bus_start_running(&bus, &c);
        bus_run(&bus, 1);
        bus.wires.port[0].fault = fault[i];
        bus_run(&bus, 1);
        printf("      hal reports %d\n", fault[i]);
        for (int k = 0; k < 5; k++)
            check_int(diag_name[counter[k]].name, bus.app.count[counter[k]], k == i);
        bool serious = fault[i] == HAL_BUS_OFF || fault[i] == HAL_DOWN;
        check_int("fault bit", bus.app.faults, serious ? FAULT_BUS : 0);
        check_int("commands behind it are taken", bus.app.state, STATE_RUNNING);
    }
    bus_set(&bus, SETTING_FIRST + SET_HEALTH_EVERY, 1);
    bus_run(&bus, DIAG_COUNTERS + 1);
    int wrong = 0;
    for (unsigned i = 0; i < DIAG_COUNTERS; i++)
        wrong += isnan(bus_item(&bus, WIRE_HEALTH, i));
    check_int("counters that HEALTH does not tell in one turn", wrong, 0);
    check_near("frames_received is told", bus_item(&bus, WIRE_HEALTH, DIAG_FRAMES_RECEIVED),
               bus.app.count[DIAG_FRAMES_RECEIVED], DIAG_COUNTERS);
    check_near("bus_down is told", bus_item(&bus, WIRE_HEALTH, DIAG_BUS_DOWN), 1, 0);
    for (int i = 1; i <= DIAG_COUNTERS; i++) {
        bus_forget(&bus);
        bus_silent(&bus, 1);
        if (bus_value(&bus, WIRE_HEALTH, HEALTH_ITEM) == DIAG_COMMAND_AGE_FRAMES)
            check_near("age of the last heartbeat, frames", bus_value(&bus, WIRE_HEALTH, HEALTH_VALUE), i, 0);
    }
    /* More than a frame takes in: the rest waits, in order. */
    bus_start_running(&bus, &c);
    bus_run(&bus, 1);
    for (int i = 0; i < 300; i++)
        bus_arm(&bus, 0, ARM_AMPLITUDE, i);
    bus_silent(&bus, 1);
    check_near("of 300 frames in one go, the 256th", bus.app.mailbox.armed[0].value[0], 255, 0);
    check_int("counted", bus.app.count[DIAG_RX_BUDGET], 1);
    bus_silent(&bus, 1);
    check_near("and the last in the next", bus.app.mailbox.armed[0].value[0], 299, 0);
}

/* A bus that takes two frames a turn: the newest of each kind waits, in its place; all is counted. */
TEST(app_report_pressure)
{
    const struct app_config c = bus_config();
    bus_start_running(&bus, &c);
    bus_run(&bus, 5);
    bus.wires.port[0].tx_limit = 0;
    bus_forget(&bus);
    uint32_t deferred = bus.app.telemetry.deferred, replaced = bus.app.telemetry.replaced;
    bus_run(&bus, 50);
    deferred = bus.app.telemetry.deferred - deferred;
    replaced = bus.app.telemetry.replaced - replaced;
    check_int("no room at all: nothing seen", bus.n_seen, 0);
    check_int("kept = deferred - replaced", bus.app.telemetry.n_tx, deferred - replaced);
    check_above("deferred in 50 frames", deferred, 150);
    int twice = 0;
    for (uint32_t i = 0; i < bus.app.telemetry.n_tx; i++) {
        for (uint32_t k = 0; k < i; k++)
            twice += bus.app.telemetry.tx[i].id == bus.app.telemetry.tx[k].id;
    }
    check_int("kinds kept twice", twice, 0);
    uint32_t n = bus.app.telemetry.n_tx, first = bus.app.telemetry.tx[0].id;
    double frame = (double)(uint16_t)(bus.app.frame - 1), tick = (double)bus.app.plant.now.tick;
    bus.wires.port[0].tx_limit = UINT32_MAX;
    bus.app.state = STATE_STOPPED; /* nothing new but what is due anyway, and an answer */
    bus_stream(&bus, RIG_FORCE, 0, 1.0);
    bus_silent(&bus, 1);
    check_int("room again: what waited comes first, in its order", 0x200 + bus.seen[0].kind, (int)first);
    double sync_frame = -1.0, sync_tick = -1.0;
    for (uint32_t i = 0; i < n; i++) {
        if (bus.seen[i].kind == WIRE_SYNC)
            sync_frame = bus.seen[i].value[SYNC_FRAME], sync_tick = bus.seen[i].value[SYNC_TICK];
    }
    check_near("the SYNC that waited is the newest: frame", sync_frame, frame, 0);
    check_near("tick", sync_tick, tick, 0);
    check_int("nothing waits any more", bus.app.telemetry.n_tx, 0);
    bus_forget(&bus);
    bus_silent(&bus, 1);
    check_near("and nothing old comes later: SYNC", bus_value(&bus, WIRE_SYNC, SYNC_FRAME),
               (double)(uint16_t)(bus.app.frame - 1), 0);
    check_int("one SYNC", bus_count(&bus, WIRE_SYNC), 1);
    /* Some room: in the long run every kind gets through. */
    bus_start_running(&bus, &c);
    bus_run(&bus, 5);
    bus.wires.port[0].tx_limit = 2;
    bus_forget(&bus);
    bus_run(&bus, 400);
    int starved = 0;
    for (unsigned kind = WIRE_STATUS; kind <= WIRE_INFO; kind++) {
        bool periodic = kind == WIRE_STATUS || kind == WIRE_MOTION || kind == WIRE_CONTACT ||
                        kind == WIRE_SYNC || kind == WIRE_LEDGER || kind == WIRE_HEALTH ||
                        kind == WIRE_EVENT_SUMMARY;
        starved += periodic && bus_count(&bus, kind) == 0;
    }
    check_int("two frames a turn: kinds that never come", starved, 0);
    check_int("frames seen in 400 turns", bus.n_seen, 800);
    double last = bus_value(&bus, WIRE_SYNC, SYNC_FRAME);
    check_above("the last SYNC is younger than 12 frames", last, (double)(bus.app.frame - 12));
}

/* Counters of telemetry: each kind for itself, one more with each frame. */
TEST(app_report_kinds)
{
    struct plant alone;
    int seen[WIRE_KINDS], wrong = 0;
    memset(seen, -1, sizeof seen);
    start_bouncing(&alone);
    for (int i = 0; i < 20; i++) {
        bus_forget(&bus);
        bus_run(&bus, 100);
        for (int k = 0; k < bus.n_seen; k++) {
            const struct message *m = &bus.seen[k];
            if (seen[m->kind] >= 0)
                wrong += m->counter != (seen[m->kind] + 1) % WIRE_COUNTER_STATES;
            seen[m->kind] = m->counter;
        }
    }
    check_int("telemetry counters that do not advance by one", wrong, 0);
    check_int("healthy called once a frame", bus.wires.port[0].healthy, (int)bus.app.frame);
}
