/* demo_picture.c - see demo_picture.h. */
#include "host_sim/demo/demo_picture.h"
#include "host_sim/cli/chart.h"
#include "host_sim/cli/files.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MICRO       "\xC2\xB5"
#define TOUCH_LABEL "first touch"

struct picture {
    struct chart chart;
    const struct demo_record *record;
    double column[DEMO_COLUMNS][DEMO_ROWS]; /* in the units of the picture */
    size_t n;
};

/* Panels over the time of the plant: a column as a line, or two as an envelope with a level. */
static const struct panel {
    const char *label;
    double height, headroom, scale; /* headroom: a factor of its upper limit */
    int column;
    enum chart_colour colour;
    const char *level; /* NULL: a line */
} panels[] = {
    {"Slow force drive: amplitude (N)", 90.0, 1.25, 1.0, DEMO_SLOW_N, CHART_BLUE, NULL},
    {"Fast base drive: amplitude (" MICRO "m)", 45.0, 1.0, 1e6, DEMO_BASE_M, CHART_ORANGE, NULL},
    {"Displacement of the mass (" MICRO "m, positive into the contact)", 150.0, 1.0, 1e6, DEMO_DISPLACEMENT,
     CHART_BLUE, TOUCH_LABEL},
    {"Share of time without contact (%)", 80.0, 1.0, 100.0, DEMO_LOSS, CHART_RED, NULL},
    {"Contact force (N)", 110.0, 1.0, 1.0, DEMO_FORCE, CHART_GREEN, "preload"},
    {"Controller's force (N)", 90.0, 1.0, 1.0, DEMO_COMMAND, CHART_BLUE, NULL},
};
enum { PANELS = sizeof panels / sizeof panels[0] };

/* The time at which the phases from `phase` on begin. */
static double phase_begin(const struct picture *p, int phase)
{
    const double *t = p->record->column[DEMO_TIME];
    for (size_t i = 0; i < p->n; i++)
        if (p->record->column[DEMO_PHASE][i] >= phase)
            return i ? t[i - 1] : t[0];
    return p->n ? t[p->n - 1] : 0.0;
}

static void shade_phases(struct picture *p, bool named)
{
    for (int i = 0; i < DEMO_PHASES; i++)
        if (i % 2 == 1 || named)
            chart_span(&p->chart, phase_begin(p, i), phase_begin(p, i + 1), named ? demo_phase_name[i] : NULL,
                       i % 2 ? CHART_GREY : CHART_NONE);
}

/* Runs of values above `above`; `before`: each begins at the place before it. */
static void shade_above(struct picture *p, const double *x, const double *y, size_t n, double above,
                        size_t before)
{
    for (size_t i = 0; i < n; i++) {
        size_t begin = i;
        while (i < n && y[i] > above)
            i++;
        if (i > begin)
            chart_span(&p->chart, x[begin >= before ? begin - before : 0], x[i - 1], NULL, CHART_RED);
    }
}

static void mark_events(struct picture *p, bool named)
{
    const struct demo_record *r = p->record;
    char text[64];
    snprintf(text, sizeof text, "first lift-off at %.2f N", r->first_loss_N);
    if (!isnan(r->first_loss_s))
        chart_marker(&p->chart, r->first_loss_s, named ? text : NULL, CHART_RED);
    if (!isnan(r->reaction_begin_s))
        chart_marker(&p->chart, r->reaction_begin_s, named ? "time-out: drives to zero" : NULL, CHART_PURPLE);
}

/* The axis over the range of the values and zero. */
static void begin_panel(struct picture *p, const struct panel *k, const double *low, const double *high)
{
    double min = 0.0, max = 0.0;
    chart_range_add(&min, &max, low, p->n);
    chart_range_add(&min, &max, high, p->n);
    bool touches_zero = min == 0.0 && max > 0.0;
    chart_range_finish(&min, &max);
    chart_panel(&p->chart, k->label, k->height, touches_zero ? 0.0 : min, max * k->headroom);
}

static void draw_panel(struct picture *p, const struct panel *k, bool first)
{
    const struct demo_record *r = p->record;
    const double *t = r->column[DEMO_TIME];
    double *low = p->column[k->column], *high = k->level ? p->column[k->column + 1] : low;
    for (size_t i = 0; i < p->n; i++) {
        high[i] = k->scale * r->column[k->column + (high > low)][i];
        low[i] = k->scale * r->column[k->column][i];
    }
    begin_panel(p, k, low, high);
    if (k->level) {
        shade_above(p, t, r->column[DEMO_LOSS], p->n, 0.0, 1);
        chart_band(&p->chart, t, low, high, p->n, k->colour, "envelope");
        if (k->column == DEMO_DISPLACEMENT)
            chart_legend(&p->chart, CHART_RED, "contact lost");
        chart_level(&p->chart, k->column == DEMO_FORCE ? r->rest_N : 0.0, CHART_GREY, k->level);
    } else {
        shade_phases(p, first);
        chart_line(&p->chart, t, low, p->n, k->colour, NULL);
    }
    mark_events(p, first);
}

/* ---- the burst ---- */

enum { BURST_DISPLACEMENT = 0, BURST_FORCE = 3, BURST_IN_CONTACT = 4 };

/* The first sample apart of the lift-off nearest to the trigger; -1 for none. */
static int find_liftoff(const struct demo_record *r)
{
    const double *contact = r->burst[BURST_IN_CONTACT];
    int best = -1;
    for (int i = 1; i < DEMO_BURST; i++)
        if (contact[i - 1] > 0.5 && contact[i] < 0.5 &&
            (best < 0 || abs(i - DEMO_BURST_BEFORE) < abs(best - DEMO_BURST_BEFORE)))
            best = i;
    return best;
}

static void draw_burst(struct picture *p)
{
    const struct demo_record *r = p->record;
    double x[DEMO_BURST], y[DEMO_BURST], apart[DEMO_BURST], min = (double)INFINITY, max = -(double)INFINITY;
    int zero = find_liftoff(r);
    if (!demo_burst_complete(r) || zero < 0)
        return;
    for (int i = 0; i < DEMO_BURST; i++) {
        x[i] = 1e3 * (i - zero) * r->tick_s;
        y[i] = 1e6 * r->burst[BURST_DISPLACEMENT][i];
        apart[i] = 1.0 - r->burst[BURST_IN_CONTACT][i];
    }
    chart_range_add(&min, &max, y, DEMO_BURST);
    chart_range_finish(&min, &max);
    chart_x_range(&p->chart, x[0], x[DEMO_BURST - 1]);
    chart_panel(&p->chart,
                "Burst capture around one lift-off, every integration step: displacement (" MICRO "m)", 100.0,
                min, max);
    shade_above(p, x, apart, DEMO_BURST, 0.5, 0);
    chart_legend(&p->chart, CHART_RED, "contact lost");
    chart_level(&p->chart, 0.0, CHART_GREY, TOUCH_LABEL);
    chart_line(&p->chart, x, y, DEMO_BURST, CHART_BLUE, NULL);
    min = max = 0.0;
    chart_range_add(&min, &max, r->burst[BURST_FORCE], DEMO_BURST);
    chart_range_finish(&min, &max);
    chart_panel(&p->chart, "Burst capture: contact force (N)", 80.0, min, max);
    shade_above(p, x, apart, DEMO_BURST, 0.5, 0);
    chart_line(&p->chart, x, r->burst[BURST_FORCE], DEMO_BURST, CHART_GREEN, NULL);
    chart_x_axis(&p->chart, "time from lift-off (ms)");
}

static const char *draw(struct picture *p, FILE *f)
{
    const double *t = p->record->column[DEMO_TIME];
    p->n = (size_t)p->record->n_rows;
    chart_begin(&p->chart, "A preloaded Hertzian contact, commanded over a bus in real time",
                "As the controller sent and heard it, 1 kHz frames; envelopes over the last 50 ms, contact "
                "loss per 10 ms");
    chart_x_range(&p->chart, 0.0, p->n > 1 ? ceil(10.0 * t[p->n - 1]) / 10.0 : 1.0);
    for (int i = 0; i < PANELS; i++)
        draw_panel(p, &panels[i], i == 0);
    chart_x_axis(&p->chart, "plant time (s)");
    draw_burst(p);
    return chart_end(&p->chart, f);
}

bool demo_write_picture(const struct demo_record *r, const char *path, char *why)
{
    struct picture *p = calloc(1, sizeof *p);
    FILE *f = p ? files_compose(path) : NULL;
    const char *reason = !p ? "no memory for the picture" : !f ? strerror(errno) : NULL;
    if (f) {
        p->record = r;
        reason = draw(p, f);
        if (!files_finish(f, !reason) && !reason)
            reason = files_unwritten(errno);
    }
    if (reason)
        snprintf(why, DEMO_REASON, "cannot write %s: %s", path, reason);
    free(p);
    return !reason;
}
