/* test_replay.c - a run recorded under overruns and bus faults replays to equal telemetry and an equal plant. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "hal/log.h"
#include "hal/replay.h"
#include "tests/bus.h"
#include "tests/test.h"

void test_replay_run(void);
void test_replay_tampered(void);

enum { FRAMES = 400, FAULT_AT = 150 };

static struct bus bus;
static struct log record;
static struct replay replay;
static struct app again;
static float again_capture[BUS_CAPTURE];
static char path[] = "/tmp/contactplant_replay_XXXXXX";

/* Frame periods missed before turn i: short ones, and one beyond what a catch-up makes up. */
static uint32_t missed_before(int i)
{
    return i == 200 ? 1 : i == 220 ? 3 : i == 300 ? 150 : 0;
}

static void record_turn(struct app *a, uint32_t missed)
{
    log_set_frame(&record, a->frame, a->config.frame_s);
    uint32_t due = app_overrun(a, missed);
    for (uint32_t i = 0; i < due; i++) {
        log_set_frame(&record, a->frame, a->config.frame_s);
        app_frame(a);
    }
}

static void command_turn(int i)
{
    bus_enable(&bus, true);
    if (i == 20)
        bus_order(&bus, CONTROL_START);
    if (i == 30)
        bus_drive(&bus, RIG_FORCE, 20.0, 250.0, 0.5, 0.05);
    if (i == 31)
        bus_fire(&bus, 1u << RIG_FORCE, false, bus.app.plant.now.tick + 37, 100);
    if (i == 100) /* refused: no such parameter */
        bus_write(&bus, 63, 1.0);
}

/* Records FRAMES turns under this overrun policy; returns the state hash at the end. */
static uint64_t make_recording(enum overrun_policy policy)
{
    const struct app_config c = bus_config();
    memcpy(path + strlen(path) - 6, "XXXXXX", 6);
    close(mkstemp(path));
    bus_start(&bus, &c);
    check_true("recording opens", log_open(&record, path, "can0", bus.app.hal) == NULL);
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
    check_true("recording closes", log_close(&record) == NULL);
    return plant_hash(&bus.app.plant);
}

static bool is_timing(const struct message *m)
{
    return m->kind == WIRE_HEALTH && m->value[HEALTH_ITEM] >= DIAG_COMPUTE_MAX_US;
}

/* The loop of replay.h. Returns the first difference or what is wrong with the log; NULL when all is equal. */
static const char *replay_all(void)
{
    struct app_config c = bus_config();
    const char *difference = NULL;
    int got;
    c.capture = again_capture;
    c.n_capture = BUS_CAPTURE;
    if (app_init(&again, &c, &replay.hal) || replay_open(&replay, path, &again.scene, c.frame_s, is_timing))
        return "cannot begin";
    while (!difference && (got = replay_frame(&replay, again.frame)) > 0) {
        uint32_t due = replay.missed ? app_overrun(&again, replay.missed) : 1;
        for (uint32_t i = 0; i < due && got > 0 && !difference; i++) {
            if (again.frame != replay.frame)
                got = replay_frame(&replay, again.frame);
            app_frame(&again);
            difference = replay_check(&replay);
        }
    }
    replay_close(&replay);
    return difference ? difference : got < 0 ? replay.reason : NULL;
}

void test_replay_run(void)
{
    static const char *const name[] = {"catch_up", "skip", "freeze", "stop"};
    for (int policy = OVERRUN_CATCH_UP; policy <= OVERRUN_STOP; policy++) {
        printf("policy %s\n", name[policy]);
        uint64_t hash = make_recording((enum overrun_policy)policy);
        const char *difference = replay_all();
        check_string("difference", difference ? difference : "none", "none");
        check_hex("state of the replayed plant", plant_hash(&again.plant), hash);
        check_int("its bus frame", (int64_t)again.frame, (int64_t)bus.app.frame);
        check_int("overruns it counted", again.count[DIAG_OVERRUNS], 3);
        check_int("bus-off it counted", again.count[DIAG_BUS_OFF], 1);
        check_above("messages compared", (double)replay.compared, FRAMES);
        check_int("drives it fired", again.count[DIAG_FIRE_APPLIED], 1);
        unlink(path);
    }
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

void test_replay_tampered(void)
{
    (void)make_recording(OVERRUN_CATCH_UP);
    tamper("214#", 4);
    const char *difference = replay_all();
    printf("%s\n", difference ? difference : "(equal)");
    check_true("one changed digit of telemetry is found", difference && strstr(difference, "recorded 214#"));
    unlink(path);
    (void)make_recording(OVERRUN_CATCH_UP);
    tamper("200#", 5); /* FIRE: its checksum no longer fits, so the drive does not start */
    difference = replay_all();
    printf("%s\n", difference ? difference : "(equal)");
    check_true("a changed command changes the run", difference != NULL);
    unlink(path);
}
