/* trial_read.c - see trial_read.h: the sections of a test file, and what a case must have. */
#include "host_sim/trial/trial_read.h"

#include <math.h>
#include <string.h>
#include "host_sim/cli/options.h"
#include "host_sim/cli/options_nearest.h"
#include "host_sim/trial/trial_at.h"
#include "host_sim/trial/trial_expect.h"
#include "host_sim/trial/trial_keys.h"

/* Whether the plant and the controller are known, as every case needs. */
static bool check_before_case(struct trial_reader *r)
{
    if (!r->trial->scene.model)
        return trial_wrong(r, "no plant before the first case; write [plant] and scene = hertz_rig, say");
    if (!*r->trial->command && !r->trial->attached)
        return trial_wrong(r, "no controller before the first case; write [controller] and command = .., "
                              "builtin = keep, or attach");
    if (r->trial->loops && !r->trial->lever.model)
        return trial_wrong(
            r, "builtin = loops are those of a microscope; write microscope = tapping in [plant], say");
    return true;
}

/* An expect that came by `like` is about the case's own target and frequency. */
static bool bind_expects(struct trial_reader *r, struct trial_case *c)
{
    for (int i = 0; i < c->n_expects; i++) {
        struct metric_setting *what = &c->expect[i].what;
        r->text.line = c->expect[i].line;
        bool is_target = metric_table[what->kind].of == OF_TARGET;
        if (is_target && what->signal != c->target_signal)
            return trial_wrong(r, "expect: [case %s] has a target of another signal", c->name);
        if (what->from_s >= c->over_s || (isfinite(what->to_s) && what->to_s > c->over_s))
            return trial_wrong(r, "expect: its window leaves the %g s of [case %s]", c->over_s, c->name);
        what->target = c->target;
        what->band = c->band;
        what->frequency_Hz = c->lockin_Hz;
    }
    return true;
}

static bool check_case(struct trial_reader *r)
{
    struct trial_case *c = r->now;
    int line = r->text.line;
    if (!c)
        return true;
    r->text.line = c->line;
    if (!(c->over_s > 0.0))
        return trial_wrong(r, "[case %s]: how long? write over = 3 s, say", c->name);
    if (!c->n_expects && !*c->golden)
        return trial_wrong(r, "[case %s]: nothing is expected; write expect METRIC OP VALUE", c->name);
    for (int i = 0; i < c->n_acts; i++)
        if (c->act[i].at_s >= c->over_s)
            return trial_wrong(r, "[case %s]: an `at` at %g s is after its end at %g s", c->name,
                               c->act[i].at_s, c->over_s);
    if (!trial_bind_fires(r, c) || !bind_expects(r, c))
        return false;
    r->text.line = line;
    return true;
}

static bool begin_case(struct trial_reader *r, struct word name)
{
    struct trial *t = r->trial;
    if (!check_before_case(r))
        return false;
    if (!name.n)
        return trial_wrong(r, "[case]: which one? write [case NAME]");
    for (int i = 0; i < t->n_cases; i++)
        if (scene_text_is(name, t->cases[i].name))
            return trial_wrong(r, "[case %s] stands there already, in line %d", t->cases[i].name,
                               t->cases[i].line);
    if (t->n_cases == TRIAL_CASES)
        return trial_wrong(r, "more than %d cases; write a second file", TRIAL_CASES);
    r->now = &t->cases[t->n_cases++];
    memset(r->now, 0, sizeof *r->now);
    r->now->line = r->text.line;
    r->now->plant.rate_Hz = t->plant.rate_Hz;
    r->now->plant.substeps = t->plant.substeps;
    r->now->varied = -1;
    r->now->vary.n = 1;
    r->now->first_seed = r->now->n_seeds = 1;
    r->section = TRIAL_IN_CASE;
    return trial_copy(r, name, r->now->name, sizeof r->now->name);
}

static bool take_header(struct trial_reader *r, struct word w)
{
    static const char *const names[] = {"plant", "controller", "case"};
    char text[OPTIONS_ADVICE];
    if (w.at[w.n - 1] != ']')
        return trial_wrong(r, "%.*s: a section stands alone in its line, as [plant] or [case NAME]",
                           scene_text_shown(w), w.at);
    struct word rest = {w.at + 1, w.n - 2}, name = scene_text_take(&rest);
    if (!check_case(r))
        return false;
    memset(r->given, 0, sizeof r->given);
    if (scene_text_is(name, "case"))
        return begin_case(r, rest);
    int i = scene_text_is(name, "plant")        ? TRIAL_IN_PLANT
            : scene_text_is(name, "controller") ? TRIAL_IN_CONTROLLER
                                                : 0;
    if (!i)
        return trial_wrong(r, "[%.*s]: no such section%s", scene_text_shown(name), name.at,
                           options_advise(name.at, name.n, names, 3, NULL, text, sizeof text));
    if (rest.n)
        return trial_wrong(r, "[%s]: one word too many", names[i - 1]);
    if (r->now || (i == TRIAL_IN_PLANT && r->trial->scene.model) ||
        (i == TRIAL_IN_CONTROLLER && (*r->trial->command || r->trial->attached)))
        return trial_wrong(r, "[%s] stands once, before the cases", names[i - 1]);
    r->section = i;
    return true;
}

static bool take_line(struct trial_reader *r, struct word w)
{
    struct word rest = w, first = scene_text_take(&rest);
    if (*w.at == '[')
        return take_header(r, w);
    if (r->section == TRIAL_IN_NOTHING)
        return trial_wrong(r, "%.*s: stands before the first section; begin with [plant]",
                           scene_text_shown(first), first.at);
    if (r->section == TRIAL_IN_CASE && scene_text_is(first, "at"))
        return trial_read_at(r, rest);
    if (r->section == TRIAL_IN_CASE && scene_text_is(first, "expect"))
        return trial_read_expect(r, rest);
    return trial_read_key(r, w);
}

bool trial_parse(const char *file, const char *text, size_t n,
                 bool (*load)(const char *file, const char *name, struct scene *s, char *why),
                 struct trial *t, char *why)
{
    struct trial_reader r = {
        .text = {.file = file, .what = "test", .shell_key = "command", .why = why, .rest = {text, n}},
        .trial = t,
        .load = load};
    struct word w;
    memset(t, 0, sizeof *t);
    t->file = file;
    *why = 0;
    if (n > TRIAL_BYTES)
        return scene_text_wrong(file, 0, why, "larger than %d bytes: not a test", TRIAL_BYTES);
    while (scene_text_next(&r.text, &w))
        if (!take_line(&r, w))
            return false;
    if (*why || !check_case(&r))
        return false;
    return t->n_cases ? true
                      : scene_text_wrong(file, 0, why, "no case; write [case NAME] with over = and expect");
}
