/* bus.c - see bus.h. */
#include "tests/bus.h"

#include <math.h>
#include <string.h>
#include "tests/test.h"

enum { PLANT, CONTROLLER, PORTS };

struct app_config bus_config(void)
{
    return (struct app_config){.model = &hertz_rig,
                               .method = &rk4,
                               .frame_s = 1e-3,
                               .substeps = 16,
                               .dilation = 1.0,
                               .base_id = 0x200};
}

void bus_start(struct bus *b, const struct app_config *c)
{
    struct app_config config = *c;
    memset(b, 0, sizeof *b);
    config.capture = b->capture;
    config.n_capture = BUS_CAPTURE;
    loopback_init(&b->wires, PORTS, LOOPBACK_RING);
    const char *why = app_init(&b->app, &config, &b->wires.port[PLANT].hal);
    if (why)
        check_string("app_init", why, "no refusal");
    b->scene = b->app.scene;
    b->session = 1;
}

void bus_start_running(struct bus *b, const struct app_config *c)
{
    bus_start(b, c);
    bus_run(b, 1);
    bus_order(b, CONTROL_START);
}

void bus_next_session(struct bus *b)
{
    b->session = (uint8_t)(b->app.session % WIRE_SESSIONS + 1);
    memset(b->counter, 0, sizeof b->counter);
}

void bus_put(struct bus *b, const struct frame *f)
{
    const struct hal *hal = &b->wires.port[CONTROLLER].hal;
    if (hal->send(hal->context, f) != 1)
        check_true("the bus takes the command", 0);
}

void bus_encode(struct bus *b, unsigned kind, const double value[WIRE_FIELDS], struct frame *f)
{
    struct message m = {.kind = (uint8_t)kind, .counter = b->counter[kind]};
    memcpy(m.value, value, sizeof m.value);
    m.value[SESSION] = b->session;
    b->counter[kind] = (uint8_t)((m.counter + 1) % WIRE_COUNTER_STATES);
    wire_encode(&b->scene, &m, f);
}

void bus_command(struct bus *b, unsigned kind, const double value[WIRE_FIELDS])
{
    struct frame f;
    bus_encode(b, kind, value, &f);
    bus_put(b, &f);
}

void bus_enable(struct bus *b, bool on)
{
    bus_command(b, WIRE_ENABLE, (double[WIRE_FIELDS]){0, on, (double)(uint32_t)b->app.frame});
}

void bus_control(struct bus *b, enum control_operation operation, double argument)
{
    bus_command(b, WIRE_CONTROL, (double[WIRE_FIELDS]){0, operation, 255 - (int)operation, argument});
}

void bus_order(struct bus *b, enum control_operation operation)
{
    bus_control(b, operation, (double)(uint32_t)b->app.frame);
}

void bus_arm(struct bus *b, int channel, enum arm_field field, double value)
{
    bus_command(b, WIRE_ARM + (unsigned)channel, (double[WIRE_FIELDS]){0, field, value});
}

void bus_drive(struct bus *b, int channel, double amplitude, double frequency_Hz, double phase_rad,
               double ramp_s)
{
    bus_arm(b, channel, ARM_AMPLITUDE, amplitude);
    bus_arm(b, channel, ARM_FREQUENCY, frequency_Hz);
    bus_arm(b, channel, ARM_PHASE, phase_rad);
    bus_arm(b, channel, ARM_RAMP, ramp_s);
}

void bus_fire(struct bus *b, unsigned channels, bool parameters, uint64_t tick, unsigned fraction_256)
{
    bus_command(b, WIRE_FIRE,
                (double[WIRE_FIELDS]){0, channels, parameters, fraction_256 / 256.0, (double)(uint32_t)tick});
}

void bus_stream(struct bus *b, int channel, uint64_t frame, double value)
{
    bus_command(b, WIRE_STREAM + (unsigned)channel, (double[WIRE_FIELDS]){0, (double)(uint16_t)frame, value});
}

void bus_write(struct bus *b, unsigned index, double value)
{
    bus_command(b, WIRE_PARAM_WRITE, (double[WIRE_FIELDS]){0, index, value});
}

void bus_commit(struct bus *b, const struct staged *set, enum commit_when when)
{
    bus_command(b, WIRE_PARAM_COMMIT, (double[WIRE_FIELDS]){0, staged_count(set), when, staged_crc(set)});
}

void bus_set(struct bus *b, unsigned index, double value)
{
    struct staged set = {{0}, {0}};
    staged_put(&set, index, value);
    bus_write(b, index, value);
    bus_commit(b, &set, COMMIT_NOW);
}

void bus_run(struct bus *b, int n)
{
    for (int i = 0; i < n; i++) {
        bus_enable(b, true);
        bus_silent(b, 1);
    }
}

void bus_silent(struct bus *b, int n)
{
    for (int i = 0; i < n; i++) {
        app_frame(&b->app);
        bus_collect(b);
    }
}

void bus_collect(struct bus *b)
{
    const struct hal *hal = &b->wires.port[CONTROLLER].hal;
    struct frame f;
    while (hal->recv(hal->context, &f) == 1) {
        if (b->n_seen == BUS_SEEN)
            check_true("the test forgets what it has seen in time", 0), b->n_seen = 0;
        if (wire_decode(&b->scene, &f, &b->seen[b->n_seen]) == WIRE_OK)
            b->n_seen++;
    }
}

void bus_forget(struct bus *b)
{
    b->n_seen = 0;
}

const struct message *bus_last(const struct bus *b, unsigned kind)
{
    for (int i = b->n_seen; i > 0; i--) {
        if (b->seen[i - 1].kind == kind)
            return &b->seen[i - 1];
    }
    return NULL;
}

int bus_count(const struct bus *b, unsigned kind)
{
    int n = 0;
    for (int i = 0; i < b->n_seen; i++)
        n += b->seen[i].kind == kind;
    return n;
}

double bus_value(const struct bus *b, unsigned kind, int field)
{
    const struct message *m = bus_last(b, kind);
    return m ? m->value[field] : (double)NAN;
}

int bus_cause(const struct bus *b, unsigned kind)
{
    for (int i = b->n_seen; i > 0; i--) {
        const struct message *m = &b->seen[i - 1];
        if (m->kind == WIRE_REPLY && m->value[REPLY_MESSAGE] == kind)
            return (int)m->value[REPLY_CAUSE];
    }
    return -1;
}

double bus_item(const struct bus *b, unsigned kind, unsigned item)
{
    for (int i = b->n_seen; i > 0; i--) {
        const struct message *m = &b->seen[i - 1];
        if (m->kind == kind && m->value[0] == item)
            return m->value[1];
    }
    return (double)NAN;
}

void check_bits(const char *name, double got, double expected)
{
    uint64_t a, b;
    memcpy(&a, &got, sizeof a);
    memcpy(&b, &expected, sizeof b);
    check_hex(name, a, b);
}
