/* device.c - see device.h. */
#include "host_sim/device/device.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "host_sim/cli/clock.h"
#include "host_sim/cli/names.h"
#include "host_sim/device/device_wire.h"
#include "host_sim/live/bus.h"
#include "host_sim/live/explain.h"
#include "host_sim/trial/controller.h"

enum {
    LEAD_FRAMES = 20,  /* so long before its instant a drive or set is on its way */
    HEALTH_ROUNDS = 3, /* within so many every counter is told, where none is lost */
    TRIES = 3          /* for a command whose frame was lost */
};
static const double answer_s = 0.5, look_s = 0.02, grace_s = 1.0, open_s = 5.0;

struct device {
    const struct bench_setting *s;
    const struct trial_case *c;
    struct bench_result *r;
    struct bench_plant twin;
    struct bus bus;
    struct client_link link;
    struct client client;
    struct device_wire wire;
    struct controller_place at;
    struct controller controller;
    int next_act;
    bool act_sent;
    double act_sent_s;
    double frame_s;
    uint32_t substeps;
};

/* ---- set-up ---- */

/* False, and untested with the reason, where a case needs what a device cannot do. */
static bool check_case(struct device *d)
{
    const struct scene *scene = &d->twin.scene.scene;
    const char *why = NULL;
    bool drives = false;
    for (int i = 0; i < scene->model->n_inputs; i++)
        drives = drives || scene->drive[i].amplitude != 0.0 || scene->drive[i].noise > 0.0;
    if (*d->c->link)
        why = "link: the bus of a plant in real time is as it is; run the plant with --faults";
    else if (scene->started || drives)
        why = "the scene has a start or drives of its own, which the reset before a case ends";
    if (why)
        snprintf(d->r->error, sizeof d->r->error, "%s", why);
    d->r->verdict = why ? VERDICT_UNTESTED : d->r->verdict;
    return !why;
}

static bool open_bus(struct device *d)
{
    char why[BUS_REASON];
    const char *bus = d->s->bus ? d->s->bus : "udp:20003", *peer[] = {d->s->plant};
    bool can = !strncmp(bus, "can:", 4);
    if (!bus_open(&d->bus, bus, peer, can ? 0 : 1, &d->twin.scene.app.scene, why))
        return controller_fail(d->r, "%s%s", why, "");
    if (d->s->log) {
        controller_log_path(d->s, d->r, ".log", d->r->log);
        if (!bus_record(&d->bus, d->r->log, 0, why))
            return controller_fail(d->r, "--log: cannot write %.400s%s", d->r->log, "");
    }
    snprintf(d->at.plant, sizeof d->at.plant, "%s", d->s->plant);
    snprintf(d->at.me, sizeof d->at.me, "%s", d->s->controller);
    d->at.can = can ? bus : NULL;
    d->link = (struct client_link){.context = &d->bus, .wait = bus_wait};
    client_init(&d->client, &d->bus.hal, &d->twin.scene.app.scene);
    d->client.link = &d->link;
    d->client.heard = device_wire_hear;
    d->client.heard_context = &d->wire;
    d->wire.twin = &d->twin;
    device_wire_begin(&d->wire, d->c, can);
    return true;
}

static bool is_answered(const struct client *c, const void *argument)
{
    const struct device_wire *w = argument;
    (void)c;
    return w->answered;
}

static void expect_answer(struct device *d, unsigned kind)
{
    d->wire.kind = kind;
    d->wire.answered = false;
}

static bool wait_answer(struct device *d)
{
    return client_wait(&d->client, is_answered, &d->wire, answer_s) && d->wire.cause == CAUSE_OK;
}

/* Every parameter and setting that the file names somewhere, as this case has it. */
static int list_values(const struct device *d, unsigned *index, double *value)
{
    const struct trial *t = d->s->trial;
    const struct app *a = &d->twin.scene.app;
    bool named[SETTING_FIRST + SETTINGS] = {false};
    int n = 0;
    for (int i = 0; i < t->plant.n; i++)
        named[t->plant.set[i].index] = true;
    for (int k = 0; k < t->n_cases; k++) {
        const struct trial_case *c = &t->cases[k];
        for (int i = 0; i < c->plant.n; i++)
            named[c->plant.set[i].index] = true;
        for (int i = 0; i < c->n_acts; i++)
            for (int j = 0; j < c->act[i].n; j++)
                named[c->act[i].set[j].index] = true;
        if (c->varied >= 0)
            named[c->varied] = true;
    }
    for (unsigned i = 0; i < SETTING_FIRST + SETTINGS; i++)
        if (named[i]) {
            index[n] = i;
            value[n++] = i < SETTING_FIRST ? a->plant.si[i] : a->setting[i - SETTING_FIRST];
        }
    return n;
}

static bool set_values(struct device *d)
{
    unsigned index[SETTING_FIRST + SETTINGS];
    double value[SETTING_FIRST + SETTINGS];
    int n = list_values(d, index, value);
    bool done = n == 0;
    for (int i = 0; i < TRIES && !done; i++) {
        expect_answer(d, WIRE_PARAM_COMMIT);
        client_set(&d->client, n, index, value, COMMIT_NOW);
        done = wait_answer(d);
        client_enable(&d->client, true);
    }
    return done;
}

static bool command(struct device *d, enum control_operation operation, enum plant_state state)
{
    bool done = d->client.latest.state == state && operation == CONTROL_PAUSE;
    for (int i = 0; i < TRIES && !done; i++) {
        expect_answer(d, WIRE_CONTROL);
        client_control(&d->client, operation, d->client.latest.frame);
        done = wait_answer(d) && client_wait_state(&d->client, state, answer_s);
        client_enable(&d->client, true);
    }
    return done;
}

/* HEALTH tells one counter at a time. */
static bool hear_counters(struct device *d)
{
    double every = d->twin.scene.app.setting[SET_HEALTH_EVERY];
    memset(d->wire.told, 0, sizeof d->wire.told);
    return every > 0.0 && client_wait(&d->client, device_wire_has_counters, &d->wire,
                                      HEALTH_ROUNDS * DIAG_COUNTERS * every * d->frame_s);
}

/* The plant at rest with the case's values, and nobody in a session. */
static bool prepare_plant(struct device *d)
{
    char why[EXPLAIN_REASON];
    if (!client_open(&d->client, false, open_s)) {
        explain_no_session(&d->client, why);
        return controller_fail(d->r, "%.400s%s", why, "");
    }
    bool runs = d->client.latest.state == STATE_RUNNING;
    if (runs && !command(d, CONTROL_PAUSE, STATE_PAUSED))
        return controller_fail(d->r, "the plant does not pause%s%s", "", "");
    if (!set_values(d))
        return controller_fail(d->r, "the plant refuses the values of the case, or does not answer%s%s", "",
                               "");
    if (!command(d, CONTROL_RESET, STATE_READY))
        return controller_fail(d->r, "the plant does not reset%s%s", "", "");
    if (!client_close(&d->client, open_s))
        return controller_fail(d->r, "the plant does not close the session that was to prepare it%s%s", "",
                               "");
    d->wire.zero = d->client.latest.tick;
    return true;
}

/* ---- the case ---- */

/* The tick of the frame with which an `at` line's time begins. */
static uint64_t tick_of(const struct device *d, const struct trial_act *a)
{
    return d->wire.zero + (uint64_t)ceil(a->at_s / d->frame_s - 1e-9) * d->substeps;
}

static void send_act(struct device *d, const struct trial_act *a)
{
    struct client *c = &d->client;
    double field[ARM_FIELDS];
    unsigned index[TRIAL_SETS];
    double value[TRIAL_SETS];
    c->session = c->latest.session;
    expect_answer(d, WIRE_FIRE);
    if (a->arms) {
        for (int i = 0; i < ARM_FIELDS; i++)
            field[i] = a->given >> i & 1u ? a->value[i] : (double)NAN;
        client_arm_fields(c, a->input, field);
    } else {
        for (int i = 0; i < a->n; i++) {
            index[i] = a->set[i].index;
            value[i] = a->set[i].value;
        }
        client_set(c, a->n, index, value, COMMIT_WITH_FIRE);
    }
    client_fire(c, a->arms ? 1u << a->input : 0u, !a->arms, tick_of(d, a), 0.0);
    d->act_sent = true;
    d->act_sent_s = clock_now_s();
}

/* Sends what is due soon, one at a time; the plant itself does it at its instant. False: it was refused. */
static bool act(struct device *d)
{
    const struct trial_act *a = &d->c->act[d->next_act];
    char when[32];
    if (d->next_act == d->c->n_acts || !client_in_session(&d->client))
        return true;
    snprintf(when, sizeof when, "%g", a->at_s);
    if (!d->act_sent && d->client.latest.tick + LEAD_FRAMES * d->substeps >= tick_of(d, a))
        send_act(d, a);
    if (!d->act_sent)
        return true;
    if (d->wire.answered && d->wire.cause == CAUSE_OK) {
        d->next_act++;
        d->act_sent = false;
        return true;
    }
    if (d->wire.answered)
        return controller_fail(d->r, "at %s s: the plant refused it: %s", when,
                               names_text(d->twin.scene.config.model, NAMES_CAUSE, d->wire.cause));
    if (clock_now_s() < d->act_sent_s + answer_s)
        return true;
    return controller_fail(
        d->r, "at %s s: the plant did not answer; does the controller send commands of this kind, too?%s",
        when, "");
}

static bool is_news(const struct client *c, const void *argument)
{
    const struct device *d = argument;
    return c->latest.count[WIRE_SYNC] > 0 && (d->wire.answered || c->latest.tick >= d->wire.zero);
}

static const char *state_name(const struct device *d)
{
    const char *name = names_text(d->twin.scene.config.model, NAMES_STATE, (unsigned)d->client.latest.state);
    return name ? name : "?";
}

/* Until plant time has reached the end; false: it did not, and the result says why. */
static void run(struct device *d)
{
    uint64_t frames = (uint64_t)ceil(d->c->over_s / d->frame_s - 1e-9),
             end = d->wire.zero + frames * d->substeps;
    uint64_t first = d->client.latest.frame,
             limit = first + BENCH_SLOWER * frames + (uint64_t)(BENCH_START_S / d->frame_s);
    uint64_t heard = 0;
    double heard_s = clock_now_s();
    const struct latest *l = &d->client.latest;
    while (l->tick < end && l->frame < limit) {
        (void)client_wait(&d->client, is_news, d, look_s);
        if (l->count[WIRE_SYNC] != heard)
            heard_s = clock_now_s();
        heard = l->count[WIRE_SYNC];
        bus_set_frame(&d->bus, l->frame, d->frame_s, 0);
        if (d->s->patience_s > 0.0 && clock_now_s() > heard_s + d->s->patience_s) {
            controller_fail(d->r, "no word of the plant any more; see its own output%s%s", "", "");
            return;
        }
        if (!act(d) ||
            controller_has_ended(&d->controller, d->c, d->wire.now_s, d->wire.stopped_s >= 0.0, d->r))
            return;
    }
    if (l->tick < end)
        controller_explain_stand(d->c, state_name(d), d->wire.now_s, d->wire.stopped_s >= 0.0, d->r);
}

static bool is_over(const struct client *c, const void *argument)
{
    (void)argument;
    return !client_in_session(c);
}

/* The controller may end its session; where none does, the plant is stopped. */
static void let_go(struct device *d)
{
    double end_s = clock_now_s() + grace_s;
    child_ask(&d->controller.child);
    while (child_look(&d->controller.child) && clock_now_s() < end_s)
        client_poll(&d->client), bus_wait(&d->bus, look_s);
    controller_end(&d->controller, d->r);
    client_poll(&d->client);
    for (int i = 0; i < TRIES && client_in_session(&d->client); i++) {
        d->client.session = d->client.latest.session;
        client_control(&d->client, CONTROL_STOP, 0);
        (void)client_wait(&d->client, is_over, NULL, answer_s);
    }
}

static void measure(struct device *d)
{
    bool before = hear_counters(d);
    memcpy(d->wire.before, d->wire.count, sizeof d->wire.before);
    d->wire.measures = true;
    if (!controller_start(&d->controller, d->s, &d->twin.scene, &d->at, d->r))
        return;
    run(d);
    bool after = d->r->verdict != VERDICT_ERROR && hear_counters(d);
    device_wire_judge(&d->wire, d->c, before && after, d->r);
    d->wire.measures = false;
}

void device_run(const struct bench_setting *s, struct bench_result *r)
{
    static struct device d; /* large: not on the stack */
    char why[CONTROLLER_REASON];
    memset(&d, 0, sizeof d);
    d.s = s;
    d.r = r;
    d.c = &s->trial->cases[r->i_case];
    double begin_s = clock_now_s();
    if (!bench_plant_open(&d.twin, s->trial, d.c, r->varied ? &r->varied_value : NULL, why)) {
        controller_fail(r, "%s%s", why, "");
    } else if (check_case(&d)) {
        d.frame_s = d.twin.scene.config.frame_s;
        d.substeps = d.twin.scene.config.substeps;
        if (open_bus(&d) && prepare_plant(&d))
            measure(&d);
        let_go(&d);
        if (!bus_end_record(&d.bus, why) && r->verdict != VERDICT_ERROR)
            controller_fail(r, "--log: %s%s", why, "");
    }
    r->plant_s = fmin(d.wire.now_s, d.c->over_s);
    r->took_s = clock_now_s() - begin_s;
    bus_close(&d.bus);
    bench_plant_close(&d.twin);
}
