/* test_replay.c - the replay source by hand, and a whole run: recorded under overruns and bus faults, it
 * replays to equal telemetry and an equal plant. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "firmware/plant/plant_report.h"
#include "firmware/stage/stages.h"
#include "hal/link/faults.h"
#include "hal/posix/log.h"
#include "hal/posix/log_read.h"
#include "host_sim/replay/replay_source.h"
#include "host_sim/live/fault_list.h"
#include "tests/fixture/bus.h"
#include "tests/fixture/fault_lists.h"
#include "tests/unit/test.h"

enum { FRAMES = 400, FAULT_AT = 150, LINES = 8000 };

static struct loopback_bus wires;
static struct bus bus;
static struct log record;
static struct replay replay;
static struct app replayed;
static struct stages stages, replayed_stages;
static float replayed_capture[BUS_CAPTURE];
static uint64_t deferred[1]; /* line of a log taken on the bus that goes one frame later */
static char path[] = "/tmp/contactplant_replay_XXXXXX";

/* A file of its own for each test. */
static void make_file(const char *text)
{
    memcpy(path + strlen(path) - 6, "XXXXXX", 6);
    FILE *f = fdopen(mkstemp(path), "w");
    fputs(text, f);
    fclose(f);
}

/* A line without a mark. */
static int put_line(char *text, uint64_t time_us, const char *interface, const struct frame *f, int fault)
{
    struct log_line l = {.time_us = time_us, .frame = *f, .fault = fault};
    snprintf(l.interface, sizeof l.interface, "%s", interface);
    return log_format(text, &l);
}

/* ---- the source by itself ---- */

static const struct wire_scene scene = {.base_id = 0x240, .lsb = {1e-9, 1e-6, 1e-9, 1e-3}};

static struct frame message(unsigned kind, double first, double second)
{
    struct message m = {.kind = (uint8_t)kind, .counter = 5, .value = {first, second}};
    struct frame f;
    wire_encode(&scene, &m, &f);
    return f;
}

/* HEALTH stands for the messages that may differ from one machine to another. */
static bool is_health(const struct message *m)
{
    return m->kind == WIRE_HEALTH;
}

/* Frame 0: a command and its answer. Frame 2: a fault, two
 * commands, a health report. Frame 3: two missed before. */
static void record_three_frames(void)
{
    make_file("");
    loopback_init(&wires, 2, 8);
    check_no_error("recording opens", log_open(&record, path, "can0", &wires.port[0].hal));
    struct frame stop = {.id = 0x242, .length = 1}, other = {.id = 0x282, .length = 1}, got;
    struct frame sync = message(WIRE_SYNC, 1, 64), overrun = message(WIRE_OVERRUN, 2, 3);
    struct frame health = message(WIRE_HEALTH, 1, 10);
    struct hal *h = &record.hal;
    log_set_frame(&record, 0, 1e-3);
    wires.port[1].hal.send(&wires.port[1], &stop);
    h->recv(h->context, &got);
    h->send(h->context, &sync);
    log_set_frame(&record, 2, 1e-3);
    wires.port[0].fault = HAL_DROPPED;
    h->recv(h->context, &got);
    wires.port[1].hal.send(&wires.port[1], &stop);
    wires.port[1].hal.send(&wires.port[1], &other);
    wires.port[1].hal.send(&wires.port[1], &stop);
    for (int i = 0; i < 3; i++)
        h->recv(h->context, &got);
    h->send(h->context, &health);
    log_set_frame(&record, 3, 1e-3);
    log_missed(&record, 2);
    h->send(h->context, &overrun);
    h->send(h->context, &sync);
    check_no_error("recording closes", log_close(&record));
}

static int64_t replay_recv(void)
{
    struct frame f;
    int got = replay.hal.recv(replay.hal.context, &f);
    return got > 0 ? (int64_t)f.id : got;
}

static void replay_send(unsigned kind, double first, double second)
{
    struct frame f = message(kind, first, second);
    check_int("the replay takes it", replay.hal.send(replay.hal.context, &f), 1);
}

TEST(replay_frames)
{
    record_three_frames();
    check_no_error("replay opens", replay_open(&replay, path, NULL, &scene, 1e-3, is_health));
    check_int("frame 0", replay_frame(&replay, 0), 1);
    check_int("its command", replay_recv(), 0x242);
    check_int("no other yet", replay_recv(), 0);
    replay_send(WIRE_SYNC, 1, 64);
    check_no_error("its answer is the recorded one", replay_check(&replay));
    check_int("frame 1", replay_frame(&replay, 1), 1);
    check_int("has nothing", replay_recv(), 0);
    check_no_error("and is sent nothing", replay_check(&replay));
    check_int("frame 2", replay_frame(&replay, 2), 1);
    check_int("the fault", replay_recv(), -HAL_DROPPED);
    check_int("first command", replay_recv(), 0x242);
    check_int("another plant's, which counts as received", replay_recv(), 0x282);
    check_int("second command", replay_recv(), 0x242);
    check_int("no more", replay_recv(), 0);
    replay_send(WIRE_HEALTH, 1, 99);
    check_no_error("an excluded message may differ", replay_check(&replay));
    check_int("no overrun before frame 2", replay.missed, 0);
    check_int("frame 3", replay_frame(&replay, 3), 1);
    check_int("frame periods missed before frame 3", replay.missed, 2);
    replay_send(WIRE_OVERRUN, 2, 3);
    replay_send(WIRE_SYNC, 1, 64);
    check_no_error("equal to the end", replay_check(&replay));
    check_int("the log ends", replay_frame(&replay, 4), 0);
    check_int("received, faults included", (int64_t)replay.commands, 5);
    check_int("compared", (int64_t)replay.compared, 3);
    check_int("excluded", (int64_t)replay.excluded_lines, 1);
    check_int("of others", (int64_t)replay.passed_over, 1);
    replay_close(&replay);
    unlink(path);
}

/* Replays frame 0 of the recording and sends what `send_all` says; the difference must name `part`. */
static void difference(const char *name, int n_sync, double tick, const char *part)
{
    record_three_frames();
    check_no_error("replay opens", replay_open(&replay, path, NULL, &scene, 1e-3, is_health));
    replay_frame(&replay, 0);
    for (int i = 0; i < n_sync; i++)
        replay_send(WIRE_SYNC, 1, tick);
    const char *reason = replay_check(&replay);
    printf("%s\n", reason ? reason : "(equal)");
    check_contains(name, reason, part);
    replay_close(&replay);
    unlink(path);
}

static void bad_log(const char *name, const char *text, const char *part)
{
    make_file(text);
    check_no_error("replay opens", replay_open(&replay, path, NULL, &scene, 1e-3, NULL));
    int got = 1;
    for (uint64_t frame = 0; frame < 10 && got > 0; frame++)
        got = replay_frame(&replay, frame);
    printf("%s\n", replay.reason);
    check_int(name, got, -1);
    check_contains("the reason", replay.reason, part);
    replay_close(&replay);
    unlink(path);
}

TEST(replay_differences)
{
    difference("a changed byte", 1, 65, ":3: frame 0: recorded 256#");
    difference("a missing frame", 0, 0, "replay sent nothing");
    difference("a frame too many", 2, 64, "recorded nothing, replay sent 256#");
    bad_log("a stamp between frames", "(1.001000) c 241#\n(1.001500) c 241#\n", ":2: the time stamp");
    bad_log("a stamp that goes back", "(1.002000) c 241#\n(1.001000) c 241#\n", ":2: the time stamp");
    check_error("no such log", replay_open(&replay, "/nosuchdir/x", NULL, &scene, 1e-3, NULL));
}

/* A frame 0 whose second send, a SYNC, was refused. Replays it with this second send, a SYNC whose number is
 * `beside` more: the reason why it differs, or NULL. */
static const char *replay_refused(unsigned beside, double tick)
{
    struct frame sync = message(WIRE_SYNC, 1, 64), f = message(WIRE_SYNC, 1, tick);
    f.id += beside;
    make_file("");
    loopback_init(&wires, 2, 8);
    check_no_error("recording opens", log_open(&record, path, "can0", &wires.port[0].hal));
    log_set_frame(&record, 0, 1e-3);
    check_int("the first is sent", record.hal.send(record.hal.context, &sync), 1);
    wires.port[0].tx_limit = 1;
    check_int("the second has no room", record.hal.send(record.hal.context, &sync), 0);
    check_no_error("recording closes", log_close(&record));
    check_no_error("replay opens", replay_open(&replay, path, NULL, &scene, 1e-3, is_health));
    check_int("frame 0", replay_frame(&replay, 0), 1);
    replay_send(WIRE_SYNC, 1, 64);
    check_int("the replay refuses it, too", replay.hal.send(replay.hal.context, &f), 0);
    const char *reason = replay_check(&replay);
    replay_close(&replay);
    unlink(path);
    return reason;
}

/* A refused frame is compared with the one that would have been sent: by its number, and by its bytes. */
TEST(replay_refused)
{
    check_no_error("the same", replay_refused(0, 64));
    check_contains("other bytes", replay_refused(0, 65), "message 0x16, which was refused");
    check_contains("another number", replay_refused(1, 64), "message 0x16, which was refused");
}

/* Frames of nobody's in a log without marks are passed over. */
TEST(replay_others)
{
    make_file("(1.000000) c 300#00\n(1.000000) c 242#00\n");
    check_no_error("replay opens", replay_open(&replay, path, NULL, &scene, 1e-3, NULL));
    check_int("frame 0", replay_frame(&replay, 0), 1);
    check_int("its command", replay_recv(), 0x242);
    check_int("and nothing else", replay_recv(), 0);
    check_no_error("the plant need not send it", replay_check(&replay));
    check_int("passed over", (int64_t)replay.passed_over, 1);
    replay_close(&replay);
    unlink(path);
}

/* ---- a whole run ---- */

/* Frame periods missed before turn i: short ones, and one beyond what a catch-up makes up. */
static uint32_t missed_before(int i)
{
    return i == 200 ? 1 : i == 220 ? 3 : i == 300 ? 150 : 0;
}

static void record_turn(struct app *a, uint32_t missed)
{
    log_set_frame(&record, a->frame, a->config.frame_s);
    log_missed(&record, missed);
    uint32_t due = app_overrun(a, missed);
    for (int i = 0; due > 0; i++) {
        log_set_frame(&record, a->frame, a->config.frame_s);
        app_frame(a);
        if (--due > 0 && i % 2) { /* while frames are made up, periods begin */
            log_set_frame(&record, a->frame, a->config.frame_s);
            log_missed(&record, 1);
            due = app_overrun(a, 1);
        }
    }
}

static void command_turn(int i)
{
    bus_enable(&bus, true);
    if (i == 20)
        bus_order(&bus, CONTROL_START);
    if (i == 30) {
        bus_drive(&bus, RIG_FORCE, 20.0, 250.0, 0.5, 0.05);
        bus_arm(&bus, RIG_FORCE, ARM_NOISE, 5.0);
        bus_arm(&bus, RIG_FORCE, ARM_NOISE_SEED, 99.0);
    }
    if (i == 31)
        bus_fire(&bus, 1u << RIG_FORCE, false, bus.app.plant.now.tick + 37, 100);
    if (i == 50)
        bus_set(&bus, SETTING_FIRST + SET_SENSOR_NOISE, 1e-9);
    if (i == 60) { /* an actuator with a resonance, and a noisy sensor */
        bus_set(&bus, SETTING_FIRST + SET_STAGE + STAGE_SET_RESONANCE, 300.0);
        bus_set(&bus, SETTING_FIRST + SET_STAGE + STAGE_AT, 1.0 + RIG_FORCE);
        bus_set(&bus, SETTING_FIRST + SET_STAGE + STAGE_SETTINGS + STAGE_SET_NOISE, 1e-9);
        bus_set(&bus, SETTING_FIRST + SET_STAGE + STAGE_SETTINGS + STAGE_AT, 1.0 + MODEL_INPUTS);
        bus_set(&bus, SETTING_FIRST + SET_LOCKIN_OUTPUT + 1, 1.0 + MODEL_OUTPUTS);
    }
    if (i == 100) /* refused: no such parameter */
        bus_write(&bus, 63, 1.0);
}

/* Records FRAMES turns under this overrun policy; returns the state hash at the end. */
static uint64_t make_recording(enum overrun_policy policy)
{
    struct app_config c = bus_config();
    c.stage_calls = &stages_for_plants;
    c.stages = &stages;
    make_file("");
    bus_start(&bus, &c);
    check_no_error("recording opens", log_open(&record, path, "can0", bus.app.hal));
    bus.app.hal = &record.hal;
    for (int i = 0; i < FRAMES; i++) {
        if (i == 10)
            bus_set(&bus, SETTING_FIRST + SET_OVERRUN_POLICY, policy);
        command_turn(i);
        bus.wires.port[0].fault = i == FAULT_AT ? HAL_DROPPED | HAL_BUS_OFF : 0;
        record_turn(&bus.app, missed_before(i));
        bus_collect(&bus);
        bus_forget(&bus);
    }
    check_no_error("recording closes", log_close(&record));
    return plant_hash(&bus.app.plant);
}

static bool is_timing(const struct message *m)
{
    return m->kind == WIRE_HEALTH && m->value[HEALTH_ITEM] >= DIAG_COMPUTE_MAX_US &&
           m->value[HEALTH_ITEM] <= DIAG_LATENESS_MAX_FRAME;
}

/* The loop of replay.h. Returns the first difference or
 * what is wrong with the log; NULL when all is equal. */
static const char *replay_all(void)
{
    struct app_config c = bus_config();
    const char *difference = NULL;
    int got;
    c.capture = replayed_capture;
    c.n_capture = BUS_CAPTURE;
    c.stage_calls = &stages_for_plants;
    c.stages = &replayed_stages;
    if (app_init(&replayed, &c, &replay.hal) ||
        replay_open(&replay, path, NULL, &replayed.scene, c.frame_s, is_timing))
        return "cannot begin";
    replay_defer(&replay, deferred, 1);
    while (!difference && (got = replay_frame(&replay, replayed.frame)) > 0) {
        (void)!app_overrun(&replayed, replay.missed);
        if (replayed.frame != replay.frame)
            got = replay_frame(&replay, replayed.frame);
        app_frame(&replayed);
        difference = replay_check(&replay);
    }
    replay_close(&replay);
    return difference ? difference : got < 0 ? replay.reason : NULL;
}

TEST(replay_run)
{
    static const char *const name[] = {"catch_up", "skip", "freeze", "stop"};
    for (int policy = OVERRUN_CATCH_UP; policy <= OVERRUN_STOP; policy++) {
        printf("policy %s\n", name[policy]);
        uint64_t hash = make_recording((enum overrun_policy)policy);
        const char *difference = replay_all();
        check_string("difference", difference ? difference : "none", "none");
        check_hex("state of the replayed plant", plant_hash(&replayed.plant), hash);
        check_true("with its stages", replayed.plant.staged);
        check_int("its bus frame", (int64_t)replayed.frame, (int64_t)bus.app.frame);
        check_int("overruns it counted", replayed.count[DIAG_OVERRUNS], bus.app.count[DIAG_OVERRUNS]);
        check_int("while frames were made up, too", replayed.count[DIAG_OVERRUNS] > 3,
                  policy == OVERRUN_CATCH_UP);
        check_int("bus-off it counted", replayed.count[DIAG_BUS_OFF], 1);
        check_above("messages compared", (double)replay.compared, FRAMES);
        check_int("drives it fired", replayed.count[DIAG_FIRE_APPLIED], 1);
        unlink(path);
    }
}

/* ---- what makes a log of a healthy plant differ from what the plant would do alone ---- */

static struct faults faults;

/* Over the bad link of this list, if any, recorded between plant and link. */
static void begin_recording(const char *list, uint64_t seed)
{
    struct app_config c = bus_config();
    char why[FAULT_LIST_REASON];
    c.stage_calls = &stages_for_plants;
    c.stages = &stages;
    make_file("");
    bus_start(&bus, &c);
    faults_init(&faults, bus.app.hal, seed);
    check_true("the list is good", !*list || fault_list_read(&faults, list, 1e-3, why));
    check_no_error("recording opens", log_open(&record, path, "can0", &faults.hal));
    bus.app.hal = &record.hal;
    bus_set(&bus, SETTING_FIRST + SET_HEALTH_EVERY, 1);
}

/* Anything that may come: a stray frame under an identifier of
 * telemetry, frames of others, of other lengths, in both formats. */
static void put_strays(int i)
{
    struct message m = {.kind = WIRE_MOTION, .counter = (uint8_t)(i % WIRE_COUNTER_STATES)};
    struct frame f;
    wire_encode(&bus.scene, &m, &f);
    if (i % 7 == 3)
        bus_put(&bus, &f);
    m.kind = WIRE_OVERRUN;
    m.value[OVERRUN_MISSED] = 7;
    wire_encode(&bus.scene, &m, &f);
    if (i % 11 == 5)
        bus_put(&bus, &f);
    f = (struct frame){.id = 0x222, .length = 2, .data = {1, 2}}; /* SELF_TEST, cut */
    if (i % 13 == 1)
        bus_put(&bus, &f);
    f = (struct frame){.id = 0x202, .length = 8, .flags = FRAME_EXTENDED}; /* in the other format */
    if (i % 17 == 2)
        bus_put(&bus, &f);
    f = (struct frame){.id = 0x700, .length = 1};
    for (int k = 0; i % 50 == 10 && k < APP_RECV_BUDGET; k++) /* as many as a frame takes */
        bus_put(&bus, &f);
}

static void record_session(bool strays)
{
    for (int i = 0; i < FRAMES; i++) {
        if (i == 300 && !bus.app.enabled) { /* the bad link may have ended the session */
            bus.session++;
            memset(bus.counter, 0, sizeof bus.counter);
        }
        command_turn(i);
        if (i == 310)
            bus_order(&bus, CONTROL_START);
        if (strays)
            put_strays(i);
        record_turn(&bus.app, i % 90 == 60 ? (uint32_t)i / 45 : 0);
        bus_collect(&bus);
        bus_forget(&bus);
    }
    check_no_error("recording closes", log_close(&record));
}

/* Whatever was received is received again and counts as it did. */
TEST(replay_received)
{
    begin_recording("", 1);
    record_session(true);
    const char *difference = replay_all();
    check_string("difference", difference ? difference : "none", "none");
    check_hex("state of the replayed plant", plant_hash(&replayed.plant), plant_hash(&bus.app.plant));
    check_int("frames under identifiers of telemetry: 57 MOTIONs, 36 OVERRUNs",
              replayed.count[DIAG_UNKNOWN_ID], 93);
    check_above("frames in which the bound was reached by frames of others", replayed.count[DIAG_RX_BUDGET],
                5);
    int differ = 0;
    for (int i = 0; i < DIAG_COUNTERS; i++)
        differ += i < DIAG_COMPUTE_MAX_US && replayed.count[i] != bus.app.count[i];
    check_int("counters that differ", differ, 0);
    unlink(path);
}

/* Some of these, by the seed; each of the first twelve seeds has one for certain. */
static void make_list(char *list, size_t size, unsigned seed)
{
    static const char *const kind[] = {"refuse=%.2f@.01:.4",  "bus-off@.12:.14",    "drop=%.2f",
                                       "duplicate=%.2f",      "repeat=%.2f@.04:.2", "reorder=%.2f@.04:.2",
                                       "truncate=%.2f@.1:.2", "flip=%.2f@.1:.2",    "delay=%.2f:30@.1:.2",
                                       "in.freeze@.06:.1",    "out.freeze@.15:.19", "burst=17@.1:.2"};
    fault_list_draw(list, size, kind, sizeof kind / sizeof kind[0], seed);
}

TEST(replay_faults)
{
    enum { SEEDS = 120 };
    int differ = 0, moved = 0, refused = 0, off = 0;
    for (unsigned seed = 1; seed <= SEEDS; seed++) {
        char list[512];
        make_list(list, sizeof list, seed);
        begin_recording(list, seed);
        record_session(false);
        const char *difference = replay_all();
        if (difference)
            printf("%s\n    %s\n", list, difference);
        differ += difference != NULL;
        moved += plant_hash(&replayed.plant) != plant_hash(&bus.app.plant);
        refused += bus.app.telemetry.deferred > 0;
        off += bus.app.count[DIAG_BUS_OFF] > 0;
        unlink(path);
    }
    printf("%d lists, %d with refused sends, %d with bus-off\n", SEEDS, refused, off);
    check_int("logs that do not replay", differ, 0);
    check_int("plants that end in another state", moved, 0);
    check_above("lists with refused sends", refused, 50);
    check_above("lists with bus-off", off, 30);
}

/* Changes the first line whose identifier is `id` in byte `at` of its data. */
static void tamper(const char *id, int at)
{
    static char text[1 << 20];
    FILE *f = fopen(path, "r+");
    size_t n = fread(text, 1, sizeof text - 1, f);
    text[n] = 0;
    char *hit = strstr(text, id);
    check_true("there is a line to change", hit != NULL);
    if (hit)
        hit[strlen(id) + (size_t)(2 * at)] ^=
            1; /* 0..9 stay digits, A B, C D, E F stay what they are but in order */
    rewind(f);
    fwrite(text, 1, n, f);
    fclose(f);
}

TEST(replay_tampered)
{
    (void)make_recording(OVERRUN_CATCH_UP);
    tamper("214#", 4);
    const char *difference = replay_all();
    printf("%s\n", difference ? difference : "(equal)");
    check_contains("one changed digit of telemetry is found", difference, "recorded 214#");
    unlink(path);
    (void)make_recording(OVERRUN_CATCH_UP);
    tamper("200#", 5); /* FIRE: its checksum no longer fits, so the drive does not start */
    difference = replay_all();
    printf("%s\n", difference ? difference : "(equal)");
    check_error("a changed command changes the run", difference);
    unlink(path);
}

/* ---- logs taken on the bus ---- */

static struct log_line line[LINES];

/* The recording as candump saw it: the same lines under wall-clock stamps. The first `id`, if any, stands
 * before the SYNC before it, as when it came while the plant was in its frame. Returns that line's number. */
static uint64_t take_on_bus(const char *id)
{
    static struct log_reader reader;
    uint64_t moved = 0;
    int n = 0, at = 0;
    char text[LOG_LINE_MAX];
    check_no_error("the recording opens", log_reader_open(&reader, path));
    while (n < LINES && log_read_line(&reader, &line[n]) > 0)
        n += line[n].way != LOG_OVERRUN; /* which is told to the recorder only */
    log_reader_close(&reader);
    FILE *f = fopen(path, "w");
    for (int i = 0; i < n; i++) {
        put_line(text, PLANT_LOG_EPOCH_US + (uint64_t)i * 7, "vcan0", &line[i].frame, line[i].fault);
        if (id && !moved && strstr(text, id)) {
            struct log_line command = line[i];
            memmove(&line[at + 1], &line[at], (size_t)(i - at) * sizeof line[0]);
            line[at] = command;
            moved = (uint64_t)at + 1;
        }
        at = strstr(text, " 216#") && !moved ? i : at;
    }
    for (int i = 0; i < n; i++) {
        put_line(text, PLANT_LOG_EPOCH_US + (uint64_t)i * 7, "vcan0", &line[i].frame, line[i].fault);
        fputs(text, f);
    }
    fclose(f);
    return moved;
}

TEST(replay_on_bus)
{
    for (int policy = OVERRUN_CATCH_UP; policy <= OVERRUN_STOP; policy++) {
        printf("policy %d\n", policy);
        (void)make_recording((enum overrun_policy)policy);
        (void)take_on_bus(NULL);
        const char *difference = replay_all();
        check_string("difference", difference ? difference : "none", "none");
        check_int("frames, the last one left out", (int64_t)replayed.frame, (int64_t)bus.app.frame - 1);
        check_int("drives it fired", replayed.count[DIAG_FIRE_APPLIED], 1);
        check_int("overruns it counted", replayed.count[DIAG_OVERRUNS], bus.app.count[DIAG_OVERRUNS]);
        unlink(path);
    }
    (void)make_recording(OVERRUN_CATCH_UP);
    uint64_t moved = take_on_bus(" 202#");
    const char *difference = replay_all();
    printf("%s\n", difference ? difference : "(equal)");
    check_error("a start that stands one frame early is a difference", difference);
    bool named = false;
    for (int i = 0; i < LOG_BUS_DOUBTFUL; i++)
        named = named || replay.bus.doubtful[i] == moved;
    check_true("its line is among the doubtful ones", named);
    deferred[0] = moved;
    difference = replay_all();
    check_string("one frame later there is none", difference ? difference : "none", "none");
    check_int("to the end", (int64_t)replayed.frame, (int64_t)bus.app.frame - 1);
    deferred[0] = 0;
    unlink(path);
}

static void sync_line(char *text, uint32_t frame)
{
    struct frame f = message(WIRE_SYNC, frame, 64.0 * frame);
    put_line(text, PLANT_LOG_EPOCH_US + frame, "vcan0", &f, 0);
}

/* A heartbeat has no answer behind it and may be the last command for long: it must not wait for one. */
TEST(replay_on_bus_unanswered)
{
    char text[LOG_LINE_MAX * 8] = "";
    struct frame f = message(WIRE_ENABLE, 1, 0);
    for (uint32_t i = 0; i < 6; i++) {
        if (i == 1)
            put_line(text + strlen(text), PLANT_LOG_EPOCH_US, "vcan0", &f, 0);
        sync_line(text + strlen(text), i);
    }
    make_file(text);
    for (uint64_t late = 0; late < 3; late++) {
        const uint64_t lines[2] = {2, 2};
        check_no_error("replay opens", replay_open(&replay, path, NULL, &scene, 1e-3, NULL));
        replay_defer(&replay, lines, (uint32_t)late);
        uint64_t frame = 0;
        while (replay_frame(&replay, frame) > 0 && !replay.n_commands)
            frame++;
        check_int("frame of the command that stands before SYNC 1", (int64_t)frame, (int64_t)(1 + late));
        replay_close(&replay);
    }
    unlink(path);
}

/* Two commands that the plant takes in frames 1 and 3, while what it says waits for the wire: the REPLY to
 * the first one says nothing of the second. */
TEST(replay_on_bus_answered)
{
    char text[LOG_LINE_MAX * 9] = "";
    struct message m = {.kind = WIRE_REPLY, .value = {0, WIRE_CONTROL, CAUSE_OK, 5}};
    struct frame first = message(WIRE_CONTROL, 1, 0), second, reply;
    wire_encode(&scene, &m, &reply);
    m = (struct message){.kind = WIRE_CONTROL, .counter = 6};
    wire_encode(&scene, &m, &second);
    sync_line(text, 0);
    put_line(text + strlen(text), PLANT_LOG_EPOCH_US, "vcan0", &first, 0);
    put_line(text + strlen(text), PLANT_LOG_EPOCH_US, "vcan0", &second, 0);
    put_line(text + strlen(text), PLANT_LOG_EPOCH_US, "vcan0", &reply, 0);
    for (uint32_t i = 1; i < 6; i++)
        sync_line(text + strlen(text), i);
    make_file(text);
    const uint64_t lines[4] = {2, 3, 3, 2};
    const uint32_t commands[6] = {0, 1, 0, 1, 0, 0};
    check_no_error("replay opens", replay_open(&replay, path, NULL, &scene, 1e-3, NULL));
    replay_defer(&replay, lines, 4);
    for (uint64_t frame = 0; replay_frame(&replay, frame) > 0; frame++) {
        check_int("commands of a frame", replay.n_commands, commands[frame]);
        check_int("its SYNC, and in frame 1 the REPLY", replay.n_telemetry, 1 + (frame == 1));
    }
    check_int("doubtful", (int64_t)replay.bus.n_doubtful, 1);
    check_int("namely the second command", (int64_t)replay.bus.doubtful[0], 3);
    replay_close(&replay);
    unlink(path);
}

/* A sample acts up to 64 frames after it came, when 31 more may
 * wait and every frame had a heartbeat: it is still doubtful then. */
TEST(replay_on_bus_doubt)
{
    enum { AHEAD = 64, WAITING = 32 };
    static char text[LOG_LINE_MAX * 3 * (AHEAD + 2)];
    struct frame sample = message(WIRE_STREAM, AHEAD, 1.0), beat = message(WIRE_ENABLE, 1, 0);
    char *end = text;
    for (uint32_t i = 0; i < AHEAD + 2; i++) {
        sync_line(end, i);
        end += strlen(end);
        if (i < WAITING)
            end += put_line(end, PLANT_LOG_EPOCH_US, "vcan0", &sample, 0);
        end += put_line(end, PLANT_LOG_EPOCH_US, "vcan0", &beat, 0);
    }
    make_file(text);
    check_no_error("replay opens", replay_open(&replay, path, NULL, &scene, 1e-3, NULL));
    for (uint64_t frame = 0; replay_frame(&replay, frame) > 0;)
        frame++;
    bool named = false;
    for (int i = 0; i < LOG_BUS_DOUBTFUL; i++)
        named = named || replay.bus.doubtful[i] == 2;
    check_int("commands seen", (int64_t)replay.bus.n_doubtful, AHEAD + 1 + WAITING);
    check_true("the first sample is among the doubtful ones", named);
    replay_close(&replay);
    unlink(path);
}

static void refused_log(const char *name, const char *text, const char *part)
{
    make_file(text);
    check_no_error("replay opens", replay_open(&replay, path, NULL, &scene, 1e-3, NULL));
    int got = replay_frame(&replay, 0);
    for (uint64_t i = 1; got > 0; i++)
        got = replay_frame(&replay, i);
    printf("%s\n", replay.reason);
    check_int(name, got, -1);
    check_contains(name, replay.reason, part);
    replay_close(&replay);
    unlink(path);
}

TEST(replay_on_bus_refused)
{
    char text[LOG_LINE_MAX * 4] = "(1700000000.000000) vcan0 700#00\n";
    sync_line(text + strlen(text), 3);
    refused_log("candump came too late", text, ":2: the plant is past its first frame");
    sync_line(text, 0);
    sync_line(text + strlen(text), 1);
    sync_line(text + strlen(text), 3);
    refused_log("a SYNC is missing", text, ":3: a frame without SYNC");
    static char many[LOG_LINE_MAX * (LOG_BUS_LINES + 2)];
    const struct frame command = message(WIRE_ENABLE, 1, 0);
    sync_line(many, 0);
    for (int i = 0, n = (int)strlen(many); i <= LOG_BUS_LINES; i++)
        n += put_line(many + n, PLANT_LOG_EPOCH_US, "vcan0", &command, 0);
    refused_log("a SYNC that never comes", many, ":1026: more than 1024 lines without a SYNC");
}

/* Frames of others are counted and passed over; what a plant
 * said before this one's first frame is not this one's. */
TEST(replay_on_bus_others)
{
    char text[LOG_LINE_MAX * 12] = "";
    static const char other[] = "(1700000000.000000) vcan0 700#00\n(1700000000.000000) vcan0 00000214#00\n";
    struct frame motion = message(WIRE_MOTION, 1, 0);
    strcat(text, other);
    put_line(text + strlen(text), PLANT_LOG_EPOCH_US, "vcan0", &motion, 0);
    for (uint32_t i = 0; i < 3; i++) {
        sync_line(text + strlen(text), i);
        strcat(text, other);
    }
    make_file(text);
    check_no_error("replay opens", replay_open(&replay, path, NULL, &scene, 1e-3, NULL));
    uint32_t telemetry = 0;
    for (uint64_t i = 0; replay_frame(&replay, i) > 0; i++)
        telemetry += replay.n_telemetry;
    check_int("lines of others passed over", (int64_t)replay.passed_over, 8);
    check_int("lines of the plant: two SYNCs, the last frame left out", telemetry, 2);
    replay_close(&replay);
    unlink(path);
}
