/* advance.c - one frame of plant time in an app in any state that the seams allow. Lock-in, capture, watch,
 * sensors, samples and FIREs use only what exists, and the seams hold again. A plant that advances may become
 * any plant (`plant`). A FIRE may bring any drives and settings (`arm`, `settings`). An operation on a burst
 * is defined and keeps its seam (`capture`).
 *
 * A lock-in with a window and one without are tried by themselves: else Eva would take the slots of the
 * latter for read. A call that makes up for several frames is several of these. */
#define plant_advance  plant_advance_in_proof
#define plant_run      plant_run_in_proof
#define plant_run_seen plant_run_seen_in_proof
#include "tests/eva/any_plant.h"
#undef plant_advance
#undef plant_run
#undef plant_run_seen
#define mailbox_take_fire   mailbox_take_fire_in_proof
#define mailbox_take_sample mailbox_take_sample_in_proof
#include "firmware/bus/mailbox.c"
#undef mailbox_take_fire
#undef mailbox_take_sample
#define app_apply_fire app_apply_fire_in_proof
#include "firmware/app/app_apply.c"
#undef app_apply_fire

#include "firmware/app/app_advance.h"
#include "firmware/app/telemetry_send.h"
#include "firmware/plant/plant_change.h"
#include "models/shaft_bearing.h"

bool plant_advance(struct plant *to_move, struct instant to);
bool plant_run(struct plant *to_move, uint64_t ticks);
bool plant_run_seen(struct plant *to_move, uint64_t ticks, plant_look *look, plant_look_ticks *several,
                    void *who);
bool mailbox_take_fire(struct mailbox *b, struct instant before, struct fire *f);
bool mailbox_take_sample(struct mailbox *b, uint64_t frame, int channel, struct sample *s);
bool app_apply_fire(struct app *a, const struct fire *f);

static struct app app;
static float memory[1];

/* ---- what other proofs have ---- */

/* Any plant of the same model. */
static void any_moment(struct plant *p)
{
    const struct model *m = p->model;
    *p = pl;
    p->model = m;
}

/* FIREs bring a set: the first one does, before plant time can fail, and others may follow. Else none
 * does. Between the two lies a frame that begins like the one and goes on like the other. */
static bool sets_come, set_has_come;

bool plant_advance(struct plant *to_move, struct instant to)
{
    bool finite = (sets_come && !set_has_come) || eva_bool();
    any_moment(to_move);
    to_move->now = to;
    if (!finite)
        to_move->now = (struct instant){eva_word(), eva_uint(0, TICK_FRACTIONS - 1)};
    return finite;
}

bool plant_run(struct plant *to_move, uint64_t ticks)
{
    return plant_advance(to_move, (struct instant){to_move->now.tick + ticks, 0});
}

static void look_at_block(const struct plant *seen, plant_look_ticks *several, void *who)
{
    static struct method_block b;
    eva_any(&b, sizeof b);
    /*@ loop unroll BLOCK_TICKS; */
    for (uint32_t from = 0; from < BLOCK_TICKS; from++)
        several(who, seen, &b, from, eva_uint(1, BLOCK_TICKS - from));
}

/* Any number of looks, each at another plant, and at any ticks of a block. */
bool plant_run_seen(struct plant *to_move, uint64_t ticks, plant_look *look, plant_look_ticks *several,
                    void *who)
{
    while (eva_bool()) {
        any_moment(to_move);
        look(who, to_move);
        if (several)
            look_at_block(to_move, several, who);
    }
    return plant_run(to_move, ticks);
}

/* See `climb`. */
const char *plant_promote(struct plant *to_climb, const struct model *to)
{
    (void)to_climb, (void)to;
    return NULL;
}

const char *plant_accepts(const struct plant *asked, const double *si)
{
    (void)asked, (void)si;
    return eva_bool() ? "a reason" : NULL;
}

const char *plant_could_climb(const struct plant *asked, const struct model *to, const double *si)
{
    (void)asked, (void)to, (void)si;
    return eva_bool() ? "a reason" : NULL;
}

const char *plant_change(struct plant *to_change, const double *si)
{
    (void)si;
    any_moment(to_change);
    return NULL;
}

bool app_apply_fire(struct app *a, const struct fire *f)
{
    (void)f;
    any_moment(&a->plant);
    any_burst(a);
    if (!sets_come)
        return false;
    set_has_come = true;
    any_settings(a);
    parameters_settings_changed(a);
    return true;
}

bool mailbox_take_fire(struct mailbox *b, struct instant before, struct fire *f)
{
    (void)before;
    b->n_fires = eva_uint(0, MAILBOX_FIRES);
    eva_any(f, sizeof *f);
    f->parameters = eva_bool();
    return (sets_come && !set_has_come) || eva_bool();
}

bool mailbox_take_sample(struct mailbox *b, uint64_t frame, int channel, struct sample *s)
{
    (void)frame, (void)channel;
    b->n_samples = eva_uint(0, MAILBOX_SAMPLES);
    eva_any(s, sizeof *s);
    return eva_bool();
}

void capture_add(struct capture *c, float *floats, const double *signal)
{
    double sum = 0.0;
    ASSERT(floats == memory && seam_burst(&app) && c == &app.capture);
    for (uint32_t i = 0; i < c->n_signals; i++)
        sum += signal[i];
    app.balance_residual_J = sum; /* they are all read */
    any_burst(&app);
}

void capture_trigger_now(struct capture *c, enum capture_trigger trigger, uint64_t tick)
{
    (void)tick;
    ASSERT(trigger < TRIGGERS && seam_burst(&app) && c == &app.capture);
    any_burst(&app);
}

void telemetry_reply(struct telemetry *t, const struct app *a, const struct message *command,
                     enum cause cause, unsigned index, uint64_t ticks_late)
{
    (void)t, (void)a, (void)command, (void)cause, (void)index, (void)ticks_late;
}

static void dac(struct plant *to_move, const int16_t *code)
{
    ASSERT(to_move == &app.plant && code >= app.mailbox.block.code[0]);
    eva_any(to_move->drive, sizeof to_move->drive);
}

static void adc(const struct plant *seen, int16_t *code)
{
    ASSERT(seen == &app.plant);
    code[0] = code[1] = (int16_t)Frama_C_interval(INT16_MIN, INT16_MAX);
}

static void change(struct stages *s, struct plant *to_change, const double *setting)
{
    (void)s, (void)to_change, (void)setting;
}

static const struct plant_stage_calls converters = {.change = change, .dac = dac, .adc = adc};

/* ---- any app ---- */

/* With a window or without. */
static void any_lockin(bool on)
{
    const struct model *m = app.plant.model;
    eva_any(&app.lockin, sizeof app.lockin);
    app.lockin.window.n_ticks = on ? eva_uint(1, UINT32_MAX) : 0;
    for (int i = 0; i < LOCKIN_SLOTS; i++) {
        app.lockin.slot[i].harmonic = (uint8_t)eva_uint(0, LOCKIN_HARMONICS);
        app.lockin.slot[i].drive = (uint8_t)eva_uint(0, (uint32_t)m->n_inputs - 1);
        app.lockin.slot[i].output = (uint8_t)eva_uint(0, (uint32_t)m->n_outputs - 1);
        app.lockin.slot[i].first = (uint8_t)eva_uint(0, (uint32_t)i);
    }
}

/* Each observable that watch_start takes, by itself. */
static void watch(const struct model *m)
{
    any_plant(m);
    /*@ loop unroll 40; */
    for (int i = -1; i <= MODEL_EIGENFREQUENCY + 1; i++) {
        struct watch w;
        const struct watch_limits limits = {i, 0.0, 1.0};
        if (watch_start(&w, &limits, m))
            continue;
        w.outside = eva_bool();
        w.tripped = eva_bool();
        (void)watch_tick(&w, &pl);
        (void)watch_read(&pl, i);
    }
}

static void any_app(const struct model *m, bool window, bool codes)
{
    any_plant(m);
    pl.tick_s = eva_between(1e-6 / 4096, 10.0);
    app.plant = pl;
    app.config.model = m;
    app.config.promote = NULL;
    any_codes(&app, &converters, codes);
    app.config.capture = memory;
    any_settings(&app);
    sensor_init(&app.sensor);
    app.sensor.newest = eva_uint(0, SENSOR_RING - 1);
    app.state = (enum plant_state)Frama_C_interval(STATE_OFF, STATE_FAULT);
    app.skip = 0;
    app.step_left = eva_word();
    app.mailbox.n_fires = eva_uint(sets_come, MAILBOX_FIRES);
    set_has_come = false;
    any_burst(&app);
    any_lockin(window);
    app.watch = (struct watch){.active = eva_bool(), .state = -1, .outside = eva_bool()};
}

static void frame(const struct model *m, bool window, bool sets, bool codes)
{
    sets_come = sets;
    any_app(m, window, codes);
    (void)app_advance(&app);
    ASSERT(seam_burst(&app) && seam_codes(&app));
    ASSERT(app.sensor.newest < SENSOR_RING);
    for (int i = 0; i < LOCKIN_SLOTS; i++)
        ASSERT(seam_lockin(&app, i));
}

/* A climb inside a frame, from any rung that can. Inputs stay as many, and outputs become no fewer. So a
 * burst that began with the rung's goes on with the full model's, and windows begin anew within the seam. */
static void climb(const struct model *m)
{
    if (!m->climb)
        return;
    ASSERT(m->full->n_inputs == m->n_inputs && m->full->n_outputs >= m->n_outputs);
    any_app(m, true, false);
    app.plant.model = m->full;
    parameters_settings_changed(&app);
    ASSERT(seam_burst(&app));
    for (int i = 0; i < LOCKIN_SLOTS; i++)
        ASSERT(seam_lockin(&app, i));
}

int main(void)
{
    /*@ loop unroll 14; */
    for (int i = 0; i < MODELS; i++) {
        climb(model_table[i]);
        watch(model_table[i]);
        if (model_table[i]->full)
            continue;
        frame(model_table[i], false, false, false);
        frame(model_table[i], false, true, false);
        frame(model_table[i], true, false, false);
        frame(model_table[i], true, true, false);
    }
    frame(&shaft_bearing, true, false, true);
    return 0;
}
