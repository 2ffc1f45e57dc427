/* telemetry.c - see telemetry.h. Round robins keep each slow message at one frame per turn. */
#include "firmware/telemetry.h"

#include <math.h>
#include "firmware/app.h"
#include "firmware/identity.h"
#include "firmware/session.h"
#include "models/elementary.h"

enum {
    ECHO_FIELDS = ARM_FIELDS,
    ECHOES_PER_FRAME = 4,
    BALANCE_FRAMES = 100, /* plant frames from one look at the balance to the next */
    IDENTITY_EVERY = 100  /* frames, whatever the settings say: who only listens waits no longer for it */
};

/* Energies below this fraction of the model's unit are too small to raise an alarm. */
#define BALANCE_FLOOR 1e-4

/* A message whose fields are these, and further ones 0. Out of line: inlined it would be there eleven times. */
NEVER_INLINE void send_values(struct app *a, unsigned kind, double first, double second, double third)
{
    struct message m = {.kind = (uint8_t)kind, .value = {first, second, third}};
    telemetry_send(a, &m);
}

/* A multiple of `every` is among the last n numbers up to `frame`; never for 0. */
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

/* What STATUS says, in one word: a change goes out at once. */
static uint32_t status_word(const struct app *a)
{
    return (uint32_t)a->session | (uint32_t)a->state << 8 | (uint32_t)a->reaction << 16 |
           (uint32_t)a->watch.tripped << 23 | (uint32_t)a->faults << 24;
}

static void send_status(struct app *a)
{
    struct message m = {.kind = WIRE_STATUS};
    m.value[SESSION] = a->session;
    m.value[STATUS_STATE] = a->state;
    m.value[STATUS_REACTION] = a->reaction;
    m.value[STATUS_WATCH] = a->watch.tripped;
    m.value[STATUS_FAULTS] = a->faults;
    m.value[STATUS_FRAME] = (double)(uint32_t)a->frame;
    telemetry_send(a, &m);
    a->status_sent = status_word(a);
}

static void send_sync(struct app *a)
{
    send_values(a, WIRE_SYNC, (double)(uint16_t)a->frame, (double)(uint32_t)a->plant.now.tick, 0.0);
}

/* MOTION and CONTACT as they are due, and before them the SYNC that dates them. */
static void send_motion(struct app *a, uint32_t advanced)
{
    bool motion = falls(a->sensor.frame, advanced, (uint64_t)a->setting[SET_MOTION_EVERY]);
    bool contact = falls(a->sensor.frame, advanced, (uint64_t)a->setting[SET_CONTACT_EVERY]);
    if (motion || contact || due(a, SET_SYNC_EVERY) || (advanced > 0 && a->state == STATE_PAUSED))
        send_sync(a);
    for (int pair = 0; pair < 2; pair++) {
        struct message m = {.kind = (uint8_t)(WIRE_MOTION + pair)};
        if (!(pair == 0 ? motion : contact))
            continue;
        m.value[MOTION_IN_CONTACT] = a->plant.regime;
        m.value[MOTION_DISPLACEMENT] = sensor_read(&a->sensor, a->setting, 2 * pair);
        m.value[MOTION_VELOCITY] = sensor_read(&a->sensor, a->setting, 2 * pair + 1);
        telemetry_send(a, &m);
    }
}

static void send_event(struct app *a, const struct event *e)
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
    telemetry_send(a, &time);
    telemetry_send(a, &data);
}

/* Contact events: the first few of a frame as they are, the others counted. */
static void send_events(struct app *a)
{
    uint32_t left = (uint32_t)a->setting[SET_EVENTS_PER_FRAME];
    struct event e;
    for (int i = 0; i < PLANT_EVENTS && plant_take_event(&a->plant, &e); i++) {
        a->touchdowns += e.touch;
        if (left > 0)
            send_event(a, &e);
        else
            a->not_sent++;
        left -= left > 0;
    }
}

static void send_watch(struct app *a)
{
    struct message m = {.kind = WIRE_WATCH};
    m.value[WATCH_OBSERVABLE] = a->watch.limits.observable;
    m.value[WATCH_TICK] = (double)(uint16_t)a->watch.tick;
    m.value[WATCH_VALUE] = a->watch.value;
    telemetry_send(a, &m);
    a->watch.pending = false;
}

/* The energy above rest: what swings to and fro in the plant even when nothing flows in or out. */
static double swing(const struct plant *pl)
{
    struct input still[MODEL_INPUTS] = {{0.0, 0.0}};
    double x[MODEL_STATES];
    pl->model->rest(pl->p, x);
    return pl->model->energy(pl->p, pl->excitation.at[2], pl->x) - pl->model->energy(pl->p, still, x);
}

/* The ledger's alarm: what did not balance since the last time, against all that flowed and swings. Whatever is sent. */
static void check_balance(struct app *a)
{
    struct plant *pl = &a->plant;
    double residual_J = plant_residual(pl);
    double moved_J = (pl->ledger.gross + fabs(swing(pl)) + BALANCE_FLOOR) * pl->scale.energy_J;
    if (!(fabs(residual_J - a->balance_residual_J) <= a->setting[SET_LEDGER_ALARM] * moved_J))
        session_fault(a, FAULT_LEDGER);
    a->balance_residual_J = residual_J;
    pl->ledger.gross = 0.0;
}

/* As long as one waits, it goes on collecting: nothing that was counted may be lost with it. */
static void send_summary(struct app *a)
{
    struct plant *pl = &a->plant;
    struct message m = {.kind = WIRE_EVENT_SUMMARY};
    if (telemetry_waits(a, WIRE_EVENT_SUMMARY))
        return;
    m.value[SUMMARY_TOUCHDOWNS] = a->touchdowns;
    m.value[SUMMARY_LOSS] = pl->total_time > 0.0 ? pl->loss_time / pl->total_time : 0.0;
    m.value[SUMMARY_NOT_SENT] = a->not_sent;
    telemetry_send(a, &m);
    a->touchdowns = 0;
    a->not_sent = 0;
    pl->loss_time = 0.0;
    pl->total_time = 0.0;
}

/* Finished windows, as long as none has to wait: slots must not push each other out when the bus is full. */
static void send_lockin(struct app *a)
{
    for (int i = 0; i < LOCKIN_SLOTS && !telemetry_waits(a, WIRE_LOCKIN); i++) {
        struct lockin_result *r = &a->lockin_result[i];
        if (r->pending)
            send_values(a, WIRE_LOCKIN, i, r->amplitude, r->phase);
        r->pending = false;
    }
}

static void send_ledger(struct app *a)
{
    const struct plant *pl = &a->plant;
    uint32_t item = a->ledger_next;
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
    send_values(a, WIRE_LEDGER, item, value, 0.0);
    a->ledger_next = (item + 1) % (uint32_t)(LEDGER_WORK + pl->model->n_inputs);
}

void app_gather_counts(struct app *a)
{
    const struct plant_counts *p = &a->plant.counts;
    a->count[DIAG_SWITCHES] = p->switches;
    a->count[DIAG_SWITCH_BUDGET] = p->budget;
    a->count[DIAG_METHOD_BUDGET] = p->work;
    a->count[DIAG_SWITCH_RESIDUAL] = p->residual;
    a->count[DIAG_EVENTS_LOST] = p->events_lost;
    a->count[DIAG_NOT_FINITE] = p->not_finite;
    a->count[DIAG_PIECES_MAX] = p->pieces_max;
    a->count[DIAG_COMMAND_AGE_FRAMES] = (uint32_t)session_command_age(a);
    a->count[DIAG_COMPUTE_MAX_US] = a->timing.compute.max_us;
    a->count[DIAG_COMPUTE_MAX_FRAME] = (uint32_t)a->timing.compute.max_frame;
    a->count[DIAG_CAPTURE_STATE] = a->capture.state;
    a->count[DIAG_CAPTURE_PRETRIGGER] = a->capture.pretrigger;
    a->count[DIAG_CAPTURE_TICK] = (uint32_t)a->capture.trigger_tick;
    a->count[DIAG_LATENESS_MAX_US] = a->timing.lateness.max_us;
    a->count[DIAG_SENSOR_FAULTS] = a->sensor.active;
    a->count[DIAG_LATENESS_MAX_FRAME] = (uint32_t)a->timing.lateness.max_frame;
}

static void send_health(struct app *a)
{
    uint32_t item = a->health_next;
    app_gather_counts(a);
    send_values(a, WIRE_HEALTH, item, a->count[item], 0.0);
    a->health_next = (item + 1) % DIAG_COUNTERS;
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

/* One item a frame, IDENTITY first; none pushes out one that waits. Behind SYNC, with which a frame's report begins. */
static void send_info(struct app *a)
{
    if (falls(a->frame, UINT64_C(1) + a->jump, IDENTITY_EVERY))
        a->info_pending |= 1u << INFO_IDENTITY;
    if (!a->info_pending || telemetry_waits(a, WIRE_INFO))
        return;
    uint32_t item = 0;
    while (!((a->info_pending >> item) & 1u))
        item++;
    if ((a->info_pending >> INFO_IDENTITY) & 1u)
        item = INFO_IDENTITY;
    a->info_pending &= ~(1u << item);
    send_values(a, WIRE_INFO, item, info_value(a, item), 0.0);
}

/* What each drive is set to, then what the rig is, one field a turn. */
static void send_echo(struct app *a)
{
    const struct plant *pl = &a->plant;
    uint32_t n_drive = (uint32_t)pl->model->n_inputs * ECHO_FIELDS, item = a->echo_next;
    a->echo_next = (item + 1) % (n_drive + INFO_ITEMS);
    if (item >= n_drive) {
        a->info_pending |= 1u << (item - n_drive); /* with the next frame */
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
    send_values(a, WIRE_DRIVE_ECHO, channel, item % ECHO_FIELDS, value[item % ECHO_FIELDS]);
}

/* Parameters that were written or asked for, in order of their index. */
static void send_parameters(struct app *a)
{
    int left = ECHOES_PER_FRAME;
    for (unsigned i = 0; i < SETTING_FIRST + SETTINGS && left > 0; i++) {
        uint32_t bit = 1u << (i % 32), *pending = &a->echo_pending[i / 32];
        if (*pending < bit)
            i |= 31; /* none further on in this word */
        if (!(*pending & bit))
            continue;
        if (telemetry_waits(a, WIRE_PARAM_ECHO))
            return;
        *pending &= ~bit;
        double value = i < SETTING_FIRST ? a->plant.si[i] : a->setting[i - SETTING_FIRST];
        send_values(a, WIRE_PARAM_ECHO, i, value, 0.0);
        left--;
    }
}

/* One check a frame, in their order, as long as none has to wait. */
static void send_selftest(struct app *a)
{
    unsigned i = 0;
    if (!a->selftest_pending || telemetry_waits(a, WIRE_SELF_TEST))
        return;
    while (!((a->selftest_pending >> i) & 1u))
        i++;
    unsigned ran = (a->selftest.present >> i) & 1u, failed = (a->selftest.failed >> i) & 1u;
    unsigned verdict = !ran ? SELF_TEST_ABSENT : failed ? SELF_TEST_FAILED : SELF_TEST_PASSED;
    send_values(a, WIRE_SELF_TEST, i, verdict, (double)a->selftest.error[i]);
    a->selftest_pending &= (uint16_t) ~(1u << i);
}

static void send_capture(struct app *a)
{
    uint32_t signal, sample;
    float value;
    for (int i = 0; i < (int)a->setting[SET_CAPTURE_PER_FRAME]; i++) {
        if (telemetry_waits(a, WIRE_CAPTURE_DATA) ||
            !capture_next(&a->capture, a->config.capture, &signal, &sample, &value))
            return;
        send_values(a, WIRE_CAPTURE_DATA, signal, sample, (double)value);
    }
}

static void send_latency(struct app *a)
{
    const struct latency *l = &a->latency;
    struct message m = {.kind = WIRE_LATENCY};
    m.value[LATENCY_MESSAGE] = l->kind;
    m.value[LATENCY_COUNTER] = l->counter;
    m.value[LATENCY_APPLY] = (double)(l->applied_tick - l->received_tick);
    m.value[LATENCY_SEND] = (double)(a->plant.now.tick - l->applied_tick);
    telemetry_send(a, &m);
    a->latency.pending = false;
}

static void send_hash(struct app *a)
{
    /* 48 of 64 bits fit beside counter and CRC. */
    send_values(a, WIRE_HASH, (double)(plant_hash(&a->plant) & 0xFFFFFFFFFFFFu), 0.0, 0.0);
}

void telemetry_tell_selftest(struct app *a)
{
    a->selftest_pending = a->selftest.present ? (1u << SELFTEST_CHECKS) - 1u : 0;
}

void telemetry_tell_info(struct app *a)
{
    a->info_pending = (1u << INFO_ITEMS) - 1u;
}

void telemetry_report(struct app *a, uint32_t advanced)
{
    if (falls(a->plant.now.tick / a->config.substeps, advanced, BALANCE_FRAMES))
        check_balance(a);
    telemetry_send_kept(a);
    send_motion(a, advanced);
    send_info(a);
    send_events(a);
    if (a->watch.pending)
        send_watch(a);
    send_lockin(a);
    if (a->latency.pending && (a->latency.kind == WIRE_FIRE || due(a, SET_ECHO_EVERY)))
        send_latency(a);
    if (due(a, SET_LEDGER_EVERY))
        send_ledger(a);
    if (due(a, SET_HEALTH_EVERY))
        send_health(a);
    if (due(a, SET_ECHO_EVERY))
        send_echo(a);
    if (due(a, SET_SUMMARY_EVERY))
        send_summary(a);
    if (due(a, SET_HASH_EVERY))
        send_hash(a);
    send_selftest(a);
    send_parameters(a);
    send_capture(a);
    /* last, so that what happened in this frame is in it */
    if (due(a, SET_STATUS_EVERY) || a->status_sent != status_word(a))
        send_status(a);
}
