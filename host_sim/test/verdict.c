/* verdict.c - see verdict.h. */
#include "host_sim/test/verdict.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include "host_sim/cli/files.h"
#include "host_sim/cli/ticks.h"
#include "host_sim/cli/trouble.h"
#include "host_sim/cli/unit.h"
#include "host_sim/replay/compare.h"
#include "host_sim/test/bench/controller.h"

/* Every case expects 0 of these, unless it names the metric. */
static const enum metric_kind implicit[BENCH_IMPLICIT] = {METRIC_FAULTS, METRIC_REFUSED, METRIC_TIMEOUTS,
                                                          METRIC_MALFORMED};

static bool is_named(const struct test_case *c, enum metric_kind kind)
{
    for (int i = 0; i < c->n_expects; i++)
        if (c->expect[i].what.kind == kind)
            return true;
    return false;
}

int verdict_settings(const struct test_case *c, struct metric_setting *s)
{
    int n = 0;
    for (int i = 0; i < c->n_expects; i++) {
        s[n] = c->expect[i].what;
        s[n].to_s = fmin(s[n].to_s, c->over_s);
        n++;
    }
    for (int i = 0; i < BENCH_IMPLICIT; i++)
        if (!is_named(c, implicit[i]))
            s[n++] = (struct metric_setting){.kind = implicit[i], .signal = -1, .to_s = c->over_s};
    return n;
}

void verdict_truths(const struct test_case *c, struct metric_setting *s)
{
    static const enum metric_kind kind[BENCH_TRUTHS] = {METRIC_PEAK_FORCE, METRIC_IMPACT_SPEED};
    for (int i = 0; i < BENCH_TRUTHS; i++)
        s[i] = (struct metric_setting){.kind = kind[i], .signal = -1, .to_s = c->over_s};
}

static bool holds(enum test_operator op, double value, double limit)
{
    bool equal = !(value < limit) && !(value > limit);
    switch (op) {
    case TEST_EQUAL:
        return equal;
    case TEST_UNEQUAL:
        return !equal;
    case TEST_AT_MOST:
        return value <= limit;
    case TEST_AT_LEAST:
        return value >= limit;
    case TEST_BELOW:
        return value < limit;
    default:
        return value > limit;
    }
}

/* Four digits are enough for people; the report for programs has all. */
static void write_value(double value, const char *unit, char text[UNIT_TEXT])
{
    char rounded[UNIT_TEXT];
    snprintf(rounded, sizeof rounded, "%.4g", value);
    unit_write_asked(strtod(rounded, NULL), unit, text);
}

static void describe(const struct evidence *e, const struct measurement *m, struct outcome *o)
{
    const struct metric_setting *what = &m->set;
    char more[128] = "", value[UNIT_TEXT] = "";
    const struct metric_value *v = &o->value;
    if (what->kind == METRIC_FAULTS)
        trouble_faults(e->faults, more, sizeof more);
    if (what->kind == METRIC_REFUSED)
        trouble_refusals(e->count, more, sizeof more);
    if (v->known && isfinite(v->value))
        write_value(v->value, o->unit, value);
    if (!v->known && m->untold)
        snprintf(o->found, sizeof o->found, "not judged: %s", m->untold);
    else if (!v->known && !*v->note)
        snprintf(o->found, sizeof o->found, "nothing to judge fell into its window");
    else if (*v->note)
        snprintf(o->found, sizeof o->found, "%s", v->note);
    else if (what->kind == METRIC_HASH)
        snprintf(o->found, sizeof o->found, "it was %016llx", (unsigned long long)v->hash);
    else
        snprintf(o->found, sizeof o->found, "it was %s%s%s%s at %.6g s", value, *more ? " (" : "", more,
                 *more ? ")" : "", v->when_s);
}

static void judge_one(const struct evidence *e, const struct test_expect *x, struct measurement *m,
                      struct outcome *o)
{
    if (!m->untold)
        measurement_end(m, e->now_s, e->hash, &o->value);
    o->line = x->line;
    o->kind = x->what.kind;
    memcpy(o->text, x->text, sizeof o->text);
    bool good = o->kind == METRIC_HASH ? (o->value.hash == x->hash) == (x->op == TEST_EQUAL)
                                       : holds(x->op, o->value.value, x->value);
    o->verdict = !o->value.known ? VERDICT_UNTESTED : good ? VERDICT_OK : VERDICT_FAIL;
    if (o->verdict == VERDICT_FAIL && !x->line && o->kind == METRIC_FAULTS)
        o->verdict = VERDICT_ERROR; /* the plant's own trouble */
    memcpy(o->unit, x->unit, sizeof o->unit);
    o->value.value /= x->one;
    describe(e, m, o);
}

/* After an error of the bench the measurements are incomplete and none is judged. */
void verdict_judge(const struct evidence *e, const struct test_case *c, struct measurement *m, int n,
                   struct bench_result *r)
{
    r->hash = e->hash;
    r->faults = e->faults;
    memcpy(r->count, e->count, sizeof r->count);
    for (int i = 0; i < n && r->verdict != VERDICT_ERROR; i++) {
        struct test_expect own = {.what = m[i].set, .one = 1.0};
        snprintf(own.text, sizeof own.text, "%s == 0 (every case, unless it names it)",
                 metric_table[own.what.kind].name);
        judge_one(e, i < c->n_expects ? &c->expect[i] : &own, &m[i], &r->outcome[r->n++]);
    }
    for (int i = 0; i < r->n; i++)
        if (r->outcome[i].verdict > r->verdict)
            r->verdict = r->outcome[i].verdict;
}

/* ---- a golden log ---- */

/* The option, or else the variable, that says where the record is. */
static const char *place(const struct bench_setting *s)
{
    return s->log ? "--log" : "TMPDIR";
}

bool verdict_begin_record(const struct bench_setting *s, struct bench_result *r, struct bus *bus,
                          struct verdict_record *to)
{
    char why[BUS_REASON];
    to->file = -1;
    if (!s->log && !*s->test->cases[r->i_case].golden)
        return true;
    if (s->log)
        controller_log_path(s, r, ".log", to->path);
    else
        to->file = files_make_temporary(to->path, BENCH_PATH);
    snprintf(r->log, sizeof r->log, "%s", s->log ? to->path : "");
    return bus_record(bus, to->path, 0, why) ||
           controller_fail(r, "%s: cannot write %.400s", place(s), to->path);
}

void verdict_end_record(const struct bench_setting *s, struct bench_result *r, struct bus *bus)
{
    char why[BUS_REASON];
    if (!bus_end_record(bus, why) && r->verdict != VERDICT_ERROR)
        controller_fail(r, "%s: %s", place(s), why);
}

/* A signal that is compared comes from the controller alone. */
static bool needs_commands(const struct test_case *c)
{
    bool needs = false;
    for (int i = DECODE_OUTPUTS; i < DECODE_SIGNALS; i++)
        needs = needs || !isnan(c->limit[i].tolerance);
    return needs;
}

/* A golden log that this run has just made: its folder was made for the record. */
static bool is_record(const char *golden, const char *record)
{
    struct stat x, y;
    return !stat(golden, &x) && !stat(record, &y) && x.st_dev == y.st_dev && x.st_ino == y.st_ino;
}

void verdict_compare(const struct bench_setting *s, const struct scene_app *scene, const char *record,
                     uint64_t zero, bool deaf, struct bench_result *r)
{
    const struct test_case *c = &s->test->cases[r->i_case];
    const struct app_config *a = &scene->config;
    char path[BENCH_PATH], text[COMPARE_TEXT];
    if (!*c->golden || r->verdict == VERDICT_ERROR)
        return;
    uint64_t frames = ticks_begun(c->over_s, a->frame_s);
    bench_scene_path(s->test->file, c->golden, path);
    struct compare k = {.command = "test",
                        .path = {path, record},
                        .name = s->log ? NULL : "this run",
                        .scene = scene,
                        .zero = zero,
                        .end = frames * a->substeps,
                        .gaps = s->realtime};
    memcpy(k.limit, c->limit, sizeof k.limit);
    struct outcome *o = &r->outcome[r->n++];
    o->line = c->golden_line;
    o->kind = METRICS;
    snprintf(o->text, sizeof o->text, "as golden = %.200s", c->golden);
    if (deaf && needs_commands(c)) {
        o->verdict = VERDICT_UNTESTED;
        snprintf(text, sizeof text, "not judged: " VERDICT_DEAF);
    } else if (is_record(path, record)) {
        o->verdict = VERDICT_ERROR;
        snprintf(text, sizeof text, "there was no such log, and now it is that of this very run");
    } else {
        enum compare_verdict v = compare_logs(&k, text);
        o->verdict = v == COMPARE_EQUAL ? VERDICT_OK : v == COMPARE_APART ? VERDICT_FAIL : VERDICT_ERROR;
    }
    snprintf(o->found, sizeof o->found, "%.300s", text);
    r->verdict = o->verdict > r->verdict ? o->verdict : r->verdict;
}
