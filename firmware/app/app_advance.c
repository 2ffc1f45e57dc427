/* app_advance.c - plant time in a frame: fires and samples at their instants, ticks, lock-in, capture,
 * watch and sensors. */
#include "firmware/app/app_advance.h"

#include <string.h>
#include "firmware/app/app.h"
#include "firmware/app/app_apply.h"
#include "firmware/app/parameters.h"
#include "firmware/app/session.h"

/* The lock-in slots that measure in this frame: those whose drive sounds. Neighbours that are at an equal
 * tick of their windows share its weights: they follow the first of them. */
struct listening {
    int n;
    plant_look *measure;
    struct {
        struct lockin *lockin, *leader;
        const struct drive *drive;
        uint8_t slot, output;
    } at[LOCKIN_SLOTS];
};

/* One tick of the lock-in: outputs in model units, results of stages in SI. */
ALWAYS_INLINE void measure_all(struct listening *to, const struct plant *pl, double *output)
{
    double weight = 0.0;
    pl->model->output(pl->p, pl->segment.at[2], pl->x, output);
    for (int k = 0; k < to->n; k++) {
        struct lockin *l = to->at[k].lockin;
        const struct drive *d = to->at[k].drive;
        if (l == to->at[k].leader)
            weight = lockin_weight(l);
        lockin_sample(l, weight * output[to->at[k].output], d->cosine, d->sine);
    }
}

/* A plant_look. */
static void measure(void *listening, const struct plant *pl)
{
    double output[MODEL_OUTPUTS];
    measure_all(listening, pl, output);
}

/* With the results of stages. */
static void measure_staged(void *listening, const struct plant *pl)
{
    double output[MODEL_OUTPUTS + PLANT_STAGES];
    memcpy(&output[MODEL_OUTPUTS], pl->stage_calls->results(pl->stages), PLANT_STAGES * sizeof *output);
    measure_all(listening, pl, output);
}

/* Collects the slots that measure. A slot begins a new window when its drive is silent, or when a fault or
 * a climb has left it inside a frame. */
static void listen(struct app *a, struct listening *to)
{
    struct lockin *leader = NULL;
    to->n = 0;
    to->measure = a->plant.staged ? measure_staged : measure;
    for (int i = 0; i < LOCKIN_SLOTS; i++) {
        const struct drive *d = &a->plant.drive[a->lockin_channel[i]];
        struct lockin *l = &a->lockin[i];
        bool sounds = d->amplitude != 0.0 || d->ramp_left > 0 || l->harmonic == 0;
        if (l->i_tick > 0 && !(sounds && l->i_tick % a->config.substeps == 0))
            lockin_start(l, l->n_ticks, l->harmonic);
        if (l->n_ticks == 0 || !sounds)
            continue;
        if (!leader || leader->i_tick != l->i_tick)
            leader = l;
        to->at[to->n].lockin = l;
        to->at[to->n].leader = leader;
        to->at[to->n].drive = d;
        to->at[to->n].slot = (uint8_t)i;
        to->at[to->n++].output = a->lockin_output[i];
    }
}

/* Ends windows at the end of a frame and converts the results to SI; a change of parameters begins new
 * windows, so the units are right. Leaders come last: the others copy their leader's window before it
 * begins anew. */
NEVER_INLINE void finish_windows(struct app *a, const struct listening *to)
{
    for (int k = to->n - 1; k >= 0; k--) {
        double amplitude, phase;
        int i = to->at[k].output;
        double unit =
            i < MODEL_OUTPUTS ? scale_of(&a->plant.scale, a->plant.model->output_signal[i].quantity) : 1.0;
        lockin_follow(to->at[k].lockin, to->at[k].leader);
        struct lockin_result *r = &a->lockin_result[to->at[k].slot];
        if (lockin_finish(to->at[k].lockin, &amplitude, &phase))
            *r = (struct lockin_result){r->number + 1, amplitude * unit, phase};
    }
}

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
NEVER_INLINE bool advance_through_fires(struct app *a, struct instant end, struct listening *to)
{
    struct fire f;
    while (mailbox_take_fire(&a->mailbox, end, &f)) {
        if (!plant_advance(&a->plant, f.at))
            return false;
        if (app_apply_fire(a, &f))
            to->n = 0;
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
static bool advance_tick(struct app *a, struct listening *to)
{
    struct instant end = {a->plant.now.tick + 1, 0};
    uint32_t switches = a->plant.counts.switches;
    bool capturing = is_capturing(a);
    if (!advance_through_fires(a, end, to) || !plant_advance(&a->plant, end))
        return false;
    if (to->n > 0)
        to->measure(to, &a->plant);
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

static bool advance_tick_by_tick(struct app *a, struct listening *to)
{
    bool codes = a->streaming >= APP_STREAMING_CODES;
    for (uint32_t i = 0; i < a->config.substeps; i++) {
        if (codes)
            app_apply_codes(a, i);
        if (!advance_tick(a, to))
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
    struct listening *to;
    const struct app_config *config;
};

/* A plant_look. */
static void witness_tick(void *witness, const struct plant *pl)
{
    const struct witness *w = witness;
    if (w->to->n > 0)
        w->to->measure(w->to, pl);
    w->config->observe(w->config->observer, pl);
}

/* The ticks of a frame: in one run where no fire, capture, watch or code may act in each of them. */
static bool advance_ticks(struct app *a, struct listening *to)
{
    struct witness witness = {to, &a->config};
    if (a->watch.active || a->mailbox.n_fires > 0 || is_capturing(a) || a->streaming >= APP_STREAMING_CODES)
        return advance_tick_by_tick(a, to);
    if (a->config.observe)
        return plant_run_seen(&a->plant, a->config.substeps, witness_tick, &witness);
    if (to->n > 0)
        return plant_run_seen(&a->plant, a->config.substeps, to->measure, to);
    return plant_run(&a->plant, a->config.substeps);
}

/* One frame of plant time. */
static void advance_frame(struct app *a)
{
    const struct plant_counts *n = &a->plant.counts;
    uint32_t budget = n->budget + n->work;
    struct listening to;
    app_apply_samples(a, a->plant.now.tick / a->config.substeps);
    listen(a, &to);
    bool finite = advance_ticks(a, &to);
    finish_windows(a, &to);
    if (!finite) {
        session_fault(a, FAULT_NOT_FINITE);
        return;
    }
    if (n->budget + n->work != budget)
        session_fault(a, FAULT_BUDGET);
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
        sense(a);
        a->step_left -= a->step_left > 0;
    }
    return advanced;
}
