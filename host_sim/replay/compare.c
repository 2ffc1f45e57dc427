/* compare.c - contactplant compare: where two logs part; see compare.h. */
#include "host_sim/replay/compare.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "host_sim/cli/options_nearest.h"
#include "host_sim/cli/unit.h"
#include "host_sim/commands.h"
#include "host_sim/replay/decode_log.h"
#include "host_sim/replay/decode_signals.h"

static const struct usage compare_usage = {
    .name = "compare",
    .words = "LOG LOG [SIGNAL=TOLERANCE]...",
    .summary =
        "Compares two recorded logs row by row and tells the first row outside the tolerances. Exits with 1\n"
        "where there is one, or where the logs have other rows. Signals without a tolerance are not "
        "compared;\n"
        "without any tolerance all must be equal. Rows while plant time stands do not count.",
    .words_help = DECODE_LOG_WORDS
    "SIGNAL is an output that the bus carries, or command_INPUT. TOLERANCE has a unit.\n",
    .examples = "  contactplant compare golden.log now.log\n"
                "  contactplant compare golden.log now.log \"penetration=0.1 um\" \"command_force=0.2 N\"\n",
    .min_words = 2,
    .words_read = 2,
    .max_words = 2 + DECODE_SIGNALS,
    .table = {decode_logs_options, scene_options},
};

/* ---- two logs ---- */

struct side {
    struct decode_log log;
    uint64_t zero, last;
    int got; /* as decode_log_next */
    struct decode_row row;
};

/* The next row with a tick of its own, which counts from `zero` then. Plant time may begin anew, at 0. */
static void step(struct side *s)
{
    unsigned run = s->row.run;
    do {
        s->got = decode_log_next(&s->log, &s->row);
        if (s->got > 0 && s->row.run != run)
            s->zero = s->last = 0;
        run = s->row.run;
    } while (s->got > 0 && s->row.tick <= s->last);
    s->last = s->row.tick;
    s->row.tick -= s->zero;
}

/* Which row is of an earlier time: below 0 that of a, above 0 that of b, 0 neither. */
static int order(const struct decode_row *a, const struct decode_row *b)
{
    if (a->run != b->run)
        return a->run < b->run ? -1 : 1;
    return (a->tick > b->tick) - (a->tick < b->tick);
}

static const char *name_of(const struct compare *c, int i)
{
    return i && c->name ? c->name : c->path[i];
}

static bool open_side(struct side *s, const struct compare *c, int i, char *text)
{
    const struct app *a = &c->scene->app;
    memset(s, 0, sizeof *s);
    s->zero = s->last = i ? c->zero : 0;
    const char *reason = decode_log_open(&s->log, c->path[i], c->interface[i], &a->scene, a->plant.tick_s);
    if (reason)
        snprintf(text, COMPARE_TEXT, "%s", reason);
    else
        step(s);
    return !reason;
}

/* The bus did not bring it. */
static bool is_gap(const struct decode_row *r, int i)
{
    if (i < DECODE_OUTPUTS)
        return !r->said[i / 2];
    return isnan(r->value[i]) && r->echoed >> (i - DECODE_OUTPUTS) & 1u;
}

/* Where the plant tells its commands, one without a sample yet is 0. */
static double value_of(const struct compare *c, const struct decode_row *r, int i)
{
    return c->gaps && i >= DECODE_OUTPUTS && isnan(r->value[i]) ? 0.0 : r->value[i];
}

/* The signal of these rows that leaves its tolerance, or -1. A value that only one of them has is outside. */
static int outside(const struct compare *c, const struct decode_row *a, const struct decode_row *b)
{
    for (int i = 0; i < decode_signals(c->scene->config.model); i++) {
        double x = value_of(c, a, i), y = value_of(c, b, i);
        bool neither = isnan(x) && isnan(y);
        if (c->gaps && (is_gap(a, i) || is_gap(b, i)))
            continue;
        if (!isnan(c->tolerance[i]) && !neither && !(fabs(x - y) <= c->tolerance[i]))
            return i;
    }
    return -1;
}

/* A value that one log alone has: in which, and what. */
static void tell_alone(const struct compare *c, const double *value, const char *unit, char *text)
{
    int has = isnan(value[0]);
    snprintf(text, COMPARE_TEXT, "%.9g %s in %.80s alone, not known in %.80s", value[has], unit,
             name_of(c, has), name_of(c, !has));
}

static enum compare_verdict tell_outside(const struct compare *c, int i, const struct decode_row *a,
                                         const struct decode_row *b, char *text)
{
    const struct model *m = c->scene->config.model;
    const double value[2] = {a->value[i], b->value[i]}, apart = fabs(value[0] - value[1]);
    const char *unit = decode_signal(m, i)->unit;
    char name[DECODE_NAME], how[COMPARE_TEXT];
    if (c->part_s)
        *c->part_s = a->t_s;
    decode_name(m, i, name);
    if (isnan(apart))
        tell_alone(c, value, unit, how);
    else
        snprintf(how, sizeof how, "%.9g and %.9g %s, apart by %.3g, %.3g allowed", value[0], value[1], unit,
                 apart, c->tolerance[i]);
    snprintf(text, COMPARE_TEXT, "they part at %.9g s of plant time (frame %llu): %s is %.200s", a->t_s,
             (unsigned long long)a->frame, name, how);
    return COMPARE_APART;
}

static bool goes_on(const struct compare *c, const struct side *s)
{
    return s->got > 0 && s->row.tick <= c->end;
}

static enum compare_verdict compare_rows(const struct compare *c, struct side *a, struct side *b, char *text)
{
    unsigned long long n = 0;
    while (goes_on(c, a) && goes_on(c, b)) {
        int before = order(&a->row, &b->row);
        if (!before) {
            int i = outside(c, &a->row, &b->row);
            if (i >= 0)
                return tell_outside(c, i, &a->row, &b->row, text);
            n++;
        } else if (!c->gaps) {
            snprintf(text, COMPARE_TEXT,
                     "row %llu is tick %llu in one and %llu in the other%s: not the same course of time",
                     n + 1, (unsigned long long)a->row.tick, (unsigned long long)b->row.tick,
                     a->row.run != b->row.run ? ", where time begins anew in one alone" : "");
            return COMPARE_APART;
        }
        if (before <= 0)
            step(a);
        if (before >= 0)
            step(b);
    }
    if (a->got < 0 || b->got < 0) {
        snprintf(text, COMPARE_TEXT, "%s", (a->got < 0 ? a : b)->log.log.reader.reason);
        return COMPARE_BAD;
    }
    snprintf(text, COMPARE_TEXT, "%llu rows agree", n);
    if (n && goes_on(c, a) == goes_on(c, b))
        return COMPARE_EQUAL;
    bool first = goes_on(c, b);
    if (n)
        snprintf(text, COMPARE_TEXT, "%s ends first, after %llu rows", name_of(c, first ? 0 : 1), n);
    else
        snprintf(text, COMPARE_TEXT,
                 "%s has no row of this plant while its time runs; is its --base-id another one?",
                 name_of(c, a->log.rows.begun && goes_on(c, a) ? 1 : 0));
    return n ? COMPARE_APART : COMPARE_BAD;
}

enum compare_verdict compare_logs(const struct compare *c, char *text)
{
    static struct side a, b;
    enum compare_verdict v = COMPARE_BAD;
    if (!open_side(&a, c, 0, text))
        return v;
    if (open_side(&b, c, 1, text)) {
        v = compare_rows(c, &a, &b, text);
        for (int i = 0; i < 2 && v != COMPARE_BAD; i++)
            decode_log_tell(i ? &b.log : &a.log, c->command);
        decode_log_close(&b.log);
    }
    decode_log_close(&a.log);
    return v;
}

/* ---- the command ---- */

static int read_tolerance(const struct options *o, const struct model *m, const char *word, struct compare *c)
{
    char name[DECODE_SIGNALS][DECODE_NAME], why[UNIT_REASON];
    const char *names[DECODE_SIGNALS], *equal = strchr(word, '=');
    int n = decode_signals(m);
    size_t length = equal ? (size_t)(equal - word) : 0;
    if (!equal)
        return options_misuse(o->usage, "%s: write SIGNAL=TOLERANCE; a scene is given by --model", word);
    for (int i = 0; i < n; i++) {
        decode_name(m, i, name[i]);
        names[i] = name[i];
        if (strlen(name[i]) != length || strncmp(name[i], word, length))
            continue;
        if (!unit_read(equal + 1, strlen(equal + 1), decode_signal(m, i)->unit, &c->tolerance[i], why))
            return options_misuse(o->usage, "%s: %s", word, why);
        return c->tolerance[i] >= 0.0 ? 0 : options_misuse(o->usage, "%s: a tolerance is 0 or more", word);
    }
    return options_misuse(o->usage, "%s: no such signal%s", word,
                          options_advise(word, length, names, n, NULL));
}

int cmd_compare(int argc, char **argv)
{
    static struct scene_app scene;
    struct compare c = {.command = "compare", .scene = &scene, .end = UINT64_MAX};
    struct options o;
    char text[COMPARE_TEXT];
    int status;
    if (!options_parse(&o, &compare_usage, argc, argv, &status))
        return status;
    status = decode_scene(&scene, &o, OPTIONS_WORDS);
    for (int i = 0; i < DECODE_SIGNALS; i++)
        c.tolerance[i] = o.n_words > 2 ? (double)NAN : 0.0;
    for (int i = 2; i < o.n_words && !status; i++)
        status = read_tolerance(&o, scene.config.model, o.word[i], &c);
    if (!status) {
        for (int i = 0; i < 2; i++) {
            c.path[i] = o.word[i];
            c.interface[i] = options_text(&o, "interface", options_count(&o, "interface") > 1 ? i : 0);
        }
        enum compare_verdict v = compare_logs(&c, text);
        if (v == COMPARE_BAD)
            status = options_failure(&compare_usage, "%s", text);
        else
            printf("%s\n", text);
        status = v == COMPARE_APART ? STATUS_FAILED : status;
    }
    scene_free(&scene);
    return status;
}
