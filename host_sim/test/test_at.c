/* test_at.c - see test_at.h. */
#include "host_sim/test/test_at.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "host_sim/cli/options.h"
#include "host_sim/cli/options_nearest.h"

#define TIME_MAX 1e6

enum { FIRE_PARTS = 256 }; /* FIRE cuts a tick into so many */

/* The plant of a test can do these; a session is the controller's. */
static const unsigned verbs =
    1u << ACTION_ARM | 1u << ACTION_FIRE_INPUT | 1u << ACTION_SET | 1u << ACTION_STREAM | 1u << ACTION_FAULTS;

/* The time is what stands before the verb. */
static bool split_verb(struct word rest, struct word *time, struct word *verb, struct word *words)
{
    struct word left = rest;
    while (left.n) {
        const char *at = left.at;
        *verb = scene_text_take(&left);
        if (action_find(verbs, *verb) < ACTION_VERBS) {
            *time = scene_text_trimmed((struct word){rest.at, (size_t)(at - rest.at)});
            *words = left;
            return time->n > 0;
        }
    }
    return false;
}

/* The first word of three letters stands where the verb should. */
static bool no_verb(struct test_reader *r, struct word rest)
{
    const char *name[ACTION_VERBS];
    int n = action_names(verbs, name);
    struct word word = scene_text_take(&rest);
    while (rest.n && (word.n < 3 || !isalpha((unsigned char)word.at[0])))
        word = scene_text_take(&rest);
    return test_wrong(
        r, "at: no verb%s",
        options_advise(word.at, word.n, name, n,
                       "write at TIME arm INPUT .., fire INPUT, set NAME=VALUE, stream INPUT VALUE "
                       "or faults LIST, for instance at 0.1 s set mass=5 kg"));
}

bool test_read_at(struct test_reader *r, struct word rest)
{
    struct test_case *c = r->now;
    struct word time, verb, words;
    struct test_act a = {.waits = false};
    char why[SCENE_REASON];
    if (!split_verb(rest, &time, &verb, &words))
        return no_verb(r, rest);
    if (!test_read_value(r, "at", time, "s", 0.0, TIME_MAX, &a.at_s))
        return false;
    if (!action_read(test_model(r->test), action_find(verbs, verb), words, &a.what, why))
        return test_wrong(r, "%s", why);
    if (c->n_acts == TEST_ACTS)
        return test_wrong(r, "more than %d lines with at in a case", TEST_ACTS);
    int i = c->n_acts++;
    for (; i > 0 && c->act[i - 1].at_s > a.at_s; i--)
        c->act[i] = c->act[i - 1];
    c->act[i] = a;
    return true;
}

/* ---- fire ---- */

static bool has_fire(const struct test_case *c, int input)
{
    bool has = false;
    for (int i = 0; i < c->n_acts; i++)
        has = has || (c->act[i].what.verb == ACTION_FIRE_INPUT && c->act[i].what.input == input);
    return has;
}

/* As for FIRE the last value armed counts, and what was fired is armed no more. */
static void arm(struct action *armed, const struct action *a)
{
    armed->given |= a->given;
    for (int i = 0; i < DRIVE_FIELDS; i++)
        if (a->given >> i & 1u)
            armed->value[i] = a->value[i];
}

static bool bind_input(struct test_reader *r, struct test_case *c, int input, const char *name)
{
    struct action armed = {.given = 0};
    double armed_s = 0.0;
    for (int i = 0; i < c->n_acts; i++) {
        struct action *a = &c->act[i].what;
        bool arms = a->verb == ACTION_ARM;
        if (a->input != input || (!arms && a->verb != ACTION_FIRE_INPUT))
            continue;
        c->act[i].waits = arms;
        if (arms) {
            arm(&armed, a);
            armed_s = c->act[i].at_s;
            continue;
        }
        if (!armed.given)
            return test_wrong(
                r, "[case %s]: fire %s at %g s finds nothing armed; write at TIME arm %s .. before it",
                c->name, name, c->act[i].at_s, name);
        a->given = armed.given;
        memcpy(a->value, armed.value, sizeof a->value);
        armed.given = 0;
    }
    return armed.given ? test_wrong(r,
                                    "[case %s]: arm %s at %g s waits for a fire that does not come; write "
                                    "at TIME fire %s after it",
                                    c->name, name, armed_s, name)
                       : true;
}

bool test_bind_fires(struct test_reader *r, struct test_case *c)
{
    const struct model *m = r->test->scene.model;
    for (int i = 0; i < m->n_inputs; i++)
        if (has_fire(c, i) && !bind_input(r, c, i, m->input_signal[i].name))
            return false;
    return true;
}

struct instant test_instant(const struct test_act *a, double tick_s)
{
    uint64_t parts = (uint64_t)llround(FIRE_PARTS * (a->at_s / tick_s));
    return (struct instant){parts / FIRE_PARTS,
                            (uint32_t)(parts % FIRE_PARTS * (TICK_FRACTIONS / FIRE_PARTS))};
}
