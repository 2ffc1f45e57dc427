/* device.c - see device.h. */
#include "host_sim/test/bench/device.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>
#include "firmware/bus/wire_table.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/names.h"
#include "host_sim/cli/ticks.h"
#include "host_sim/test/bench/device_wire.h"
#include "host_sim/test/test_at.h"
#include "host_sim/live/bus.h"
#include "host_sim/live/explain.h"
#include "host_sim/test/bench/controller.h"
#include "host_sim/live/client_host.h"

enum {
    FIRES = 2,          /* that wait in the plant at most, which has room for four */
    HEALTH_ROUNDS = 20, /* within so many every counter is told, though frames are lost */
    TRIES = 3           /* for a command whose frame was lost */
};
static const double lead_s = 0.4; /* so long before its instant an `at` line is on its way */
static const double answer_s = 0.5, look_s = 0.02, grace_s = 1.0, open_s = 5.0;

struct device {
    const struct bench_setting *s;
    const struct test_case *c;
    struct bench_result *r;
    struct bench_plant plant;
    struct bus bus;
    struct verdict_record record;
    struct client_link link;
    struct hal paced; /* the bus, a command a bus frame */
    struct client client;
    struct device_wire wire;
    struct controller_place at;
    struct controller controller;
    int next_act;
    int act_tries; /* to send the next one */
    double act_sent_s;
    double frame_s;
    uint32_t substeps;
    double echo_before; /* stream_echo_every of the plant before this case; NaN: it was left alone */
};

/* ---- set-up ---- */

/* False, and untested with the reason, where a case needs what a device cannot do. */
static bool check_case(struct device *d)
{
    const struct scene *scene = &d->plant.scene.scene;
    const char *why = NULL;
    bool drives = false;
    for (int i = 0; i < scene->model->n_inputs; i++)
        drives = drives || scene->drive[i].amplitude != 0.0 || scene->drive[i].noise > 0.0;
    bool streams = false;
    for (int i = 0; i < d->c->n_acts; i++)
        streams = streams || d->c->act[i].what.verb == ACTION_STREAM;
    if (streams)
        why = "stream: a plant in real time takes samples from its controller";
    else if (bench_has_faults(d->c))
        why = "link: the bus of a plant in real time is as it is; run the plant with --faults";
    else if (scene->started || drives)
        why = "the scene has a start or drives of its own, which the reset before a case ends";
    if (why)
        snprintf(d->r->error, sizeof d->r->error, "%s", why);
    d->r->verdict = why ? VERDICT_UNTESTED : d->r->verdict;
    return !why;
}

static bool has_sync(const struct client *c, const void *argument)
{
    return c->latest.count[WIRE_SYNC] > *(const uint64_t *)argument;
}

/* A board's CAN controller keeps a few frames only, and an emulated bus has no bit times. */
static int send_paced(void *context, const struct frame *f)
{
    struct device *d = context;
    int taken = d->bus.hal.send(d->bus.hal.context, f);
    d->bus.hal.flush(d->bus.hal.context);
    uint64_t seen = d->client.latest.count[WIRE_SYNC];
    if (seen)
        (void)client_wait(&d->client, has_sync, &seen, answer_s);
    return taken;
}

static int receive(void *context, struct frame *f)
{
    struct device *d = context;
    return d->bus.hal.recv(d->bus.hal.context, f);
}

static void flush(void *context)
{
    struct device *d = context;
    d->bus.hal.flush(d->bus.hal.context);
}

static bool open_bus(struct device *d)
{
    char why[BUS_REASON];
    const char *bus = d->s->bus ? d->s->bus : "udp:20003", *peer[] = {d->s->plant};
    bool can = !strncmp(bus, "can:", 4);
    if (!bus_open(&d->bus, bus, peer, can ? 0 : 1, &d->plant.scene.app.scene, why))
        return controller_fail(d->r, "%s%s", why, "");
    if (!verdict_begin_record(d->s, d->r, &d->bus, &d->record))
        return false;
    d->bus.log.listens = true;
    snprintf(d->at.plant, sizeof d->at.plant, "%s", d->s->plant);
    snprintf(d->at.me, sizeof d->at.me, "%s", d->s->controller);
    d->at.can = can ? bus : NULL;
    d->link = (struct client_link){.context = &d->bus, .wait = bus_wait};
    d->paced = (struct hal){.context = d, .recv = receive, .send = send_paced, .flush = flush};
    client_init(&d->client, can ? &d->paced : &d->bus.hal, &d->plant.scene.app.scene);
    d->client.link = &d->link;
    d->client.heard = device_wire_take;
    d->client.heard_context = &d->wire;
    d->wire.plant = &d->plant;
    device_wire_begin(&d->wire, d->c);
    return true;
}

/* Before a try of a command: where the one before it was not answered, its answer may still be on the way,
 * and counts. */
static void expect_answer(struct device *d, unsigned kind, bool again)
{
    if (!again || d->client.reply.came)
        client_expect(&d->client, kind);
}

static bool wait_answer(struct device *d)
{
    return client_wait_reply(&d->client, answer_s) && d->client.reply.cause == CAUSE_OK;
}

/* Every parameter and setting that the file names somewhere, as this case has it. */
static int list_values(const struct device *d, unsigned *index, double *value)
{
    const struct test_file *t = d->s->test;
    const struct app *a = &d->plant.scene.app;
    bool named[SETTING_FIRST + SETTINGS] = {false};
    int n = 0;
    for (int i = 0; i < t->plant.n; i++)
        named[t->plant.set[i].index] = true;
    for (int k = 0; k < t->n_cases; k++) {
        const struct test_case *c = &t->cases[k];
        for (int i = 0; i < c->plant.n; i++)
            named[c->plant.set[i].index] = true;
        for (int i = 0; i < c->n_acts; i++)
            for (int j = 0; j < c->act[i].what.n; j++)
                named[c->act[i].what.set[j].index] = true;
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

static bool set_all(struct device *d, int n, const unsigned *index, const double *value)
{
    bool done = n == 0;
    for (int i = 0; i < TRIES && !done; i++) {
        expect_answer(d, WIRE_PARAM_COMMIT, i > 0);
        client_set(&d->client, n, index, value, COMMIT_NOW);
        done = wait_answer(d);
        client_enable(&d->client, true);
    }
    return done;
}

static bool set_values(struct device *d)
{
    unsigned index[SETTING_FIRST + SETTINGS];
    double value[SETTING_FIRST + SETTINGS];
    return set_all(d, list_values(d, index, value), index, value);
}

static const unsigned echo_index = SETTING_FIRST + SET_STREAM_ECHO_EVERY;

static bool has_echo_setting(const struct client *c, const void *argument)
{
    (void)argument;
    return !isnan(c->latest.parameter[echo_index]);
}

/* Over UDP the plant alone hears the controller: it echoes each sample. An older plant has no such setting.
 */
static void begin_echo(struct device *d)
{
    const double every_frame = 1.0;
    double *every = &d->client.latest.parameter[echo_index];
    *every = (double)NAN;
    for (int i = 0; i < TRIES && isnan(*every); i++) {
        client_read(&d->client, echo_index);
        (void)client_wait(&d->client, has_echo_setting, NULL, answer_s);
        client_enable(&d->client, true);
    }
    double before = *every;
    d->wire.echoes = !isnan(before) && set_all(d, 1, &echo_index, &every_frame);
    if (d->wire.echoes)
        d->echo_before = before;
    else
        device_wire_deafen(&d->wire);
}

/* Leaves the plant as it was before the case. */
static void end_echo(struct device *d)
{
    if (isnan(d->echo_before) || !client_open(&d->client, false, open_s))
        return;
    (void)set_all(d, 1, &echo_index, &d->echo_before);
    (void)client_close(&d->client, open_s);
}

static bool command(struct device *d, enum control_operation operation, enum plant_state state)
{
    bool done = d->client.latest.state == state && operation == CONTROL_PAUSE;
    for (int i = 0; i < TRIES && !done; i++) {
        expect_answer(d, WIRE_CONTROL, i > 0);
        client_control(&d->client, operation, d->client.latest.frame);
        done = wait_answer(d) && client_wait_state(&d->client, state, answer_s);
        client_enable(&d->client, true);
    }
    return done;
}

/* So long the plant may be silent. */
static double silence_s(const struct device *d)
{
    return d->s->patience_s > 0.0 ? d->s->patience_s : 1e9;
}

static bool has_counters(const struct client *c, const void *argument)
{
    const struct device_wire *w = argument;
    return device_wire_has_counters(w) || c->latest.frame >= w->until;
}

/* HEALTH tells one counter at a time. Its pace is the plant's, which may be slower than real time. */
static bool hear_counters(struct device *d)
{
    double every = d->plant.scene.app.setting[SET_HEALTH_EVERY];
    memset(d->wire.rows.tally.known, 0, sizeof d->wire.rows.tally.known);
    d->wire.until = d->client.latest.frame + (uint64_t)(HEALTH_ROUNDS * DIAG_COUNTERS * every);
    (void)client_wait(&d->client, has_counters, &d->wire, silence_s(d));
    return device_wire_has_counters(&d->wire);
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
    if (!d->at.can)
        begin_echo(d);
    if (!command(d, CONTROL_RESET, STATE_READY))
        return controller_fail(d->r, "the plant does not reset%s%s", "", "");
    if (!client_close(&d->client, open_s))
        return controller_fail(d->r, "the plant does not close the session that was to prepare it%s%s", "",
                               "");
    d->wire.zero = d->client.latest.tick;
    return true;
}

/* ---- the case ---- */

static bool is_drive(const struct test_act *a)
{
    return a->what.verb == ACTION_ARM || a->what.verb == ACTION_FIRE_INPUT;
}

/* A fire's own tick; else that of the frame with which the line's time begins. */
static uint64_t tick_of(const struct device *d, const struct test_act *a)
{
    if (a->what.verb == ACTION_FIRE_INPUT)
        return d->wire.zero + test_instant(a, d->frame_s / d->substeps).tick;
    return d->wire.zero + ticks_begun(a->at_s, d->frame_s) * d->substeps;
}

static void repeat_last(struct client *c, int input, double field[ARM_FIELDS])
{
    int last = ARM_FIELDS - 1;
    while (last > 0 && isnan(field[last]))
        last--;
    for (int i = 0; i < last; i++)
        field[i] = (double)NAN;
    client_arm_fields(c, input, field);
}

static void send_act(struct device *d, const struct test_act *a)
{
    struct client *c = &d->client;
    double field[ARM_FIELDS];
    unsigned index[ACTION_SETS];
    double value[ACTION_SETS], fraction = 0.0;
    c->session = c->latest.session;
    expect_answer(d, WIRE_FIRE, d->act_tries > 0);
    if (is_drive(a)) {
        action_fields(&a->what, field);
        client_arm_fields(c, a->what.input, field);
        repeat_last(c, a->what.input, field); /* a gap in the counters tells of one that was lost */
    } else {
        action_split_set(&a->what, index, value);
        client_set(c, a->what.n, index, value, COMMIT_WITH_FIRE);
    }
    if (a->what.verb == ACTION_FIRE_INPUT)
        fraction = test_instant(a, d->frame_s / d->substeps).fraction / (double)TICK_FRACTIONS;
    client_fire(c, is_drive(a) ? 1u << a->what.input : 0u, !is_drive(a), tick_of(d, a), fraction);
    d->act_tries++;
    d->act_sent_s = clock_now_s();
}

/* Soon enough to be sent, with room for it: a set waits for the one before it. */
static bool is_due(const struct device *d, const struct test_act *a)
{
    uint64_t now = d->client.latest.tick, lead = (uint64_t)(lead_s / d->frame_s) * d->substeps;
    int waiting = 0;
    bool set_waits = false;
    for (int i = 0; i < d->next_act; i++) {
        bool waits = !d->c->act[i].waits && tick_of(d, &d->c->act[i]) > now;
        waiting += waits;
        set_waits = set_waits || (waits && d->c->act[i].what.verb == ACTION_SET);
    }
    return now + lead >= tick_of(d, a) && waiting < FIRES && (is_drive(a) || !set_waits);
}

/* Sends what is due soon, one at a time; the plant itself does it at its instant. False: it was refused. */
static bool act(struct device *d)
{
    while (d->next_act < d->c->n_acts && d->c->act[d->next_act].waits)
        d->next_act++; /* its fire arms it */
    const struct test_act *a = &d->c->act[d->next_act];
    char when[32];
    bool takes = d->client.latest.state == STATE_RUNNING || d->client.latest.state == STATE_PAUSED;
    if (d->next_act == d->c->n_acts || !takes || !client_in_session(&d->client))
        return true;
    snprintf(when, sizeof when, "%g", a->at_s);
    if (!d->act_tries && is_due(d, a))
        send_act(d, a);
    if (!d->act_tries)
        return true;
    if (d->client.reply.came && d->client.reply.cause == CAUSE_OK) {
        d->next_act++;
        d->act_tries = 0;
        return true;
    }
    if (!d->client.reply.came && clock_now_s() < d->act_sent_s + answer_s)
        return true;
    bool lost = !d->client.reply.came || d->client.reply.cause == CAUSE_INCOMPLETE; /* a frame of it */
    if (lost && d->act_tries < TRIES) {
        send_act(d, a);
        return true;
    }
    if (d->client.reply.came)
        return controller_fail(d->r, "at %s s: the plant refused it: %s", when,
                               names_text(d->plant.scene.config.model, NAMES_CAUSE, d->client.reply.cause));
    return controller_fail(
        d->r, "at %s s: the plant did not answer; does the controller send commands of this kind, too?%s",
        when, "");
}

static bool is_news(const struct client *c, const void *argument)
{
    const struct device *d = argument;
    return c->latest.count[WIRE_SYNC] > 0 && (d->client.reply.came || c->latest.tick >= d->wire.zero);
}

static const char *state_name(const struct device *d)
{
    const char *name = names_text(d->plant.scene.config.model, NAMES_STATE, (unsigned)d->client.latest.state);
    return name ? name : "?";
}

/* Until plant time has reached the end; false: it did not, and the result says why. */
static void run(struct device *d)
{
    uint64_t frames = ticks_begun(d->c->over_s, d->frame_s), end = d->wire.zero + frames * d->substeps;
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
        if (clock_now_s() > heard_s + silence_s(d)) {
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
    while (child_group_runs(&d->controller.child) && clock_now_s() < end_s)
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
    memcpy(d->wire.before, d->wire.rows.tally.count, sizeof d->wire.before);
    d->wire.measures = true;
    if (!controller_start(&d->controller, d->s, &d->plant.scene, &d->at, d->r))
        return;
    run(d);
    bool after = d->r->verdict != VERDICT_ERROR && hear_counters(d);
    device_wire_judge(&d->wire, d->c, before && after, d->r);
    d->wire.measures = false;
}

/* Only a client on an open bus is asked to let go. */
static void run_case(struct device *d)
{
    d->frame_s = d->plant.scene.config.frame_s;
    d->substeps = d->plant.scene.config.substeps;
    if (!open_bus(d))
        return;
    if (prepare_plant(d))
        measure(d);
    let_go(d);
    verdict_end_record(d->s, d->r, &d->bus);
    verdict_compare(d->s, &d->plant.scene, d->record.path, d->wire.zero, !d->at.can && !d->wire.echoes, d->r);
    end_echo(d);
}

void device_run(const struct bench_setting *s, struct bench_result *r)
{
    static struct device d; /* large: not on the stack */
    char why[CONTROLLER_REASON];
    memset(&d, 0, sizeof d);
    d.record.file = -1;
    d.s = s;
    d.r = r;
    d.c = &s->test->cases[r->i_case];
    d.echo_before = (double)NAN;
    double begin_s = clock_now_s();
    if (!bench_plant_open(&d.plant, s->test, d.c, r->varied ? &r->varied_value : NULL, why))
        controller_fail(r, "%s%s", why, "");
    else if (check_case(&d))
        run_case(&d);
    r->plant_s = fmin(d.wire.now_s, d.c->over_s);
    r->took_s = clock_now_s() - begin_s;
    bus_close(&d.bus);
    if (d.record.file >= 0)
        close(d.record.file);
    bench_plant_close(&d.plant);
}
