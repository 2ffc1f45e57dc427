/* send_verbs.c - the commands of contactplant send. */
#include "host_sim/cli/clock.h"
#include "host_sim/commands.h"
#include "host_sim/cli/names.h"
#include "host_sim/live/send.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SETS_MAX = 32, NAME_SIZE = 64 };
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
    int i = names_find(send_model(s), NAMES_INPUT, name);
    if (i < 0)
        options_misuse(s->o->usage, "no input \"%s\"; contactplant list shows them", name);
    return i;
}

/* FIELD=VALUE words into value[], NaN where not given. */
static int read_fields(const struct sender *s, int n, const char *const *word, double *value)
{
    char name[NAME_SIZE];
    for (int i = 0; i < ARM_FIELDS; i++)
        value[i] = (double)NAN;
    for (int i = 0; i < n; i++) {
        double x;
        int field = options_read_setting(word[i], name, sizeof name, &x)
                        ? names_find(send_model(s), NAMES_ARM, name)
                        : -1;
        if (field < 0)
            return options_misuse(s->o->usage,
                                  "arm: \"%s\" is not amplitude=, frequency=, phase=, ramp=, noise=, "
                                  "noise_hold= or noise_seed= with a finite number",
                                  word[i]);
        if (field != ARM_AMPLITUDE && field != ARM_PHASE && x < 0.0)
            return options_misuse(s->o->usage, "arm: %s is negative; give 0 or more", word[i]);
        value[field] = x;
    }
    return 0;
}

static int check_arm(const struct sender *s, int n, const char *const *word)
{
    double value[ARM_FIELDS];
    return find_input(s, word[0]) < 0 ? STATUS_MISUSED : read_fields(s, n - 1, word + 1, value);
}

static int run_arm(struct sender *s, int n, const char *const *word)
{
    double value[ARM_FIELDS];
    int i = find_input(s, word[0]);
    (void)read_fields(s, n - 1, word + 1, value);
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

static int check_stream(const struct sender *s, int n, const char *const *word)
{
    double x;
    (void)n;
    if (find_input(s, word[0]) < 0)
        return STATUS_MISUSED;
    return options_read_number(word[1], &x)
               ? 0
               : options_misuse(s->o->usage, "stream: \"%s\" is not a finite number", word[1]);
}

static int run_stream(struct sender *s, int n, const char *const *word)
{
    double x = 0.0;
    int i = find_input(s, word[0]);
    (void)n;
    (void)options_read_number(word[1], &x);
    client_poll(&s->station.client);
    send_expect(s, WIRE_STREAM + (unsigned)i);
    for (int twice = 0; twice < 2; twice++) /* as for arm */
        client_stream(&s->station.client, i,
                      s->station.client.latest.tick / s->station.scene.config.substeps + 2, x);
    return wait_objection(s);
}

static int read_sets(const struct sender *s, int n, const char *const *word, unsigned *index, double *value)
{
    char name[NAME_SIZE], why[SCENE_REASON];
    for (int i = 0; i < n; i++) {
        if (!options_read_setting(word[i], name, sizeof name, &value[i]))
            return options_misuse(s->o->usage, "set %s: write NAME=VALUE with a finite number", word[i]);
        int found = scene_find(send_model(s), name, why);
        if (found < 0 || !scene_accepts(send_model(s), found, value[i], why))
            return options_misuse(s->o->usage, "%s", why);
        index[i] = (unsigned)found;
    }
    return 0;
}

static int check_set(const struct sender *s, int n, const char *const *word)
{
    unsigned index[SETS_MAX];
    double value[SETS_MAX];
    return read_sets(s, n, word, index, value);
}

static int run_set(struct sender *s, int n, const char *const *word)
{
    unsigned index[SETS_MAX];
    double value[SETS_MAX];
    (void)read_sets(s, n, word, index, value);
    send_expect(s, WIRE_PARAM_COMMIT);
    for (int i = 0; i < SEND_TRIES; i++) {
        client_set(&s->station.client, n, index, value, COMMIT_NOW);
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
    {"arm", 2, 1 + ARM_FIELDS, check_arm, run_arm},
    {"fire", 0, 0, check_fire, run_fire},
    {"stream", 2, 2, check_stream, run_stream},
    {"set", 1, SETS_MAX, check_set, run_set},
    {"read", 1, 1, check_read, run_read},
    {"capture", 1, 3, send_check_capture, send_run_capture},
};
