/* sweep_point.c - see sweep_point.h. */
#include "host_sim/maps/sweep/sweep_point.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "host_sim/scene/plant_of_scene.h"
#include "host_sim/scene/scene_check.h"
#include "models/math/elementary.h"

#define TURN_RAD (2.0 * ELEMENTARY_PI)

/* The fewest ticks in a period of the reference, of the fastest drive and of the contact. While a point
 * settles they only keep switches apart that follow soon after each other, unless the error depends on the
 * step. Measuring needs more. */
struct density {
    double reference, drive, contact;
};
static const struct density coarse = {4.0, 4.0, 4.0}, fine = {96.0, 16.0, 32.0};

enum { TICKS_MAX = 4000000, /* in a period */ WINDOW_MAX = 1 << 30 /* a longer half is not doubled */ };

/* A free motion falls by e so many times, within these numbers of periods. */
static const double settle_falls = 9.2; /* 1e-4 is left */
static const double nudged = 1e-4;      /* share of the largest position; settling leaves 1e-8 */
static const double rounded = 1e-12;    /* ratio of two equal frequencies, less 1 */
enum { SETTLE_LEAST = 20, SETTLE_MOST = 20000 };

/* The scene at one point. */
struct setup {
    struct scene_point q;
    double period, fastest; /* period of the reference, s; the fastest drive, rad/s */
    bool beats;             /* a drive of another frequency than the reference sounds */
    double fall;            /* periods in which the slowest free motion falls by e */
};

int sweep_reference(const struct scene *s)
{
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    int slowest = -1;
    scenes_resolve(s, si, drive);
    for (int i = 0; i < s->model->n_inputs; i++)
        if (maps_sounds(&drive[i]) && (slowest < 0 || drive[i].omega < drive[slowest].omega))
            slowest = i;
    return slowest;
}

static void set_up(const struct sweep *s, const struct scene *scene, struct setup *u)
{
    point_of_scene(scene, &u->q);
    u->period = TURN_RAD / u->q.drive[s->reference].omega;
    u->fastest = 0.0;
    u->beats = false;
    for (int i = 0; i < scene->model->n_inputs; i++) {
        const struct harmonic *d = &u->q.drive[i];
        if (!maps_sounds(d))
            continue;
        u->fastest = fmax(u->fastest, d->omega);
        u->beats = u->beats || fabs(d->omega * u->period / TURN_RAD - 1.0) > rounded;
    }
    double rate = 0.5 * maps_damping(scene->model, u->q.p) / u->q.scale.time_s * u->period;
    u->fall = rate * SETTLE_MOST > 1.0 ? 1.0 / rate : SETTLE_MOST;
}

/* Periods of settling, a whole number of those of the subharmonics. */
static uint64_t settling(const struct sweep *s, const struct setup *u)
{
    double n = fmin(fmax(ceil(settle_falls * u->fall), SETTLE_LEAST), SETTLE_MOST);
    uint64_t periods = s->settle < 0 ? (uint64_t)n : (uint64_t)s->settle;
    return (periods + s->common - 1) / s->common * s->common;
}

/* Whole ticks in a period. They are at least those of the scene where the error depends on the step, or
 * where the method refuses a longer one. */
static double ticks_of(const struct sweep *s, const struct scene *scene, const struct setup *u,
                       const struct density *d)
{
    const struct model *m = scene->model;
    double turns = u->period / TURN_RAD;
    double n = fmax(d->reference, fmax(d->drive * u->fastest * turns,
                                       d->contact * m->eigenfrequency(u->q.p) / u->q.scale.time_s * turns));
    double h = u->period / ceil(n) / u->q.scale.time_s;
    if (s->m.method->order > 0 || s->m.method->refuse(m, u->q.p, h, s->m.tol))
        n = fmax(n, u->period / scene_check_step(scene) - 1e-9);
    return ceil(n);
}

/* Puts the plant into this state, with `ticks` ticks in a period. */
static const char *put_plant(struct sweep *s, const struct scene *scene, const struct setup *u, double ticks,
                             bool no_ledger, const struct sweep_state *at)
{
    const struct model *m = scene->model;
    double x[MODEL_STATES];
    struct plant_config c = plant_config_of_real_scene(scene, u->q.si, u->period / ticks, s->scratch);
    c.method = s->m.method;
    c.tol = s->m.tol;
    c.no_ledger = no_ledger;
    if (!(ticks <= TICKS_MAX))
        return "more than 4e6 steps in a period of the reference";
    const char *why = plant_init(&s->plant, &c);
    if (why)
        return why;
    for (int i = 0; i < m->n_inputs; i++)
        if (maps_sounds(&u->q.drive[i]))
            plant_drive_start(&s->plant, i, u->q.drive[i].amplitude, u->q.drive[i].omega / TURN_RAD,
                              turns_to_double(at->phase[i]) * TURN_RAD);
    for (int i = 0; i < m->n_states; i++)
        x[i] = at->x[i] / scale_of(&s->plant.scale, m->state_signal[i].quantity);
    plant_set_state(&s->plant, x);
    return NULL;
}

/* No real plant stays on a motion that is unstable, or exactly symmetric where it need not be. */
static void nudge(struct plant *pl)
{
    double x[MODEL_STATES], most = 0.0;
    memcpy(x, pl->x, sizeof x);
    for (int i = 0; i < pl->model->n_states / 2; i++)
        most = fmax(most, fabs(x[i]));
    x[0] += nudged * most;
    plant_set_state(pl, x);
}

static void scene_start(const struct scene *scene, const struct setup *u, struct sweep_state *at)
{
    double x[MODEL_STATES];
    scenes_begin(scene, u->q.si, u->q.drive, x);
    for (int i = 0; i < scene->model->n_states; i++)
        at->x[i] = x[i] * scale_of(&u->q.scale, scene->model->state_signal[i].quantity);
    for (int i = 0; i < scene->model->n_inputs; i++)
        at->phase[i] = turns_of(u->q.drive[i].phase / TURN_RAD);
}

/* The inputs where the drives have these phases. */
static void inputs_at(const struct setup *u, const struct model *m, const struct sweep_state *at,
                      struct input *input)
{
    struct harmonic drive[MODEL_INPUTS];
    for (int i = 0; i < m->n_inputs; i++) {
        drive[i] = u->q.drive[i];
        drive[i].phase = turns_to_double(at->phase[i]) * TURN_RAD;
    }
    scenes_inputs(m, &u->q.scale, drive, input);
}

static void leave(const struct scene *scene, const struct setup *u, const struct plant *pl,
                  struct sweep_state *at)
{
    struct input input[MODEL_INPUTS];
    for (int i = 0; i < pl->model->n_states; i++)
        at->x[i] = pl->x[i] * scale_of(&pl->scale, pl->model->state_signal[i].quantity);
    for (int i = 0; i < pl->model->n_inputs; i++)
        if (drive_active(&pl->drive[i]))
            at->phase[i] = pl->drive[i].carrier + pl->drive[i].offset;
    inputs_at(u, pl->model, at, input);
    scenes_show_state(scene, u->q.p, &u->q.scale, input, pl->x, at->shown);
}

void sweep_take_state(const struct sweep *s, const struct scene *scene, struct sweep_state *at)
{
    struct setup u;
    struct input input[MODEL_INPUTS];
    memcpy(at->x, at->shown, sizeof at->x);
    if (!scene->paper)
        return;
    set_up(s, scene, &u);
    inputs_at(&u, scene->model, at, input);
    scenes_take_state(scene, u.q.p, &u.q.scale, input, at->shown, at->x);
    for (int i = 0; i < scene->model->n_states; i++)
        at->x[i] *= scale_of(&u.q.scale, scene->model->state_signal[i].quantity);
}

/* ---- measuring ---- */

static void begin(const struct sweep *s, double ticks, int halves, const struct sweep_state *at,
                  struct sweep_meter *m)
{
    uint32_t harmonic[SWEEP_HARMONICS];
    uint64_t n = (uint64_t)ticks;
    for (int i = 0; i < s->n_harmonics; i++)
        harmonic[i] = s->harmonic[i].n * (s->common / s->harmonic[i].m);
    sweep_meter_start(m, (int)s->m.scene.observable, harmonic, s->n_harmonics, (int64_t)n * halves,
                      at->phase[s->reference] / s->common, UINT64_MAX / (n * s->common));
}

double sweep_largest(const struct sweep *s, const struct sweep_measured *y)
{
    const double rounding = 1e-12; /* share by which an output that stands still seems to move */
    double largest = rounding * fmax(fabs(y->lowest), fabs(y->highest));
    for (int i = 0; i < s->n_harmonics; i++)
        largest = fmax(largest, y->amplitude[i]);
    return largest;
}

double sweep_change(const struct sweep *s, const struct sweep_measured *a, const struct sweep_measured *b)
{
    double change = 0.0, largest = sweep_largest(s, b);
    for (int i = 0; i < s->n_harmonics; i++) {
        double re = b->amplitude[i] * cos(b->phase[i]) - a->amplitude[i] * cos(a->phase[i]);
        double im = b->amplitude[i] * sin(b->phase[i]) - a->amplitude[i] * sin(a->phase[i]);
        change = fmax(change, hypot(re, im));
    }
    return largest > 0.0 ? change / largest : 0.0;
}

/* ---- points ---- */

const char *sweep_check(struct sweep *s, const struct scene *scene)
{
    struct setup u;
    struct sweep_state at;
    int which;
    scenes_resolve(scene, u.q.si, u.q.drive);
    const char *why = plant_check(scene->model, u.q.si, &which);
    if (why)
        return why;
    if (!(u.q.drive[s->reference].omega > 0.0))
        return "the drive that counts the periods has no frequency there";
    set_up(s, scene, &u);
    for (int i = 0; i < scene->model->n_inputs; i++)
        if (fabs(u.q.drive[i].amplitude) >
            DRIVE_LIMIT * scale_of(&u.q.scale, scene->model->input_signal[i].quantity))
            return "a drive is above what a plant takes";
    scene_start(scene, &u, &at);
    why = put_plant(s, scene, &u, ticks_of(s, scene, &u, &fine), false, &at);
    return why ? why : put_plant(s, scene, &u, ticks_of(s, scene, &u, &coarse), true, &at);
}

const char *sweep_point(struct sweep *s, const struct scene *scene, double value,
                        const struct sweep_state *from, int times, struct sweep_result *r)
{
    struct setup u;
    struct sweep_meter m;
    struct sweep_measured first;
    set_up(s, scene, &u);
    *r = (struct sweep_result){.value = value, .escaped = true};
    if (from)
        r->end = *from;
    else
        scene_start(scene, &u, &r->end);
    double ticks = ticks_of(s, scene, &u, &coarse);
    const char *why = put_plant(s, scene, &u, ticks, true, &r->end);
    if (!why)
        nudge(&s->plant);
    if (why || !plant_run(&s->plant, (uint64_t)ticks * settling(s, &u)))
        return why;
    uint32_t unlocated = s->plant.counts.budget;
    leave(scene, &u, &s->plant, &r->end);
    ticks = ticks_of(s, scene, &u, &fine);
    why = put_plant(s, scene, &u, ticks, false, &r->end);
    if (why)
        return why;
    r->beats = u.beats;
    int half = s->measure / 2 * (r->beats ? 2 : 1); /* the squared window is wider */
    for (; r->beats && times > 1 && ticks * half < WINDOW_MAX; times /= 2)
        half *= 2;
    begin(s, ticks, half, &r->end, &m);
    m.beats = r->beats;
    if (!sweep_meter_run(&m, &s->plant, &first) || !sweep_meter_run(&m, &s->plant, &r->measured))
        return NULL;
    r->change = sweep_change(s, &first, &r->measured);
    r->settled = r->change / (1.0 - exp(-half / u.fall));
    r->unlocated = unlocated + s->plant.counts.budget;
    r->escaped = false;
    leave(scene, &u, &s->plant, &r->end);
    return NULL;
}
