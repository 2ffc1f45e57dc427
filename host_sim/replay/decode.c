/* decode.c - contactplant decode: a log as a table. */
#include "host_sim/replay/decode_signals.h"
#include "host_sim/cli/names.h"
#include "host_sim/cli/options.h"
#include "host_sim/commands.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct option decode_own[] = {
    {"out", "FILE", "rows as CSV (standard output)", OPTION_TEXT, .initial = NULL},
    {"events", "FILE", "contact events as CSV: time, kind, contact, speed, peak force", OPTION_TEXT,
     .initial = NULL},
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
    .examples = "  contactplant decode run.log --out run.csv --events events.csv\n"
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
    for (int i = 0; i < decode_signals(m); i++)
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
    char name[DECODE_NAME];
    int got;
    fputs("t_s,frame,tick,state,in_contact", out);
    for (int i = 0; i < decode_signals(m); i++) {
        decode_name(m, i, name);
        fprintf(out, ",%s [%s]", name, decode_signal(m, i)->unit);
    }
    fputc('\n', out);
    while ((got = decode_next(d, &row)) > 0)
        put_row(out, m, &row);
    if (got < 0)
        return options_failure(o->usage, "%s", d->reader.reason);
    return d->begun ? 0 : decode_no_rows(o, o->word[0]);
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

int cmd_decode(int argc, char **argv)
{
    static struct scene_app scene;
    static struct decode d;
    struct options o;
    int status;
    if (!options_parse(&o, &decode_usage, argc, argv, &status))
        return status;
    status = decode_scene(&scene, &o, 1);
    if (!status && !(status = open_log(&d, &o, o.word[0], &scene))) {
        status = decode_files(&d, &o, scene.config.model);
        decode_close(&d);
    }
    scene_free(&scene);
    return status;
}
