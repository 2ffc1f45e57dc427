/* demo_picture.c - the record as one picture. */
#include "host_sim/cli/chart.h"
#include "host_sim/demo/demo.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MICRO = 1000000 };

struct picture {
    struct chart chart;
    const struct demo_record *record;
    double column[DEMO_COLUMNS][DEMO_ROWS]; /* in the units of the picture */
    size_t n;
};

static void fill_columns(struct picture *p)
{
    double scale[DEMO_COLUMNS];
    for (int k = 0; k < DEMO_COLUMNS; k++)
        scale[k] = 1.0;
    scale[DEMO_BASE_M] = scale[DEMO_DISPLACEMENT] = scale[DEMO_DISPLACEMENT + 1] = MICRO;
    scale[DEMO_LOSS] = 100.0;
    p->n = (size_t)p->record->n_rows;
    for (int k = 0; k < DEMO_COLUMNS; k++)
        for (size_t i = 0; i < p->n; i++)
            p->column[k][i] = scale[k] * p->record->column[k][i];
}

/* A panel over the range of two columns and zero; headroom: a factor of its upper limit. */
static void panel(struct picture *p, const char *label, double height, double headroom, int low, int high)
{
    double min = 0.0, max = 0.0;
    chart_range_add(&min, &max, p->column[low], p->n);
    chart_range_add(&min, &max, p->column[high], p->n);
    bool touches_zero = min == 0.0 && max > 0.0;
    chart_range_finish(&min, &max);
    chart_panel(&p->chart, label, height, touches_zero ? 0.0 : min, max * headroom);
}

/* The time at which the phases from `phase` on begin. */
static double phase_begin(const struct picture *p, enum demo_phase phase)
{
    for (size_t i = 0; i < p->n; i++)
        if (p->column[DEMO_PHASE][i] >= phase)
            return i ? p->column[DEMO_TIME][i - 1] : p->column[DEMO_TIME][0];
    return p->n ? p->column[DEMO_TIME][p->n - 1] : 0.0;
}

static void shade_phases(struct picture *p, bool named)
{
    for (int i = 0; i < DEMO_PHASES; i++) {
        double begin = phase_begin(p, (enum demo_phase)i), end = phase_begin(p, (enum demo_phase)(i + 1));
        if (i % 2 == 1 || named)
            chart_span(&p->chart, begin, end, named ? demo_phase_name[i] : NULL,
                       i % 2 ? CHART_GREY : CHART_NONE);
    }
}

/* Runs of rows with any contact loss. */
static void shade_loss(struct picture *p)
{
    size_t n = p->n;
    for (size_t i = 0; i < n; i++) {
        size_t begin = i;
        while (i < n && p->column[DEMO_LOSS][i] > 0.0)
            i++;
        if (i > begin)
            chart_span(&p->chart, p->column[DEMO_TIME][begin ? begin - 1 : 0], p->column[DEMO_TIME][i - 1],
                       NULL, CHART_RED);
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

static void draw_drives(struct picture *p)
{
    const double *t = p->column[DEMO_TIME];
    panel(p, "Slow force drive: amplitude (N)", 90.0, 1.25, DEMO_SLOW_N, DEMO_SLOW_N);
    shade_phases(p, true);
    chart_line(&p->chart, t, p->column[DEMO_SLOW_N], p->n, CHART_BLUE, NULL);
    mark_events(p, true);
    panel(p, "Fast base drive: amplitude (\xC2\xB5m)", 45.0, 1.0, DEMO_BASE_M, DEMO_BASE_M);
    shade_phases(p, false);
    chart_line(&p->chart, t, p->column[DEMO_BASE_M], p->n, CHART_ORANGE, NULL);
    mark_events(p, false);
}

static void draw_motion(struct picture *p)
{
    const double *t = p->column[DEMO_TIME];
    panel(p, "Displacement of the mass (\xC2\xB5m, positive into the contact)", 150.0, 1.0, DEMO_DISPLACEMENT,
          DEMO_DISPLACEMENT + 1);
    shade_loss(p);
    chart_band(&p->chart, t, p->column[DEMO_DISPLACEMENT], p->column[DEMO_DISPLACEMENT + 1], p->n, CHART_BLUE,
               "envelope");
    chart_legend(&p->chart, CHART_RED, "contact lost");
    chart_level(&p->chart, 0.0, CHART_GREY, "first touch");
    mark_events(p, false);
    panel(p, "Share of time without contact (%)", 80.0, 1.0, DEMO_LOSS, DEMO_LOSS);
    shade_phases(p, false);
    chart_line(&p->chart, t, p->column[DEMO_LOSS], p->n, CHART_RED, NULL);
    mark_events(p, false);
}

static void draw_forces(struct picture *p)
{
    const double *t = p->column[DEMO_TIME];
    panel(p, "Contact force (N)", 110.0, 1.0, DEMO_FORCE, DEMO_FORCE + 1);
    shade_loss(p);
    chart_band(&p->chart, t, p->column[DEMO_FORCE], p->column[DEMO_FORCE + 1], p->n, CHART_GREEN, "envelope");
    chart_level(&p->chart, p->record->rest_N, CHART_GREY, "preload");
    mark_events(p, false);
    panel(p, "Controller's force (N)", 90.0, 1.0, DEMO_COMMAND, DEMO_COMMAND);
    shade_phases(p, false);
    chart_line(&p->chart, t, p->column[DEMO_COMMAND], p->n, CHART_BLUE, NULL);
    mark_events(p, false);
    chart_x_axis(&p->chart, "plant time (s)");
}

/* ---- the burst ---- */

enum { BURST_DISPLACEMENT = 0, BURST_FORCE = 3, BURST_IN_CONTACT = 4 };

/* The first sample apart of the lift-off nearest to the trigger; -1 for none. */
static int find_liftoff(const struct demo_record *r)
{
    int best = -1;
    for (int i = 1; i < DEMO_BURST; i++) {
        bool here = r->burst[BURST_IN_CONTACT][i - 1] > 0.5 && r->burst[BURST_IN_CONTACT][i] < 0.5;
        if (here && (best < 0 || abs(i - DEMO_BURST_BEFORE) < abs(best - DEMO_BURST_BEFORE)))
            best = i;
    }
    return best;
}

static void shade_apart(struct picture *p, const double *x)
{
    const double *contact = p->record->burst[BURST_IN_CONTACT];
    for (int i = 0; i < DEMO_BURST; i++) {
        int begin = i;
        while (i < DEMO_BURST && contact[i] < 0.5)
            i++;
        if (i > begin)
            chart_span(&p->chart, x[begin], x[i - 1], NULL, CHART_RED);
    }
}

static void draw_burst(struct picture *p)
{
    const struct demo_record *r = p->record;
    double x[DEMO_BURST], y[DEMO_BURST], min = (double)INFINITY, max = -(double)INFINITY;
    int zero = find_liftoff(r);
    if (!demo_burst_complete(r) || zero < 0)
        return;
    for (int i = 0; i < DEMO_BURST; i++) {
        x[i] = 1e3 * (i - zero) * r->tick_s;
        y[i] = MICRO * r->burst[BURST_DISPLACEMENT][i];
    }
    chart_range_add(&min, &max, y, DEMO_BURST);
    chart_range_finish(&min, &max);
    chart_x_range(&p->chart, x[0], x[DEMO_BURST - 1]);
    chart_panel(&p->chart,
                "Burst capture around one lift-off, every integration step: displacement (\xC2\xB5m)", 100.0,
                min, max);
    shade_apart(p, x);
    chart_legend(&p->chart, CHART_RED, "contact lost");
    chart_level(&p->chart, 0.0, CHART_GREY, "first touch");
    chart_line(&p->chart, x, y, DEMO_BURST, CHART_BLUE, NULL);
    min = max = 0.0;
    chart_range_add(&min, &max, r->burst[BURST_FORCE], DEMO_BURST);
    chart_range_finish(&min, &max);
    chart_panel(&p->chart, "Burst capture: contact force (N)", 80.0, min, max);
    shade_apart(p, x);
    chart_line(&p->chart, x, r->burst[BURST_FORCE], DEMO_BURST, CHART_GREEN, NULL);
    chart_x_axis(&p->chart, "time from lift-off (ms)");
}

/* ---- all ---- */

static const char *draw(struct picture *p, FILE *f)
{
    fill_columns(p);
    chart_begin(&p->chart, "A preloaded Hertzian contact, commanded over a bus in real time",
                "As the controller sent and heard it, 1 kHz frames; envelopes over the last 50 ms, contact "
                "loss per 10 ms");
    chart_x_range(&p->chart, 0.0, p->n > 1 ? ceil(10.0 * p->column[DEMO_TIME][p->n - 1]) / 10.0 : 1.0);
    draw_drives(p);
    draw_motion(p);
    draw_forces(p);
    draw_burst(p);
    return chart_end(&p->chart, f);
}

bool demo_write_picture(const struct demo_record *r, const char *path, char *why)
{
    struct picture *p = calloc(1, sizeof *p);
    FILE *f = p ? fopen(path, "w") : NULL;
    const char *reason = "no memory for the picture";
    if (p && !f)
        snprintf(why, DEMO_REASON, "cannot write %s: %s", path, strerror(errno));
    if (f) {
        p->record = r;
        reason = draw(p, f);
        if (fclose(f) && !reason)
            reason = "the picture could not be written completely (disk full?)";
    }
    if (!p || (f && reason))
        snprintf(why, DEMO_REASON, "%s: %s", path, reason);
    free(p);
    return p && f && !reason;
}
