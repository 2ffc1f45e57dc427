/* test_expect.c - see test_expect.h. */
#include "host_sim/test/test_expect.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "host_sim/cli/options.h"
#include "host_sim/cli/options_nearest.h"
#include "host_sim/cli/unit.h"

#define TIME_MAX  1e6
#define VALUE_MAX 1e300

static bool is_signals(enum metric_kind k)
{
    return metric_table[k].of == OF_SIGNAL;
}

/* Neither a metric of the plant as a whole nor one of the n signals in names[METRIC_SIGNALS + METRICS]: the
 * nearest of both. */
static bool no_metric(struct test_reader *r, struct word name, const char **names, int n)
{
    for (int k = 0; k < METRICS; k++)
        if (!is_signals((enum metric_kind)k))
            names[n++] = metric_table[k].name;
    return test_wrong(r, "expect: no metric \"%.*s\"%s", scene_text_shown(name), name.at,
                      options_advise(name.at, name.n, names, n, "contactplant list metrics shows them"));
}

/* SIGNAL or SIGNAL.STATISTIC; a bare signal is judged at every instant. */
static bool read_signal(struct test_reader *r, struct test_expect *e, struct word name)
{
    const char *dot = memchr(name.at, '.', name.n), *known[METRICS], *names[METRIC_SIGNALS + METRICS];
    int n = 0;
    struct word signal = {name.at, dot ? (size_t)(dot - name.at) : name.n}, statistic = {dot, 0};
    const struct model *m = r->test->scene.model;
    e->what.signal = test_list_signals(m, signal, names);
    if (e->what.signal < 0)
        return no_metric(r, signal, names, metric_signals(m));
    e->what.kind = METRICS;
    if (!dot)
        return true;
    statistic = (struct word){dot + 1, name.n - signal.n - 1};
    for (int k = 0; k < METRICS; k++) {
        if (!is_signals((enum metric_kind)k))
            continue;
        known[n++] = metric_table[k].name;
        e->what.kind = scene_text_is(statistic, metric_table[k].name) ? (enum metric_kind)k : e->what.kind;
    }
    return e->what.kind < METRICS
               ? true
               : test_wrong(r, "expect: no statistic \"%.*s\" of a signal%s", scene_text_shown(statistic),
                            statistic.at, options_advise(statistic.at, statistic.n, known, n, NULL));
}

static bool read_metric(struct test_reader *r, struct test_expect *e, struct word name)
{
    for (int k = 0; k < METRICS; k++)
        if (!is_signals((enum metric_kind)k) && scene_text_is(name, metric_table[k].name)) {
            e->what.kind = (enum metric_kind)k;
            e->what.signal = metric_table[k].of == OF_TARGET ? r->now->target_signal : -1;
            return true;
        }
    return read_signal(r, e, name);
}

static bool read_operator(struct test_reader *r, struct test_expect *e, struct word w)
{
    static const char *const text[] = {"==", "!=", "<=", ">=", "<", ">"};
    for (int i = 0; i < 6; i++)
        if (scene_text_is(w, text[i])) {
            e->op = (enum test_operator)i;
            return true;
        }
    return test_wrong(r, "expect: \"%.*s\" stands where an operator belongs: == != <= >= < >",
                      scene_text_shown(w), w.at);
}

/* Whether the metric can be measured here. */
static bool check_metric(struct test_reader *r, struct test_expect *e)
{
    const struct model *m = r->test->scene.model;
    bool most = e->op == TEST_AT_MOST || e->op == TEST_BELOW, equal = e->op <= TEST_UNEQUAL;
    if (e->what.kind == METRICS && equal)
        return test_wrong(r,
                          "expect: a signal at every instant takes <= >= < >; or add .min, .max, .mean, ..");
    if (e->what.kind == METRICS)
        e->what.kind = most ? METRIC_MAX : METRIC_MIN;
    const struct metric *k = &metric_table[e->what.kind];
    if (k->of == OF_CONTACTS && m->n_contacts == 0)
        return test_wrong(r, "expect: %s: %s has no contact that opens", k->name, m->name);
    if (k->of == OF_TARGET && !r->now->has_target)
        return test_wrong(r, "expect: %s: write target = SIGNAL VALUE within BAND before it", k->name);
    if ((e->what.kind == METRIC_AMPLITUDE || e->what.kind == METRIC_PHASE) && !(r->now->lockin_Hz > 0.0))
        return test_wrong(r, "expect: %s: at which frequency? write lockin = 225 Hz, say, before it",
                          k->name);
    if (e->what.kind == METRIC_HASH && !equal)
        return test_wrong(r, "expect: hash: it takes == and !=");
    return true;
}

static bool read_hash(struct test_reader *r, struct test_expect *e, struct word w)
{
    e->hash = 0;
    for (size_t i = 0; i < w.n && w.n == 16; i++) {
        const char *digits = "0123456789abcdef", *at = strchr(digits, w.at[i]);
        if (!at)
            break;
        e->hash = e->hash << 4 | (uint64_t)(at - digits);
        if (i == 15)
            return true;
    }
    return test_wrong(r, "expect: hash: \"%.*s\" is not 16 digits of 0-9 a-f", scene_text_shown(w), w.at);
}

/* A prefix before a power or a bracket would be ambiguous: um^2 is 1e-12 m^2. */
static bool prefix_allowed(const char *unit)
{
    size_t n = strcspn(unit, "^ /");
    return *unit != '(' && unit[n] != '^';
}

static bool read_value(struct test_reader *r, struct test_expect *e, struct word w)
{
    char unit[METRIC_UNIT];
    if (e->what.kind == METRIC_HASH)
        return read_hash(r, e, w);
    metric_unit(r->test->scene.model, e->what.kind, e->what.signal, unit);
    size_t n = strlen(unit);
    bool equal =
        n < w.n && !memcmp(w.at + w.n - n, unit, n) && !strchr("zafpnumkMG\xB5\xBC", w.at[w.n - n - 1]);
    if (!prefix_allowed(unit) && !equal)
        return test_wrong(r, "expect: \"%.*s\": give a number in %s, without a prefix", scene_text_shown(w),
                          w.at, unit);
    e->one = unit_asked(w.at, w.n, unit, e->unit);
    return test_read_value(r, "expect", w, unit, -VALUE_MAX, VALUE_MAX, &e->value);
}

/* Takes `MARK TIME` off the end of *rest. */
static bool take_time(struct test_reader *r, struct word *rest, const char *mark, double *time)
{
    struct word tail;
    if (!test_take_tail(rest, mark, &tail))
        return true;
    return test_read_value(r, mark, tail, "s", 0.0, TIME_MAX, time);
}

static bool read_window(struct test_reader *r, struct test_expect *e, struct word *rest)
{
    e->what.from_s = 0.0;
    e->what.to_s = (double)INFINITY;
    if (!take_time(r, rest, "to", &e->what.to_s) || !take_time(r, rest, "from", &e->what.from_s))
        return false;
    if (!(e->what.to_s > e->what.from_s))
        return test_wrong(r, "expect: from %g s to %g s is no window", e->what.from_s, e->what.to_s);
    return true;
}

bool test_read_expect(struct test_reader *r, struct word rest)
{
    struct test_case *c = r->now;
    if (c->n_expects == TEST_EXPECTS)
        return test_wrong(r, "more than %d lines with expect in a case", TEST_EXPECTS);
    struct test_expect *e = &c->expect[c->n_expects];
    memset(e, 0, sizeof *e);
    e->line = r->text.line;
    e->one = 1.0;
    snprintf(e->text, sizeof e->text, "%.*s", (int)rest.n, rest.at);
    struct word metric = scene_text_take(&rest), op = scene_text_take(&rest);
    if (!op.n)
        return test_wrong(r,
                          "expect: write expect METRIC OP VALUE, for instance expect contact_loss <= 0.1 %%");
    if (!read_metric(r, e, metric) || !read_operator(r, e, op) || !check_metric(r, e) ||
        !read_window(r, e, &rest))
        return false;
    if (!rest.n)
        return test_wrong(r, "expect: the value is missing behind %.*s", scene_text_shown(op), op.at);
    if (!read_value(r, e, rest))
        return false;
    e->what.frequency_Hz = c->lockin_Hz;
    e->what.target = c->target;
    e->what.band = c->band;
    c->n_expects++;
    return true;
}
