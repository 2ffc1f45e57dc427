/* test_decode.c - rows of messages made by hand: what is missing, repeated, overtaken, or never due. And logs
 * of several interfaces and of another plant. */
#include "firmware/bus/identity.h"
#include "host_sim/listen/decode_rows.h"
#include "host_sim/replay/plant_log.h"
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SUBSTEPS = 64 };

static const struct wire_scene scene = {
    .base_id = 0x240, .lsb = {1e-9, 1e-6, 1e-9, 1e-3}, .substeps = SUBSTEPS, .identity = 4711};
static struct decode decoder;
static unsigned counter[WIRE_KINDS];

/* Every message that the plant has sent so far counts, whether it is heard or not. */
static struct message next_message(unsigned kind, double a, double b, double c)
{
    struct message m = {.kind = (uint8_t)kind, .value = {a, b, c}};
    m.counter = (uint8_t)(counter[kind]++ % WIRE_COUNTER_STATES);
    return m;
}

static void begin(void)
{
    memset(counter, 0, sizeof counter);
    decode_begin(&decoder, &scene, 1e-3 / SUBSTEPS);
}

/* The letters that are heard of frame i, whose displacement is i: S, M, C. The others are sent. Capitals of
 * `row` are the parts of the row that it ends; -1 without one. */
static int hear_frame(int i, const char *heard, struct decode_row *row)
{
    static const struct {
        char letter;
        unsigned kind;
    } part[] = {{'S', WIRE_SYNC}, {'M', WIRE_MOTION}, {'C', WIRE_CONTACT}};
    int ended = -1;
    for (size_t k = 0; k < 3; k++) {
        bool sync = part[k].kind == WIRE_SYNC;
        struct message m = next_message(part[k].kind, sync ? i : 1.0, sync ? i * SUBSTEPS : i, i);
        struct decode_row r;
        for (const char *c = heard; *c; c++)
            if (*c == part[k].letter && decode_take(&decoder, &m, &r)) {
                *row = r;
                ended = (int)r.frame;
            }
    }
    return ended;
}

/* Frames from 0 on as the words say, '-' for none; each row must have its own values, or none. */
static void check_frames(const char *name, const char *words, int rows, int without, int missing)
{
    char text[400];
    int i = 0, n = 0, wrong = 0, empty = 0;
    struct decode_row row;
    begin();
    snprintf(text, sizeof text, "%s", words);
    for (char *word = strtok(text, " "); word; word = strtok(NULL, " "), i++) {
        int frame = hear_frame(i, *word == '-' ? "" : word, &row);
        if (frame < 0)
            continue;
        n++;
        empty += isnan(row.value[0]);
        wrong += !isnan(row.value[0]) && row.value[0] != (double)frame;
        wrong += !isnan(row.value[2]) && row.value[2] != (double)frame;
        wrong += row.contact_known != (row.said[0] || row.said[1]);
    }
    check_int(name, wrong, 0);
    check_int("  rows", n, rows);
    check_int("  without a displacement", empty, without);
    check_int("  frames missing", (int64_t)decoder.missing, missing);
}

#define TEN       "SMC SMC SMC SMC SMC SMC SMC SMC SMC SMC "
#define NO_MOTION "SC SC SC SC SC SC SC SC SC SC "
#define NOTHING   "- - - - - - - - - - "

/* Frame i of a plant that echoes the samples i and -i: its SYNC, and the echoes where `heard` says so. The
 * commands of the row that it ends. */
static void hear_echoes(int i, bool heard, double command[2])
{
    struct decode_row row;
    struct message sync = next_message(WIRE_SYNC, i, i * SUBSTEPS, 0.0);
    struct message one = next_message(WIRE_STREAM_ECHO, (i + 65535) % 65536, i, 0.0);
    struct message two = next_message(WIRE_STREAM_ECHO + 1, (i + 65535) % 65536, -i, 0.0);
    if (decode_take(&decoder, &sync, &row))
        memcpy(command, &row.value[DECODE_OUTPUTS], 2 * sizeof *command);
    if (heard) {
        (void)decode_take(&decoder, &one, &row);
        (void)decode_take(&decoder, &two, &row);
    }
}

TEST(decode_echo)
{
    struct decode_row row;
    double command[2] = {7.0, 7.0};
    begin();
    for (int i = 40000; i < 40020; i++)
        hear_echoes(i, i != 40017, command);
    check_near("a row has the sample of the frame before it", command[0], 40018.0, 0.0);
    check_near("  of each input", command[1], -40018.0, 0.0);
    hear_echoes(40020, true, command);
    struct message late = next_message(WIRE_STREAM_ECHO, 40018, 1.0, 0.0);
    (void)decode_take(&decoder, &late, &row);
    hear_echoes(40021, false, command);
    check_near("one of another frame is not taken", command[0], 40020.0, 0.0);
    hear_echoes(40022, true, command);
    check_nan("a row whose echo is missing", command[0]);
    struct message stream = next_message(WIRE_STREAM, 0.0, 0.0, 0.0);
    stream.value[STREAM_SAMPLE] = 2.5;
    (void)decode_take(&decoder, &stream, &row);
    hear_echoes(40023, true, command);
    hear_echoes(40024, true, command);
    check_near("where STREAM is heard, that is the command", command[0], 2.5, 0.0);
    check_near("  of its input alone", command[1], -40023.0, 0.0);
    check_int("echoes missing", (int64_t)decoder.missing, 4);
}

TEST(decode_missing)
{
    check_frames("all heard", TEN "S", 10, 0, 0);
    check_frames("a MOTION less", "SMC SMC SC SMC SMC S", 5, 1, 1);
    check_frames("ten MOTION less", TEN NO_MOTION TEN "S", 30, 10, 10);
    check_frames("twenty MOTION less", TEN NO_MOTION NO_MOTION TEN "S", 40, 20, 20);
    check_frames("a SYNC less", "SMC SMC MC SMC SMC S", 4, 0, 1);
    check_frames("a SYNC less, and the MOTION before it", "SMC SC MC SMC SMC S", 4, 1, 2);
    check_frames("a SYNC less, and the MOTION behind it", "SMC SMC C SMC SMC S", 4, 1, 2);
    check_frames("a SYNC less, and an earlier MOTION", "SMC SC SMC MC SMC S", 4, 1, 2);
    check_frames("a frame less", "SMC SMC - SMC SMC S", 4, 1, 3);
    check_frames("twenty frames less", TEN NOTHING NOTHING TEN "S", 20, 1, 60);
    check_frames("fifteen SYNC less", TEN "MC MC MC MC MC MC MC MC MC MC MC MC MC MC MC SMC SMC S", 12, 0,
                 15);
    check_frames("the first ones unheard", NOTHING "MC C SMC SMC S", 2, 0, 1);
}

TEST(decode_repeated)
{
    check_frames("each MOTION twice", "SMMC SMMC SMMC SMMC S", 4, 0, 0);
    check_frames("each SYNC twice", "SSMC SSMC SSMC SSMC S", 4, 0, 0);
    struct decode_row row;
    begin();
    (void)hear_frame(0, "SMC", &row);
    (void)hear_frame(1, "SMC", &row);
    struct message late = next_message(WIRE_MOTION, 1, 2, 2);
    (void)hear_frame(3, "SMC", &row);
    (void)decode_take(&decoder, &late, &row);
    check_int("a MOTION that was overtaken is left out", hear_frame(4, "S", &row), 3);
    check_near("  the row has its own", row.value[0], 3.0, 0.0);
}

/* Only each third frame has a MOTION, and then periods are missed, or a setting changes the pace. */
/* A plant that is started again, also after more frames than FRAME counts; and one SYNC that comes late. */
TEST(decode_anew)
{
    static const int lengths[] = {20, 400, 40000};
    struct decode_row row = {.frame = 0};
    for (size_t k = 0; k < sizeof lengths / sizeof lengths[0]; k++) {
        int n = 0, wrong = 0;
        begin();
        for (int i = 0; i < 2 * lengths[k]; i++) {
            if (i == lengths[k])
                memset(counter, 0, sizeof counter);
            if (hear_frame(i % lengths[k], "SMC", &row) < 0)
                continue;
            wrong +=
                row.tick != (uint64_t)(n % lengths[k]) * SUBSTEPS || row.run != (unsigned)(n / lengths[k]);
            wrong += !(row.value[0] == n % lengths[k]);
            n++;
        }
        check_int("rows", n, 2 * lengths[k] - 1);
        check_int("  of another tick or run", wrong, 0);
        check_int("  frames missing", (int64_t)decoder.missing, 0);
    }
    begin();
    for (int i = 0; i < 300; i++)
        (void)hear_frame(i, "SMC", &row);
    (void)hear_frame(150, "S", &row);
    (void)hear_frame(301, "SMC", &row);
    check_int("a SYNC that is 150 frames late begins nothing", row.run, 0);
}

TEST(decode_pace)
{
    struct decode_row row;
    int n = 0, of_other = 0;
    begin();
    for (int i = 0; i < 60; i++) {
        int step = i < 30 ? 3 : 20;
        if (i == 30) {
            struct message echo = next_message(WIRE_PARAM_ECHO, 0, 0, 0);
            (void)decode_take(&decoder, &echo, &row);
        }
        struct message sync = next_message(WIRE_SYNC, i, i * SUBSTEPS, 0);
        if (decode_take(&decoder, &sync, &row)) {
            n += row.said[0];
            of_other += row.said[0] && row.value[0] != (double)row.frame;
            of_other += row.due;
        }
        if (i % step)
            continue;
        struct message motion = next_message(WIRE_MOTION, 1, i, i);
        (void)decode_take(&decoder, &motion, &row);
    }
    check_int("rows with a MOTION", n, 11);
    check_int("of another tick, or thought missing", of_other, 0);
    check_int("frames missing", (int64_t)decoder.missing, 0);
    struct message overrun = next_message(WIRE_OVERRUN, 150, 60, 0);
    (void)decode_take(&decoder, &overrun, &row);
    struct message sync = next_message(WIRE_SYNC, 210, 210 * SUBSTEPS, 0);
    check_true("a SYNC after 150 missed periods", decode_take(&decoder, &sync, &row));
    check_int("frames missing", (int64_t)decoder.missing, 0);
    memset(counter, 0, sizeof counter);
    sync = next_message(WIRE_SYNC, 0, 0, 0);
    (void)decode_take(&decoder, &sync, &row);
    (void)hear_frame(1, "SMC", &row);
    check_int("a plant that begins anew: its first row", (int64_t)row.frame, 0);
    check_int("  frames missing", (int64_t)decoder.missing, 0);
}

/* ---- events ---- */

static struct listen_event event[8];
static int n_events;

static void take_event(void *context, const struct listen_event *e)
{
    (void)context;
    event[n_events++ % 8] = *e;
}

/* Event i at tick i with speed i: T and D are heard, the others are sent. */
static void hear_events(const char *const *heard, int n)
{
    struct decode_row row;
    begin();
    n_events = 0;
    decoder.events.take = take_event;
    for (int i = 0; i < n; i++) {
        struct message time = next_message(WIRE_EVENT_TIME, 1, 0, 0),
                       data = next_message(WIRE_EVENT_DATA, 1, 0, i);
        time.value[EVENT_TIME_TICK] = i;
        if (strchr(heard[i], 'T'))
            (void)decode_take(&decoder, &time, &row);
        if (strchr(heard[i], 'D'))
            (void)decode_take(&decoder, &data, &row);
    }
}

TEST(decode_events)
{
    static const char *const heard[] = {"TD", "D", "TD", "T", "TD", "", "TD", "T", "D", "TD"};
    static const int at[] = {0, 2, 3, 4, 6, 7, 9}, has_data[] = {1, 1, 0, 1, 1, 0, 1};
    hear_events(heard, 10);
    check_int("events with a time", n_events, 7);
    for (int i = 0; i < 7; i++) {
        check_near("  its time, ticks", event[i].t_s / decoder.tick_s, at[i], 1e-9);
        check_int("  with its data", event[i].has_data, has_data[i]);
        check_true("  the speed is its own, or none", isnan(event[i].speed) != event[i].has_data &&
                                                          (!event[i].has_data || event[i].speed == at[i]));
    }
    check_int("frames missing", (int64_t)decoder.missing, 6);
}

/* ---- logs ---- */

static char path[] = "/tmp/contactplant_decode_XXXXXX";

static void put_line(FILE *f, const char *interface, unsigned kind, double a, double b)
{
    char text[LOG_LINE_MAX];
    struct message m = next_message(kind, a, b, 0);
    struct log_line line = {.time_us = PLANT_LOG_EPOCH_US};
    snprintf(line.interface, sizeof line.interface, "%s", interface);
    wire_encode(&scene, &m, &line.frame);
    log_format(text, &line);
    fputs(text, f);
}

/* Why a log is refused that has SYNCs on the first two interfaces, and tells these identities there (0:
 * none); frames of others are on the third one. "" where it is not. */
static const char *refused(const char *const on[3], double first, double second, const char *interface)
{
    static struct plant_log l;
    memcpy(path + strlen(path) - 6, "XXXXXX", 6);
    FILE *f = fdopen(mkstemp(path), "w");
    const double identity[2] = {first, second};
    for (int k = 0; k < 2 && on[k]; k++) {
        put_line(f, on[k], WIRE_SYNC, 1, 64);
        if (identity[k] > 0.0)
            put_line(f, on[k], WIRE_INFO, INFO_IDENTITY, identity[k]);
    }
    fprintf(f, "(1700000000.000000) %s 256#00\n(1700000000.000000) %s 300##011\n", on[2], on[2]);
    fclose(f);
    const char *why = plant_log_open(&l, path, interface, &scene);
    if (!why)
        plant_log_close(&l);
    unlink(path);
    return why ? why : "";
}

TEST(plant_log_interfaces)
{
    static const char *const one[] = {"can0", NULL, "can1"}, *const two[] = {"can0", "can1", "can2"};
    check_string("one", refused(one, 4711, 0, NULL), "");
    check_string("one, by its name", refused(one, 4711, 0, "can0"), "");
    check_contains("another one", refused(one, 4711, 0, "can1"),
                   "no frame of this plant on can1, but on can0");
    check_contains("two", refused(two, 4711, 4711, NULL),
                   "on can0 and can1; choose one, as by --interface can0");
    check_string("the second", refused(two, 1, 4711, "can1"), "");
    check_contains("the first is another plant", refused(two, 1, 4711, "can0"), "is of another plant");
    check_contains("another plant", refused(one, 4712, 0, NULL), "is of another plant");
    check_string("no identity", refused(one, 0, 0, NULL), "");
}
