/* send_verbs.c - see send_verbs.h. */
#include "firmware/bus/wire_table.h"
#include "host_sim/live/send_verbs.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/names.h"
#include "host_sim/commands.h"
#include "host_sim/out/cell.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double objection_s = 0.05, full_s = 2.0;

const unsigned send_verbs = (1u << ACTION_VERBS) - 1u - (1u << ACTION_FIRE_INPUT) - (1u << ACTION_FAULTS);

/* After commands that are answered only when refused. */
static int wait_objection(struct sender *s)
{
    send_wait(s, objection_s);
    return s->refused ? STATUS_FAILED : STATUS_DONE;
}

/* Sends a command until it is answered: the first try may repeat a counter of the session's owner. */
static int send_until_answered(struct sender *s, unsigned kind, const struct action *a, const char *what,
                               void (*send)(struct sender *s, const struct action *a))
{
    send_expect(s, kind);
    for (int i = 0; i < SEND_TRIES; i++) {
        send(s, a);
        if (send_answer(s))
            return s->refused ? STATUS_FAILED : STATUS_DONE;
    }
    return send_no_answer(s, what);
}

/* ---- session and plant time ---- */

static int run_enable(struct sender *s, const struct action *a)
{
    (void)a;
    printf("ENABLE: session %u\n", s->remote.client.session);
    return STATUS_DONE;
}

static int run_disable(struct sender *s, const struct action *a)
{
    (void)a;
    if (!client_close(&s->remote.client, SEND_SILENCE_S))
        return send_no_answer(s, "disable");
    printf("ENABLE: off\n");
    return STATUS_DONE;
}

static enum control_operation operation_of(const struct action *a)
{
    static const enum control_operation operation[ACTION_VERBS] = {
        [ACTION_START] = CONTROL_START, [ACTION_STOP] = CONTROL_STOP,
        [ACTION_PAUSE] = CONTROL_PAUSE, [ACTION_STEP] = CONTROL_STEP,
        [ACTION_RESET] = CONTROL_RESET, [ACTION_RUN_UNTIL] = CONTROL_RUN_UNTIL};
    return operation[a->verb];
}

static void send_control(struct sender *s, const struct action *a)
{
    struct client *c = &s->remote.client;
    bool counts = a->verb == ACTION_STEP || a->verb == ACTION_RUN_UNTIL;
    client_control(c, operation_of(a), counts ? a->argument : c->latest.frame);
}

static int run_control(struct sender *s, const struct action *a)
{
    s->stopped = a->verb == ACTION_STOP;
    return send_until_answered(s, WIRE_CONTROL, a,
                               names_text(send_model(s), NAMES_OPERATION, (unsigned)operation_of(a)),
                               send_control);
}

/* ---- drives and samples ---- */

static int run_arm(struct sender *s, const struct action *a)
{
    double field[ARM_FIELDS];
    action_fields(a, field);
    send_expect(s, WIRE_ARM + (unsigned)a->input);
    for (int twice = 0; twice < 2; twice++) /* the first frame may repeat a counter of the session's owner */
        client_arm_fields(&s->remote.client, a->input, field);
    s->armed |= 1u << a->input;
    return wait_objection(s);
}

static void send_fire(struct sender *s, const struct action *a)
{
    struct client *c = &s->remote.client;
    uint64_t later = (uint64_t)options_number(s->o, "in") * s->remote.scene.config.substeps;
    bool named = options_given(s->o, "tick");
    (void)a;
    client_fire(c, s->armed, false,
                named ? strtoull(options_text(s->o, "tick", 0), NULL, 0) : c->latest.tick + later, 0.0);
}

static int run_fire(struct sender *s, const struct action *a)
{
    if (!s->armed)
        return options_failure(s->o->usage, "fire: arm something before it on the same command line");
    int status = send_until_answered(s, WIRE_FIRE, a, "fire", send_fire);
    s->armed = s->answered ? 0 : s->armed;
    return status;
}

static int run_stream(struct sender *s, const struct action *a)
{
    struct client *c = &s->remote.client;
    client_poll(c);
    send_expect(s, WIRE_STREAM + (unsigned)a->input);
    for (int twice = 0; twice < 2; twice++) /* as for arm */
        client_stream(c, a->input, c->latest.tick / s->remote.scene.config.substeps + 2, a->sample);
    return wait_objection(s);
}

/* ---- parameters and settings ---- */

static void send_set(struct sender *s, const struct action *a)
{
    unsigned index[ACTION_SETS];
    double value[ACTION_SETS];
    action_split_set(a, index, value);
    client_set(&s->remote.client, a->n, index, value, COMMIT_NOW);
}

static int run_set(struct sender *s, const struct action *a)
{
    return send_until_answered(s, WIRE_PARAM_COMMIT, a, "set", send_set);
}

static int run_read(struct sender *s, const struct action *a)
{
    unsigned index = a->set[0].index;
    double x = send_ask(s, index);
    if (isnan(x))
        return send_no_answer(s, "read");
    printf("%s = %.9g %s\n", a->text, x, scene_parameter(send_model(s), (int)index)->unit);
    return STATUS_DONE;
}

/* ---- bursts ---- */

static void print_burst(const struct sender *s)
{
    const struct model *m = send_model(s);
    printf("sample");
    for (int k = 0; k < m->n_outputs; k++)
        printf(",%s", m->output_signal[k].name);
    for (uint32_t i = 0; i < s->count; i++) {
        printf("\n%u", (unsigned)(s->first + i));
        for (int k = 0; k < m->n_outputs; k++)
            putchar(','), cell_put(stdout, (double)s->burst[i * (uint32_t)m->n_outputs + (uint32_t)k], 9);
    }
    printf("\n");
}

/* Takes values until the plant sends no more. True when all came. */
static bool collect_burst(struct sender *s)
{
    const uint64_t *count = &s->remote.client.latest.count[WIRE_CAPTURE_DATA];
    uint64_t seen;
    do {
        seen = *count;
        double end = clock_now_s() + SEND_ANSWER_S;
        send_expect(s, WIRE_CAPTURE); /* none is sent: no answer ends the wait */
        while (clock_now_s() < end && !clock_interrupted())
            (void)send_wait(s, SEND_LOOK_S);
    } while (*count != seen && !clock_interrupted());
    bool complete = true;
    for (uint32_t i = 0; i < s->count * (uint32_t)send_model(s)->n_outputs; i++)
        complete = complete && !isnan(s->burst[i]);
    return complete;
}

static void send_capture(struct sender *s, const struct action *a)
{
    client_capture(&s->remote.client, (enum capture_operation)a->operation, s->first, s->count);
}

/* Waits for a burst that is filling, as HEALTH says. If there is none then, the plant refuses to read it
 * out. */
static void wait_full(struct sender *s)
{
    double *state = &s->remote.client.latest.health[DIAG_CAPTURE_STATE], end = clock_now_s() + full_s;
    *state = (double)NAN; /* the state before the last command does not count */
    send_expect(s, WIRE_CAPTURE);
    while (*state != CAPTURE_FULL && *state != CAPTURE_IDLE && clock_now_s() < end && !clock_interrupted())
        (void)send_wait(s, SEND_LOOK_S);
}

static int read_burst(struct sender *s, const struct action *a)
{
    double count = a->count ? a->count : send_ask(s, SETTING_FIRST + SET_CAPTURE_SAMPLES);
    if (!(count >= 1.0 && count <= 65535.0))
        return send_no_answer(s, "read capture_samples");
    s->first = a->first;
    s->count = (uint32_t)count;
    size_t n_values = (size_t)s->count * (size_t)send_model(s)->n_outputs;
    s->burst = malloc(n_values * sizeof *s->burst);
    if (!s->burst)
        return options_failure(s->o->usage, "out of memory");
    for (size_t i = 0; i < n_values; i++)
        s->burst[i] = NAN;
    wait_full(s);
    int status = send_until_answered(s, WIRE_CAPTURE, a, "capture", send_capture);
    if (status)
        return status;
    bool complete = collect_burst(s);
    print_burst(s);
    free(s->burst);
    s->burst = NULL;
    return complete ? STATUS_DONE
                    : options_failure(s->o->usage,
                                      "some values did not arrive: their cells are empty; read again");
}

static int run_capture(struct sender *s, const struct action *a)
{
    if (a->operation == CAPTURE_READ)
        return read_burst(s, a);
    s->first = s->count = 0;
    return send_until_answered(s, WIRE_CAPTURE, a, "capture", send_capture);
}

int send_check(const struct sender *s, const struct action *a)
{
    if (a->verb == ACTION_FIRE && options_given(s->o, "tick") && options_given(s->o, "in"))
        return options_misuse(s->o->usage, "fire: --tick and --in both say when; give one of them");
    return STATUS_DONE;
}

int send_run(struct sender *s, const struct action *a)
{
    static int (*const run[ACTION_VERBS])(struct sender * s, const struct action *a) = {
        [ACTION_ENABLE] = run_enable,     [ACTION_DISABLE] = run_disable, [ACTION_START] = run_control,
        [ACTION_STOP] = run_control,      [ACTION_PAUSE] = run_control,   [ACTION_STEP] = run_control,
        [ACTION_RUN_UNTIL] = run_control, [ACTION_RESET] = run_control,   [ACTION_ARM] = run_arm,
        [ACTION_FIRE] = run_fire,         [ACTION_STREAM] = run_stream,   [ACTION_SET] = run_set,
        [ACTION_READ] = run_read,         [ACTION_CAPTURE] = run_capture,
    };
    return run[a->verb](s, a);
}
