/* app.c - set-up, one frame of work, faults, and the time-out and overrun reactions; see app.h. */
#include "firmware/app/app.h"

#include <string.h>
#include "firmware/app/account.h"
#include "firmware/app/app_advance.h"
#include "firmware/app/command.h"
#include "firmware/app/telemetry_send.h"
#include "firmware/bus/identity.h"
#include "firmware/app/parameters.h"
#include "firmware/app/session.h"
#include "firmware/plant/plant_change.h"

enum {
    CATCH_UP_MAX =
        100, /* frames made up in one go; a longer stall slips, or the plant would chase the clock */
    OVERRUN_MAX = 65535 /* most missed frames that one OVERRUN reports */
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

/* A climb must be possible when the watch trips. So it is checked now and at each change of parameters. */
static const char *start_watch(struct app *a, const struct app_config *c)
{
    const char *why = c->watch ? watch_start(&a->watch, c->watch, c->model) : NULL;
    if (why || !c->promote)
        return why;
    return c->watch ? parameters_could_climb(a, a->plant.si) : "a model to climb to needs a watch that trips";
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
    why = parameters_check_settings(c->model, a->setting);
    why = why ? why : parameters_check_stages(c, c->model, a->setting);
    if (why)
        return why;
    struct plant_config pc = {.model = c->model, .si = c->si, .method = c->method, .scratch = c->scratch};
    pc.stage_calls = c->stage_calls;
    pc.stages = c->stages;
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
    telemetry_init(&a->telemetry);
    a->config.si = NULL; /* taken over; the caller's arrays may go */
    a->config.setting = NULL;
    a->config.watch = NULL;
    a->reaction = REACTION_NONE;
    sensor_init(&a->sensor);
    parameters_settings_changed(a);
    return NULL;
}

void app_take_selftest(struct app *a, const struct selftest_result *r)
{
    a->selftest = *r;
    telemetry_tell_selftest(&a->telemetry, a);
    if (r->failed)
        session_fault(a, FAULT_SELF_TEST);
}

void app_take_last_run(struct app *a, uint32_t kind)
{
    a->count[DIAG_LAST_RUN] = kind;
    session_fault(a, FAULT_ASSERT);
}

/* ---- the frame ---- */

static uint32_t now_us(const struct app *a)
{
    return a->hal->now_us(a->hal->context);
}

static void begin_frame(struct app *a)
{
    command_receive(a);
    session_check_age(a);
}

static void report_frame(struct app *a, uint32_t advanced)
{
    account_judge(a, advanced);
    telemetry_report(&a->telemetry, a, advanced);
    plant_begin_record(&a->plant); /* this frame's record has been reported */
    a->hal->flush(a->hal->context);
}

/* It took so long. */
static void end_frame(struct app *a, uint32_t us)
{
    histogram_add(&a->timing.compute, us, a->frame);
    /* Also while a fault is latched, that of the last run among them: the watchdog only guards that
     * frames end. */
    a->hal->healthy(a->hal->context);
    a->jump = 0;
    a->away = 0;
    a->due -= a->due > 0;
    a->frame++;
}

void app_frame(struct app *a)
{
    uint32_t begin_us = now_us(a);
    begin_frame(a);
    report_frame(a, app_advance(a));
    end_frame(a, now_us(a) - begin_us);
}

void app_frames(struct app *const *a, uint32_t n, plant_bind_sides *bind)
{
    uint32_t advanced[SIDES], begin_us = now_us(a[0]);
    for (uint32_t i = 0; i < n; i++)
        begin_frame(a[i]);
    app_advance_beside(a, n, bind, advanced);
    for (uint32_t i = 0; i < n; i++)
        report_frame(a[i], advanced[i]);
    uint32_t us = now_us(a[0]) - begin_us;
    for (uint32_t i = 0; i < n; i++)
        end_frame(a[i], (us + i) / n); /* whole microseconds, all of them together */
}

/* Counts missed frames as bus frames. Some of them are made up, by the policy; the others get no turn.
 * `moving`: plant time ran before. */
static void pass_by(struct app *a, uint32_t missed, bool moving)
{
    enum overrun_policy policy = (enum overrun_policy)(int)a->setting[SET_OVERRUN_POLICY];
    bool catch_up = policy == OVERRUN_CATCH_UP,
         here = a->due > 0; /* the period before had its frame just now */
    uint32_t room = CATCH_UP_MAX - session_behind(a), run = missed < room ? missed : room;
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
    telemetry_send(&a->telemetry, a, &m);
    a->count[DIAG_OVERRUNS]++;
    a->count[DIAG_FRAMES_MISSED] += missed;
    if (too_long && a->enabled)
        session_time_out(a); /* nothing that waited meanwhile may act */
    else if (too_long)
        session_end(a); /* nor open a session */
    if (moving && stops)
        session_fault(a, FAULT_OVERRUN);
    pass_by(a, missed, moving);
    return a->due;
}
