/* decode.c - contactplant decode: a log as a table. */
#include "host_sim/replay/decode_log.h"
#include "host_sim/replay/decode_signals.h"
#include "host_sim/out/cell.h"
#include "host_sim/cli/names.h"
#include "host_sim/cli/options.h"
#include "host_sim/commands.h"
#include "host_sim/replay/log_report.h"
#include "host_sim/replay/log_series.h"
#include "host_sim/report/figure.h"

#include <math.h>
#include <stdio.h>

static const struct option decode_options[] = {
    {"out", "FILE", "rows as CSV (standard output)", OPTION_WRITES, .initial = NULL},
    {"events", "FILE", "contact events as CSV: time, kind, contact, speed, peak force", OPTION_WRITES,
     .initial = NULL},
    {"svg", "FILE", "also draw it: each signal over plant time", OPTION_WRITES, .initial = NULL},
    {"report", "FILE", "a page with charts of rows and events, which opens in a browser without a network",
     OPTION_WRITES, .initial = NULL},
    {.name = NULL},
};

static const struct usage decode_usage = {
    .name = "decode",
    .words = "LOG [SCENE]",
    .summary =
        "Prints a recorded log as a table in SI units, a row for each SYNC of the plant: plant time, state,\n"
        "the outputs that the bus carries, and the newest sample streamed to each input. A cell whose frame "
        "is\n"
        "missing is empty. Give the SCENE and options of the recorded run.",
    .words_help = DECODE_LOG_WORDS SCENE_WORDS_HELP,
    .examples = "  contactplant decode run.log --out run.csv --events events.csv --svg run.svg\n"
                "  contactplant decode field.log my.ini --base-id 0x240 | head\n",
    .min_words = 1,
    .words_read = 1,
    .max_words = 2,
    .table = {decode_options, decode_log_options, scene_options},
};

static int open_log(struct decode_log *d, const struct options *o, const char *path,
                    const struct scene_app *s)
{
    const char *reason =
        decode_log_open(d, path, options_text(o, "interface", 0), &s->app.scene, s->app.plant.tick_s);
    return reason ? options_failure(o->usage, "%s", reason) : 0;
}

static void put_event(void *context, const struct listen_event *e)
{
    FILE *f = context;
    fprintf(f, "%.12g,%s,%u,", e->t_s, e->touch ? "touchdown" : "liftoff", e->contact);
    cell_put(f, e->speed, 9);
    fputc(',', f);
    cell_put(f, e->peak_force_N, 9);
    fputc('\n', f);
}

/* Bands from the smallest to the largest value of some rows: no line is drawn through samples of a motion
 * that is faster than they are. Values beyond the bus's range are marked. */
static void draw_signal(struct figure *g, const struct log_series *r, const struct model *m, int k)
{
    const struct decimate *d = &r->bins;
    const char *legend = "beyond the bus's range";
    char name[DECODE_NAME];
    double low = (double)INFINITY, high = -(double)INFINITY, from, to;
    bool beyond = k < DECODE_OUTPUTS && r->n_beyond[k];
    chart_range_add(&low, &high, d->low[k], d->n);
    if (!(low <= high) && !beyond)
        return; /* nothing was said of it */
    decode_name(m, k, name);
    figure_panel(g, name, decode_signal(m, k)->unit, 90.0);
    for (size_t i = 0; beyond && log_series_next(r, k, &i, &from, &to); legend = NULL)
        figure_put(g, &(struct figure_layer){FIGURE_SPAN, .legend = legend, .colour = CHART_RED, .n = 1,
                                             .x = &from, .z = &to});
    figure_put(g, &(struct figure_layer){FIGURE_BAND, .n = d->n, .x = d->x, .y = d->low[k], .z = d->high[k]});
    figure_put(g, &(struct figure_layer){FIGURE_LINE, .n = d->n, .x = d->x, .y = d->high[k]});
    figure_put(g, &(struct figure_layer){FIGURE_LINE, .n = d->n, .x = d->x, .y = d->low[k]});
}

static int draw(const struct log_series *r, const struct options *o, const struct model *m)
{
    struct figure g;
    double from = r->bins.x[0];
    figure_begin_picture(&g, o, o->word[0]);
    figure_subtitle(&g, "bands: least and greatest values");
    figure_axis(&g, &(struct figure_axis){"plant time", "s", from, fmax(r->bins.last, from + 1e-9), false});
    for (int k = 0; k < decode_signals(m); k++)
        draw_signal(&g, r, m, k);
    return figure_end(&g, o);
}

static int print_rows(struct decode_log *d, const struct options *o, const struct model *m, FILE *out)
{
    static struct log_series rows;
    struct decode_row row;
    int got;
    decode_put_header(out, m);
    log_series_begin(&rows, m->n_inputs);
    while ((got = decode_log_next(d, &row)) > 0) {
        decode_put_row(out, m, &row);
        log_series_add(&rows, &row);
    }
    if (got < 0)
        return options_failure(o->usage, "%s", d->log.reader.reason);
    if (!d->rows.begun)
        return decode_no_rows(o, o->word[0]);
    return options_given(o, "svg") && rows.n ? draw(&rows, o, m) : 0;
}

static int decode_files(struct decode_log *d, const struct options *o, const struct model *m)
{
    bool rows = options_given(o, "out"), wanted = options_given(o, "events");
    FILE *out = rows ? options_create(o, "out") : stdout,
         *events = out && wanted ? options_create(o, "events") : NULL;
    bool opened = out && (events || !wanted);
    if (events)
        fputs("t_s,kind,contact,speed [m/s],peak_force [N]\n", events);
    d->rows.events.take = events ? put_event : NULL;
    d->rows.events.context = events;
    int status = opened ? print_rows(d, o, m, out) : STATUS_FAILED;
    int written = out ? options_close(o, "out", out, NULL) : 0;
    int kept = events ? options_close(o, "events", events, NULL) : 0;
    return status ? status : written ? written : kept;
}

int cmd_decode(int argc, char **argv)
{
    static struct scene_app scene;
    static struct decode_log d;
    struct options o;
    int status;
    if (!options_parse(&o, &decode_usage, argc, argv, &status))
        return status;
    status = scene_open(&scene, &o, 1, NULL);
    if (!status && !(status = open_log(&d, &o, o.word[0], &scene))) {
        status = decode_files(&d, &o, scene.config.model);
        if (!status)
            decode_log_tell(&d, o.usage->name);
        decode_log_close(&d);
    }
    if (!status)
        status =
            log_report(&o, o.word[0], options_text(&o, "interface", 0), &scene, argc, argv, NULL, NULL, NULL);
    scene_free(&scene);
    return status;
}
