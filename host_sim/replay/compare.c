/* compare.c - contactplant compare: where two logs part; see compare.h. */
#include "host_sim/replay/compare.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "host_sim/cli/options_nearest.h"
#include "host_sim/cli/unit.h"
#include "host_sim/commands.h"
#include "host_sim/out/plural.h"
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

enum { ROWS_NOTED = 64 };

/* ---- two logs ---- */

static void note_place(struct compare_side *s)
{
    log_reader_tell(&s->log.log.reader, &s->place);
    s->before = s->log.rows;
    s->since = 0;
}

/* As decode_log_next, into s->row; of a log that may grow the last row is left for later. */
static int next_row(struct compare_side *s, bool grows)
{
    struct decode_row row;
    if (grows && s->since == ROWS_NOTED)
        note_place(s);
    int got = decode_log_next(&s->log, &row);
    if (got <= 0 || (grows && s->log.ended))
        return got < 0 ? got : 0;
    s->row = row;
    s->since++;
    return got;
}

/* The next row with a tick of its own, which counts from `zero` then. Plant time may begin anew, at 0. */
static void step(struct compare_side *s, bool grows)
{
    unsigned run = s->row.run;
    do {
        s->got = next_row(s, grows);
        if (s->got > 0 && s->row.run != run)
            s->zero = s->last = 0;
        run = s->row.run;
    } while (s->got > 0 && s->row.tick <= s->last);
    if (s->got <= 0)
        return;
    s->last = s->row.tick;
    s->row.tick -= s->zero;
}

/* From the end of what was there on: what was read of the last rows is read again. */
static void resume(struct compare_side *s)
{
    struct decode_row row;
    s->log.rows = s->before;
    s->log.ended = false;
    bool good = log_reader_seek(&s->log.log.reader, &s->place);
    for (unsigned i = 0; good && i < s->since; i++)
        good = decode_log_next(&s->log, &row) > 0;
    if (good)
        step(s, true);
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

static bool open_side(struct compare_course *g, int i)
{
    const struct compare *c = &g->c;
    struct compare_side *s = &g->side[i];
    const struct app *a = &c->scene->app;
    memset(s, 0, sizeof *s);
    s->zero = s->last = i ? c->zero : 0;
    const char *reason = decode_log_open(&s->log, c->path[i], c->interface[i], &a->scene, a->plant.tick_s);
    if (reason) {
        snprintf(g->text, COMPARE_TEXT, "%s", reason);
        return false;
    }
    note_place(s);
    step(s, g->grow);
    return true;
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
        if (!isnan(c->limit[i].tolerance) && !neither && !(fabs(x - y) <= c->limit[i].tolerance))
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

static void tell_outside(const struct compare *c, int i, const struct decode_row *a,
                         const struct decode_row *b, char *text)
{
    const struct model *m = c->scene->config.model;
    const struct compare_limit *l = &c->limit[i];
    const double value[2] = {a->value[i] / l->one, b->value[i] / l->one};
    const double apart = fabs(a->value[i] - b->value[i]) / l->one;
    const char *unit = *l->unit ? l->unit : decode_signal(m, i)->unit;
    char name[DECODE_NAME], how[COMPARE_TEXT];
    if (c->part_s)
        *c->part_s = a->t_s;
    decode_name(m, i, name);
    if (isnan(apart))
        tell_alone(c, value, unit, how);
    else
        snprintf(how, sizeof how, "%.9g and %.9g %s, apart by %.3g, %.3g allowed", value[0], value[1], unit,
                 apart, l->tolerance / l->one);
    snprintf(text, COMPARE_TEXT, "they part at %.9g s of plant time (frame %llu): %s is %.200s", a->t_s,
             (unsigned long long)a->frame, name, how);
}

static bool goes_on(const struct compare *c, const struct compare_side *s)
{
    return s->got > 0 && s->row.tick <= c->end;
}

/* The next rows; before: which of them is earlier. */
static void judge_rows(struct compare_course *g, int before)
{
    const struct decode_row *a = &g->side[0].row, *b = &g->side[1].row;
    int i = before ? -1 : outside(&g->c, a, b);
    if (!before && g->each)
        g->each(g->context, a, b);
    if (g->part)
        return;
    g->part = i >= 0 || (before && !g->c.gaps);
    g->rows += !before && !g->part;
    if (i >= 0)
        tell_outside(&g->c, i, a, b, g->text);
    else if (g->part)
        snprintf(g->text, COMPARE_TEXT,
                 "row %llu is tick %llu in one and %llu in the other%s: not the same course of time",
                 (unsigned long long)g->rows + 1, (unsigned long long)a->tick, (unsigned long long)b->tick,
                 a->run != b->run ? ", where time begins anew in one alone" : "");
}

/* Logs that do not part in a row. */
static enum compare_verdict tell_ends(const struct compare_course *g, char *text)
{
    const struct compare *c = &g->c;
    const struct compare_side *a = &g->side[0], *b = &g->side[1];
    unsigned long long n = g->rows;
    bool first = goes_on(c, b);
    if (a->got < 0 || b->got < 0)
        snprintf(text, COMPARE_TEXT, "%s", (a->got < 0 ? a : b)->log.log.reader.reason);
    else if (!n)
        snprintf(text, COMPARE_TEXT,
                 "%s has no row of this plant while its time runs; is its --base-id another one?",
                 name_of(c, a->log.rows.begun && goes_on(c, a) ? 1 : 0));
    else if (goes_on(c, a) == goes_on(c, b))
        snprintf(text, COMPARE_TEXT, "%llu row%s agree%s", n, plural((double)n), singular((double)n));
    else
        snprintf(text, COMPARE_TEXT, "%s ends first, after %llu row%s", name_of(c, first ? 0 : 1), n,
                 plural((double)n));
    if (a->got < 0 || b->got < 0 || !n)
        return COMPARE_BAD;
    return goes_on(c, a) == goes_on(c, b) ? COMPARE_EQUAL : COMPARE_APART;
}

bool compare_open(struct compare_course *g)
{
    g->verdict = COMPARE_BAD;
    if (open_side(g, 0)) {
        if (open_side(g, 1))
            return true;
        decode_log_close(&g->side[0].log);
    }
    return false;
}

void compare_go_on(struct compare_course *g)
{
    struct compare_side *a = &g->side[0], *b = &g->side[1];
    for (int i = 0; i < 2; i++)
        if (g->grow && g->side[i].got == 0)
            resume(&g->side[i]);
    while (goes_on(&g->c, a) && goes_on(&g->c, b) && (g->each || !g->part)) {
        int before = order(&a->row, &b->row);
        judge_rows(g, before);
        if (before <= 0)
            step(a, g->grow);
        if (before >= 0)
            step(b, g->grow);
    }
    g->verdict = g->part ? COMPARE_APART : tell_ends(g, g->text);
}

void compare_close(struct compare_course *g)
{
    for (int i = 0; i < 2; i++)
        decode_log_close(&g->side[i].log);
}

enum compare_verdict compare_logs(const struct compare *c, char *text)
{
    static struct compare_course g;
    g = (struct compare_course){.c = *c};
    if (compare_open(&g)) {
        compare_go_on(&g);
        for (int i = 0; i < 2 && g.verdict != COMPARE_BAD; i++)
            decode_log_tell(&g.side[i].log, c->command);
        compare_close(&g);
    }
    memcpy(text, g.text, COMPARE_TEXT);
    return g.verdict;
}

/* ---- the command ---- */

static int read_tolerance(const struct options *o, const struct model *m, const char *word, struct compare *c)
{
    char name[DECODE_SIGNALS][DECODE_NAME], why[UNIT_REASON];
    const char *names[DECODE_SIGNALS], *equal = strchr(word, '=');
    int n = decode_signals(m);
    size_t length = equal ? (size_t)(equal - word) : 0;
    if (!equal)
        return options_misuse(o->usage, "%s: write SIGNAL=TOLERANCE%s", word,
                              c->command ? "; a scene is given by --model" : "");
    for (int i = 0; i < n; i++) {
        decode_name(m, i, name[i]);
        names[i] = name[i];
        if (strlen(name[i]) != length || strncmp(name[i], word, length))
            continue;
        struct compare_limit *l = &c->limit[i];
        const char *text = equal + 1 + strspn(equal + 1, " \t"), *unit = decode_signal(m, i)->unit;
        if (!isnan(l->tolerance))
            return options_misuse(o->usage, "%s: a tolerance of this signal is given already", word);
        if (!unit_read(text, strlen(text), unit, &l->tolerance, why))
            return options_misuse(o->usage, "%s: %s", word, why);
        l->one = unit_asked(text, strlen(text), unit, l->unit);
        return l->tolerance >= 0.0 ? 0 : options_misuse(o->usage, "%s: a tolerance is 0 or more", word);
    }
    return options_misuse(o->usage, "%s: no such signal%s", word,
                          options_advise(word, length, names, n, NULL));
}

int compare_allow(struct compare *c, const struct options *o, const char *const *word, int n)
{
    int status = 0;
    for (int i = 0; i < DECODE_SIGNALS; i++)
        c->limit[i] = (struct compare_limit){n ? (double)NAN : 0.0, 1.0, ""};
    for (int i = 0; i < n && !status; i++)
        status = read_tolerance(o, c->scene->config.model, word[i], c);
    return status;
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
    status = scene_open(&scene, &o, OPTIONS_WORDS, NULL);
    status = status ? status : compare_allow(&c, &o, o.word + 2, o.n_words - 2);
    if (!status) {
        for (int i = 0; i < 2; i++) {
            c.path[i] = o.word[i];
            c.interface[i] = decode_interface(&o, i);
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
