/* test_read.c - see test_read.h: the sections of a test file, and what a case must have. */
#include "host_sim/test/test_read.h"

#include <math.h>
#include <string.h>
#include "host_sim/cli/options.h"
#include "host_sim/cli/options_nearest.h"
#include "host_sim/test/test_at.h"
#include "host_sim/test/test_expect.h"
#include "host_sim/test/test_keys.h"

/* Whether the plant and the controller are known, as every case needs. */
static bool check_before_case(struct test_reader *r)
{
    if (!r->test->scene.model)
        return test_wrong(r, "no plant before the first case; write [plant] and scene = hertz_rig, say");
    if (!*r->test->command && !r->test->attached)
        return test_wrong(r, "no controller before the first case; write [controller] and command = .., "
                             "builtin = keep, or attach");
    if (r->test->loops && !r->test->lever.model)
        return test_wrong(
            r, "builtin = loops are those of a microscope; write microscope = tapping in [plant], say");
    return true;
}

/* An expect that came by `like` is about the case's own target and frequency. */
static bool bind_expects(struct test_reader *r, struct test_case *c)
{
    for (int i = 0; i < c->n_expects; i++) {
        struct metric_setting *what = &c->expect[i].what;
        r->text.line = c->expect[i].line;
        bool is_target = metric_table[what->kind].of == OF_TARGET;
        if (is_target && what->signal != c->target_signal)
            return test_wrong(r, "expect: [case %s] has a target of another signal", c->name);
        if (what->from_s >= c->over_s || (isfinite(what->to_s) && what->to_s > c->over_s))
            return test_wrong(r, "expect: its window leaves the %g s of [case %s]", c->over_s, c->name);
        what->target = c->target;
        what->band = c->band;
        what->frequency_Hz = c->lockin_Hz;
    }
    return true;
}

static bool check_case(struct test_reader *r)
{
    struct test_case *c = r->now;
    int line = r->text.line;
    if (!c)
        return true;
    r->text.line = c->line;
    if (!(c->over_s > 0.0))
        return test_wrong(r, "[case %s]: how long? write over = 3 s, say", c->name);
    if (!c->n_expects && !*c->golden)
        return test_wrong(r, "[case %s]: nothing is expected; write expect METRIC OP VALUE", c->name);
    for (int i = 0; i < c->n_acts; i++)
        if (c->act[i].at_s >= c->over_s)
            return test_wrong(r, "[case %s]: an `at` at %g s is after its end at %g s", c->name,
                              c->act[i].at_s, c->over_s);
    if (!test_bind_fires(r, c) || !bind_expects(r, c))
        return false;
    r->text.line = line;
    return true;
}

static bool begin_case(struct test_reader *r, struct word name)
{
    struct test_file *t = r->test;
    if (!check_before_case(r))
        return false;
    if (!name.n)
        return test_wrong(r, "[case]: which one? write [case NAME]");
    for (int i = 0; i < t->n_cases; i++)
        if (scene_text_is(name, t->cases[i].name))
            return test_wrong(r, "[case %s] stands there already, in line %d", t->cases[i].name,
                              t->cases[i].line);
    if (t->n_cases == TEST_CASES)
        return test_wrong(r, "more than %d cases; write a second file", TEST_CASES);
    r->now = &t->cases[t->n_cases++];
    memset(r->now, 0, sizeof *r->now);
    r->now->line = r->text.line;
    r->now->plant.rate_Hz = t->plant.rate_Hz;
    r->now->plant.substeps = t->plant.substeps;
    r->now->varied = -1;
    r->now->vary.n = 1;
    r->now->first_seed = r->now->n_seeds = 1;
    r->section = TEST_IN_CASE;
    return test_copy(r, name, r->now->name, sizeof r->now->name);
}

static bool take_header(struct test_reader *r, struct word w)
{
    static const char *const names[] = {"plant", "controller", "case"};
    if (w.at[w.n - 1] != ']')
        return test_wrong(r, "%.*s: a section stands alone in its line, as [plant] or [case NAME]",
                          scene_text_shown(w), w.at);
    struct word rest = {w.at + 1, w.n - 2}, name = scene_text_take(&rest);
    if (!check_case(r))
        return false;
    memset(r->given, 0, sizeof r->given);
    memset(r->set_given, 0, sizeof r->set_given);
    if (scene_text_is(name, "case"))
        return begin_case(r, scene_text_name(rest));
    int i = scene_text_is(name, "plant")        ? TEST_IN_PLANT
            : scene_text_is(name, "controller") ? TEST_IN_CONTROLLER
                                                : 0;
    if (!i)
        return test_wrong(r, "[%.*s]: no such section%s", scene_text_shown(name), name.at,
                          options_advise(name.at, name.n, names, 3, NULL));
    if (rest.n)
        return test_wrong(r, "[%s]: one word too many", names[i - 1]);
    if (r->now || (i == TEST_IN_PLANT && r->test->scene.model) ||
        (i == TEST_IN_CONTROLLER && (*r->test->command || r->test->attached)))
        return test_wrong(r, "[%s] stands once, before the cases", names[i - 1]);
    r->section = i;
    return true;
}

static bool take_line(struct test_reader *r, struct word w)
{
    struct word rest = w, first = scene_text_take(&rest);
    if (*w.at == '[')
        return take_header(r, w);
    if (r->section == TEST_IN_NOTHING)
        return test_wrong(r, "%.*s: stands before the first section; begin with [plant]",
                          scene_text_shown(first), first.at);
    if (r->section == TEST_IN_CASE && scene_text_is(first, "at"))
        return test_read_at(r, rest);
    if (r->section == TEST_IN_CASE && scene_text_is(first, "expect"))
        return test_read_expect(r, rest);
    return test_read_key(r, w);
}

bool test_parse(const char *file, const char *text, size_t n,
                bool (*load)(const char *file, const char *name, struct scene *s, char *why),
                struct test_file *t, char *why)
{
    struct test_reader r = {
        .text = {.file = file, .what = "test", .shell_key = "command", .why = why, .rest = {text, n}},
        .test = t,
        .load = load};
    struct word w;
    memset(t, 0, sizeof *t);
    t->file = file;
    *why = 0;
    if (n > TEST_BYTES)
        return scene_text_wrong(file, 0, why, "larger than %d bytes: not a test", TEST_BYTES);
    while (scene_text_next(&r.text, &w))
        if (!take_line(&r, w))
            return false;
    if (*why || !check_case(&r))
        return false;
    return t->n_cases ? true
                      : scene_text_wrong(file, 0, why, "no case; write [case NAME] with over = and expect");
}
