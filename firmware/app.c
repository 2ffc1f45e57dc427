/* app.c - set-up, one frame of work, faults, and the time-out and overrun reactions; see app.h. */
#include "firmware/app.h"

#include <string.h>
#include "firmware/app_parts.h"
#include "firmware/command.h"
#include "firmware/identity.h"
#include "firmware/telemetry.h"

enum {
    CATCH_UP_MAX =
        100, /* frames made up in one go; a longer stall slips, or the plant would chase the clock */
    OVERRUN_MAX = 65535 /* missed frames that OVERRUN can tell apart */
};

/* ---- set-up ---- */

static const char *check_config(const struct app_config *c)
{
    uint32_t last = c->extended ? 0x1FFFFFFFu : 0x7FFu;
    if (!(c->frame_s >= 1e-6 && c->frame_s <= 10.0))
        return "frame period outside 1e-6..10 s";
    if (c->substeps < 1 || c->substeps > 4096)
        return "substeps outside 1..4096";
    if (c->base_id % WIRE_BASE_ALIGN != 0)
        return "base identifier must be a multiple of 0x40";
    if (c->base_id > last - (WIRE_KINDS - 1))
        return "base identifier too large";
    return NULL;
}

/* Sensor faults, lock-in windows and everything else that follows from the settings. */
void app_settings_changed(struct app *a)
{
    uint32_t n_ticks = (uint32_t)a->setting[SET_LOCKIN_FRAMES] * a->config.substeps;
    sensor_change(&a->sensor, a->setting);
    for (int i = 0; i < LOCKIN_SLOTS; i++) {
        lockin_start(&a->lockin[i], n_ticks, (uint32_t)a->setting[SET_LOCKIN_HARMONIC + i]);
        a->lockin_channel[i] = (uint8_t)a->setting[SET_LOCKIN_CHANNEL + i];
        a->lockin_output[i] = (uint8_t)a->setting[SET_LOCKIN_OUTPUT + i];
    }
}

/* Whether the plant could climb is asked now and at each change of parameters, so that it can when it must. */
static const char *start_watch(struct app *a, const struct app_config *c)
{
    const char *why = c->watch ? watch_start(&a->watch, c->watch, c->model) : NULL;
    if (why || !c->promote)
        return why;
    return c->watch ? app_could_climb(a, a->plant.si) : "a model to climb to needs a watch that trips";
}

const char *app_init(struct app *a, const struct app_config *c, const struct hal *hal)
{
    const char *why = check_config(c);
    if (why)
        return why;
    memset(a, 0, sizeof *a);
    a->config = *c;
    a->hal = hal;
    for (int i = 0; i < SETTINGS; i++) {
        a->setting[i] = c->setting ? c->setting[i] : setting_initial(i, c->model, c->frame_s);
        if (!setting_accepts(i, a->setting[i]))
            return "a setting is outside its range";
    }
    why = app_check_settings(c->model, a->setting);
    if (why)
        return why;
    struct plant_config pc = {.model = c->model, .si = c->si, .method = c->method, .work = c->work};
    pc.tick_s = c->frame_s / c->substeps;
    pc.dilation = c->dilation;
    pc.tol = c->tol;
    why = plant_init(&a->plant, &pc);
    if (why)
        return why;
    why = start_watch(a, c);
    if (why)
        return why;
    const struct scale *s = &a->plant.scale;
    a->scene = (struct wire_scene){.base_id = c->base_id,
                                   .extended = c->extended,
                                   .frame_rate_Hz = 1.0 / c->frame_s,
                                   .dilation = c->dilation,
                                   .substeps = c->substeps};
    a->scene.lsb[0] = wire_lsb(s->length_m);
    a->scene.lsb[1] = wire_lsb(scale_of(s, QUANTITY_VELOCITY));
    a->scene.lsb[2] = wire_lsb(s->length_m);
    a->scene.lsb[3] = wire_lsb(s->force_N);
    identity_fill(&a->scene, c->model, a->setting);
    app_tell_info(a);
    a->config.si = NULL; /* taken over; the caller's arrays may go */
    a->config.setting = NULL;
    a->config.watch = NULL;
    a->reaction = REACTION_NONE;
    sensor_init(&a->sensor);
    app_settings_changed(a);
    return NULL;
}

/* ---- drives all at once ---- */

void app_drives_to_zero(struct app *a, double ramp_s)
{
    struct plant *pl = &a->plant;
    uint64_t ticks = (uint64_t)(int64_t)(ramp_s / pl->tick_s + 0.5);
    bool sounded = false;
    for (int i = 0; i < pl->model->n_inputs; i++) {
        struct drive_setting s = drive_target(&pl->drive[i]);
        s.amplitude = 0.0;
        s.ramp_ticks = ticks;
        if (drive_active(&pl->drive[i])) {
            drive_change(plant_touch_drive(pl, i), &s);
            pl->drive[i].noise.level = 0.0;
            drive_sample(&pl->drive[i], 0.0, ticks > 0 ? ticks : 1);
            sounded = true;
        }
    }
    pl->counts.changes += sounded;
    mailbox_empty(&a->mailbox);
    a->streaming = 0;
}

void app_fault(struct app *a, enum fault_bit fault)
{
    capture_trigger_now(&a->capture, TRIGGER_FAULT, a->plant.now.tick);
    a->faults |= (uint8_t)fault;
    if (fault & (FAULT_NOT_FINITE | FAULT_OVERRUN | FAULT_ASSERT | FAULT_SELF_TEST)) {
        app_drives_to_zero(a, 0.0);
        a->state = STATE_FAULT;
        a->step_left = 0;
    }
}

void app_tell_selftest(struct app *a)
{
    a->selftest_pending = a->selftest.present ? (1u << SELFTEST_CHECKS) - 1u : 0;
}

void app_tell_info(struct app *a)
{
    a->info_pending = (1u << INFO_ITEMS) - 1u;
}

void app_take_selftest(struct app *a, const struct selftest_result *r)
{
    a->selftest = *r;
    app_tell_selftest(a);
    if (r->failed)
        app_fault(a, FAULT_SELF_TEST);
}

void app_take_last_run(struct app *a, uint32_t kind)
{
    a->count[DIAG_LAST_RUN] = kind;
    app_fault(a, FAULT_ASSERT);
}

void app_end_session(struct app *a)
{
    a->enabled = false;
    a->echo_from = a->frame + 1;
    a->step_left = 0;
    mailbox_empty(&a->mailbox);
    a->streaming = 0;
}

/* ---- the age of commands ---- */

/* Frames still to be made up after this one. */
static uint32_t behind(const struct app *a)
{
    return a->due > 0 ? a->due - 1 : 0;
}

/* The bus frame that it is by the time: this one's number lags while frames are made up. */
static uint64_t now(const struct app *a)
{
    return a->frame + behind(a);
}

/* It may have come at any time since the frame before, so at the beginning of an absence. */
void app_hear_heartbeat(struct app *a)
{
    a->heartbeat_frame = now(a) - a->away;
    a->absent = a->away;
}

uint64_t app_command_age(const struct app *a)
{
    return now(a) - a->heartbeat_frame;
}

static void time_out(struct app *a)
{
    app_end_session(a);
    app_fault(a, FAULT_TIMEOUT);
    a->count[DIAG_TIMEOUTS]++;
    a->reaction = (enum reaction)(int)a->setting[SET_REACTION];
    if (a->reaction == REACTION_RAMP)
        app_drives_to_zero(a, a->setting[SET_REACTION_RAMP_S]);
    if (a->reaction == REACTION_ZERO)
        app_drives_to_zero(a, 0.0);
    if (a->reaction == REACTION_FREEZE && (a->state == STATE_RUNNING || a->state == STATE_PAUSED))
        a->state = STATE_FROZEN;
}

/* What the plant was away itself is forgiven, but not again and again: as many frames as the time-out has, once. */
static void check_age(struct app *a)
{
    uint64_t limit = (uint64_t)a->setting[SET_TIMEOUT_FRAMES];
    uint64_t forgiven = a->absent < limit ? a->absent : limit;
    if (a->enabled && app_command_age(a) > limit + forgiven)
        time_out(a);
}

/* ---- the frame ---- */

void app_frame(struct app *a)
{
    uint32_t begin_us = a->hal->now_us(a->hal->context);
    command_receive(a);
    check_age(a);
    uint32_t advanced = app_advance(a);
    telemetry_report(a, advanced);
    a->hal->flush(a->hal->context);
    histogram_add(&a->timing.compute, a->hal->now_us(a->hal->context) - begin_us, a->frame);
    /* Also with a latched fault, that of the last run among them: only a frame that does not end starves the watchdog. */
    a->hal->healthy(a->hal->context);
    a->jump = 0;
    a->away = 0;
    a->due -= a->due > 0;
    a->frame++;
}

/* Missed frames become bus frames: some of them are made up, the others get no turn. `moving`: plant time ran before. */
static void pass_by(struct app *a, uint32_t missed, bool moving)
{
    enum overrun_policy policy = (enum overrun_policy)(int)a->setting[SET_OVERRUN_POLICY];
    bool catch_up = policy == OVERRUN_CATCH_UP,
         here = a->due > 0; /* the period before had its frame just now */
    uint32_t room = CATCH_UP_MAX - behind(a), run = missed < room ? missed : room;
    if (a->state != STATE_RUNNING || policy == OVERRUN_FREEZE || policy == OVERRUN_STOP)
        run = 0;
    uint32_t jump = catch_up ? missed - run : missed;
    a->count[DIAG_FRAMES_SLIPPED] += moving ? missed - run : 0;
    a->due += (catch_up ? run : 0) + !here;
    a->skip = catch_up ? 0 : run;
    a->frame += jump;
    a->jump = jump;
    a->away = missed - here;
    a->absent += a->away;
}

uint32_t app_overrun(struct app *a, uint32_t missed)
{
    bool moving = a->state == STATE_RUNNING, stops = a->setting[SET_OVERRUN_POLICY] == OVERRUN_STOP;
    if (missed == 0)
        return a->due = a->due > 0 ? a->due : 1;
    missed = missed < OVERRUN_MAX ? missed : OVERRUN_MAX;
    bool too_long = missed >= (uint32_t)a->setting[SET_TIMEOUT_FRAMES];
    struct message m = {.kind = WIRE_OVERRUN, .value = {missed, (double)(uint32_t)a->frame}};
    telemetry_send(a, &m);
    a->count[DIAG_OVERRUNS]++;
    a->count[DIAG_FRAMES_MISSED] += missed;
    if (too_long && a->enabled)
        time_out(a); /* nothing that waited meanwhile may act */
    else if (too_long)
        app_end_session(a); /* nor open a session */
    if (moving && stops)
        app_fault(a, FAULT_OVERRUN);
    pass_by(a, missed, moving);
    return a->due;
}
