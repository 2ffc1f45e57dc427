/* decode.c - contactplant decode: a log as a table; contactplant compare: where two logs part. */
#include "host_sim/replay/log_report.h"
#include "host_sim/cli/names.h"
#include "host_sim/cli/options.h"
#include "host_sim/cli/unit.h"
#include "host_sim/commands.h"
#include "host_sim/scene/scene.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NAME = 64 };

static const struct option decode_own[] = {
    {"out", "FILE", "rows as CSV (standard output)", OPTION_TEXT, .initial = NULL},
    {"events", "FILE", "contact events as CSV: time, kind, contact, speed, peak force", OPTION_TEXT,
     .initial = NULL},
    {"report", "FILE", "a page with charts of rows and events, which opens in a browser without a network",
     OPTION_TEXT, .initial = NULL},
    {.name = NULL},
};

static const struct option compare_own[] = {
    {"model", "NAME", "the plant's model or scene, as given to contactplant run (hertz_rig)", OPTION_TEXT,
     .initial = NULL},
    {.name = NULL},
};

#define LOG_WORDS "LOG is a log of contactplant run --log, of contactplant test --log, or of candump -L.\n"

static const struct usage decode_usage = {
    .name = "decode",
    .words = "LOG [SCENE]",
    .summary =
        "Prints a recorded log as a table in SI units, a row for each SYNC of the plant: plant time, state,\n"
        "the outputs that the bus carries, and the newest sample streamed to each input. Give the SCENE and\n"
        "options of the recorded run.",
    .words_help = LOG_WORDS SCENE_WORDS_HELP,
    .examples = "  contactplant decode run.log --out run.csv --events events.csv\n"
                "  contactplant decode field.log my.ini --base-id 0x240 | head\n",
    .min_words = 1,
    .max_words = 2,
    .table = {decode_own, scene_options},
};

static const struct usage compare_usage = {
    .name = "compare",
    .words = "LOG LOG [SIGNAL=TOLERANCE]...",
    .summary =
        "Compares two recorded logs row by row and tells the first row outside the tolerances. Exits with 1\n"
        "where there is one, or where the logs have other rows. Signals without a tolerance are not "
        "compared;\n"
        "without any tolerance all must be equal.",
    .words_help =
        LOG_WORDS "SIGNAL is an output that the bus carries, or command_INPUT. TOLERANCE has a unit.\n",
    .examples = "  contactplant compare golden.log now.log\n"
                "  contactplant compare golden.log now.log \"penetration=0.1 um\" \"command_force=0.2 N\"\n",
    .min_words = 2,
    .max_words = 2 + DECODE_SIGNALS,
    .table = {compare_own, scene_options},
};

/* ---- signals ---- */

static const struct signal *signal_at(const struct model *m, int i)
{
    return i < DECODE_OUTPUTS ? &m->output_signal[i] : &m->input_signal[i - DECODE_OUTPUTS];
}

static int signals(const struct model *m)
{
    return DECODE_OUTPUTS + m->n_inputs;
}

static void name_signal(const struct model *m, int i, char text[NAME])
{
    snprintf(text, NAME, "%s%s", i < DECODE_OUTPUTS ? "" : "command_", signal_at(m, i)->name);
}

/* The scene's identity and tick. 0, or the exit status. */
static int open_scene(struct scene_app *s, const struct options *o, int i_word)
{
    char why[SCENE_REASON];
    if (!scene_from_options(s, o, i_word))
        return STATUS_MISUSED;
    return scene_start(s, NULL, why) ? 0 : options_misuse(o->usage, "%s", why);
}

static int open_log(struct decode *d, const struct options *o, const char *path, const struct scene_app *s)
{
    const char *reason = decode_open(d, path, &s->app.scene, s->app.plant.tick_s);
    return reason ? options_failure(o->usage, "%s", reason) : 0;
}

static int no_rows(const struct options *o, const char *path)
{
    return options_failure(o->usage, "%s has no SYNC of this plant; is its --base-id another one?", path);
}

/* ---- decode ---- */

static void put_number(FILE *f, double x)
{
    if (!isnan(x))
        fprintf(f, ",%.9g", x);
    else
        fputc(',', f);
}

static void put_row(FILE *f, const struct model *m, const struct decode_row *r)
{
    const char *state = names_text(m, NAMES_STATE, (unsigned)r->state);
    fprintf(f, "%.9f,%llu,%llu,%s,%u", r->t_s, (unsigned long long)r->frame, (unsigned long long)r->tick,
            state ? state : "", r->closed);
    for (int i = 0; i < signals(m); i++)
        put_number(f, r->value[i]);
    fputc('\n', f);
}

static void put_event(void *context, const struct decode_event *e)
{
    FILE *f = context;
    fprintf(f, "%.12g,%s,%u,%.9g,%.9g\n", e->t_s, e->touch ? "touchdown" : "liftoff", e->contact, e->speed,
            e->peak_force_N);
}

static int print_rows(struct decode *d, const struct options *o, const struct model *m, FILE *out)
{
    struct decode_row row;
    char name[NAME];
    int got;
    fputs("t_s,frame,tick,state,in_contact", out);
    for (int i = 0; i < signals(m); i++) {
        name_signal(m, i, name);
        fprintf(out, ",%s [%s]", name, signal_at(m, i)->unit);
    }
    fputc('\n', out);
    while ((got = decode_next(d, &row)) > 0)
        put_row(out, m, &row);
    if (got < 0)
        return options_failure(o->usage, "%s", d->reader.reason);
    return d->begun ? 0 : no_rows(o, o->word[0]);
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
                                 options_text(o, "events", 0)};
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
    status = status ? status : open_scene(&scene, &o, 1);
    if (!status && !(status = open_log(&d, &o, o.word[0], &scene))) {
        status = decode_files(&d, &o, scene.config.model);
        decode_close(&d);
    }
    if (!status)
        status = log_report(&o, o.word[0], &scene, argc, argv, NULL, NULL);
    scene_free(&scene);
    return status;
}

/* ---- compare ---- */

struct tolerances {
    double value[DECODE_SIGNALS]; /* NaN: not compared */
};

static int read_tolerance(const struct options *o, const struct model *m, const char *word,
                          struct tolerances *t)
{
    char own[DECODE_SIGNALS][NAME], why[UNIT_REASON];
    const char *names[DECODE_SIGNALS], *equal = strchr(word, '=');
    int n = signals(m);
    size_t length = equal ? (size_t)(equal - word) : 0;
    if (!equal)
        return options_misuse(o->usage, "%s: write SIGNAL=TOLERANCE", word);
    for (int i = 0; i < n; i++) {
        name_signal(m, i, own[i]);
        names[i] = own[i];
        if (strlen(own[i]) != length || strncmp(own[i], word, length))
            continue;
        if (!unit_read(equal + 1, strlen(equal + 1), signal_at(m, i)->unit, &t->value[i], why))
            return options_misuse(o->usage, "%s: %s", word, why);
        return t->value[i] >= 0.0 ? 0 : options_misuse(o->usage, "%s: a tolerance is 0 or more", word);
    }
    char name[NAME];
    snprintf(name, sizeof name, "%.*s", (int)length, word);
    const char *nearest = options_nearest(name, names, n);
    return options_misuse(o->usage, "%s: no such signal%s%s%s", word, nearest ? "; did you mean " : "",
                          nearest ? nearest : "", nearest ? "?" : "");
}

static int read_tolerances(const struct options *o, const struct model *m, struct tolerances *t)
{
    int status = 0;
    for (int i = 0; i < DECODE_SIGNALS; i++)
        t->value[i] = o->n_words > 2 ? (double)NAN : 0.0;
    for (int i = 2; i < o->n_words && !status; i++)
        status = read_tolerance(o, m, o->word[i], t);
    return status;
}

/* The signal of these rows that leaves its tolerance, or -1. A value that only one of them has is outside. */
static int outside(const struct model *m, const struct tolerances *t, const struct decode_row *a,
                   const struct decode_row *b)
{
    for (int i = 0; i < signals(m); i++) {
        bool neither = isnan(a->value[i]) && isnan(b->value[i]);
        if (!isnan(t->value[i]) && !neither && !(fabs(a->value[i] - b->value[i]) <= t->value[i]))
            return i;
    }
    return -1;
}

static int tell_outside(const struct model *m, const struct tolerances *t, int i, const struct decode_row *a,
                        const struct decode_row *b)
{
    char name[NAME];
    const char *unit = signal_at(m, i)->unit;
    name_signal(m, i, name);
    printf("they part at %.9g s of plant time (frame %llu): %s is %.9g and %.9g %s, apart by %.3g, %.3g "
           "allowed\n",
           a->t_s, (unsigned long long)a->frame, name, a->value[i], b->value[i], unit,
           fabs(a->value[i] - b->value[i]), t->value[i]);
    return STATUS_FAILED;
}

static int compare_rows(struct decode *a, struct decode *b, const struct options *o, const struct model *m,
                        const struct tolerances *t)
{
    struct decode_row x, y;
    unsigned long long n = 0;
    for (;; n++) {
        int got = decode_next(a, &x), other = decode_next(b, &y);
        if (got < 0 || other < 0)
            return options_failure(o->usage, "%s", got < 0 ? a->reader.reason : b->reader.reason);
        if (!got && !other)
            break;
        if (got != other) {
            printf("%s ends first, after %llu rows\n", o->word[got ? 1 : 0], n);
            return STATUS_FAILED;
        }
        if (x.tick != y.tick) {
            printf("row %llu is tick %llu in one and %llu in the other: not the same course of time\n", n + 1,
                   (unsigned long long)x.tick, (unsigned long long)y.tick);
            return STATUS_FAILED;
        }
        int i = outside(m, t, &x, &y);
        if (i >= 0)
            return tell_outside(m, t, i, &x, &y);
    }
    if (!n)
        return no_rows(o, o->word[0]);
    printf("%llu rows agree\n", n);
    return STATUS_DONE;
}

int cmd_compare(int argc, char **argv)
{
    static struct scene_app scene;
    static struct decode a, b;
    struct options o;
    struct tolerances t;
    int status;
    if (!options_parse(&o, &compare_usage, argc, argv, &status))
        return status;
    status = open_scene(&scene, &o, OPTIONS_WORDS);
    status = status ? status : read_tolerances(&o, scene.config.model, &t);
    if (!status && !(status = open_log(&a, &o, o.word[0], &scene))) {
        if (!(status = open_log(&b, &o, o.word[1], &scene))) {
            status = compare_rows(&a, &b, &o, scene.config.model, &t);
            decode_close(&b);
        }
        decode_close(&a);
    }
    scene_free(&scene);
    return status;
}
