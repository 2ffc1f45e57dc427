/* client.c - see client.h. */
#include "firmware/bus/wire_table.h"
#include "host_sim/live/client.h"
#include "firmware/bus/identity.h"
#include "firmware/bus/mailbox.h"

#include <math.h>
#include <string.h>

enum { POLL_BUDGET = 8192 }; /* frames taken in one poll; a plant sends some ten a millisecond */
static const double open_retry_s = 0.05;
static const double look_s = 0.1; /* a wait looks up so often: a signal may have come just before it */
static const double identity_s =
    1.0; /* a plant of 100 frames a second and more tells it by itself in this time */
static const double explain_s =
    2.0; /* for the other items of INFO: a round of them takes 0.9 s at 1000 frames */

void client_begin(struct client *c, const struct hal *hal, const struct wire_scene *scene,
                  const struct client_waiter *waiter)
{
    memset(c, 0, sizeof *c);
    c->hal = hal;
    c->waiter = waiter;
    c->scene = *scene;
    latest_begin(&c->latest);
    c->reply.kind = WIRE_KINDS; /* none is expected */
}

static void take_reply(struct client *c, const struct message *m)
{
    struct client_reply *r = &c->reply;
    unsigned n = WIRE_COUNTER_STATES, behind = ((unsigned)m->value[REPLY_COUNTER] + n - r->first_counter) % n;
    bool expected = (unsigned)m->value[REPLY_MESSAGE] == r->kind && (uint8_t)m->value[SESSION] == c->session;
    if (r->came || !expected || behind >= (c->counter[r->kind] + n - r->first_counter) % n)
        return;
    r->came = true;
    r->cause = (enum cause)m->value[REPLY_CAUSE];
}

void client_take(struct client *c, const struct frame *f)
{
    struct message m;
    enum wire_status status = wire_decode(&c->scene, f, &m);
    if (status == WIRE_NOT_OURS)
        return;
    if (status != WIRE_OK) {
        c->bad++;
        return;
    }
    if (m.kind >= WIRE_COMMANDS)
        latest_take(&c->latest, c->scene.substeps, &m);
    if (m.kind == WIRE_REPLY)
        take_reply(c, &m);
    if (c->heard)
        c->heard(c->heard_context, f, &m);
}

static bool in_lockstep(const struct client *c)
{
    return c->link && c->link->answer;
}

int client_poll(struct client *c)
{
    int n = 0;
    for (int i = 0; i < POLL_BUDGET; i++) {
        struct frame f;
        int got = c->hal->recv(c->hal->context, &f);
        if (got == 0)
            break;
        if (got < 0)
            c->bus_faults++;
        else
            client_take(c, &f), n++;
    }
    return n;
}

/* Integers longer than their field travel as their low bits. */
static double cut(const struct field *f, double value)
{
    if (f->kind != FIELD_UNSIGNED || f->scale != SCALE_ONE || !(value >= 0.0) || f->bits > 52)
        return value;
    return fmod(value, (double)(UINT64_C(1) << f->bits));
}

/* One command: value[] in the order of its layout without SESSION, n of them. Integers that are longer than
 * their field are cut to its bits. False when the bus had no room. It goes out at once; in lockstep with the
 * next wait. */
static bool send_command(struct client *c, unsigned kind, int n, const double *value)
{
    const struct message_layout *layout = wire_layout(kind);
    struct message m = {.kind = (uint8_t)kind, .counter = c->counter[kind]};
    struct frame f;
    m.value[SESSION] = c->session;
    for (int i = 0; i < n && i + 1 < layout->n_fields; i++)
        m.value[i + 1] = cut(&layout->field[i + 1], value[i]);
    wire_encode(&c->scene, &m, &f);
    c->counter[kind] =
        (uint8_t)((m.counter + 1) % WIRE_COUNTER_STATES); /* the answer may come while it goes */
    if (c->hal->send(c->hal->context, &f) != 1) {
        c->counter[kind] = m.counter;
        c->unsent++;
        return false;
    }
    if (in_lockstep(c))
        c->unsaid = true;
    else
        c->hal->flush(c->hal->context);
    return true;
}

bool client_in_session(const struct client *c)
{
    const struct latest *l = &c->latest;
    return l->session != 0 && l->state != STATE_OFF && l->reaction == REACTION_NONE;
}

bool client_enable(struct client *c, bool on)
{
    const double value[] = {on ? 1.0 : 0.0, (double)c->latest.frame};
    return send_command(c, WIRE_ENABLE, 2, value);
}

bool client_control(struct client *c, enum control_operation operation, uint64_t argument)
{
    /* the operation's complement keeps a damaged frame with a lucky CRC from becoming another operation */
    unsigned bits = wire_layout(WIRE_CONTROL)->field[CONTROL_COMPLEMENT].bits;
    const double value[] = {(double)operation, (double)(~(unsigned)operation & ((1u << bits) - 1u)),
                            (double)(argument & UINT32_MAX)};
    return send_command(c, WIRE_CONTROL, 3, value);
}

bool client_arm(struct client *c, int channel, double amplitude, double frequency_Hz, double phase_rad,
                double ramp_s)
{
    const double none = (double)NAN;
    return client_arm_fields(
        c, channel, (const double[ARM_FIELDS]){amplitude, frequency_Hz, phase_rad, ramp_s, none, none, none});
}

bool client_arm_fields(struct client *c, int channel, const double *field)
{
    bool sent = true;
    for (int i = 0; i < ARM_FIELDS; i++) {
        const double value[] = {(double)i, field[i]};
        if (!isnan(field[i]))
            sent = send_command(c, WIRE_ARM + (unsigned)channel, 2, value) && sent;
    }
    return sent;
}

bool client_fire(struct client *c, unsigned channels, bool parameters, uint64_t tick, double fraction)
{
    const double value[] = {(double)channels, parameters ? 1.0 : 0.0, fraction, (double)(tick & UINT32_MAX)};
    return send_command(c, WIRE_FIRE, 4, value);
}

bool client_stream(struct client *c, int channel, uint64_t frame, double sample)
{
    const double value[] = {(double)(frame & UINT32_MAX), sample};
    return send_command(c, WIRE_STREAM + (unsigned)channel, 2, value);
}

bool client_set(struct client *c, int n, const unsigned *index, const double *value, enum commit_when when)
{
    struct staged set;
    bool sent = true;
    memset(&set, 0, sizeof set);
    for (int i = 0; i < n; i++) {
        const double write[] = {(double)index[i], value[i]};
        staged_put(&set, index[i], value[i]);
        sent = send_command(c, WIRE_PARAM_WRITE, 2, write) && sent;
    }
    const double commit[] = {(double)staged_count(&set), (double)when, (double)staged_crc(&set)};
    return send_command(c, WIRE_PARAM_COMMIT, 3, commit) && sent;
}

void client_expect(struct client *c, unsigned kind)
{
    c->reply = (struct client_reply){.kind = kind, .first_counter = c->counter[kind]};
}

bool client_read(struct client *c, unsigned index)
{
    const double value[] = {(double)index};
    return send_command(c, WIRE_PARAM_READ, 1, value);
}

bool client_capture(struct client *c, enum capture_operation operation, uint32_t first, uint32_t count)
{
    const double value[] = {(double)operation, (double)first, (double)count};
    return send_command(c, WIRE_CAPTURE, 3, value);
}

static double clock_s(const struct client *c)
{
    return c->waiter->now_s(c->waiter->context);
}

static bool is_interrupted(const struct client *c)
{
    return c->waiter->is_interrupted(c->waiter->context);
}

/* The time that waits go by: the clock, in lockstep bus frames. */
static double now_s(const struct client *c)
{
    return in_lockstep(c) ? (double)c->turns / c->scene.frame_rate_Hz : clock_s(c);
}

/* Waits for more until `end_s`. */
static void pause_until(const struct client *c, double end_s)
{
    double left_s = end_s - clock_s(c);
    if (c->link)
        c->link->wait(c->link->context, left_s < look_s ? fmax(left_s, 0.0) : look_s);
    else
        c->waiter->rest(c->waiter->context, left_s);
}

static bool wait_by_clock(struct client *c, bool (*condition)(const struct client *c, const void *argument),
                          const void *argument, double seconds)
{
    double end_s = clock_s(c) + seconds;
    bool interrupted = is_interrupted(c);
    while (is_interrupted(c) == interrupted) {
        int n = client_poll(c);
        if (condition(c, argument))
            return true;
        if (!(clock_s(c) < end_s))
            return false;
        if (!n)
            pause_until(c, end_s);
    }
    return false;
}

/* One bus frame: our word goes out, and all that the plant says in that frame is taken. False when it stays
 * silent or has ended. Silence is counted in looks: a client that was stopped itself does not complain. */
static bool take_turn(struct client *c)
{
    const struct client_link *l = c->link;
    bool interrupted = is_interrupted(c), said = l->answer(l->context) == CLIENT_ANSWERED;
    double silent_s = c->silent ? l->patience_s : 0.0; /* it was waited for already */
    if (said) {
        c->unsaid = false;
        c->hal->flush(c->hal->context);
    }
    if (l->answer(l->context) == CLIENT_ANSWERED) /* at once, in one process */
        client_poll(c);
    for (;;) {
        double begin_s = clock_s(c);
        enum client_answer answer = l->answer(l->context);
        bool tired = l->patience_s > 0.0 && silent_s >= l->patience_s;
        if (answer != CLIENT_UNANSWERED || tired || is_interrupted(c) != interrupted) {
            c->turns += answer == CLIENT_ANSWERED;
            c->silent = tired || answer == CLIENT_REFUSED;
            return answer == CLIENT_ANSWERED;
        }
        l->wait(l->context, look_s);
        client_poll(c);
        silent_s += fmin(clock_s(c) - begin_s, look_s);
    }
}

static bool wait_by_turns(struct client *c, bool (*condition)(const struct client *c, const void *argument),
                          const void *argument, double seconds)
{
    double end_s = now_s(c) + seconds;
    bool interrupted = is_interrupted(c);
    if (!c->unsaid && condition(c, argument))
        return true;
    while (is_interrupted(c) == interrupted && take_turn(c)) {
        if (!c->unsaid && condition(c, argument))
            return true;
        if (!(now_s(c) < end_s))
            return false;
    }
    return false;
}

bool client_wait(struct client *c, bool (*condition)(const struct client *c, const void *argument),
                 const void *argument, double seconds)
{
    return (in_lockstep(c) ? wait_by_turns : wait_by_clock)(c, condition, argument, seconds);
}

/* The message that client_wait_message waits for. */
struct more {
    unsigned kind;
    uint64_t count;
};

static bool has_more(const struct client *c, const void *argument)
{
    const struct more *m = argument;
    return c->latest.count[m->kind] > m->count;
}

static bool wait_message(struct client *c, unsigned kind, double seconds)
{
    const struct more more = {kind, c->latest.count[kind]};
    return client_wait(c, has_more, &more, seconds);
}

bool client_wait_alive(struct client *c, double seconds)
{
    return wait_message(c, WIRE_STATUS, seconds) && wait_message(c, WIRE_SYNC, seconds);
}

static bool is_state(const struct client *c, const void *argument)
{
    return c->latest.state == *(const enum plant_state *)argument;
}

bool client_wait_state(struct client *c, enum plant_state state, double seconds)
{
    return client_wait(c, is_state, &state, seconds);
}

static bool is_tick(const struct client *c, const void *argument)
{
    return c->latest.tick >= *(const uint64_t *)argument;
}

bool client_wait_tick(struct client *c, uint64_t tick, double seconds)
{
    return client_wait(c, is_tick, &tick, seconds);
}

static bool is_contact(const struct client *c, const void *argument)
{
    return c->latest.contact_tick >= *(const uint64_t *)argument;
}

bool client_wait_contact(struct client *c, uint64_t tick, double seconds)
{
    return client_wait(c, is_contact, &tick, seconds);
}

static bool has_reply(const struct client *c, const void *argument)
{
    (void)argument;
    return c->reply.came;
}

bool client_wait_reply(struct client *c, double seconds)
{
    return client_wait(c, has_reply, NULL, seconds);
}

static bool is_ours(const struct client *c, const void *argument)
{
    (void)argument;
    return client_in_session(c) && c->latest.session == c->session;
}

/* ---- identity ---- */

enum client_identity client_identity(const struct client *c)
{
    double told = c->latest.info[INFO_IDENTITY];
    if (isnan(told))
        return CLIENT_UNTOLD;
    return told == (double)c->scene.identity ? CLIENT_SAME : CLIENT_OTHER;
}

static bool is_told(const struct client *c, const void *argument)
{
    (void)argument;
    return client_identity(c) != CLIENT_UNTOLD;
}

/* Every part is told, or there is no need for them. */
static bool is_explained(const struct client *c, const void *argument)
{
    double assumed;
    (void)argument;
    for (unsigned i = 0; i < INFO_ITEMS; i++)
        if (identity_item(&c->scene, i, &assumed) && isnan(c->latest.info[i]))
            return client_identity(c) == CLIENT_SAME;
    return true;
}

bool client_wait_identity(struct client *c, double seconds)
{
    if (!client_wait(c, is_told, NULL, seconds))
        return false;
    client_wait(c, is_explained, NULL, explain_s);
    return client_identity(c) == CLIENT_SAME;
}

/* Once in a session the plant tells all of it at once. */
static bool is_known_in_session(struct client *c, bool joined, double seconds)
{
    if (client_wait_identity(c, seconds))
        return true;
    if (!joined)
        client_close(c, seconds);
    return false;
}

static bool may_try_again(const struct client *c, double end_s)
{
    return now_s(c) < end_s && !is_interrupted(c) && !c->silent;
}

bool client_open(struct client *c, bool join, double seconds)
{
    double end_s = now_s(c) + seconds;
    if (!client_wait_alive(c, seconds))
        return false;
    if (!client_wait_identity(c, identity_s) && client_identity(c) == CLIENT_OTHER)
        return false;
    do {
        bool taken = client_in_session(c), joined = taken && join;
        c->session = joined ? c->latest.session : (uint8_t)(c->latest.session % WIRE_SESSIONS + 1);
        client_enable(c, true);
        if (client_wait(c, is_ours, NULL, open_retry_s))
            return is_known_in_session(c, joined, seconds);
    } while (may_try_again(c, end_s));
    return false;
}

static bool is_closed(const struct client *c, const void *argument)
{
    (void)argument;
    return !is_ours(c, NULL);
}

bool client_close(struct client *c, double seconds)
{
    double end_s = now_s(c) + seconds;
    if (is_closed(c, NULL))
        return true;
    do {
        client_enable(c, false);
        if (client_wait(c, is_closed, NULL, open_retry_s))
            return true;
    } while (may_try_again(c, end_s));
    return false;
}
