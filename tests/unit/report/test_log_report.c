/* test_log_report.c - a report of a log that does not know everything. It has rows without a message, values
 * beyond the bus's range and missing frames, all from messages made by hand. */
#include "host_sim/cli/files.h"
#include "host_sim/cli/trouble.h"
#include "host_sim/replay/log_report.h"
#include "host_sim/scene/scene.h"
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static struct scene_app scene;
static struct decode decoder;
static struct log_report report;
static char page[1 << 20];

/* The plant of all tests: 0.4 mm, 0.8 m/s and 4.2 kN are what its bus can say. */
static bool open_scene(void)
{
    char why[SCENE_REASON];
    bool good = scene_init(&scene, "rig", why) && scene_start(&scene, NULL, why);
    decode_begin(&decoder, &scene.app.scene, scene.app.plant.tick_s);
    return good;
}

/* Takes the message; true with the row that it ends. */
static bool hear(unsigned kind, double a, double b, double c, struct decode_row *row)
{
    static uint8_t counter[WIRE_KINDS];
    struct message m = {.kind = (uint8_t)kind, .counter = counter[kind], .value = {a, b, c}};
    counter[kind] = (uint8_t)((counter[kind] + 1) % WIRE_COUNTER_STATES);
    return decode_take(&decoder, &m, row);
}

TEST(decode_knows_what_was_not_said)
{
    struct decode_row row;
    check_true("scene", open_scene());
    hear(WIRE_SYNC, 1, 64, 0, &row);
    check_true("a row ends", hear(WIRE_SYNC, 2, 128, 0, &row));
    check_int("before the first MOTION contact is not known", row.contact_known, 0);
    check_int("nothing is beyond the range before it", (int)row.beyond, 0);
    hear(WIRE_MOTION, 1, (double)NAN, 1e-3, &row);
    hear(WIRE_CONTACT, 1, 1e-6, 3.0, &row);
    hear(WIRE_SYNC, 3, 192, 0, &row);
    check_int("then it is", row.contact_known && row.closed == 1, 1);
    check_int("the displacement was said to be not available", (int)row.beyond, 1);
    scene_free(&scene);
}

static struct decode_row row_at(uint64_t frame, double value)
{
    struct decode_row r = {.frame = frame, .t_s = 1e-3 * (double)frame, .closed = 1, .contact_known = true};
    for (int i = 0; i < DECODE_SIGNALS; i++)
        r.value[i] = value;
    r.beyond = isnan(value) ? 15u : 0u;
    return r;
}

/* Frames 0 to 9, 10 to 19 beyond the range, 20 to 29; then 30 to 59 are missing, and 60 to 69. */
TEST(log_series_has_gaps_and_marks)
{
    static struct log_series s;
    size_t i = 0;
    double from = 0.0, to = 0.0;
    int empty = 0;
    log_series_begin(&s, 1);
    for (uint64_t frame = 0; frame < 70; frame++) {
        struct decode_row r = row_at(frame, frame / 10 == 1 ? (double)NAN : 2.0);
        if (frame < 30 || frame >= 60)
            log_series_add(&s, &r);
    }
    check_int("rows", (int)s.n, 40);
    check_int("without a displacement", (int)s.n_beyond[0], 10);
    check_true("one interval beyond the range", log_series_next(&s, 0, &i, &from, &to));
    check_near("from, s", from, 0.010, 1e-12);
    check_near("to, s", to, 0.020, 1e-12);
    check_true("and no other", !log_series_next(&s, 0, &i, &from, &to));
    for (size_t k = 0; k < s.bins.n; k++)
        empty += s.bins.x[k] > 0.0295 && s.bins.x[k] < 0.0595 && isnan(s.bins.high[0][k]);
    check_int("bins without a value where rows are missing", empty, 30);
}

TEST(decimate_open_unknown)
{
    struct decimate_open *d = malloc(sizeof *d);
    decimate_open_begin(d, 0.0, DECIMATE_BINS, DECIMATE_UNKNOWN);
    decimate_open_add(d, 10.5, 1);
    decimate_open_add(d, 20.0, 0);
    decimate_open_add(d, DECIMATE_BINS, 0);
    check_true("not known", isnan(d->share[0]) && isnan(d->share[10]));
    check_near("open", d->share[11], 1.0, 1e-12);
    check_near("closed", d->share[20], 0.0, 0.0);
    free(d);
}

TEST(trouble_in_words)
{
    uint32_t count[DIAG_COUNTERS] = {0};
    char text[TROUBLE_TEXT];
    check_true("nothing", !trouble_list(count, 0, text));
    check_string("no words for it", text, "");
    count[DIAG_OVERRUNS] = 1;
    count[DIAG_FRAMES_MISSED] = 355;
    count[DIAG_TIMEOUTS] = 1;
    count[DIAG_LATE] = 3;
    count[DIAG_SESSION] = 9;
    check_true("something", trouble_list(count, FAULT_TIMEOUT | FAULT_BUDGET, text));
    check_string("all of it", text,
                 "1 overrun, 355 frames missed, 1 time-out of the controller, 12 refused (3 late, 9 "
                 "session), faults: budget, timeout");
}

TEST(log_tally_between_health)
{
    struct log_tally t = {0};
    struct message overrun = {.kind = WIRE_OVERRUN, .value = {[OVERRUN_MISSED] = 5}};
    struct message reply = {.kind = WIRE_REPLY, .value = {[REPLY_CAUSE] = CAUSE_LATE}};
    struct message status = {.kind = WIRE_STATUS, .value = {[STATUS_FAULTS] = FAULT_TIMEOUT}};
    for (int i = 0; i < DIAG_COUNTERS; i++) {
        struct message m = {.kind = WIRE_HEALTH, .value = {[HEALTH_ITEM] = i}};
        check_int("complete before the last", log_tally_is_complete(&t), 0);
        log_tally_take(&t, &m);
    }
    check_int("complete", log_tally_is_complete(&t), 1);
    log_tally_take(&t, &overrun), log_tally_take(&t, &overrun);
    log_tally_take(&t, &reply), log_tally_take(&t, &status);
    check_int("overruns", (int)t.count[DIAG_OVERRUNS], 2);
    check_int("frames missed", (int)t.count[DIAG_FRAMES_MISSED], 10);
    check_int("late", (int)t.count[DIAG_LATE], 1);
    check_int("time-outs", (int)t.count[DIAG_TIMEOUTS], 1);
}

/* The page of these rows and events. */
static const char *page_of(int n_rows, const struct listen_event *e, int n_events)
{
    char path[] = "/tmp/contactplant_log_XXXXXX", *argv[] = {path};
    const struct log_tally nothing = {0};
    struct html h;
    char why[FILES_REASON];
    int fd = mkstemp(path);
    files_begin();
    if (fd < 0 || close(fd) || !files_take("report", path, false, why) || !open_scene() ||
        html_begin(&h, path, "t", NULL, 0, argv))
        return "";
    log_report_begin_in(&report, &h, scene.config.model);
    for (int i = 0; i < n_rows; i++) {
        struct decode_row r = row_at((uint64_t)i, i % 4 ? 1e-6 : (double)NAN);
        r.contact_known = i > 2;
        r.closed = i > 2;
        log_report_row(&report, &r);
    }
    for (int i = 0; i < n_events; i++)
        log_report_event(&report, &e[i]);
    log_report_charts(&report, &scene, &nothing);
    log_report_end_in(&report, &h);
    (void)html_end(&h);
    FILE *f = fopen(path, "r");
    size_t n = f ? fread(page, 1, sizeof page - 1, f) : 0;
    page[n] = '\0';
    if (f)
        (void)fclose(f);
    unlink(path);
    scene_free(&scene);
    return page;
}

static void check_says(const char *text, const char *words, bool wanted)
{
    check_int(check_name("%s: %s", wanted ? "says" : "does not say", words), strstr(text, words) != NULL,
              wanted);
}

TEST(log_report_without_an_event)
{
    const char *text = page_of(100, NULL, 0);
    check_says(text, "Contact did not change: it was closed all the time that is known.", true);
    check_says(text, "seen in the rows alone", false);
    check_says(text, "largest force", false);
    check_says(text, "hardest impact", false);
    check_says(text, "25 of 100 rows have no displacement: it was beyond the bus's range of 419 µm.", true);
    check_says(text, "\"kind\":\"span\",\"name\":\"beyond the bus's range\"", true);
}

TEST(log_report_of_peaks_beyond_the_range)
{
    const struct listen_event e[] = {
        {.t_s = 0.01, .has_data = true, .peak_force_N = 3302.0, .speed = 0.1},
        {.t_s = 0.02, .has_data = true, .touch = true, .speed = -0.5},
        {.t_s = 0.03, .has_data = true, .peak_force_N = (double)NAN, .speed = 0.1}};
    const char *text = page_of(100, e, 3);
    check_says(text, "1 touchdowns and 2 lift-offs were sent.", true);
    check_says(text, "The largest force was at least 4194 N: 1 of 2 peaks were beyond the bus's range.",
               true);
    check_says(text, "The hardest impact had 0.5 m/s.", true);
    check_says(text, "beyond the range", true);
    check_says(text, "\"nan\"", false);
}
