/* voice.c - see voice.h. */
#include "host_sim/scope/voice.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/names.h"

#include <math.h>
#include <string.h>

enum { LINE = 1024, HEAD = 4096 }; /* bytes of one element of a list; of what stands before the list */

static const double status_every_s = 0.5;

static const struct {
    const char *event, *list;
} lanes[LANES] = {
    [LANE_ROWS] = {"rows", "rows"},          [LANE_CONTACT] = {"contact", "events"},
    [LANE_SUMMARY] = {"summary", "summary"}, [LANE_LOCKIN] = {"lockin", "lockin"},
    [LANE_SAID] = {"said", "said"},          [LANE_BURST] = {"burst", "data"},
};

static void tell_lane(struct voice *v, enum lane lane)
{
    char text[HEAD];
    struct json j;
    json_begin(&j, text, sizeof text);
    json_put(&j, "event: %r\ndata: {'plant':%u,", lanes[lane].event, (uint64_t)v->number);
    voice_put_head(v, lane, &j);
    json_put(&j, "'%r':[", lanes[lane].list);
    server_tell_json(v->server, &j);
    server_tell_json(v->server, &v->lane[lane]);
    server_tell(v->server, "]}\n\n", 4);
    json_begin(&v->lane[lane], v->text[lane], VOICE_LANE);
}

/* One element more of a list. */
static void add_element(struct voice *v, enum lane lane, const struct json *element)
{
    if (v->lane[lane].n + element->n + 2 > VOICE_LANE)
        tell_lane(v, lane);
    json_item(&v->lane[lane], "%r", element->at);
}

/* ---- rows ---- */

static void end_row(struct voice *v)
{
    struct voice_row *r = &v->row;
    char text[LINE];
    struct json j;
    json_begin(&j, text, sizeof text);
    json_put(&j, "[%u,%t,%u", r->frame, (double)r->tick * v->scene.app.plant.tick_s, (uint64_t)r->closed);
    for (int i = 0; i < VOICE_OUTPUTS; i++)
        json_item(&j, "%n", r->output[i]);
    for (int i = 0; i < v->scene.config.model->n_inputs; i++)
        json_item(&j, "%n", r->sample[i]);
    json_put(&j, "]");
    if (r->begun && r->moved)
        add_element(v, LANE_ROWS, &j);
}

/* Plant time went back: the plant was started anew. */
static void tell_restart(struct voice *v)
{
    char text[LINE];
    struct json j;
    voice_tell(v);
    json_begin(&j, text, sizeof text);
    json_put(&j, "event: restart\ndata: {'plant':%u}\n\n", (uint64_t)v->number);
    server_tell_json(v->server, &j);
}

static void begin_row(struct voice *v)
{
    struct voice_row *r = &v->row;
    const struct latest *l = &v->client.latest;
    bool back = r->begun && l->tick < r->tick;
    end_row(v);
    if (back)
        tell_restart(v);
    r->frame = l->frame;
    r->tick = l->tick;
    r->begun = true;
    r->moved = false;
    for (int i = 0; i < VOICE_OUTPUTS; i++)
        r->output[i] = (double)NAN;
}

/* Samples act within a session. */
static void hear_status(struct voice *v)
{
    for (int i = 0; !client_in_session(&v->client) && i < MODEL_INPUTS; i++)
        v->row.sample[i] = (double)NAN;
}

static void hear_outputs(struct voice_row *r, const struct message *m)
{
    const double *value = m->value;
    int first = m->kind == WIRE_MOTION ? 0 : 2;
    r->moved = true;
    r->closed = (unsigned)value[MOTION_IN_CONTACT];
    r->output[first] = value[MOTION_DISPLACEMENT];
    r->output[first + 1] = value[MOTION_VELOCITY];
}

/* ---- contact events: two messages each ---- */

static void add_event(struct voice *v, double speed, double peak_force)
{
    const double *value = v->touched.value;
    double tick = (double)wire_nearest_32(v->client.latest.tick, value[EVENT_TIME_TICK]);
    char text[LINE];
    struct json j;
    json_begin(&j, text, sizeof text);
    json_put(&j, "[%t,%u,%u,%n,%n]", (tick + value[EVENT_TIME_FRACTION]) * v->scene.app.plant.tick_s,
             (uint64_t)value[EVENT_CONTACT], (uint64_t)value[EVENT_TOUCH], speed, peak_force);
    add_element(v, LANE_CONTACT, &j);
    v->touch_waits = false;
}

static void hear_event_time(struct voice *v, const struct message *m)
{
    if (v->touch_waits)
        add_event(v, (double)NAN, (double)NAN);
    v->touched = *m;
    v->touch_waits = true;
}

static void hear_event_data(struct voice *v, const struct message *m)
{
    bool same = m->counter == v->touched.counter &&
                m->value[EVENT_CONTACT] == v->touched.value[EVENT_CONTACT] &&
                m->value[EVENT_TOUCH] == v->touched.value[EVENT_TOUCH];
    if (v->touch_waits && same)
        add_event(v, m->value[EVENT_DATA_SPEED], m->value[EVENT_DATA_PEAK_FORCE]);
}

/* ---- lists of few numbers ---- */

static void hear_numbers(struct voice *v, enum lane lane, const double *value, int n)
{
    char text[LINE];
    struct json j;
    json_begin(&j, text, sizeof text);
    json_put(&j, lane == LANE_BURST ? "[" : "[%t", voice_time(v));
    for (int i = 0; i < n; i++)
        json_item(&j, "%n", value[i]);
    json_put(&j, "]");
    add_element(v, lane, &j);
}

static void hear_burst(struct voice *v, const struct message *m)
{
    double at = m->value[CAPTURE_DATA_SAMPLE] * MODEL_OUTPUTS + m->value[CAPTURE_DATA_SIGNAL];
    if (!(at > v->burst_at)) {
        if (v->lane[LANE_BURST].n)
            tell_lane(v, LANE_BURST);
        v->bursts++;
    }
    v->burst_at = at;
    hear_numbers(v, LANE_BURST, m->value, 3);
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

static void hear_message(struct voice *v, const struct message *m)
{
    const struct message_layout *l = wire_layout(m->kind);
    char text[LINE];
    struct json j;
    json_begin(&j, text, sizeof text);
    json_put(&j, "[%t,%u,'%r',{", voice_time(v), v->client.latest.frame, names_kind(m->kind));
    for (int i = 0; i < l->n_fields; i++)
        put_field(v->scene.config.model, &j, &l->field[i], m->value[i]);
    json_put(&j, "}]");
    add_element(v, LANE_SAID, &j);
}

static void hear_command(struct voice *v, const struct message *m)
{
    if (m->kind >= WIRE_STREAM && m->kind < WIRE_STREAM + MODEL_INPUTS)
        v->row.sample[m->kind - WIRE_STREAM] = m->value[STREAM_SAMPLE];
    else if (m->kind != WIRE_ENABLE || !(m->value[ENABLE_REQUEST] > 0.0) || !client_in_session(&v->client))
        hear_message(v, m);
}

static void hear_seldom(struct voice *v, const struct message *m)
{
    switch (m->kind) {
    case WIRE_REPLY:
    case WIRE_LATENCY:
    case WIRE_OVERRUN:
    case WIRE_WATCH:
        hear_message(v, m);
        break;
    case WIRE_SELF_TEST:
        if (m->value[SELF_TEST_VERDICT] == SELF_TEST_FAILED)
            hear_message(v, m);
        break;
    default: /* tables: voice_put_values */
        break;
    }
}

static void take(struct voice *v, const struct message *m)
{
    switch (m->kind) {
    case WIRE_SYNC:
        begin_row(v);
        break;
    case WIRE_STATUS:
        hear_status(v);
        break;
    case WIRE_MOTION:
    case WIRE_CONTACT:
        hear_outputs(&v->row, m);
        break;
    case WIRE_EVENT_TIME:
        hear_event_time(v, m);
        break;
    case WIRE_EVENT_DATA:
        hear_event_data(v, m);
        break;
    case WIRE_EVENT_SUMMARY:
        hear_numbers(v, LANE_SUMMARY, m->value, 3);
        break;
    case WIRE_LOCKIN:
        hear_numbers(v, LANE_LOCKIN, m->value, 3);
        break;
    case WIRE_CAPTURE_DATA:
        hear_burst(v, m);
        break;
    default:
        hear_seldom(v, m);
    }
}

/* Each message that the client decodes; none of a plant whose identity is not known to be this one. */
static void hear(void *context, const struct frame *f, const struct message *m)
{
    struct voice *v = context;
    (void)f;
    if (client_identity(&v->client) != CLIENT_SAME)
        v->withheld += m->kind != WIRE_STATUS && m->kind != WIRE_INFO;
    else if (m->kind < WIRE_COMMANDS)
        hear_command(v, m);
    else
        take(v, m);
}

/* ---- the client's end ---- */

static int give_heard(void *context, struct frame *f)
{
    struct voice *v = context;
    bool gives = v->waits;
    if (gives)
        *f = v->frame;
    v->waits = false;
    return gives;
}

void voice_begin(struct voice *v)
{
    v->hal = (struct hal){.context = v, .recv = give_heard};
    client_init(&v->client, &v->hal, &v->scene.app.scene);
    v->client.heard = hear;
    v->client.heard_context = v;
    for (int i = 0; i < LANES; i++)
        json_begin(&v->lane[i], v->text[i], VOICE_LANE);
    for (int i = 0; i < MODEL_INPUTS; i++)
        v->row.sample[i] = (double)NAN;
    const struct latest *l = &v->client.latest; /* all NaN */
    memcpy(v->told.health, l->health, sizeof l->health);
    memcpy(v->told.ledger, l->ledger, sizeof l->ledger);
    memcpy(v->told.info, l->info, sizeof l->info);
    memcpy(v->told.parameter, l->parameter, sizeof l->parameter);
    memcpy(v->told.drive, l->drive, sizeof l->drive);
    v->told.capture_tick = v->told.capture_pretrigger = (double)NAN;
    v->burst_at = HUGE_VAL;
}

bool voice_owns(const struct voice *v, const struct frame *f)
{
    const struct app_config *c = &v->scene.config;
    return (f->id & ~(uint32_t)(WIRE_KINDS - 1)) == c->base_id &&
           !(f->flags & FRAME_EXTENDED) == !c->extended;
}

void voice_hear(struct voice *v, const struct frame *f)
{
    v->frame = *f;
    v->waits = true;
    v->heard_s = clock_now_s();
    (void)client_poll(&v->client);
}

/* ---- telling ---- */

static void tell_status(struct voice *v)
{
    const struct message *m = &v->client.latest.message[WIRE_STATUS];
    bool same = true;
    for (int i = 0; i < STATUS_FRAME; i++)
        same = same && m->value[i] == v->told.status.value[i];
    if (!v->client.latest.count[WIRE_STATUS] || (same && clock_now_s() < v->told.status_s + status_every_s))
        return;
    char text[LINE];
    struct json j;
    json_begin(&j, text, sizeof text);
    voice_put_status(v, &j);
    server_tell_json(v->server, &j);
    v->told.status = *m;
    v->told.status_s = clock_now_s();
}

static void tell_values(struct voice *v)
{
    char text[VOICE_LANE];
    struct json j;
    json_begin(&j, text, sizeof text);
    voice_put_values(v, &j, &v->told);
    if (!j.full)
        server_tell_json(v->server, &j);
}

/* Where a burst's trigger came to be known after its values. */
static void tell_trigger(struct voice *v)
{
    const double *health = v->client.latest.health;
    bool news = !(health[DIAG_CAPTURE_TICK] == v->told.capture_tick &&
                  health[DIAG_CAPTURE_PRETRIGGER] == v->told.capture_pretrigger);
    bool known = !isnan(health[DIAG_CAPTURE_TICK]) && !isnan(health[DIAG_CAPTURE_PRETRIGGER]);
    if (v->lane[LANE_BURST].n || (v->bursts && news && known))
        tell_lane(v, LANE_BURST);
    v->told.capture_tick = health[DIAG_CAPTURE_TICK];
    v->told.capture_pretrigger = health[DIAG_CAPTURE_PRETRIGGER];
}

void voice_tell(struct voice *v)
{
    tell_status(v);
    if (client_identity(&v->client) != CLIENT_SAME)
        return;
    tell_values(v);
    for (int i = 0; i < LANE_BURST; i++)
        if (v->lane[i].n)
            tell_lane(v, (enum lane)i);
    tell_trigger(v);
}
