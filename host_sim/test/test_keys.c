/* test_keys.c - see test_keys.h. */
#include "host_sim/test/test_keys.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/bus/settings.h"
#include "host_sim/cli/options_nearest.h"
#include "host_sim/replay/decode_signals.h"
#include "host_sim/cli/options.h"
#include "host_sim/cli/unit.h"
#include "host_sim/scene/scene.h"
#include "host_sim/scene/scene_app.h"
#include "host_sim/scene/scene_keys.h"
#include "host_sim/scene/scene_words.h"
#include "host_sim/test/test_afm.h"

enum { KEYS = 15 };

#define TIME_MAX 1e6

/* A key, which stands once in its section. */
struct key {
    const char *name;
    unsigned sections; /* bits 1 << enum test_section */
    bool (*take)(struct test_reader *r, struct word value);
};

static const char given_twice[] = "%.*s: it stands in this section already; keep one";

static bool add_set(struct test_reader *r, struct test_plant *p, struct word name, struct word value)
{
    struct action_set set = {0, 0.0};
    int i = 0;
    if (!test_read_set(r, name, value, &set))
        return false;
    while (i < p->n && p->set[i].index != set.index)
        i++;
    if (i == TEST_SETS)
        return test_wrong(r, "more than %d parameters and settings", TEST_SETS);
    if (r->set_given[i])
        return test_wrong(r, given_twice, scene_text_shown(name), name.at);
    r->set_given[i] = true;
    p->set[i] = set;
    p->n += i == p->n;
    return true;
}

/* ---- keys ---- */

static struct test_plant *plant_of(struct test_reader *r)
{
    return r->now ? &r->now->plant : &r->test->plant;
}

static bool take_scene(struct test_reader *r, struct word value)
{
    char why[SCENE_FILE_REASON] = "";
    struct test_file *t = r->test;
    if (t->plant.n || t->plant.rate_Hz > 0.0 || t->plant.substeps || t->lever.model)
        return test_wrong(r, "scene: it stands first in [plant]; the other keys are its own");
    if (!test_copy(r, scene_text_name(value), t->scene_name, sizeof t->scene_name))
        return false;
    return r->load(t->file, t->scene_name, &t->scene, why) ? true : test_wrong(r, "scene: %.400s", why);
}

/* A lever's scene, with the station around it. */
static bool take_microscope(struct test_reader *r, struct word value)
{
    char why[SCENE_FILE_REASON] = "";
    struct test_file *t = r->test;
    if (t->plant.n || t->plant.rate_Hz > 0.0 || t->plant.substeps || t->scene.model)
        return test_wrong(r, "microscope: it stands first in [plant], in the place of scene");
    if (!test_copy(r, scene_text_name(value), t->scene_name, sizeof t->scene_name))
        return false;
    if (!r->load(t->file, t->scene_name, &t->lever, why))
        return test_wrong(r, "microscope: %.400s", why);
    if (!t->lever.model->modal_form) /* afm_lever is the one model with this view */
        return test_wrong(r,
                          "microscope: %s is no AFM lever; give soft, tapping, stiff or a scene of afm_lever",
                          t->scene_name);
    t->scene.model = &test_afm_view;
    return true;
}

static bool take_rate(struct test_reader *r, struct word value)
{
    return test_read_value(r, "rate", value, "Hz", 1.0, 20000.0, &plant_of(r)->rate_Hz);
}

static bool take_substeps(struct test_reader *r, struct word value)
{
    double n;
    if (!test_read_count(r, "substeps", value, 1.0, SCENE_SUBSTEPS_MAX, &n))
        return false;
    plant_of(r)->substeps = (uint32_t)n;
    return true;
}

static bool take_command(struct test_reader *r, struct word value)
{
    return test_copy(r, value, r->test->command, sizeof r->test->command);
}

/* The controllers that this program has itself; a scene's own drives are what shakes the plant. */
static bool take_builtin(struct test_reader *r, struct word value)
{
    static const char *const builtin[] = {"keep", "loops"};
    r->test->loops = scene_text_is(value, "loops");
    if (!r->test->loops && !scene_text_is(value, "keep"))
        return test_wrong(r, "builtin: no controller \"%.*s\"%s", scene_text_shown(value), value.at,
                          options_advise(value.at, value.n, builtin, 2,
                                         "there is keep, which is contactplant control without a drive, "
                                         "and loops, those of a microscope"));
    snprintf(r->test->command, sizeof r->test->command, "%s",
             r->test->loops ? "loops" : "{contactplant} control {scene} {options} --force 0 --duration 1e6");
    return true;
}

static bool take_over(struct test_reader *r, struct word value)
{
    return test_read_value(r, "over", value, "s", 1e-3, TIME_MAX, &r->now->over_s);
}

static bool take_link(struct test_reader *r, struct word value)
{
    return test_copy(r, value, r->now->link, sizeof r->now->link);
}

static bool take_seeds(struct test_reader *r, struct word value)
{
    struct word from = value, to = value;
    double first, last;
    (void)test_split_range(value, &from, &to);
    if (!test_read_count(r, "seeds", from, 0.0, 4294967295.0, &first) ||
        !test_read_count(r, "seeds", to, first, first + TEST_STEPS - 1, &last))
        return false;
    r->now->first_seed = (uint32_t)first;
    r->now->n_seeds = (uint32_t)(last - first) + 1;
    return true;
}

/* NAME A .. B in N, as versions before wrote it, in the form NAME=A:B:N; any other text stays. */
static void rewrite_vary(struct word value, char text[TEST_VALUE])
{
    struct word steps, from, to, rest = value, name = scene_text_take(&rest);
    if (test_take_tail(&rest, "in", &steps) && test_split_range(rest, &from, &to))
        snprintf(text, TEST_VALUE, "%.*s=%.*s:%.*s:%.*s", (int)name.n, name.at, (int)from.n, from.at,
                 (int)to.n, to.at, (int)steps.n, steps.at);
    else
        snprintf(text, TEST_VALUE, "%.*s", (int)value.n, value.at);
}

/* vary = NAME=FROM:TO:N */
static bool take_vary(struct test_reader *r, struct word value)
{
    struct scene_key k = {.full = "", .unit = ""};
    char text[TEST_VALUE], why[RANGE_REASON];
    rewrite_vary(value, text);
    struct word name = scene_text_trimmed((struct word){text, strcspn(text, "=")});
    int i = strchr(text, '=') ? scene_words_find(test_model(r->test), name, &k) : 0;
    const struct range_rules rules = {.named = true,
                                      .unit = k.unit,
                                      .bare = i >= 0 && scene_text_is(name, k.full),
                                      .min = k.min,
                                      .max = k.max,
                                      .n_min = 2,
                                      .n_max = TEST_STEPS,
                                      .order = RANGE_ANY_ORDER};
    if (i < 0)
        return test_no_name(r, name, NULL, 0);
    if (!range_read(text, &rules, &r->now->vary, why) ||
        !scene_accepts(test_model(r->test), i, r->now->vary.from, why) ||
        !scene_accepts(test_model(r->test), i, r->now->vary.to, why))
        return test_wrong(r, "vary %s: %s", text, why);
    r->now->varied = i;
    return true;
}

/* target = SIGNAL VALUE within BAND, a band in % or in the signal's unit. */
static bool take_target(struct test_reader *r, struct word value)
{
    struct word band, name = scene_text_take(&value);
    struct test_case *c = r->now;
    int i = test_find_signal(r, name);
    if (i < 0)
        return false;
    const char *unit = metric_signal(r->test->scene.model, i)->unit;
    if (!test_take_tail(&value, "within", &band))
        return test_wrong(
            r, "target: write SIGNAL VALUE within BAND, for instance penetration 5 um within 5 %%");
    if (!test_read_value(r, "target", value, unit, -1e12, 1e12, &c->target))
        return false;
    bool share = band.at[band.n - 1] == '%';
    if (!test_read_value(r, "within", band, share ? "%" : unit, 1e-30, 1e12, &c->band))
        return false;
    c->band = share ? fabs(c->target) * c->band / 100.0 : c->band;
    c->target_signal = i;
    c->has_target = true;
    return c->band > 0.0 ? true : test_wrong(r, "within: a share of 0 is nothing; give a band in %s", unit);
}

static bool take_lockin(struct test_reader *r, struct word value)
{
    return test_read_value(r, "lockin", value, "Hz", 1e-3, 1e9, &r->now->lockin_Hz);
}

/* The signal of a log with this name, -1: none. */
static int find_logged(const struct model *m, struct word name)
{
    char known[DECODE_NAME];
    for (int i = 0; i < decode_signals(m); i++) {
        decode_name(m, i, known);
        if (scene_text_is(name, known))
            return i;
    }
    return -1;
}

/* golden = LOG SIGNAL TOLERANCE .. ; a tolerance goes on until the next signal. */
static bool take_golden(struct test_reader *r, struct word value)
{
    struct test_case *c = r->now;
    const struct model *m = r->test->scene.model;
    struct word path = scene_text_take_name(&value), name = scene_text_take(&value);
    for (int i = 0; i < DECODE_SIGNALS; i++)
        c->limit[i] = (struct compare_limit){name.n ? (double)NAN : 0.0, 1.0, ""};
    while (name.n) {
        int i = find_logged(m, name);
        if (i < 0)
            return test_wrong(r,
                              "golden: %.*s is no signal of the bus; write LOG SIGNAL TOLERANCE .., for "
                              "instance golden.log penetration 0.1 um",
                              scene_text_shown(name), name.at);
        struct word next = {NULL, 0}, tolerance = {value.at, 0};
        while (value.n && (next = scene_text_take(&value)).n && find_logged(m, next) < 0)
            tolerance.n = (size_t)(next.at + next.n - tolerance.at);
        struct compare_limit *l = &c->limit[i];
        const char *unit = decode_signal(m, i)->unit;
        if (!isnan(l->tolerance))
            return test_wrong(r, "golden: %.*s stands twice; write it once", scene_text_shown(name), name.at);
        if (!test_read_value(r, "golden", tolerance, unit, 0.0, 1e12, &l->tolerance))
            return false;
        l->one = unit_asked(tolerance.at, tolerance.n, unit, l->unit);
        name = next.n && find_logged(m, next) >= 0 ? next : (struct word){NULL, 0};
    }
    c->golden_line = r->text.line;
    return test_copy(r, path, c->golden, sizeof c->golden);
}

bool test_keys_is_requirement(const char *id, size_t n)
{
    bool good = n > 0 && n < TEST_NAME;
    for (size_t i = 0; good && i < n; i++)
        good = (id[i] >= 'a' && id[i] <= 'z') || (id[i] >= 'A' && id[i] <= 'Z') || (id[i] & 0x80) ||
               strchr("0123456789-_.:", id[i]);
    return good;
}

/* requirement = ID, ID; those of `like` give way. */
static bool take_requirement(struct test_reader *r, struct word value)
{
    struct test_case *c = r->now;
    c->n_requirements = 0;
    c->requirement_line = r->text.line;
    while (value.n) {
        const char *comma = memchr(value.at, ',', value.n);
        size_t n = comma ? (size_t)(comma - value.at) : value.n;
        struct word id = scene_text_trimmed((struct word){value.at, n});
        if (!test_keys_is_requirement(id.at, id.n))
            return test_wrong(r,
                              "requirement: \"%.*s\": write ID, ID; an ID has letters, digits, - _ . : and "
                              "at most %d of them",
                              scene_text_shown(id), id.at, TEST_NAME - 1);
        if (c->n_requirements == TEST_REQUIREMENTS)
            return test_wrong(r, "requirement: more than %d", TEST_REQUIREMENTS);
        for (int i = 0; i < c->n_requirements; i++)
            if (scene_text_is(id, c->requirement[i]))
                return test_wrong(r, "requirement: %s stands twice", c->requirement[i]);
        (void)test_copy(r, id, c->requirement[c->n_requirements++], TEST_NAME);
        if (comma && n + 1 == value.n)
            return test_wrong(r, "requirement: an ID is missing behind the last comma");
        value = comma ? (struct word){comma + 1, value.n - n - 1} : (struct word){value.at, 0};
    }
    return true;
}

static bool take_like(struct test_reader *r, struct word value)
{
    const char *name[TEST_CASES];
    struct test_file *t = r->test;
    int n = t->n_cases - 1;
    value = scene_text_name(value);
    for (int i = 0; i < n; i++) {
        name[i] = t->cases[i].name;
        if (!scene_text_is(value, name[i]))
            continue;
        if (memcmp(r->given, (bool[sizeof r->given]){false}, sizeof r->given) || r->now->n_expects ||
            r->now->n_acts || r->now->plant.n)
            return test_wrong(r, "like: it stands first in its case; the other lines add to it");
        struct test_case own = *r->now;
        *r->now = t->cases[i];
        memcpy(r->now->name, own.name, sizeof own.name);
        r->now->line = own.line;
        return true;
    }
    if (!n)
        return test_wrong(r, "like: there is no case before this one");
    return test_wrong(r, "like: no case \"%.*s\" before this one%s", scene_text_shown(value), value.at,
                      options_advise(value.at, value.n, name, n, NULL));
}

#define PLANT      (1u << TEST_IN_PLANT)
#define CONTROLLER (1u << TEST_IN_CONTROLLER)
#define CASE       (1u << TEST_IN_CASE)

static const struct key keys[KEYS] = {
    {"scene", PLANT, take_scene},
    {"microscope", PLANT, take_microscope},
    {"rate", PLANT | CASE, take_rate},
    {"substeps", PLANT | CASE, take_substeps},
    {"command", CONTROLLER, take_command},
    {"builtin", CONTROLLER, take_builtin},
    {"like", CASE, take_like},
    {"over", CASE, take_over},
    {"link", CASE, take_link},
    {"seeds", CASE, take_seeds},
    {"vary", CASE, take_vary},
    {"target", CASE, take_target},
    {"lockin", CASE, take_lockin},
    {"golden", CASE, take_golden},
    {"requirement", CASE, take_requirement},
};

static bool no_key(struct test_reader *r, struct word name)
{
    const char *known[KEYS + 2] = {"expect", "at"};
    int n = r->section == TEST_IN_CASE ? 2 : 0;
    for (int i = 0; i < KEYS; i++)
        if (keys[i].sections >> r->section & 1u)
            known[n++] = keys[i].name;
    name = scene_text_take(&name);
    return test_no_name(r, name, known, n);
}

bool test_read_key(struct test_reader *r, struct word w)
{
    static const char *const controller_key[] = {"command", "builtin", "attach"};
    const char *equal = memchr(w.at, '=', w.n);
    if (r->section == TEST_IN_CONTROLLER && (*r->test->command || r->test->attached))
        return test_wrong(r, "[controller] has one line: command = .., builtin = .., or attach");
    if (r->section == TEST_IN_CONTROLLER && scene_text_is(w, "attach"))
        return r->test->attached = true;
    if (!equal)
        return test_wrong(r, "\"%.*s\": write KEY = VALUE%s", scene_text_shown(w), w.at,
                          r->section == TEST_IN_CASE ? ", at .. or expect .." : "");
    struct word key = scene_text_trimmed((struct word){w.at, (size_t)(equal - w.at)});
    struct word value = scene_text_trimmed((struct word){equal + 1, w.n - (size_t)(equal + 1 - w.at)});
    if (!key.n || !value.n)
        return test_wrong(r, "\"%.*s\": %s is missing; write KEY = VALUE", scene_text_shown(w), w.at,
                          key.n ? "the value" : "the key");
    for (int i = 0; i < KEYS; i++) {
        if (!scene_text_is(key, keys[i].name) || !(keys[i].sections >> r->section & 1u))
            continue;
        if (r->given[i])
            return test_wrong(r, given_twice, scene_text_shown(key), key.at);
        bool taken = keys[i].take(r, value);
        r->given[i] = true;
        return taken;
    }
    if (r->section == TEST_IN_CONTROLLER)
        return test_wrong(r, "%.*s: no such key in [controller]%s", scene_text_shown(key), key.at,
                          options_advise(key.at, key.n, controller_key, 3, NULL));
    if (!r->test->scene.model)
        return test_wrong(r, "%.*s: scene = NAME, or microscope = NAME, stands first in [plant]",
                          scene_text_shown(key), key.at);
    if (test_find_set(r, key) < 0)
        return no_key(r, key);
    return add_set(r, plant_of(r), key, value);
}
