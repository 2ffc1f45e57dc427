/* decoder.c - see decoder.h. */
#include "firmware/bus/wire_table.h"
#include "host_sim/scope/decoder.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/names.h"
#include "host_sim/scope/decoder_events.h"
#include "host_sim/live/client_host.h"

#include <math.h>
#include <string.h>

enum { LINE = 1024, HEAD = 4096 }; /* bytes of one element of a list; of what stands before the list */

static const double status_every_s = 0.5;

static const struct {
    const char *event, *name;
} lists[LISTS] = {
    [LIST_ROWS] = {"rows", "rows"},          [LIST_CONTACT] = {"contact", "events"},
    [LIST_SUMMARY] = {"summary", "summary"}, [LIST_LOCKIN] = {"lockin", "lockin"},
    [LIST_MESSAGES] = {"said", "said"},      [LIST_BURST] = {"burst", "data"},
};

static void send_list(struct decoder *d, enum event_list list)
{
    char text[HEAD];
    struct json j;
    json_begin(&j, text, sizeof text);
    json_put(&j, "event: %r\ndata: {'plant':%u,", lists[list].event, (uint64_t)d->number);
    decoder_put_head(d, list, &j);
    json_put(&j, "'%r':[", lists[list].name);
    server_send_json(d->server, &j);
    server_send_json(d->server, &d->list[list]);
    server_send(d->server, "]}\n\n", 4);
    json_begin(&d->list[list], d->text[list], DECODER_LIST);
}

/* One element more of a list. */
static void add_element(struct decoder *d, enum event_list list, const struct json *element)
{
    if (d->list[list].n + element->n + 2 > DECODER_LIST)
        send_list(d, list);
    json_item(&d->list[list], "%r", element->at);
}

/* ---- rows and contact events ---- */

static void add_row(struct decoder *d, const struct decode_row *r)
{
    char text[LINE];
    struct json j;
    if (!r->said[0] && !r->said[1])
        return;
    json_begin(&j, text, sizeof text);
    json_put(&j, "[%u,%t,%u", r->frame, r->t_s, (uint64_t)r->closed);
    for (int i = 0; i < DECODE_OUTPUTS + d->scene.config.model->n_inputs; i++)
        json_item(&j, "%n", r->value[i]);
    json_put(&j, "]");
    add_element(d, LIST_ROWS, &j);
}

/* The plant was started anew. */
static void send_restart(struct decoder *d)
{
    char text[LINE];
    struct json j;
    decoder_send(d);
    json_begin(&j, text, sizeof text);
    json_put(&j, "event: restart\ndata: {'plant':%u}\n\n", (uint64_t)d->number);
    server_send_json(d->server, &j);
}

static void take_row(struct decoder *d, const struct message *m)
{
    struct decode_row row;
    unsigned run = d->rows.row.run;
    if (decode_take(&d->rows, m, &row))
        add_row(d, &row);
    if (d->rows.row.run != run)
        send_restart(d);
}

/* Samples act within a session. */
static void forget_samples(struct decoder *d)
{
    for (int i = 0; i < MODEL_INPUTS; i++)
        d->rows.row.value[DECODE_OUTPUTS + i] = (double)NAN;
}

static void take_event(void *context, const struct listen_event *e)
{
    struct decoder *d = context;
    char text[LINE];
    struct json j;
    json_begin(&j, text, sizeof text);
    json_put(&j, "[%t,%u,%u,%n,%n]", e->t_s, (uint64_t)e->contact, (uint64_t)e->touch, e->speed,
             e->peak_force_N);
    add_element(d, LIST_CONTACT, &j);
}

/* ---- lists of few numbers ---- */

static void take_numbers(struct decoder *d, enum event_list list, const double *value, int n)
{
    char text[LINE];
    struct json j;
    json_begin(&j, text, sizeof text);
    json_put(&j, list == LIST_BURST ? "[" : "[%t", decoder_time(d));
    for (int i = 0; i < n; i++)
        json_item(&j, "%n", value[i]);
    json_put(&j, "]");
    add_element(d, list, &j);
}

static void take_burst(struct decoder *d, const struct message *m)
{
    double at = m->value[CAPTURE_DATA_SAMPLE] * MODEL_OUTPUTS + m->value[CAPTURE_DATA_SIGNAL];
    if (!(at > d->burst_at)) {
        if (d->list[LIST_BURST].n)
            send_list(d, LIST_BURST);
        d->bursts++;
    }
    d->burst_at = at;
    take_numbers(d, LIST_BURST, m->value, 3);
}

/* ---- the other messages, as they are ---- */

static void put_field(const struct model *m, struct json *j, const struct field *f, double value)
{
    const char *name =
        f->names != NAMES_NONE && value >= 0.0 ? names_text(m, f->names, (unsigned)value) : NULL;
    if (name)
        json_item(j, "'%r':%s", f->name, name);
    else
        json_item(j, "'%r':%n", f->name, value);
}

static void take_message(struct decoder *d, const struct message *m)
{
    const struct message_layout *l = wire_layout(m->kind);
    char text[LINE];
    struct json j;
    json_begin(&j, text, sizeof text);
    json_put(&j, "[%t,%u,'%r',{", decoder_time(d), d->client.latest.frame, names_kind(m->kind));
    for (int i = 0; i < l->n_fields; i++)
        put_field(d->scene.config.model, &j, &l->field[i], m->value[i]);
    json_put(&j, "}]");
    add_element(d, LIST_MESSAGES, &j);
}

/* Samples are in the rows, and heartbeats are many. */
static void take_command(struct decoder *d, const struct message *m)
{
    bool sample = m->kind >= WIRE_STREAM && m->kind < WIRE_STREAM + MODEL_INPUTS;
    bool heartbeat =
        m->kind == WIRE_ENABLE && m->value[ENABLE_REQUEST] > 0.0 && client_in_session(&d->client);
    if (!sample && !heartbeat)
        take_message(d, m);
}

static void take_seldom(struct decoder *d, const struct message *m)
{
    switch (m->kind) {
    case WIRE_REPLY:
    case WIRE_LATENCY:
    case WIRE_OVERRUN:
    case WIRE_WATCH:
        take_message(d, m);
        break;
    case WIRE_SELF_TEST:
        if (m->value[SELF_TEST_VERDICT] == SELF_TEST_FAILED)
            take_message(d, m);
        break;
    default: /* tables: decoder_put_values */
        break;
    }
}

static void take_report(struct decoder *d, const struct message *m)
{
    switch (m->kind) {
    case WIRE_STATUS:
        if (!client_in_session(&d->client))
            forget_samples(d);
        break;
    case WIRE_EVENT_SUMMARY:
        take_numbers(d, LIST_SUMMARY, m->value, 3);
        break;
    case WIRE_LOCKIN:
        take_numbers(d, LIST_LOCKIN, m->value, 3);
        break;
    case WIRE_CAPTURE_DATA:
        take_burst(d, m);
        break;
    default:
        take_seldom(d, m);
    }
}

/* Each message that the client decodes; none of a plant whose identity is not known to be this one. */
static void receive(void *context, const struct frame *f, const struct message *m)
{
    struct decoder *d = context;
    (void)f;
    if (client_identity(&d->client) != CLIENT_SAME) {
        d->withheld += m->kind != WIRE_STATUS && m->kind != WIRE_INFO;
        return;
    }
    take_row(d, m);
    if (m->kind < WIRE_COMMANDS)
        take_command(d, m);
    else
        take_report(d, m);
}

/* ---- the frames ---- */

void decoder_begin(struct decoder *d)
{
    const struct latest *l = &d->client.latest; /* all NaN */
    client_init(&d->client, NULL, &d->scene.app.scene);
    d->client.heard = receive;
    d->client.heard_context = d;
    decode_begin(&d->rows, &d->scene.app.scene, d->scene.app.plant.tick_s);
    d->rows.events.take = take_event;
    d->rows.events.context = d;
    for (int i = 0; i < LISTS; i++)
        json_begin(&d->list[i], d->text[i], DECODER_LIST);
    memcpy(d->sent.health, l->health, sizeof l->health);
    memcpy(d->sent.ledger, l->ledger, sizeof l->ledger);
    memcpy(d->sent.info, l->info, sizeof l->info);
    memcpy(d->sent.parameter, l->parameter, sizeof l->parameter);
    memcpy(d->sent.drive, l->drive, sizeof l->drive);
    d->sent.capture_tick = d->sent.capture_pretrigger = (double)NAN;
    d->burst_at = HUGE_VAL;
}

bool decoder_owns(const struct decoder *d, const struct frame *f)
{
    const struct app_config *c = &d->scene.config;
    return (f->id & ~(uint32_t)(WIRE_KINDS - 1)) == c->base_id &&
           !(f->flags & FRAME_EXTENDED) == !c->extended;
}

void decoder_take(struct decoder *d, const struct frame *f)
{
    d->received_s = clock_now_s();
    client_take(&d->client, f);
}

/* ---- for the browsers ---- */

static void send_status(struct decoder *d)
{
    const struct message *m = &d->client.latest.message[WIRE_STATUS];
    bool same = true;
    for (int i = 0; i < STATUS_FRAME; i++)
        same = same && m->value[i] == d->sent.status.value[i];
    if (!d->client.latest.count[WIRE_STATUS] || (same && clock_now_s() < d->sent.status_s + status_every_s))
        return;
    char text[LINE];
    struct json j;
    json_begin(&j, text, sizeof text);
    decoder_put_status(d, &j);
    server_send_json(d->server, &j);
    d->sent.status = *m;
    d->sent.status_s = clock_now_s();
}

static void send_values(struct decoder *d)
{
    char text[DECODER_LIST];
    struct json j;
    json_begin(&j, text, sizeof text);
    decoder_put_values(d, &j, &d->sent);
    if (!j.full)
        server_send_json(d->server, &j);
}

/* Where a burst's trigger came to be known after its values. */
static void send_trigger(struct decoder *d)
{
    const double *health = d->client.latest.health;
    bool news = !(health[DIAG_CAPTURE_TICK] == d->sent.capture_tick &&
                  health[DIAG_CAPTURE_PRETRIGGER] == d->sent.capture_pretrigger);
    bool known = !isnan(health[DIAG_CAPTURE_TICK]) && !isnan(health[DIAG_CAPTURE_PRETRIGGER]);
    if (d->list[LIST_BURST].n || (d->bursts && news && known))
        send_list(d, LIST_BURST);
    d->sent.capture_tick = health[DIAG_CAPTURE_TICK];
    d->sent.capture_pretrigger = health[DIAG_CAPTURE_PRETRIGGER];
}

void decoder_send(struct decoder *d)
{
    send_status(d);
    if (client_identity(&d->client) != CLIENT_SAME)
        return;
    send_values(d);
    for (int i = 0; i < LIST_BURST; i++)
        if (d->list[i].n)
            send_list(d, (enum event_list)i);
    send_trigger(d);
}
