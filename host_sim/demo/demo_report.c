/* demo_report.c - see demo_report.h. */
#include "host_sim/demo/demo_report.h"
#include "host_sim/demo/demo_report.h"

#include <math.h>
#include <stdio.h>
#include "host_sim/cli/paragraph.h"
#include "host_sim/report/html.h"

static const double settled_s = 0.3; /* end of a phase over which its result is taken */

/* Rows of a phase: from the first to before `end`. */
static int find_phase(const struct demo_record *r, enum demo_phase phase, int *end)
{
    int first = 0;
    while (first < r->n_rows && r->column[DEMO_PHASE][first] < phase)
        first++;
    for (*end = first; *end < r->n_rows && r->column[DEMO_PHASE][*end] <= phase;)
        ++*end;
    return first;
}

/* Mean of the loss over the end of a phase, %; NaN when the phase has no row. */
static double settled_loss(const struct demo_record *r, enum demo_phase phase)
{
    int end, first = find_phase(r, phase, &end), n = 0;
    double sum = 0.0;
    for (int i = end - 1; i >= first && r->column[DEMO_TIME][i] > r->column[DEMO_TIME][end - 1] - settled_s;
         i--, n++)
        sum += r->column[DEMO_LOSS][i];
    return n ? 100.0 * sum / n : (double)NAN;
}

static double last(const struct demo_record *r, enum demo_column column, enum demo_phase phase)
{
    int end, first = find_phase(r, phase, &end);
    return end > first ? r->column[column][end - 1] : (double)NAN;
}

static double most(const struct demo_record *r, enum demo_column column, enum demo_phase phase)
{
    int end;
    double value = (double)NAN;
    for (int i = find_phase(r, phase, &end); i < end; i++)
        value = fmax(value, r->column[column][i]);
    return value;
}

/* Seconds from the first row with contact loss to the last one. */
static double lost_s(const struct demo_record *r, enum demo_phase phase)
{
    int end;
    double begin_s = (double)NAN, lost = (double)NAN;
    for (int i = find_phase(r, phase, &end); i < end; i++) {
        if (!(r->column[DEMO_LOSS][i] > 0.0))
            continue;
        begin_s = isnan(begin_s) ? r->column[DEMO_TIME][i] : begin_s;
        lost = r->column[DEMO_TIME][i] - begin_s;
    }
    return lost;
}

static int tell_drives(char *text, size_t size, const struct demo *d)
{
    const struct demo_record *r = &d->record;
    return snprintf(
        text, size,
        "The rig rests with a preload of %.2f N on %.2f µm of compression; its resonance is %.1f Hz. Contact "
        "was first lost at %.4f s, at a slow force amplitude of %.2f N (%.1f %% of the preload); settled, "
        "%.1f %% of the time was without contact. The controller brought this to %.1f %% while the drive "
        "stayed: it pushed with up to %.1f N, then held %.2f µm of compression or more with %.1f N. ",
        r->rest_N, 1e6 * r->rest_m, d->client.latest.info[INFO_F0_BUS_HZ], r->first_loss_s, r->first_loss_N,
        100.0 * r->first_loss_N / r->rest_N, settled_loss(r, DEMO_DRIVE), settled_loss(r, DEMO_CONTROL),
        most(r, DEMO_COMMAND, DEMO_CONTROL), 1e6 * last(r, DEMO_PENETRATION, DEMO_CONTROL),
        last(r, DEMO_COMMAND, DEMO_CONTROL));
}

static int tell_fast(char *text, size_t size, const struct demo_record *r)
{
    double base_um = 1e6 * last(r, DEMO_BASE_M, DEMO_FAST), loss = most(r, DEMO_LOSS, DEMO_FAST),
           force_N = last(r, DEMO_COMMAND, DEMO_FAST);
    if (!(loss > 0.0))
        return snprintf(text, size,
                        "The fast base drive of %.2f µm did not break the contact; it took %.1f N. ", base_um,
                        force_N);
    return snprintf(
        text, size,
        "The fast base drive of %.2f µm broke the contact again: up to %.1f %% of the time, %.2f s long, "
        "until the controller pushed with %.1f N; at the end %.1f %% were lost, with %.1f N. ",
        base_um, 100.0 * loss, lost_s(r, DEMO_FAST), most(r, DEMO_COMMAND, DEMO_FAST),
        settled_loss(r, DEMO_FAST), force_N);
}

static int tell_end(char *text, size_t size, const struct demo *d)
{
    const struct demo_record *r = &d->record;
    const struct latest *l = &d->client.latest;
    const double *health = l->health;
    return snprintf(
        text, size,
        "Then the controller fell silent: the plant reacted %.0f frames after the frame that the last "
        "heartbeat named (limit %.0f) and had its drives at zero %.2f s later. Timing: overruns %.0f, "
        "frames missed and made up %.0f, streamed samples missed %.0f, worst wake-up %.0f µs late, worst "
        "frame %.0f µs of computing, worst pause of the controller %.1f ms.",
        (double)(r->reaction_frame - r->heartbeat_frame), l->parameter[SETTING_FIRST + SET_TIMEOUT_FRAMES],
        r->reaction_end_s - r->reaction_begin_s, health[DIAG_OVERRUNS], health[DIAG_FRAMES_MISSED],
        d->stream_missed, health[DIAG_LATENESS_MAX_US], health[DIAG_COMPUTE_MAX_US], 1e3 * d->stall_s);
}

static void sum_up(const struct demo *d, char *text, size_t size)
{
    int n = tell_drives(text, size, d);
    n += tell_fast(text + n, size - (size_t)n, &d->record);
    tell_end(text + n, size - (size_t)n, d);
}

void demo_print_summary(const struct demo *d)
{
    char text[4096];
    sum_up(d, text, sizeof text);
    printf("\n");
    paragraph_print(stdout, 0, "", "%s", text);
    printf("\n");
}

/* ---- the page ---- */

/* Charts over the time of the plant: a column as a line, or two as a band. */
static const struct {
    const char *title, *unit;
    enum demo_column column;
    bool band;
} charts[] = {
    {"slow force drive, amplitude", "N", DEMO_SLOW_N, false},
    {"fast base drive, amplitude", "m", DEMO_BASE_M, false},
    {"displacement", "m", DEMO_DISPLACEMENT, true},
    {"penetration", "m", DEMO_PENETRATION, true},
    {"contact force", "N", DEMO_FORCE, true},
    {"share of time without contact", "1", DEMO_LOSS, false},
    {"controller's force", "N", DEMO_COMMAND, false},
};

/* A line where each phase begins. */
static void mark_phases(struct html *h, const struct demo_record *r)
{
    int phase = -1;
    for (int i = 0; i < r->n_rows; i++)
        if ((int)r->column[DEMO_PHASE][i] > phase) {
            phase = (int)r->column[DEMO_PHASE][i];
            html_marker(h, r->column[DEMO_TIME][i], "%s", demo_phase_name[phase]);
        }
}

const char *demo_write_html(const struct demo *d, const char *path, int argc, char **argv)
{
    const struct demo_record *r = &d->record;
    const double *t = r->column[DEMO_TIME];
    struct html h;
    char text[4096];
    const char *why = html_begin(&h, path, "demo", NULL, argc, argv);
    if (why)
        return why;
    if (d->end == DEMO_DONE) {
        sum_up(d, text, sizeof text);
        html_words(&h, "%s", text);
    } else {
        html_words(&h, "The demonstration did not come to its end: %s.",
                   *d->why ? d->why : "it was interrupted");
    }
    html_words(&h, "A band has the least and the greatest value of the %d frames before each row.",
               DEMO_RECENT);
    for (size_t i = 0; i < sizeof charts / sizeof *charts && r->n_rows > 0; i++) {
        const double *y = r->column[charts[i].column];
        html_chart(&h, charts[i].title, charts[i].unit, "plant time", "s");
        if (charts[i].band)
            html_band(&h, charts[i].title, (size_t)r->n_rows, t, t[r->n_rows - 1], 0.0, y,
                      r->column[charts[i].column + 1]);
        else
            html_line(&h, HTML_LINE, charts[i].title, (size_t)r->n_rows, t, y);
        mark_phases(&h, r);
    }
    return html_end(&h);
}
