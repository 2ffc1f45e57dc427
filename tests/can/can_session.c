/* can_session.c - a controller's session with a plant in the same program; see can_session.h. */
#include "tests/can/can_session.h"

#include <string.h>
#include "firmware/plant/plant_report.h"
#include "models/hertz_rig.h"

enum {
    BASE_ID = 0x200,
    SUBSTEPS = 64,
    FRAMES = 1500,
    HEARTBEAT = 20,
    SILENT_FROM = 1000, /* until the next session */
    POLL = 256
};
#define FRAME_S 1e-3

/* FNV-1a, 64 bits. */
static void mix(uint64_t *hash, const void *data, size_t n)
{
    const uint8_t *byte = data;
    for (size_t i = 0; i < n; i++)
        *hash = (*hash ^ byte[i]) * UINT64_C(0x100000001B3);
}

/* ---- what the controller sends ---- */

static void put(struct can_session *s, const struct frame *f)
{
    s->unsent += !s->bench->send(s->bench->context, f);
    s->plant->flush(s->plant->context); /* takes it up, where the driver has a queue */
}

static void send(struct can_session *s, unsigned kind, int n, const double *value)
{
    struct message m = {.kind = (uint8_t)kind, .counter = s->counter[kind]};
    struct frame f;
    m.value[SESSION] = s->session;
    memcpy(m.value + 1, value, (size_t)n * sizeof *value);
    s->counter[kind] = (uint8_t)((s->counter[kind] + 1) % WIRE_COUNTER_STATES);
    wire_encode(&s->scene, &m, &f);
    put(s, &f);
}

static void enable(struct can_session *s, bool on)
{
    send(s, WIRE_ENABLE, 2, (double[]){on, (double)s->frame});
}

static void control(struct can_session *s, enum control_operation operation)
{
    send(s, WIRE_CONTROL, 3, (double[]){operation, 0xFF ^ operation, (double)s->frame});
}

static void drive(struct can_session *s, int i, double amplitude, double frequency_Hz)
{
    const double field[ARM_FIELDS] = {amplitude, frequency_Hz, 0.3, 0.05};
    for (int k = 0; k < ARM_FIELDS; k++)
        send(s, WIRE_ARM + (unsigned)i, 2, (double[]){k, field[k]});
    send(s, WIRE_FIRE, 4, (double[]){1u << i, 0, 0.25, (double)s->app.plant.now.tick + 5 * SUBSTEPS + 17});
}

static void set(struct can_session *s, unsigned index, double value)
{
    struct staged staged;
    memset(&staged, 0, sizeof staged);
    staged_put(&staged, index, value);
    send(s, WIRE_PARAM_WRITE, 2, (double[]){index, value});
    send(s, WIRE_PARAM_COMMIT, 3, (double[]){1, COMMIT_NOW, staged_crc(&staged)});
}

static void misbehave(struct can_session *s)
{
    struct frame damaged = {.id = BASE_ID + WIRE_CONTROL, .length = 8, .data = {0x55, 0x51, 1}};
    struct frame shorter = {.id = BASE_ID + WIRE_ENABLE, .length = 3, .data = {1, 2, 3}};
    struct frame unknown = {.id = BASE_ID + 0x3F, .length = 8};
    put(s, &damaged);
    put(s, &shorter);
    put(s, &unknown);
    s->counter[WIRE_CAPTURE] = 5;
    send(s, WIRE_CAPTURE, 3, (double[]){CAPTURE_STOP, 0, 0});
    s->counter[WIRE_CAPTURE] = 5; /* a repetition */
    send(s, WIRE_CAPTURE, 3, (double[]){CAPTURE_STOP, 0, 0});
    send(s, WIRE_FIRE, 4, (double[]){1, 0, 0, 1}); /* late */
}

static void speak(struct can_session *s, uint64_t i)
{
    bool silent = i >= SILENT_FROM && i < SILENT_FROM + 200;
    if (i > 0 && i % HEARTBEAT == 0 && !silent && i < FRAMES - 50)
        enable(s, true);
    if (i >= 300 && i < 400)
        send(s, WIRE_STREAM + RIG_FORCE, 2,
             (double[]){(double)(s->app.plant.now.tick / SUBSTEPS + 2), 2.0 - i % 5});
    switch (i) {
    case 25:
        control(s, CONTROL_START);
        break;
    case 40:
        set(s, SETTING_FIRST + SET_HASH_EVERY, 16.0);
        break;
    case 100:
        drive(s, RIG_FORCE, 3.0, 225.0);
        break;
    case 200:
        set(s, 0, 7.0);
        break;
    case 450:
        drive(s, RIG_FORCE, 70.0, 230.0); /* breaks contact */
        break;
    case 700:
        misbehave(s);
        break;
    case SILENT_FROM + 190:
        s->session = 2;
        break;
    case SILENT_FROM + 250:
        control(s, CONTROL_PAUSE);
        break;
    case SILENT_FROM + 260:
        control(s, CONTROL_RESET);
        break;
    case FRAMES - 40:
        enable(s, false);
        break;
    default:
        break;
    }
}

/* ---- what it hears ---- */

static bool is_timing(const struct message *m)
{
    return m->kind == WIRE_HEALTH && m->value[HEALTH_ITEM] >= DIAG_COMPUTE_MAX_US;
}

static void hear(struct can_session *s)
{
    struct frame f;
    struct message m;
    int got = s->bench->recv(s->bench->context, &f);
    for (int i = 0; i < POLL && got != 0; i++) {
        s->faults += got < 0;
        if (got > 0 && wire_decode(&s->scene, &f, &m) != WIRE_OK) {
            s->bad++;
        } else if (got > 0) {
            s->heard[m.kind]++;
            if (m.kind == WIRE_SYNC)
                s->frame = (uint64_t)m.value[SYNC_FRAME];
            if (m.kind == WIRE_REPLY && m.value[REPLY_CAUSE] < CAUSES)
                s->cause[(int)m.value[REPLY_CAUSE]]++;
            if (!is_timing(&m)) {
                mix(&s->traffic, &f.id, sizeof f.id);
                mix(&s->traffic, f.data, f.length);
            }
        }
        got = s->bench->recv(s->bench->context, &f);
    }
}

/* ---- the app's end ---- */

static int take(void *context, struct frame *f)
{
    struct can_session *s = context;
    return s->plant->recv(s->plant->context, f);
}

static int give(void *context, const struct frame *f)
{
    struct can_session *s = context;
    int taken = s->plant->send(s->plant->context, f);
    hear(s);
    return taken;
}

static void flush(void *context)
{
    struct can_session *s = context;
    s->plant->flush(s->plant->context);
    hear(s);
}

static uint32_t now_us(void *context)
{
    struct can_session *s = context;
    return s->plant->now_us(s->plant->context);
}

static void healthy(void *context)
{
    (void)context;
}

/* ---- run and report ---- */

const char *can_session_run(struct can_session *s, const struct hal *plant, const struct hal *bench)
{
    const struct app_config c = {.model = &hertz_rig,
                                 .method = &rk4,
                                 .frame_s = FRAME_S,
                                 .substeps = SUBSTEPS,
                                 .dilation = 1.0,
                                 .base_id = BASE_ID};
    memset(s, 0, sizeof *s);
    s->plant = plant;
    s->bench = bench;
    s->wire = (struct hal){s, take, give, flush, now_us, healthy};
    s->session = 1;
    s->traffic = UINT64_C(0xCBF29CE484222325);
    const char *why = app_init(&s->app, &c, &s->wire);
    s->scene = s->app.scene;
    for (uint64_t i = 0; !why && i < FRAMES; i++) {
        speak(s, i);
        app_frame(&s->app);
    }
    return why;
}

static const char *const cause_text[] = {
    "replies ok",    "replies range", "replies late",       "replies stale",   "replies session",
    "replies state", "replies full",  "replies incomplete", "replies unknown", "replies self-test"};
STATIC_ASSERT(sizeof cause_text / sizeof *cause_text == CAUSES, a_text_for_every_cause);

void can_session_report(const struct can_session *s,
                        void (*line)(const char *what, uint64_t value, int digits))
{
    line("motion", s->heard[WIRE_MOTION], 0);
    line("contact events", s->heard[WIRE_EVENT_TIME], 0);
    line("hashes", s->heard[WIRE_HASH], 0);
    for (int i = 0; i < CAUSES; i++)
        line(cause_text[i], s->cause[i], 0);
    line("undecodable", s->bad, 0);
    line("unsent", s->unsent, 0);
    line("bus faults", s->faults, 0);
    line("wrong CRC", s->app.count[DIAG_CRC], 0);
    line("wrong length", s->app.count[DIAG_LENGTH], 0);
    line("no command", s->app.count[DIAG_UNKNOWN_ID], 0);
    line("repeated", s->app.count[DIAG_REPEATED], 0);
    line("time-outs", s->app.count[DIAG_TIMEOUTS], 0);
    line("state", s->app.state, 0);
    line("tick", s->app.plant.now.tick, 0);
    line("state hash", plant_hash(&s->app.plant), 16);
    line("traffic hash", s->traffic, 16);
}
