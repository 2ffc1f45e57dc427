/* telemetry.c - see telemetry.h. Round robins keep each slow message at one frame per turn. */
#include "firmware/app/telemetry.h"

#include <string.h>
#include "firmware/app/account.h"
#include "firmware/app/app.h"
#include "firmware/app/telemetry_send.h"
#include "firmware/bus/identity.h"
#include "firmware/plant/plant_report.h"
#include "models/math/elementary.h"

enum {
    ECHO_FIELDS = ARM_FIELDS,
    ECHOES_PER_FRAME = 4,
    IDENTITY_EVERY = 100 /* frames, whatever the settings: a listener waits no longer for it */
};

/* Sends a message with these fields; further ones are 0. Not inlined: that would make eleven copies. */
NEVER_INLINE void send_values(struct telemetry *t, const struct app *a, unsigned kind, double first,
                              double second, double third)
{
    struct message m = {.kind = (uint8_t)kind, .value = {first, second, third}};
    telemetry_send(t, a, &m);
}

/* True when one of the last n numbers up to `frame` is a multiple of `every`; never for 0. */
static bool falls(uint64_t frame, uint64_t n, uint64_t every)
{
    return every > 0 && frame % every < n;
}

/* True once every `setting` bus frames, also where the plant had no turn in some. */
static bool due(const struct app *a, int setting)
{
    return falls(a->frame, UINT64_C(1) + a->jump, (uint64_t)a->setting[setting]);
}

/* ---- messages ---- */

/* The contents of STATUS in one word: a change goes out at once. */
static uint32_t status_word(const struct app *a)
{
    return (uint32_t)a->session | (uint32_t)a->state << 8 | (uint32_t)a->reaction << 16 |
           (uint32_t)a->watch.tripped << 23 | (uint32_t)a->faults << 24;
}

static void send_status(struct telemetry *t, const struct app *a)
{
    struct message m = {.kind = WIRE_STATUS};
    m.value[SESSION] = a->session;
    m.value[STATUS_STATE] = a->state;
    m.value[STATUS_REACTION] = a->reaction;
    m.value[STATUS_WATCH] = a->watch.tripped;
    m.value[STATUS_FAULTS] = a->faults;
    m.value[STATUS_FRAME] = (double)(uint32_t)a->frame;
    telemetry_send(t, a, &m);
    t->status_sent = status_word(a);
}

static void send_sync(struct telemetry *t, const struct app *a)
{
    send_values(t, a, WIRE_SYNC, (double)(uint16_t)a->frame, (double)(uint32_t)a->plant.now.tick, 0.0);
}

/* Sends the sampled command of each input, as it is at the end of the plant frame that has passed. */
static void send_samples(struct telemetry *t, const struct app *a)
{
    const struct plant *pl = &a->plant;
    double frame = (double)(uint16_t)(a->sensor.frame - 1);
    for (int i = 0; i < pl->model->n_inputs; i++) {
        double unit = scale_of(&pl->scale, pl->model->input_signal[i].quantity);
        send_values(t, a, WIRE_STREAM_ECHO + (unsigned)i, frame, pl->drive[i].sample * unit, 0.0);
    }
}

/* MOTION, CONTACT and STREAM_ECHO as they are due, and before them the SYNC that dates them. */
static void send_motion(struct telemetry *t, const struct app *a, uint32_t advanced)
{
    bool motion = falls(a->sensor.frame, advanced, (uint64_t)a->setting[SET_MOTION_EVERY]);
    bool contact = falls(a->sensor.frame, advanced, (uint64_t)a->setting[SET_CONTACT_EVERY]);
    bool samples = falls(a->sensor.frame, advanced, (uint64_t)a->setting[SET_STREAM_ECHO_EVERY]);
    if (motion || contact || samples || due(a, SET_SYNC_EVERY) || (advanced > 0 && a->state == STATE_PAUSED))
        send_sync(t, a);
    for (int pair = 0; pair < 2; pair++) {
        struct message m = {.kind = (uint8_t)(WIRE_MOTION + pair)};
        if (!(pair == 0 ? motion : contact))
            continue;
        m.value[MOTION_IN_CONTACT] = a->plant.regime;
        m.value[MOTION_DISPLACEMENT] = sensor_read(&a->sensor, a->setting, 2 * pair, &t->said[2 * pair]);
        m.value[MOTION_VELOCITY] = sensor_read(&a->sensor, a->setting, 2 * pair + 1, &t->said[2 * pair + 1]);
        telemetry_send(t, a, &m);
    }
    if (samples)
        send_samples(t, a);
}

/* The codes that the ADCs read in the last frame, while blocks of codes come for the DACs. */
static void send_codes(struct telemetry *t, const struct app *a)
{
    uint64_t first = a->plant.now.tick - a->config.substeps;
    for (uint32_t i = 0; i < a->config.substeps; i++) {
        const int16_t *code = a->mailbox.block.code[i];
        send_values(t, a, WIRE_ADC, (double)(uint16_t)(first + i), code[0], code[1]);
    }
}

static void send_event(struct telemetry *t, const struct app *a, const struct event *e)
{
    struct message time = {.kind = WIRE_EVENT_TIME}, data = {.kind = WIRE_EVENT_DATA};
    uint32_t fraction = (uint32_t)(e->fraction * TICK_FRACTIONS + 0.5);
    uint64_t tick = e->tick + fraction / TICK_FRACTIONS;
    time.value[EVENT_TOUCH] = data.value[EVENT_TOUCH] = e->touch;
    time.value[EVENT_CONTACT] = data.value[EVENT_CONTACT] = e->contact;
    time.value[EVENT_TIME_FRACTION] = (double)(fraction % TICK_FRACTIONS) / TICK_FRACTIONS;
    time.value[EVENT_TIME_TICK] = (double)(uint32_t)tick;
    data.value[EVENT_DATA_SPEED] = e->speed;
    data.value[EVENT_DATA_PEAK_FORCE] = e->peak_force;
    telemetry_send(t, a, &time);
    telemetry_send(t, a, &data);
}

/* Contact events of this frame: the first few as they are, the others counted. */
static void send_events(struct telemetry *t, const struct app *a)
{
    const struct plant *pl = &a->plant;
    uint32_t left = (uint32_t)a->setting[SET_EVENTS_PER_FRAME];
    for (uint32_t i = 0; i < pl->n_event; i++) {
        const struct event *e = &pl->event[(pl->event_head + i) % PLANT_EVENTS];
        t->touchdowns += e->touch;
        if (left > 0)
            send_event(t, a, e);
        else
            t->not_sent++;
        left -= left > 0;
    }
}

static void send_watch(struct telemetry *t, const struct app *a)
{
    struct message m = {.kind = WIRE_WATCH};
    m.value[WATCH_OBSERVABLE] = a->watch.limits.observable;
    m.value[WATCH_TICK] = (double)(uint16_t)a->watch.tick;
    m.value[WATCH_VALUE] = a->watch.value;
    telemetry_send(t, a, &m);
    t->watch_sent = a->watch.number;
}

/* While an earlier one waits to be sent the counts go on, so that none is lost with it. */
static void send_summary(struct telemetry *t, const struct app *a)
{
    struct message m = {.kind = WIRE_EVENT_SUMMARY};
    if (telemetry_waits(t, a, WIRE_EVENT_SUMMARY))
        return;
    m.value[SUMMARY_TOUCHDOWNS] = t->touchdowns;
    m.value[SUMMARY_LOSS] = t->total_s > 0.0 ? t->loss_s / t->total_s : 0.0;
    m.value[SUMMARY_NOT_SENT] = t->not_sent;
    telemetry_send(t, a, &m);
    t->touchdowns = t->not_sent = 0;
    t->loss_s = t->total_s = 0.0;
}

/* Sends finished windows until one has to wait: on a full bus slots must not replace each other's frame. */
static void send_lockin(struct telemetry *t, const struct app *a)
{
    for (int i = 0; i < LOCKIN_SLOTS && !telemetry_waits(t, a, WIRE_LOCKIN); i++) {
        const struct lockin_result *r = &a->lockin.slot[i].result;
        if (r->number != t->lockin_sent[i])
            send_values(t, a, WIRE_LOCKIN, i, r->amplitude, r->phase);
        t->lockin_sent[i] = r->number;
    }
}

static void send_ledger(struct telemetry *t, const struct app *a)
{
    const struct plant *pl = &a->plant;
    uint32_t item = t->ledger_next;
    double value;
    if (item == LEDGER_STORED)
        value = plant_energy(pl);
    else if (item == LEDGER_RESIDUAL)
        value = plant_residual(pl);
    else if (item == LEDGER_DAMPING)
        value = sum_of(&pl->ledger.damping) * pl->scale.energy_J;
    else if (item == LEDGER_CHANGE)
        value = sum_of(&pl->ledger.change) * pl->scale.energy_J;
    else
        value = sum_of(&pl->ledger.work[item - LEDGER_WORK]) * pl->scale.energy_J;
    send_values(t, a, WIRE_LEDGER, item, value, 0.0);
    t->ledger_next = (item + 1) % (uint32_t)(LEDGER_WORK + pl->model->n_inputs);
}

static void send_health(struct telemetry *t, const struct app *a)
{
    uint32_t item = t->health_next, count[DIAG_COUNTERS];
    account_counts(a, count);
    send_values(t, a, WIRE_HEALTH, item, count[item], 0.0);
    t->health_next = (item + 1) % DIAG_COUNTERS;
}

static double info_value(const struct app *a, uint32_t item)
{
    const struct plant *pl = &a->plant;
    double value, f0_bus_Hz = pl->model->eigenfrequency(pl->p) / (2.0 * ELEMENTARY_PI * pl->scale.time_s);
    if (identity_item(&a->scene, item, &value))
        return value;
    if (item == INFO_PROMOTED)
        return pl->model != a->config.model;
    return item == INFO_F0_REAL_HZ ? f0_bus_Hz * pl->dilation : f0_bus_Hz;
}

/* Sends one item a frame, IDENTITY first, and none while one waits. It comes behind SYNC, with which a
 * frame's report begins. */
static void send_info(struct telemetry *t, const struct app *a)
{
    if (falls(a->frame, UINT64_C(1) + a->jump, IDENTITY_EVERY))
        t->info_pending |= 1u << INFO_IDENTITY;
    if (!t->info_pending || telemetry_waits(t, a, WIRE_INFO))
        return;
    uint32_t item = 0;
    while (!((t->info_pending >> item) & 1u))
        item++;
    if ((t->info_pending >> INFO_IDENTITY) & 1u)
        item = INFO_IDENTITY;
    t->info_pending &= ~(1u << item);
    send_values(t, a, WIRE_INFO, item, info_value(a, item), 0.0);
}

/* Sends the settings of each drive, then the items of INFO, one field a turn. */
static void send_echo(struct telemetry *t, const struct app *a)
{
    const struct plant *pl = &a->plant;
    uint32_t n_drive = (uint32_t)pl->model->n_inputs * ECHO_FIELDS, item = t->echo_next;
    t->echo_next = (item + 1) % (n_drive + INFO_ITEMS);
    if (item >= n_drive) {
        t->info_pending |= 1u << (item - n_drive); /* with the next frame */
        return;
    }
    int channel = (int)(item / ECHO_FIELDS);
    const struct drive *d = &pl->drive[channel];
    struct drive_setting s = drive_target(d);
    struct noise_setting n = noise_target(&d->noise);
    double unit = scale_of(&pl->scale, pl->model->input_signal[channel].quantity);
    const double value[ECHO_FIELDS] = {
        [ARM_AMPLITUDE] = s.amplitude * unit,
        [ARM_FREQUENCY] = s.turns_per_tick / pl->tick_s,
        [ARM_PHASE] = s.phase_turns * 2.0 * ELEMENTARY_PI,
        [ARM_RAMP] = (double)d->ramp_left / TICK_FRACTIONS * pl->tick_s,
        [ARM_NOISE] = n.deviation * unit,
        [ARM_NOISE_HOLD] = n.hold,
        [ARM_NOISE_SEED] = n.seed,
    };
    send_values(t, a, WIRE_DRIVE_ECHO, channel, item % ECHO_FIELDS, value[item % ECHO_FIELDS]);
}

/* Sends parameters that were written or asked for, in order of their index. */
static void send_parameters(struct telemetry *t, const struct app *a)
{
    int left = ECHOES_PER_FRAME;
    for (unsigned i = 0; i < SETTING_FIRST + SETTINGS && left > 0; i++) {
        uint32_t bit = 1u << (i % 32), *pending = &t->echo_pending[i / 32];
        if (*pending < bit)
            i |= 31; /* none further on in this word */
        if (!(*pending & bit))
            continue;
        if (telemetry_waits(t, a, WIRE_PARAM_ECHO))
            return;
        *pending &= ~bit;
        double value = i < SETTING_FIRST ? a->plant.si[i] : a->setting[i - SETTING_FIRST];
        send_values(t, a, WIRE_PARAM_ECHO, i, value, 0.0);
        left--;
    }
}

/* Sends one check a frame, in their order, and none while one waits. */
static void send_selftest(struct telemetry *t, const struct app *a)
{
    unsigned i = 0;
    if (!t->selftest_pending || telemetry_waits(t, a, WIRE_SELF_TEST))
        return;
    while (!((t->selftest_pending >> i) & 1u))
        i++;
    unsigned ran = (a->selftest.present >> i) & 1u, failed = (a->selftest.failed >> i) & 1u;
    unsigned verdict = !ran ? SELF_TEST_ABSENT : failed ? SELF_TEST_FAILED : SELF_TEST_PASSED;
    send_values(t, a, WIRE_SELF_TEST, i, verdict, (double)a->selftest.error[i]);
    t->selftest_pending &= (uint16_t) ~(1u << i);
}

static void send_capture(struct telemetry *t, const struct app *a)
{
    uint32_t signal, sample;
    float value;
    for (int i = 0; i < (int)a->setting[SET_CAPTURE_PER_FRAME]; i++) {
        if (telemetry_waits(t, a, WIRE_CAPTURE_DATA) ||
            !capture_next(&a->capture, &t->reading, a->config.capture, &signal, &sample, &value))
            return;
        send_values(t, a, WIRE_CAPTURE_DATA, signal, sample, (double)value);
    }
}

static void send_latency(struct telemetry *t, const struct app *a)
{
    const struct latency *l = &a->latency;
    struct message m = {.kind = WIRE_LATENCY};
    m.value[LATENCY_MESSAGE] = l->kind;
    m.value[LATENCY_COUNTER] = l->counter;
    m.value[LATENCY_APPLY] = (double)(l->applied_tick - l->received_tick);
    m.value[LATENCY_SEND] = (double)(a->plant.now.tick - l->applied_tick);
    telemetry_send(t, a, &m);
    t->latency_sent = l->number;
}

static void send_hash(struct telemetry *t, const struct app *a)
{
    /* 48 of 64 bits fit beside counter and CRC. */
    send_values(t, a, WIRE_HASH, (double)(plant_hash(&a->plant) & 0xFFFFFFFFFFFFu), 0.0, 0.0);
}

/* Sends every item of INFO again, one per frame, IDENTITY first. */
static void tell_info(struct telemetry *t)
{
    t->info_pending = (1u << INFO_ITEMS) - 1u;
}

void telemetry_init(struct telemetry *t)
{
    memset(t, 0, sizeof *t);
    memset(t->said, 0xFF, sizeof t->said); /* a double whose bits are all one is a NaN */
    tell_info(t);
}

void telemetry_tell_selftest(struct telemetry *t, const struct app *a)
{
    t->selftest_pending = a->selftest.present ? (1u << SELFTEST_CHECKS) - 1u : 0;
}

void telemetry_greet(struct telemetry *t, const struct app *a)
{
    telemetry_tell_selftest(t, a);
    tell_info(t);
    t->watch_sent = a->watch.number - 1;
}

void telemetry_report(struct telemetry *t, const struct app *a, uint32_t advanced)
{
    t->loss_s += a->plant.loss_time * a->plant.scale.time_s;
    t->total_s += a->plant.total_time * a->plant.scale.time_s;
    telemetry_send_kept(t, a);
    send_motion(t, a, advanced);
    if (a->streaming >= APP_STREAMING_CODES && advanced > 0)
        send_codes(t, a);
    send_info(t, a);
    send_events(t, a);
    if (a->watch.tripped && a->watch.number != t->watch_sent)
        send_watch(t, a);
    send_lockin(t, a);
    if (a->latency.number != t->latency_sent && (a->latency.kind == WIRE_FIRE || due(a, SET_ECHO_EVERY)))
        send_latency(t, a);
    if (due(a, SET_LEDGER_EVERY))
        send_ledger(t, a);
    if (due(a, SET_HEALTH_EVERY))
        send_health(t, a);
    if (due(a, SET_ECHO_EVERY))
        send_echo(t, a);
    if (due(a, SET_SUMMARY_EVERY))
        send_summary(t, a);
    if (due(a, SET_HASH_EVERY))
        send_hash(t, a);
    send_selftest(t, a);
    send_parameters(t, a);
    send_capture(t, a);
    /* last, so that what happened in this frame is in it */
    if (due(a, SET_STATUS_EVERY) || t->status_sent != status_word(a))
        send_status(t, a);
}
