/* action.c - see action.h. */
#include "host_sim/live/action.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/bus/wire.h"
#include "firmware/bus/wire_table.h"
#include "host_sim/cli/names.h"
#include "host_sim/cli/options.h"
#include "host_sim/cli/options_nearest.h"
#include "host_sim/cli/unit.h"
#include "host_sim/scene/scene_words.h"

/* One line into why[SCENE_REASON]; always false. */
#define wrong(why, ...) (snprintf(why, SCENE_REASON, __VA_ARGS__) < 0)

static bool read_nothing(const struct model *m, struct word rest, struct action *a, char *why)
{
    (void)m, (void)a, (void)why;
    return rest.n == 0;
}

/* A whole number in [min, max]. */
static bool read_whole(struct word w, double min, double max, double *x)
{
    char text[ACTION_TEXT];
    snprintf(text, sizeof text, "%.*s", (int)(w.n < sizeof text ? w.n : 0), w.at);
    return options_read_number(text, x) && *x >= min && *x <= max && *x == floor(*x);
}

static bool read_step(const struct model *m, struct word rest, struct action *a, char *why)
{
    double x;
    (void)m;
    if (!rest.n)
        return false;
    if (!read_whole(rest, 1.0, 4294967295.0, &x))
        return wrong(why, "step %.*s: give a number of frames, 1 to 4294967295", scene_text_shown(rest),
                     rest.at);
    a->argument = (uint64_t)x;
    return true;
}

static bool read_run_until(const struct model *m, struct word rest, struct action *a, char *why)
{
    double x;
    (void)m;
    if (!rest.n)
        return false;
    if (!read_whole(rest, 0.0, 1.8e19, &x))
        return wrong(why, "run-until %.*s: give a plant tick, a multiple of --substeps",
                     scene_text_shown(rest), rest.at);
    a->argument = (uint64_t)x;
    return true;
}

/* Takes the first word as an input. */
static bool take_input(const struct model *m, struct word *rest, struct action *a, char *why)
{
    const char *name[MODEL_INPUTS];
    struct word w = scene_text_take(rest);
    for (int i = 0; i < m->n_inputs; i++) {
        name[i] = m->input_signal[i].name;
        a->input = i;
        if (scene_text_is(w, name[i]))
            return true;
    }
    return w.n && wrong(why, "%s has no input \"%.*s\"%s", m->name, scene_text_shown(w), w.at,
                        options_advise(w.at, w.n, name, m->n_inputs, NULL));
}

static bool read_arm(const struct model *m, struct word rest, struct action *a, char *why)
{
    struct word name, value;
    char reason[SCENE_REASON] = "";
    if (!take_input(m, &rest, a, why))
        return false;
    while (scene_words_next(&rest, &name, &value, reason)) {
        int field = scene_words_field(m, a->input, name, value, a->value, reason);
        if (field < 0)
            break;
        a->given |= 1u << field;
    }
    return *reason ? wrong(why, "arm: %.450s", reason) : a->given != 0;
}

static bool read_fire_input(const struct model *m, struct word rest, struct action *a, char *why)
{
    return take_input(m, &rest, a, why) && rest.n == 0;
}

static bool read_stream(const struct model *m, struct word rest, struct action *a, char *why)
{
    char reason[UNIT_REASON];
    if (!take_input(m, &rest, a, why) || !rest.n)
        return false;
    return unit_read_or_bare(rest.at, rest.n, m->input_signal[a->input].unit, &a->sample, reason) ||
           wrong(why, "stream: %s", reason);
}

static bool read_set(const struct model *m, struct word rest, struct action *a, char *why)
{
    struct word name, value;
    char reason[SCENE_REASON] = "";
    while (scene_words_next(&rest, &name, &value, reason)) {
        if (a->n == ACTION_SETS)
            return wrong(why, "set: more than %d values", ACTION_SETS);
        int index = scene_words_read(m, name, value, &a->set[a->n].value, reason);
        if (index < 0)
            break;
        a->set[a->n++].index = (unsigned)index;
    }
    return *reason ? wrong(why, "set: %.450s", reason) : a->n > 0;
}

static bool copy_text(struct word rest, struct action *a, char *why)
{
    if (rest.n >= sizeof a->text)
        return wrong(why, "\"%.*s..\" is longer than %zu characters", scene_text_shown(rest), rest.at,
                     sizeof a->text - 1);
    memcpy(a->text, rest.at, rest.n);
    a->text[rest.n] = '\0';
    return rest.n > 0;
}

static bool read_read(const struct model *m, struct word rest, struct action *a, char *why)
{
    struct scene_key k;
    struct word name = scene_text_take(&rest);
    if (rest.n || !copy_text(name, a, why))
        return false;
    int index = scene_words_find(m, name, &k);
    a->n = 1;
    a->set[0].index = (unsigned)index;
    return index >= 0 || scene_words_no_name(m, name, NULL, 0, why);
}

static bool read_capture(const struct model *m, struct word rest, struct action *a, char *why)
{
    static const char *const name[] = {"arm", "trigger", "stop", "read"};
    struct word operation = scene_text_take(&rest), first = scene_text_take(&rest);
    double from, count;
    if (!operation.n || !copy_text(operation, a, why))
        return false;
    a->operation = names_find(m, NAMES_CAPTURE, a->text);
    if (a->operation < 0)
        return wrong(why, "capture %s: no such operation%s", a->text,
                     options_advise(operation.at, operation.n, name, 4, NULL));
    if (!first.n)
        return true;
    if (a->operation != CAPTURE_READ || !read_whole(first, 0.0, 65535.0, &from) ||
        !read_whole(rest, 1.0, 65535.0, &count))
        return false;
    a->first = (uint32_t)from;
    a->count = (uint32_t)count;
    return true;
}

static bool read_faults(const struct model *m, struct word rest, struct action *a, char *why)
{
    (void)m;
    return rest.n && copy_text(rest, a, why);
}

static const struct {
    const char *name, *form; /* the advice where the words are none of it */
    bool (*read)(const struct model *m, struct word rest, struct action *a, char *why);
} verb_table[ACTION_VERBS] = {
    [ACTION_ENABLE] = {"enable", "enable alone", read_nothing},
    [ACTION_DISABLE] = {"disable", "disable alone", read_nothing},
    [ACTION_START] = {"start", "start alone", read_nothing},
    [ACTION_STOP] = {"stop", "stop alone", read_nothing},
    [ACTION_PAUSE] = {"pause", "pause alone", read_nothing},
    [ACTION_STEP] = {"step", "step N", read_step},
    [ACTION_RUN_UNTIL] = {"run-until", "run-until TICK", read_run_until},
    [ACTION_RESET] = {"reset", "reset alone", read_nothing},
    [ACTION_ARM] = {"arm", "arm INPUT amplitude=5 N frequency=200 Hz, say", read_arm},
    [ACTION_FIRE] = {"fire", "fire alone: it applies all that is armed", read_nothing},
    [ACTION_FIRE_INPUT] = {"fire", "fire INPUT, for instance fire force; a line for each input",
                           read_fire_input},
    [ACTION_STREAM] = {"stream", "stream INPUT VALUE, for instance stream force 2 N", read_stream},
    [ACTION_SET] = {"set", "set NAME=VALUE", read_set},
    [ACTION_READ] = {"read", "read NAME", read_read},
    [ACTION_CAPTURE] = {"capture", "capture arm, trigger, stop, or read [FIRST COUNT] below 65536",
                        read_capture},
    [ACTION_FAULTS] = {"faults", "faults drop=0.1, say, or faults none", read_faults},
};

enum action_verb action_find(unsigned verbs, struct word word)
{
    int i = 0;
    while (i < ACTION_VERBS && !(verbs >> i & 1u && scene_text_is(word, verb_table[i].name)))
        i++;
    return (enum action_verb)i;
}

int action_names(unsigned verbs, const char **name)
{
    int n = 0;
    for (int i = 0; i < ACTION_VERBS; i++)
        if (verbs >> i & 1u)
            name[n++] = verb_table[i].name;
    return n;
}

bool action_read(const struct model *m, enum action_verb verb, struct word words, struct action *a, char *why)
{
    memset(a, 0, sizeof *a);
    *why = '\0';
    a->verb = verb;
    if (verb_table[verb].read(m, words, a, why))
        return true;
    return *why ? false : wrong(why, "%s: write %s", verb_table[verb].name, verb_table[verb].form);
}

void action_fields(const struct action *a, double *field)
{
    for (int i = 0; i < DRIVE_FIELDS; i++)
        field[i] = a->given >> i & 1u ? a->value[i] : (double)NAN;
}

void action_split_set(const struct action *a, unsigned *index, double *value)
{
    for (int i = 0; i < a->n; i++) {
        index[i] = a->set[i].index;
        value[i] = a->set[i].value;
    }
}
