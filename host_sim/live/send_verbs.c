/* send_verbs.c - the commands of contactplant send. */
#include "host_sim/cli/clock.h"
#include "host_sim/commands.h"
#include "host_sim/cli/names.h"
#include "host_sim/cli/unit.h"
#include "host_sim/live/send.h"
#include "host_sim/scene/scene_words.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SETS_MAX = 32, TEXT = 4096 };
static const double objection_s = 0.05;

/* After commands that are answered only when refused. */
static int wait_objection(struct sender *s)
{
    send_wait(s, objection_s);
    return s->refused ? STATUS_FAILED : STATUS_DONE;
}

static int send_control(struct sender *s, enum control_operation operation, uint64_t argument,
                        bool named_frame)
{
    send_expect(s, WIRE_CONTROL);
    for (int i = 0; i < SEND_TRIES; i++) { /* the first try may repeat a counter of the session's owner */
        client_control(&s->station.client, operation,
                       named_frame ? s->station.client.latest.frame : argument);
        if (send_answer(s))
            return s->refused ? STATUS_FAILED : STATUS_DONE;
    }
    return send_no_answer(s, names_text(send_model(s), NAMES_OPERATION, (unsigned)operation));
}

static int run_enable(struct sender *s, int n, const char *const *word)
{
    (void)n, (void)word;
    printf("ENABLE: session %u\n", s->station.client.session);
    return STATUS_DONE;
}

static int run_disable(struct sender *s, int n, const char *const *word)
{
    (void)n, (void)word;
    if (!client_close(&s->station.client, SEND_SILENCE_S))
        return send_no_answer(s, "disable");
    printf("ENABLE: off\n");
    return STATUS_DONE;
}

static int run_start(struct sender *s, int n, const char *const *word)
{
    (void)n, (void)word;
    return send_control(s, CONTROL_START, 0, true);
}

static int run_stop(struct sender *s, int n, const char *const *word)
{
    (void)n, (void)word;
    s->stopped = true;
    return send_control(s, CONTROL_STOP, 0, true);
}

static int run_pause(struct sender *s, int n, const char *const *word)
{
    (void)n, (void)word;
    return send_control(s, CONTROL_PAUSE, 0, true);
}

static int run_reset(struct sender *s, int n, const char *const *word)
{
    (void)n, (void)word;
    return send_control(s, CONTROL_RESET, 0, true);
}

static int check_step(const struct sender *s, int n, const char *const *word)
{
    double x;
    (void)n;
    return send_read_whole(word[0], 1.0, 4294967295.0, &x)
               ? 0
               : options_misuse(s->o->usage, "step %s: give a number of frames, 1 to 4294967295", word[0]);
}

static int run_step(struct sender *s, int n, const char *const *word)
{
    (void)n;
    return send_control(s, CONTROL_STEP, strtoull(word[0], NULL, 0), false);
}

static int check_until(const struct sender *s, int n, const char *const *word)
{
    double x;
    (void)n;
    return send_read_whole(word[0], 0.0, 1.8e19, &x)
               ? 0
               : options_misuse(s->o->usage, "run-until %s: give a plant tick, a multiple of --substeps",
                                word[0]);
}

static int run_until(struct sender *s, int n, const char *const *word)
{
    (void)n;
    return send_control(s, CONTROL_RUN_UNTIL, strtoull(word[0], NULL, 0), false);
}

static int find_input(const struct sender *s, const char *name)
{
    const struct model *m = send_model(s);
    const char *known[MODEL_INPUTS];
    char advice[OPTIONS_ADVICE];
    int i = names_find(m, NAMES_INPUT, name);
    for (int k = 0; k < m->n_inputs; k++)
        known[k] = m->input_signal[k].name;
    if (i < 0)
        options_misuse(s->o->usage, "no input \"%s\"%s", name,
                       options_advise(name, strlen(name), known, m->n_inputs, NULL, advice, sizeof advice));
    return i;
}

/* The words as one text: a unit may be a word of its own. 0, or the exit status after a line. */
static int join(const struct sender *s, int n, const char *const *word, char text[TEXT])
{
    size_t used = 0;
    *text = '\0';
    for (int i = 0; i < n && used < TEXT; i++)
        used += (size_t)snprintf(text + used, TEXT - used, "%s%s", i ? " " : "", word[i]);
    return used < TEXT ? 0 : options_misuse(s->o->usage, "%s: too many letters", word[0]);
}

/* FIELD=VALUE words into value[], NaN where not given. */
static int read_fields(const struct sender *s, int input, int n, const char *const *word, double *value)
{
    char text[TEXT], why[SCENE_REASON] = "";
    struct word name, x, rest;
    for (int i = 0; i < ARM_FIELDS; i++)
        value[i] = (double)NAN;
    if (join(s, n, word, text))
        return STATUS_MISUSED;
    rest = (struct word){text, strlen(text)};
    while (scene_words_next(&rest, &name, &x, why))
        if (scene_words_field(send_model(s), input, name, x, value, why) < 0)
            break;
    return *why ? options_misuse(s->o->usage, "arm: %s", why) : 0;
}

static int check_arm(const struct sender *s, int n, const char *const *word)
{
    double value[ARM_FIELDS];
    int i = find_input(s, word[0]);
    return i < 0 ? STATUS_MISUSED : read_fields(s, i, n - 1, word + 1, value);
}

static int run_arm(struct sender *s, int n, const char *const *word)
{
    double value[ARM_FIELDS];
    int i = find_input(s, word[0]);
    (void)read_fields(s, i, n - 1, word + 1, value);
    send_expect(s, WIRE_ARM + (unsigned)i);
    for (int twice = 0; twice < 2; twice++) /* the first frame may repeat a counter of the session's owner */
        client_arm_fields(&s->station.client, i, value);
    s->armed |= 1u << i;
    return wait_objection(s);
}

static int check_fire(const struct sender *s, int n, const char *const *word)
{
    (void)n, (void)word;
    if (options_given(s->o, "tick") && options_given(s->o, "in"))
        return options_misuse(s->o->usage, "fire: --tick and --in both say when; give one of them");
    return 0;
}

static int run_fire(struct sender *s, int n, const char *const *word)
{
    const struct client *c = &s->station.client;
    uint64_t later = (uint64_t)options_number(s->o, "in") * s->station.scene.config.substeps;
    bool named = options_given(s->o, "tick");
    (void)n, (void)word;
    if (!s->armed)
        return options_failure(s->o->usage, "fire: arm something before it on the same command line");
    send_expect(s, WIRE_FIRE);
    for (int i = 0; i < SEND_TRIES; i++) {
        uint64_t tick = named ? strtoull(options_text(s->o, "tick", 0), NULL, 0) : c->latest.tick + later;
        client_fire(&s->station.client, s->armed, false, tick, 0.0);
        if (send_answer(s)) {
            s->armed = 0;
            return s->refused ? STATUS_FAILED : STATUS_DONE;
        }
    }
    return send_no_answer(s, "fire");
}

/* VALUE, with its unit or SI. */
static int read_sample(const struct sender *s, int input, int n, const char *const *word, double *x)
{
    char text[TEXT], why[UNIT_REASON];
    if (join(s, n, word, text))
        return STATUS_MISUSED;
    return unit_read_or_bare(text, strlen(text), send_model(s)->input_signal[input].unit, x, why)
               ? 0
               : options_misuse(s->o->usage, "stream: %s", why);
}

static int check_stream(const struct sender *s, int n, const char *const *word)
{
    double x;
    int i = find_input(s, word[0]);
    return i < 0 ? STATUS_MISUSED : read_sample(s, i, n - 1, word + 1, &x);
}

static int run_stream(struct sender *s, int n, const char *const *word)
{
    double x = 0.0;
    int i = find_input(s, word[0]);
    (void)read_sample(s, i, n - 1, word + 1, &x);
    client_poll(&s->station.client);
    send_expect(s, WIRE_STREAM + (unsigned)i);
    for (int twice = 0; twice < 2; twice++) /* as for arm */
        client_stream(&s->station.client, i,
                      s->station.client.latest.tick / s->station.scene.config.substeps + 2, x);
    return wait_objection(s);
}

/* 0 and how many, or the exit status after a line. */
static int read_sets(const struct sender *s, int n, const char *const *word, unsigned *index, double *value,
                     int *count)
{
    char text[TEXT], why[SCENE_REASON] = "";
    struct word name, x, rest;
    if (join(s, n, word, text))
        return STATUS_MISUSED;
    rest = (struct word){text, strlen(text)};
    for (*count = 0; scene_words_next(&rest, &name, &x, why); (*count)++) {
        if (*count == SETS_MAX)
            return options_misuse(s->o->usage, "set: more than %d values", SETS_MAX);
        int found = scene_words_read(send_model(s), name, x, &value[*count], why);
        if (found < 0)
            break;
        index[*count] = (unsigned)found;
    }
    return *why ? options_misuse(s->o->usage, "set: %s", why) : 0;
}

static int check_set(const struct sender *s, int n, const char *const *word)
{
    unsigned index[SETS_MAX];
    double value[SETS_MAX];
    int count;
    return read_sets(s, n, word, index, value, &count);
}

static int run_set(struct sender *s, int n, const char *const *word)
{
    unsigned index[SETS_MAX];
    double value[SETS_MAX];
    int count;
    (void)read_sets(s, n, word, index, value, &count);
    send_expect(s, WIRE_PARAM_COMMIT);
    for (int i = 0; i < SEND_TRIES; i++) {
        client_set(&s->station.client, count, index, value, COMMIT_NOW);
        if (send_answer(s))
            return s->refused ? STATUS_FAILED : STATUS_DONE;
    }
    return send_no_answer(s, "set");
}

static int check_read(const struct sender *s, int n, const char *const *word)
{
    char why[SCENE_REASON];
    (void)n;
    return scene_find(send_model(s), word[0], why) < 0 ? options_misuse(s->o->usage, "%s", why) : 0;
}

static int run_read(struct sender *s, int n, const char *const *word)
{
    char why[SCENE_REASON];
    unsigned index = (unsigned)scene_find(send_model(s), word[0], why);
    double x = send_ask(s, index);
    (void)n;
    if (isnan(x))
        return send_no_answer(s, "read");
    printf("%s = %.9g %s\n", word[0], x, scene_parameter(send_model(s), (int)index)->unit);
    return STATUS_DONE;
}

const struct send_verb send_verb[SEND_VERBS] = {
    {"enable", 0, 0, NULL, run_enable},
    {"disable", 0, 0, NULL, run_disable},
    {"start", 0, 0, NULL, run_start},
    {"stop", 0, 0, NULL, run_stop},
    {"pause", 0, 0, NULL, run_pause},
    {"step", 1, 1, check_step, run_step},
    {"run-until", 1, 1, check_until, run_until},
    {"reset", 0, 0, NULL, run_reset},
    {"arm", 2, OPTIONS_WORDS, check_arm, run_arm},
    {"fire", 0, 0, check_fire, run_fire},
    {"stream", 2, OPTIONS_WORDS, check_stream, run_stream},
    {"set", 1, OPTIONS_WORDS, check_set, run_set},
    {"read", 1, 1, check_read, run_read},
    {"capture", 1, 3, send_check_capture, send_run_capture},
};
