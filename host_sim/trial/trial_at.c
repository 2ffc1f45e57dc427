/* trial_at.c - the `at` lines of a test file: what happens
 * to the plant, in the words of contactplant send. */
#include "host_sim/trial/trial.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "host_sim/cli/options.h"
#include "firmware/bus/wire.h"
#include "host_sim/scene/scene_words.h"

#define TIME_MAX 1e6

enum { FIRE_PARTS = 256 }; /* FIRE cuts a tick into so many */

/* The next NAME=VALUE; false at the end, and after a message. */
static bool next_pair(struct trial_reader *r, struct word *rest, struct word *name, struct word *value)
{
    char why[SCENE_REASON] = "";
    return scene_words_next(rest, name, value, why) || (*why && trial_wrong(r, "%s", why));
}

static int find_input(struct trial_reader *r, struct word w)
{
    const struct model *m = r->trial->scene.model;
    const char *name[MODEL_INPUTS];
    char text[OPTIONS_ADVICE];
    for (int i = 0; i < m->n_inputs; i++) {
        name[i] = m->input_signal[i].name;
        if (scene_text_is(w, name[i]))
            return i;
    }
    trial_wrong(r, "at: %s has no input \"%.*s\"%s", m->name, scene_text_shown(w), w.at,
                options_advise(w.at, w.n, name, m->n_inputs, NULL, text, sizeof text));
    return -1;
}

static bool read_field(struct trial_reader *r, struct trial_act *a, struct word name, struct word value)
{
    char why[SCENE_REASON];
    int field = scene_words_field(r->trial->scene.model, a->input, name, value, a->value, why);
    if (field < 0)
        return trial_wrong(r, "arm: %s", why);
    a->given |= 1u << field;
    return true;
}

static bool read_arm(struct trial_reader *r, struct trial_act *a, struct word rest)
{
    struct word name, value, input = scene_text_take(&rest);
    a->input = find_input(r, input);
    if (a->input < 0)
        return false;
    while (next_pair(r, &rest, &name, &value))
        if (!read_field(r, a, name, value))
            return false;
    if (*r->text.why)
        return false;
    return a->given ? true : trial_wrong(r, "arm: write arm INPUT amplitude=5 N frequency=200 Hz, say");
}

static bool read_fire(struct trial_reader *r, struct trial_act *a, struct word rest)
{
    struct word input = scene_text_take(&rest);
    if (!input.n || rest.n)
        return trial_wrong(r, "fire: write fire INPUT, for instance fire force; a line for each input");
    a->input = find_input(r, input);
    return a->input >= 0;
}

static bool read_set(struct trial_reader *r, struct trial_act *a, struct word rest)
{
    struct word name, value;
    while (next_pair(r, &rest, &name, &value)) {
        if (a->n == TRIAL_SETS)
            return trial_wrong(r, "set: more than %d values", TRIAL_SETS);
        if (!trial_read_set(r, name, value, &a->set[a->n++]))
            return false;
    }
    if (*r->text.why)
        return false;
    return a->n ? true : trial_wrong(r, "set: write set NAME=VALUE");
}

static bool read_stream(struct trial_reader *r, struct trial_act *a, struct word rest)
{
    struct word input = scene_text_take(&rest);
    const char *unit;
    a->input = find_input(r, input);
    if (a->input < 0)
        return false;
    if (!rest.n)
        return trial_wrong(r, "stream: write stream INPUT VALUE, for instance stream force 2 N");
    unit = r->trial->scene.model->input_signal[a->input].unit;
    return trial_read_value(r, "stream", rest, unit, -1e12, 1e12, &a->sample);
}

static bool read_faults(struct trial_reader *r, struct trial_act *a, struct word rest)
{
    if (!rest.n)
        return trial_wrong(r, "faults: write faults drop=0.1, say, or faults none");
    return trial_copy(r, rest, a->list, sizeof a->list);
}

static const struct {
    const char *name;
    bool (*read)(struct trial_reader *r, struct trial_act *a, struct word rest);
} verbs[TRIAL_VERBS] = {[TRIAL_ARM] = {"arm", read_arm},
                        [TRIAL_FIRE] = {"fire", read_fire},
                        [TRIAL_SET] = {"set", read_set},
                        [TRIAL_STREAM] = {"stream", read_stream},
                        [TRIAL_FAULTS] = {"faults", read_faults}};

static enum trial_verb find_verb(struct word w)
{
    int i = 0;
    while (i < TRIAL_VERBS && !scene_text_is(w, verbs[i].name))
        i++;
    return (enum trial_verb)i;
}

/* The time is what stands before the verb. */
static bool split_verb(struct word rest, struct word *time, struct word *verb, struct word *words)
{
    struct word left = rest;
    while (left.n) {
        const char *at = left.at;
        *verb = scene_text_take(&left);
        if (find_verb(*verb) < TRIAL_VERBS) {
            *time = scene_text_trimmed((struct word){rest.at, (size_t)(at - rest.at)});
            *words = left;
            return time->n > 0;
        }
    }
    return false;
}

/* The first word of three letters stands where the verb should. */
static bool no_verb(struct trial_reader *r, struct word rest)
{
    const char *name[TRIAL_VERBS];
    char advice[OPTIONS_ADVICE];
    for (int i = 0; i < TRIAL_VERBS; i++)
        name[i] = verbs[i].name;
    struct word word = scene_text_take(&rest);
    while (rest.n && (word.n < 3 || !isalpha((unsigned char)word.at[0])))
        word = scene_text_take(&rest);
    return trial_wrong(
        r, "at: no verb%s",
        options_advise(word.at, word.n, name, TRIAL_VERBS,
                       "write at TIME arm INPUT .., fire INPUT, set NAME=VALUE, stream INPUT VALUE "
                       "or faults LIST, for instance at 0.1 s set mass=5 kg",
                       advice, sizeof advice));
}

bool trial_read_at(struct trial_reader *r, struct word rest)
{
    struct trial_case *c = r->now;
    struct word time, verb, words;
    struct trial_act a;
    memset(&a, 0, sizeof a);
    if (!split_verb(rest, &time, &verb, &words))
        return no_verb(r, rest);
    if (!trial_read_value(r, "at", time, "s", 0.0, TIME_MAX, &a.at_s))
        return false;
    a.verb = find_verb(verb);
    if (!verbs[a.verb].read(r, &a, words))
        return false;
    if (c->n_acts == TRIAL_ACTS)
        return trial_wrong(r, "more than %d lines with at in a case", TRIAL_ACTS);
    int i = c->n_acts++;
    for (; i > 0 && c->act[i - 1].at_s > a.at_s; i--)
        c->act[i] = c->act[i - 1];
    c->act[i] = a;
    return true;
}

/* ---- fire ---- */

static bool has_fire(const struct trial_case *c, int input)
{
    bool has = false;
    for (int i = 0; i < c->n_acts; i++)
        has = has || (c->act[i].verb == TRIAL_FIRE && c->act[i].input == input);
    return has;
}

/* As for FIRE the last value armed counts, and what was fired is armed no more. */
static void arm(struct trial_act *armed, const struct trial_act *a)
{
    armed->at_s = a->at_s;
    armed->given |= a->given;
    for (int i = 0; i < DRIVE_FIELDS; i++)
        if (a->given >> i & 1u)
            armed->value[i] = a->value[i];
}

static bool bind_input(struct trial_reader *r, struct trial_case *c, int input, const char *name)
{
    struct trial_act armed = {.given = 0};
    for (int i = 0; i < c->n_acts; i++) {
        struct trial_act *a = &c->act[i];
        if (a->input != input || (a->verb != TRIAL_ARM && a->verb != TRIAL_FIRE))
            continue;
        a->waits = a->verb == TRIAL_ARM;
        if (a->waits) {
            arm(&armed, a);
            continue;
        }
        if (!armed.given)
            return trial_wrong(
                r, "[case %s]: fire %s at %g s finds nothing armed; write at TIME arm %s .. before it",
                c->name, name, a->at_s, name);
        a->given = armed.given;
        memcpy(a->value, armed.value, sizeof a->value);
        armed.given = 0;
    }
    return armed.given ? trial_wrong(r,
                                     "[case %s]: arm %s at %g s waits for a fire that does not come; write "
                                     "at TIME fire %s after it",
                                     c->name, name, armed.at_s, name)
                       : true;
}

bool trial_bind_fires(struct trial_reader *r, struct trial_case *c)
{
    const struct model *m = r->trial->scene.model;
    for (int i = 0; i < m->n_inputs; i++)
        if (has_fire(c, i) && !bind_input(r, c, i, m->input_signal[i].name))
            return false;
    return true;
}

struct instant trial_instant(const struct trial_act *a, double tick_s)
{
    uint64_t parts = (uint64_t)llround(FIRE_PARTS * (a->at_s / tick_s));
    return (struct instant){parts / FIRE_PARTS,
                            (uint32_t)(parts % FIRE_PARTS * (TICK_FRACTIONS / FIRE_PARTS))};
}
