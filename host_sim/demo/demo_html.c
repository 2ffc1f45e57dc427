/* demo_html.c - see demo_html.h. */
#include "host_sim/demo/demo_html.h"
#include "host_sim/demo/demo_report.h"
#include "host_sim/report/html.h"

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
        demo_sum_up(d, text, sizeof text);
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
