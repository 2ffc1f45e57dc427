/* decode.c - contactplant decode: a log as a table. */
#include "host_sim/replay/decode_signals.h"
#include "host_sim/cli/chart.h"
#include "host_sim/cli/names.h"
#include "host_sim/cli/options.h"
#include "host_sim/commands.h"
#include "host_sim/replay/log_report.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct option decode_own[] = {
    {"out", "FILE", "rows as CSV (standard output)", OPTION_TEXT, .initial = NULL},
    {"events", "FILE", "contact events as CSV: time, kind, contact, speed, peak force", OPTION_TEXT,
     .initial = NULL},
    {"svg", "FILE", "also draw it: each signal over plant time", OPTION_TEXT, .initial = NULL},
    {"report", "FILE", "a page with charts of rows and events, which opens in a browser without a network",
     OPTION_TEXT, .initial = NULL},
    {.name = NULL},
};

static const struct usage decode_usage = {
    .name = "decode",
    .words = "LOG [SCENE]",
    .summary =
        "Prints a recorded log as a table in SI units, a row for each SYNC of the plant: plant time, state,\n"
        "the outputs that the bus carries, and the newest sample streamed to each input. Give the SCENE and\n"
        "options of the recorded run.",
    .words_help = DECODE_LOG_WORDS SCENE_WORDS_HELP,
    .examples = "  contactplant decode run.log --out run.csv --events events.csv --svg run.svg\n"
                "  contactplant decode field.log my.ini --base-id 0x240 | head\n",
    .min_words = 1,
    .max_words = 2,
    .table = {decode_own, scene_options},
};

static int open_log(struct decode *d, const struct options *o, const char *path, const struct scene_app *s)
{
    const char *reason = decode_open(d, path, &s->app.scene, s->app.plant.tick_s);
    return reason ? options_failure(o->usage, "%s", reason) : 0;
}

/* ---- decode ---- */

enum { COLUMNS = 1 + DECODE_SIGNALS, BINS = 800 };

/* All rows: time, then the signals. */
struct picture {
    double *row;
    size_t n, room;
};

struct bins {
    double x[BINS], low[BINS], high[BINS];
};

static void put_event(void *context, const struct decode_event *e)
{
    FILE *f = context;
    fprintf(f, "%.12g,%s,%u,%.9g,%.9g\n", e->t_s, e->touch ? "touchdown" : "liftoff", e->contact, e->speed,
            e->peak_force_N);
}

/* ---- the picture ---- */

static bool keep_row(struct picture *p, const struct decode_row *r)
{
    if (p->n == p->room) {
        size_t room = p->room ? 2 * p->room : 4096;
        double *bigger = realloc(p->row, room * COLUMNS * sizeof *bigger);
        if (!bigger)
            return false;
        p->row = bigger;
        p->room = room;
    }
    double *row = p->row + p->n++ * COLUMNS;
    row[0] = r->t_s;
    memcpy(row + 1, r->value, sizeof r->value);
    return true;
}

/* Column k of the bins' rows: the smallest and the largest value of each, so that no line is drawn through
 * samples of a motion that is faster than they are. */
static void bin_column(const struct picture *p, int k, struct bins *b)
{
    double begin = p->row[0], length = p->row[(p->n - 1) * COLUMNS] - begin;
    for (int i = 0; i < BINS; i++) {
        b->x[i] = begin + length * (i + 0.5) / BINS;
        b->low[i] = b->high[i] = (double)NAN;
    }
    for (size_t r = 0; r < p->n; r++) {
        double t = p->row[r * COLUMNS], v = p->row[r * COLUMNS + (size_t)k];
        int i = length > 0.0 ? (int)fmin((t - begin) / length * BINS, BINS - 1) : 0;
        b->low[i] = fmin(b->low[i], v);
        b->high[i] = fmax(b->high[i], v);
    }
}

static int draw(const struct picture *p, const struct options *o, const struct model *m)
{
    static struct bins b;
    struct chart c;
    char name[DECODE_NAME], label[2 * DECODE_NAME];
    FILE *f = fopen(options_text(o, "svg", 0), "w");
    if (!f)
        return options_failure(o->usage, "--svg %s cannot be written: %s", options_text(o, "svg", 0),
                               strerror(errno));
    chart_begin(&c, "contactplant decode", o->word[0]);
    chart_x_range(&c, p->row[0], fmax(p->row[(p->n - 1) * COLUMNS], p->row[0] + 1e-9));
    for (int k = 0; k < decode_signals(m); k++) {
        double low = (double)INFINITY, high = -(double)INFINITY;
        bin_column(p, k + 1, &b);
        chart_range_add(&low, &high, b.low, BINS);
        chart_range_add(&low, &high, b.high, BINS);
        if (!(low <= high))
            continue; /* nothing was said of it */
        chart_range_finish(&low, &high);
        decode_name(m, k, name);
        snprintf(label, sizeof label, "%s (%s)", name, decode_signal(m, k)->unit);
        chart_panel(&c, label, 90.0, low, high);
        chart_band(&c, b.x, b.low, b.high, BINS, CHART_BLUE, NULL);
        chart_line(&c, b.x, b.high, BINS, CHART_BLUE, NULL);
        chart_line(&c, b.x, b.low, BINS, CHART_BLUE, NULL);
    }
    chart_x_axis(&c, "plant time (s)");
    const char *why = chart_end(&c, f);
    bool closed = fclose(f) == 0;
    return why || !closed ? options_failure(o->usage, "--svg: %s", why ? why : "make room and run again") : 0;
}

static int print_rows(struct decode *d, const struct options *o, const struct model *m, FILE *out)
{
    struct picture picture = {NULL, 0, 0};
    bool draws = options_given(o, "svg"), kept = true;
    struct decode_row row;
    int got;
    decode_put_header(out, m);
    while ((got = decode_next(d, &row)) > 0) {
        decode_put_row(out, m, &row);
        kept = kept && (!draws || keep_row(&picture, &row));
    }
    int drawn = got >= 0 && d->begun && draws && kept && picture.n ? draw(&picture, o, m) : 0;
    free(picture.row);
    if (!kept)
        return options_failure(o->usage, "out of memory");
    if (got < 0)
        return options_failure(o->usage, "%s", d->reader.reason);
    return d->begun ? drawn : decode_no_rows(o, o->word[0]);
}

/* The file of an option, `other` without it; NULL after a message. */
static FILE *open_out(const struct options *o, const char *option, FILE *other)
{
    const char *path = options_text(o, option, 0);
    FILE *f = path ? fopen(path, "w") : other;
    if (!f && path)
        options_failure(o->usage, "--%s %s cannot be written: %s", option, path, strerror(errno));
    return f;
}

static int close_out(const struct options *o, FILE *f)
{
    bool bad = f && ferror(f);
    if (f && (f == stdout ? fflush(f) : fclose(f)))
        bad = true;
    return bad ? options_failure(o->usage, "cannot write the output; make room and run again") : 0;
}

static int decode_files(struct decode *d, const struct options *o, const struct model *m)
{
    FILE *out = open_out(o, "out", stdout), *events = out ? open_out(o, "events", NULL) : NULL;
    if (!out || (!events && options_given(o, "events"))) {
        if (out && out != stdout)
            (void)fclose(out);
        return STATUS_FAILED;
    }
    if (events)
        fputs("t_s,kind,contact,speed [m/s],peak_force [N]\n", events);
    d->heard = events ? put_event : NULL;
    d->context = events;
    int status = print_rows(d, o, m, out), written = close_out(o, out), kept = close_out(o, events);
    return status ? status : written ? written : kept;
}

/* --report is not one of the other files. */
static int check_report(const struct options *o)
{
    const char *path = options_text(o, "report", 0);
    const char *const other[] = {o->word[0], o->n_words > 1 ? o->word[1] : NULL, options_text(o, "out", 0),
                                 options_text(o, "events", 0), options_text(o, "svg", 0)};
    for (size_t i = 0; path && i < sizeof other / sizeof *other; i++)
        if (other[i] && scene_load_same(path, other[i]))
            return options_misuse(o->usage,
                                  "--report %s is another file of this command; choose one of its own", path);
    return 0;
}

int cmd_decode(int argc, char **argv)
{
    static struct scene_app scene;
    static struct decode d;
    struct options o;
    int status;
    if (!options_parse(&o, &decode_usage, argc, argv, &status))
        return status;
    status = check_report(&o);
    status = status ? status : decode_scene(&scene, &o, 1);
    if (!status && !(status = open_log(&d, &o, o.word[0], &scene))) {
        status = decode_files(&d, &o, scene.config.model);
        decode_close(&d);
    }
    if (!status)
        status = log_report(&o, o.word[0], &scene, argc, argv, NULL, NULL);
    scene_free(&scene);
    return status;
}
