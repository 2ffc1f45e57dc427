/* command.c - see command.h. Each handler either takes its command as a whole or refuses it and changes
 * nothing. */
#include "firmware/app/command.h"

#include <string.h>
#include "firmware/app/app.h"
#include "firmware/app/command_drives.h"
#include "firmware/app/parameters.h"
#include "firmware/app/session.h"
#include "firmware/app/telemetry_send.h"

/* The age of an echoed frame number in bus frames; one from the future becomes huge. */
static uint32_t age_of(const struct app *a, double echoed)
{
    return (uint32_t)a->frame - (uint32_t)echoed;
}

/* True for a frame beyond the age limit, or from before the end of the last session: its sender cannot
 * know of that end. */
static bool too_old(const struct app *a, double echoed)
{
    uint64_t age = age_of(a, echoed);
    return age > (uint64_t)a->setting[SET_AGE_LIMIT_FRAMES] + a->jump || age + a->echo_from > a->frame;
}

/* ---- ENABLE, CONTROL ---- */

/* A command ends the session. A frame sent before it must not undo it, however late it comes: the next
 * session needs a later frame of the plant. */
static void stop(struct app *a, enum plant_state state)
{
    session_drives_to_zero(a, 0.0);
    if (a->state != STATE_FAULT)
        a->state = state;
    if (a->state != STATE_OFF)
        a->reaction = REACTION_STOP;
    session_end(a);
}

static enum cause on_enable(struct app *a, const struct message *m)
{
    uint8_t session = (uint8_t)m->value[SESSION];
    bool request = m->value[ENABLE_REQUEST] != 0.0;
    if (a->enabled ? session != a->session : (!request || session != a->session % WIRE_SESSIONS + 1))
        return CAUSE_SESSION;
    if (too_old(a, m->value[ENABLE_FRAME]))
        return CAUSE_STALE;
    if (request && !a->enabled)
        telemetry_greet(&a->telemetry, a);
    if (a->faults & FAULT_SELF_TEST)
        return CAUSE_SELF_TEST;
    if (!request) {
        stop(a, STATE_OFF);
        return CAUSE_OK;
    }
    session_hear_heartbeat(a);
    if (a->enabled)
        return CAUSE_OK;
    a->enabled = true;
    a->session = session;
    a->reaction = REACTION_NONE;
    memset(a->receiver, 0, sizeof a->receiver);
    if (a->state == STATE_OFF)
        a->state = STATE_READY;
    return CAUSE_OK;
}

/* A fault stops plant time inside a frame; from a reset on its frames begin at whole multiples again. */
static void to_frame_start(struct instant *now, uint32_t substeps)
{
    uint64_t part = now->tick % substeps;
    if (part == 0 && now->fraction == 0)
        return;
    *now = (struct instant){now->tick - part + substeps, 0};
}

static enum cause control_reset(struct app *a)
{
    if (a->state == STATE_RUNNING)
        return CAUSE_STATE;
    to_frame_start(&a->plant.now, a->config.substeps);
    plant_reset(&a->plant);
    a->plant.counts.changes++;
    a->balance_residual_J = 0.0; /* the ledger begins anew */
    mailbox_empty(&a->mailbox);
    a->streaming = 0;
    a->step_left = 0;
    parameters_settings_changed(a);
    watch_clear(&a->watch);
    a->faults = 0;
    a->state = STATE_READY;
    return CAUSE_OK;
}

static enum cause control_start(struct app *a)
{
    if (a->state == STATE_FAULT || a->state == STATE_OFF)
        return CAUSE_STATE;
    a->state = STATE_RUNNING;
    a->step_left = 0;
    return CAUSE_OK;
}

static enum cause control_pause(struct app *a)
{
    if (a->state == STATE_FAULT || a->state == STATE_OFF)
        return CAUSE_STATE;
    a->state = STATE_PAUSED;
    a->step_left = 0;
    return CAUSE_OK;
}

static enum cause control_step(struct app *a, double frames)
{
    if (a->state != STATE_PAUSED || a->step_left > 0)
        return CAUSE_STATE;
    if (frames < 1.0)
        return CAUSE_RANGE;
    a->step_left = (uint64_t)frames;
    return CAUSE_OK;
}

/* The tick must be a frame's end: plant time stops nowhere else. */
static enum cause control_run_until(struct app *a, double low, struct remark *r)
{
    uint64_t now = a->plant.now.tick, tick = wire_nearest_32(now, low);
    if (a->state != STATE_PAUSED || a->step_left > 0)
        return CAUSE_STATE;
    if (tick % a->config.substeps != 0)
        return CAUSE_RANGE;
    if ((int64_t)(tick - now) <= 0) {
        r->ticks_late = now - tick;
        return CAUSE_LATE;
    }
    a->step_left = (tick - now) / a->config.substeps;
    return CAUSE_OK;
}

static enum cause on_control(struct app *a, const struct message *m, struct remark *r)
{
    unsigned operation = (unsigned)m->value[CONTROL_OPERATION];
    double argument = m->value[CONTROL_ARGUMENT];
    r->index = operation;
    if ((operation ^ 0xFFu) != (unsigned)m->value[CONTROL_COMPLEMENT])
        return CAUSE_RANGE;
    if (operation == CONTROL_STOP) {
        if (a->state == STATE_OFF)
            session_end(a); /* there is none: an ENABLE that was sent before opens none */
        else
            stop(a, STATE_STOPPED);
        return CAUSE_OK;
    }
    if (!a->enabled || (uint8_t)m->value[SESSION] != a->session)
        return CAUSE_SESSION;
    if (operation == CONTROL_STEP)
        return control_step(a, argument);
    if (operation == CONTROL_RUN_UNTIL)
        return control_run_until(a, argument, r);
    if (operation == 0 || operation >= CONTROL_OPERATIONS)
        return CAUSE_UNKNOWN;
    if (too_old(a, argument))
        return CAUSE_STALE;
    if (operation == CONTROL_START)
        return control_start(a);
    return operation == CONTROL_PAUSE ? control_pause(a) : control_reset(a);
}

/* ---- capture ---- */

static enum cause arm_capture(struct app *a)
{
    struct app_config *c = &a->config;
    const double *setting = a->setting;
    uint32_t n_signals = (uint32_t)a->plant.model->n_outputs;
    uint32_t n_samples = (uint32_t)setting[SET_CAPTURE_SAMPLES], n = n_signals * n_samples;
    if (c->grow_capture && n > c->n_capture) {
        float *memory = c->grow_capture(c->capture_owner, n);
        if (!memory)
            return CAUSE_FULL;
        c->capture = memory;
        c->n_capture = n;
    }
    return capture_arm(&a->capture, c->n_capture, n_signals, n_samples,
                       (uint32_t)setting[SET_CAPTURE_PRETRIGGER], (uint32_t)setting[SET_CAPTURE_EVERY_TICKS],
                       (enum capture_trigger)(int)setting[SET_CAPTURE_TRIGGER])
               ? CAUSE_OK
               : CAUSE_RANGE;
}

static enum cause on_capture(struct app *a, const struct message *m, struct remark *r)
{
    unsigned operation = (unsigned)m->value[CAPTURE_OPERATION];
    r->index = operation;
    switch (operation) {
    case CAPTURE_STOP:
        a->capture.state = CAPTURE_IDLE;
        return CAUSE_OK;
    case CAPTURE_ARM:
        return arm_capture(a);
    case CAPTURE_TRIGGER:
        if (a->capture.state != CAPTURE_ARMED)
            return CAUSE_STATE;
        a->capture.trigger = TRIGGER_COMMAND;
        capture_trigger_now(&a->capture, TRIGGER_COMMAND, a->plant.now.tick);
        return CAUSE_OK;
    case CAPTURE_READ:
        if (a->capture.state != CAPTURE_FULL)
            return CAUSE_STATE;
        return capture_read(&a->capture, &a->telemetry.reading, (uint32_t)m->value[CAPTURE_FIRST],
                            (uint32_t)m->value[CAPTURE_COUNT])
                   ? CAUSE_OK
                   : CAUSE_RANGE;
    default:
        return CAUSE_UNKNOWN;
    }
}

/* ---- every frame that arrives ---- */

static enum cause dispatch(struct app *a, const struct message *m, struct remark *r)
{
    if (m->kind == WIRE_ENABLE)
        return on_enable(a, m);
    if (m->kind == WIRE_CONTROL)
        return on_control(a, m, r);
    if (!a->enabled || (uint8_t)m->value[SESSION] != a->session)
        return CAUSE_SESSION;
    if (m->kind >= WIRE_ARM && m->kind < WIRE_ARM + MODEL_INPUTS)
        return drives_arm(a, m, r);
    if (m->kind >= WIRE_STREAM && m->kind < WIRE_STREAM + MODEL_INPUTS)
        return drives_stream(a, m, r);
    switch (m->kind) {
    case WIRE_FIRE:
        return drives_fire(a, m, r);
    case WIRE_PARAM_WRITE:
        r->index = (unsigned)m->value[PARAM_WRITE_INDEX];
        return parameters_write(a, m);
    case WIRE_PARAM_COMMIT:
        return parameters_commit(a, m);
    case WIRE_PARAM_READ:
        r->index = (unsigned)m->value[PARAM_READ_INDEX];
        return parameters_read(a, m);
    case WIRE_DAC:
        return drives_codes(a, m, r);
    default:
        ASSERT(m->kind == WIRE_CAPTURE); /* no other command has a layout */
        return on_capture(a, m, r);
    }
}

/* Commands that come every frame, or that are one of many, are answered only when they are refused. */
static bool answers_ok(unsigned kind)
{
    return kind == WIRE_FIRE || kind == WIRE_CONTROL || kind == WIRE_PARAM_COMMIT || kind == WIRE_CAPTURE;
}

static void handle(struct app *a, const struct message *m)
{
    struct remark r = {0, UINT64_MAX};
    bool was_enabled = a->enabled;
    enum cause cause = dispatch(a, m, &r);
    if (cause != CAUSE_OK)
        a->count[DIAG_RANGE + (int)cause - CAUSE_RANGE]++;
    if (cause != CAUSE_OK || answers_ok(m->kind) || a->enabled != was_enabled)
        telemetry_reply(&a->telemetry, a, m, cause, r.index, r.ticks_late);
}

/* STOP is the safe direction: idempotent, so that a repeated one is taken as well. */
static bool is_stop(const struct message *m)
{
    return m->kind == WIRE_CONTROL && m->value[CONTROL_OPERATION] == CONTROL_STOP;
}

/* False when the counter shows a repetition. Only frames of the session in force count: those of another
 * sender must not use up the counters of its owner. A new session starts its counters anew. */
static bool counter_advanced(struct app *a, const struct message *m)
{
    struct receiver *r = &a->receiver[m->kind];
    unsigned delta = (m->counter + WIRE_COUNTER_STATES - r->counter) % WIRE_COUNTER_STATES;
    if (!a->enabled || (uint8_t)m->value[SESSION] != a->session)
        return true;
    if (r->seen && delta == 0) {
        a->count[DIAG_REPEATED]++;
        return is_stop(m);
    }
    if (r->seen)
        a->count[DIAG_LOST] += delta - 1;
    r->seen = true;
    r->counter = m->counter;
    return true;
}

static void take(struct app *a, const struct frame *f)
{
    struct message m;
    enum wire_status status = wire_decode(&a->scene, f, &m);
    if (status == WIRE_NOT_OURS)
        return;
    a->count[DIAG_FRAMES_RECEIVED]++;
    if (status == WIRE_OK && m.kind >= WIRE_COMMANDS)
        status = WIRE_BAD_KIND; /* another sender uses the identifiers of our telemetry */
    switch (status) {
    case WIRE_OK:
        if (counter_advanced(a, &m))
            handle(a, &m);
        break;
    case WIRE_BAD_LENGTH:
        a->count[DIAG_LENGTH]++;
        break;
    case WIRE_BAD_CRC:
        a->count[DIAG_CRC]++;
        break;
    case WIRE_BAD_COUNTER:
        a->count[DIAG_COUNTER_INVALID]++;
        break;
    case WIRE_BAD_KIND:
    case WIRE_NOT_OURS:
        a->count[DIAG_UNKNOWN_ID]++;
        break;
    }
}

static void take_faults(struct app *a, unsigned faults)
{
    a->count[DIAG_RX_DROPPED] += (faults & HAL_DROPPED) != 0;
    a->count[DIAG_RX_FOREIGN] += (faults & HAL_FOREIGN) != 0;
    a->count[DIAG_BUS_OFF] += (faults & HAL_BUS_OFF) != 0;
    a->count[DIAG_BUS_PASSIVE] += (faults & HAL_ERROR_PASSIVE) != 0;
    a->count[DIAG_BUS_DOWN] += (faults & HAL_DOWN) != 0;
    a->count[DIAG_TX_UNSENT] += (faults & HAL_UNSENT) != 0;
    a->count[DIAG_LOG_ENDED] += (faults & HAL_LOG_ENDED) != 0;
    if (faults & (HAL_BUS_OFF | HAL_DOWN)) {
        session_fault(a, FAULT_BUS);
        telemetry_drop_kept(&a->telemetry); /* nothing from before the outage goes out after it */
    }
}

/* ---- floods ---- */

/* The frames that one look through a flood has taken. */
struct look {
    bool stop, enable;
};

/* An ENABLE that does something: of the session in force, or one that may open a session. */
static bool is_fitting_enable(const struct app *a, const struct message *m)
{
    bool fits = a->enabled ? (uint8_t)m->value[SESSION] == a->session : m->value[ENABLE_REQUEST] != 0.0;
    return fits && !too_old(a, m->value[ENABLE_FRAME]);
}

/* In a flood, for a frame behind those that this plant frame may take: true when it is taken nevertheless. */
static bool overtakes(struct app *a, const struct frame *f, struct look *l)
{
    struct message m;
    bool extended = (f->flags & FRAME_EXTENDED) != 0;
    uint32_t kind = extended == a->scene.extended ? f->id - a->scene.base_id : WIRE_KINDS;
    bool urgent = kind == WIRE_ENABLE || kind == WIRE_CONTROL;
    if (urgent && wire_decode(&a->scene, f, &m) == WIRE_OK) {
        bool *taken = kind == WIRE_ENABLE ? &l->enable : &l->stop;
        if (!*taken && (kind == WIRE_ENABLE ? is_fitting_enable(a, &m) : is_stop(&m)))
            return *taken = true;
    }
    a->count[DIAG_RX_FLOOD] += kind < WIRE_KINDS;
    return false;
}

void command_receive(struct app *a)
{
    struct frame f;
    struct look look = {false, false};
    int end = APP_RECV_BUDGET + (a->crowded ? APP_LOOK_AHEAD : 0), got, n = 0;
    for (; n < end && (got = a->hal->recv(a->hal->context, &f)) != 0; n++) {
        if (got < 0)
            take_faults(a, (unsigned)-got);
        else if (n < APP_RECV_BUDGET || overtakes(a, &f, &look))
            take(a, &f);
    }
    a->crowded = n >= APP_RECV_BUDGET;
    a->count[DIAG_RX_BUDGET] += a->crowded;
}
