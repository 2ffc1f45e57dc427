/* app_advance.c - plant time in a frame: fires and samples at their instants, ticks, lock-in, capture,
 * watch and sensors. */
#include "firmware/app/app_advance.h"

#include <string.h>
#include "firmware/app/app.h"
#include "firmware/app/app_apply.h"
#include "firmware/app/parameters.h"
#include "firmware/app/session.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"

/* Pulls the capture's triggers for the contact switches of a tick, before the sample of this tick is
 * added. */
static void trigger_on_switches(struct app *a, uint32_t n)
{
    const struct plant *pl = &a->plant;
    uint32_t kept = n < pl->n_event ? n : pl->n_event;
    for (uint32_t i = pl->n_event - kept; i < pl->n_event; i++) {
        const struct event *e = &pl->event[(pl->event_head + i) % PLANT_EVENTS];
        capture_trigger_now(&a->capture, e->touch ? TRIGGER_TOUCHDOWN : TRIGGER_LIFTOFF, e->tick);
    }
}

/* The fires that fall into the tick up to `end`. One that brings a set begins all windows anew, so none is
 * measured in the rest of this frame. Fires are rare, like a capture: both stay out of every tick's
 * registers. */
NEVER_INLINE bool advance_through_fires(struct app *a, struct instant end, struct lockin_frame *lockin)
{
    struct fire f;
    while (mailbox_take_fire(&a->mailbox, end, &f)) {
        if (!plant_advance(&a->plant, f.at))
            return false;
        if (app_apply_fire(a, &f))
            lockin->n_slots = 0;
    }
    return true;
}

NEVER_INLINE void capture_tick(struct app *a, uint32_t switches_before)
{
    double output[MODEL_OUTPUTS];
    plant_output(&a->plant, output);
    trigger_on_switches(a, a->plant.counts.switches - switches_before);
    capture_add(&a->capture, a->config.capture, output);
}

static bool is_capturing(const struct app *a)
{
    return a->capture.state == CAPTURE_ARMED || a->capture.state == CAPTURE_FILLING;
}

/* One tick, in which a fire may fall and at whose end a capture may look. */
static bool advance_tick(struct app *a, struct lockin_frame *lockin)
{
    struct instant end = {a->plant.now.tick + 1, 0};
    uint32_t switches = a->plant.counts.switches;
    bool capturing = is_capturing(a);
    if (!advance_through_fires(a, end, lockin) || !plant_advance(&a->plant, end))
        return false;
    if (lockin->n_slots > 0)
        lockin_slots_tick(lockin, &a->plant);
    if (capturing)
        capture_tick(a, switches);
    return true;
}

/* The tick has ended: is the choice of this model still sound? If not, the next tick is the full model's. */
static void watch_over(struct app *a)
{
    if (!watch_tick(&a->watch, &a->plant))
        return;
    a->count[DIAG_WATCH_TRIPS]++;
    a->count[DIAG_WATCH_TICK] = (uint32_t)a->watch.tick;
    if (!a->config.promote)
        return;
    const char *why = plant_promote(&a->plant, a->config.promote);
    ASSERT(!why);                   /* parameters_could_climb was asked before */
    a->watch.active = false;        /* its limits were for the model that was left */
    parameters_settings_changed(a); /* lock-in windows begin anew, as after a change of parameters */
}

static bool advance_tick_by_tick(struct app *a, struct lockin_frame *lockin)
{
    bool codes = a->streaming >= APP_STREAMING_CODES;
    for (uint32_t i = 0; i < a->config.substeps; i++) {
        if (codes)
            app_apply_codes(a, i);
        if (!advance_tick(a, lockin))
            return false;
        if (codes)
            app_read_codes(a, i);
        if (a->config.observe)
            a->config.observe(a->config.observer, &a->plant);
        watch_over(a);
    }
    return true;
}

/* The lock-in and the observer of the configuration. */
struct witness {
    struct lockin_frame *lockin;
    const struct app_config *config;
};

/* A plant_look. */
static void witness_tick(void *witness, const struct plant *pl)
{
    const struct witness *w = witness;
    if (w->lockin->n_slots > 0)
        lockin_slots_tick(w->lockin, pl);
    w->config->observe(w->config->observer, pl);
}

/* A fire, capture, watch or code may act in each tick. */
static bool goes_by_ticks(const struct app *a)
{
    return a->watch.active || a->mailbox.n_fires > 0 || is_capturing(a) ||
           a->streaming >= APP_STREAMING_CODES;
}

/* The ticks of a frame: in one run where it may be. */
static bool advance_ticks(struct app *a, struct lockin_frame *lockin)
{
    struct witness witness = {lockin, &a->config};
    if (goes_by_ticks(a))
        return advance_tick_by_tick(a, lockin);
    if (a->config.observe)
        return plant_run_seen(&a->plant, a->config.substeps, witness_tick, NULL, &witness);
    if (lockin->n_slots > 0)
        return plant_run_seen(&a->plant, a->config.substeps, lockin_slots_tick, lockin_slots_ticks, lockin);
    return plant_run(&a->plant, a->config.substeps);
}

/* Hands the true outputs at the end of a frame to the sensors. */
static void sense(struct app *a)
{
    double output[MODEL_OUTPUTS];
    plant_output(&a->plant, output);
    if (a->plant.staged)
        a->plant.stage_calls->replace(a->plant.stages, output);
    sensor_record(&a->sensor, a->plant.now.tick / a->config.substeps, output);
}

/* A frame of plant time under way. */
struct advance {
    struct lockin_frame lockin;
    uint32_t budget; /* reached before */
};

static void begin_advance(struct app *a, struct advance *f)
{
    f->budget = a->plant.counts.budget + a->plant.counts.work;
    app_apply_samples(a, a->plant.now.tick / a->config.substeps);
    lockin_slots_begin_frame(&a->lockin, &a->plant, a->config.substeps, &f->lockin);
}

static void end_advance(struct app *a, const struct advance *f, bool finite)
{
    lockin_slots_end_frame(&f->lockin, &a->plant);
    if (!finite)
        session_fault(a, FAULT_NOT_FINITE);
    else if (a->plant.counts.budget + a->plant.counts.work != f->budget)
        session_fault(a, FAULT_BUDGET);
    sense(a);
    a->step_left -= a->step_left > 0;
}

static void advance_frame(struct app *a)
{
    struct advance f;
    begin_advance(a, &f);
    end_advance(a, &f, advance_ticks(a, &f.lockin));
}

uint32_t app_advance(struct app *a)
{
    bool stepping = a->state == STATE_PAUSED && a->step_left > 0;
    uint32_t frames = 1 + a->skip, advanced = 0;
    a->skip = 0;
    if (a->state != STATE_RUNNING && !stepping)
        return 0;
    for (; advanced < frames && a->state != STATE_FAULT; advanced++) {
        if (stepping && a->step_left == 0)
            break; /* a step ends where it said, overrun or not */
        advance_frame(a);
    }
    return advanced;
}

/* Its next frame of plant time is one run that nobody watches tick by tick but the lock-in. */
static bool goes_beside(const struct app *a)
{
    return a->state == STATE_RUNNING && a->skip == 0 && !goes_by_ticks(a) && !a->config.observe;
}

void app_advance_beside(struct app *const *a, uint32_t n, plant_bind_sides *bind, uint32_t *advanced)
{
    struct advance f[SIDES];
    struct plant_run r[SIDES];
    struct app *of[SIDES];
    uint32_t k = 0;
    for (uint32_t i = 0; i < n; i++) {
        struct app *one = a[i];
        if (!goes_beside(one)) {
            advanced[i] = app_advance(one);
            continue;
        }
        advanced[i] = 1;
        begin_advance(one, &f[k]);
        r[k] = (struct plant_run){.pl = &one->plant, .to = one->plant.now.tick + one->config.substeps};
        if (f[k].lockin.n_slots > 0) {
            r[k].look = lockin_slots_tick;
            r[k].several = lockin_slots_ticks;
            r[k].who = &f[k].lockin;
        }
        of[k++] = one;
    }
    if (k > 0)
        plant_run_beside(r, k, bind);
    for (uint32_t i = 0; i < k; i++)
        end_advance(of[i], &f[i], r[i].good);
}
