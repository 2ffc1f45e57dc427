/* sweep_point.c - one point of a sweep: settle, then measure; see sweep.h. */
#include "host_sim/sweep.h"

#include <math.h>
#include <string.h>
#include "firmware/lockin.h"
#include "host_sim/maps.h"
#include "host_sim/scene_check.h"
#include "models/elementary.h"

#define TURN_RAD (2.0 * ELEMENTARY_PI)

/* Fewest ticks in a period of the reference, of the fastest drive and of the contact. Where the error does not depend on the
 * step they need only keep contacts apart that switch soon after each other; measured are extremes and harmonics too. */
struct density {
    double reference, drive, contact;
};
static const struct density coarse = {8.0, 8.0, 4.0}, fine = {256.0, 16.0, 32.0};

enum { TICKS_MAX = 4000000 }; /* in a period */

/* The scene at one point. */
struct setup {
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct harmonic drive[MODEL_INPUTS];
    struct scale scale;
    double period, fastest; /* of the reference, s; of all drives, rad/s */
};

static bool sounds(const struct harmonic *d)
{
    return d->omega > 0.0 && (d->amplitude < 0.0 || d->amplitude > 0.0);
}

int sweep_reference(const struct scene *s)
{
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    int slowest = -1;
    scenes_resolve(s, si, drive);
    for (int i = 0; i < s->model->n_inputs; i++)
        if (sounds(&drive[i]) && (slowest < 0 || drive[i].omega < drive[slowest].omega))
            slowest = i;
    return slowest;
}

static void set_up(const struct sweep *s, const struct scene *scene, struct setup *u)
{
    scenes_resolve(scene, u->si, u->drive);
    scene->model->prepare(u->si, u->p, &u->scale);
    u->period = TURN_RAD / u->drive[s->reference].omega;
    u->fastest = 0.0;
    for (int i = 0; i < scene->model->n_inputs; i++)
        if (sounds(&u->drive[i]))
            u->fastest = fmax(u->fastest, u->drive[i].omega);
}

/* Whole ticks in a period: so many that the method takes the step; at least those of the scene where its error depends on it. */
static double ticks_of(const struct sweep *s, const struct scene *scene, const struct setup *u,
                       const struct density *d)
{
    const struct model *m = scene->model;
    double turns = u->period / TURN_RAD;
    double n = fmax(d->reference, fmax(d->drive * u->fastest * turns,
                                       d->contact * m->eigenfrequency(u->p) / u->scale.time_s * turns));
    double h = u->period / ceil(n) / u->scale.time_s;
    if (s->method->order > 0 || s->method->refuse(m, u->p, h, s->tol))
        n = fmax(n, u->period / scene_check_step(scene) - 1e-9);
    return ceil(n);
}

/* The plant in this state with `ticks` ticks in a period. */
static const char *place(struct sweep *s, const struct scene *scene, const struct setup *u, double ticks,
                         const struct sweep_state *at)
{
    const struct model *m = scene->model;
    double x[MODEL_STATES];
    const struct plant_config c = {.model = m,
                                   .si = u->si,
                                   .method = s->method,
                                   .tick_s = u->period / ticks,
                                   .dilation = 1.0,
                                   .tol = s->tol,
                                   .work = s->work};
    if (!(ticks <= TICKS_MAX))
        return "more than 4e6 steps in a period of the reference";
    const char *why = plant_init(&s->plant, &c);
    if (why)
        return why;
    for (int i = 0; i < m->n_inputs; i++)
        if (sounds(&u->drive[i]))
            plant_drive_start(&s->plant, i, u->drive[i].amplitude, u->drive[i].omega / TURN_RAD,
                              turns_to_double(at->phase[i]) * TURN_RAD);
    for (int i = 0; i < m->n_states; i++)
        x[i] = at->x[i] / scale_of(&s->plant.scale, m->state_signal[i].quantity);
    plant_set_state(&s->plant, x);
    return NULL;
}

static void scene_start(const struct scene *scene, const struct setup *u, struct sweep_state *at)
{
    double x[MODEL_STATES];
    scenes_begin(scene, u->si, u->drive, x);
    for (int i = 0; i < scene->model->n_states; i++)
        at->x[i] = x[i] * scale_of(&u->scale, scene->model->state_signal[i].quantity);
    for (int i = 0; i < scene->model->n_inputs; i++)
        at->phase[i] = turns_of(u->drive[i].phase / TURN_RAD);
}

static void leave(const struct plant *pl, struct sweep_state *at)
{
    for (int i = 0; i < pl->model->n_states; i++)
        at->x[i] = pl->x[i] * scale_of(&pl->scale, pl->model->state_signal[i].quantity);
    for (int i = 0; i < pl->model->n_inputs; i++)
        if (drive_active(&pl->drive[i]))
            at->phase[i] = pl->drive[i].carrier + pl->drive[i].offset;
}

/* ---- measuring ---- */

struct meter {
    struct lockin lockin[SWEEP_HARMONICS];
    double z[2][SWEEP_HARMONICS][2]; /* of the halves: amplitude and phase */
    int64_t n;                       /* ticks of a half */
    uint64_t start, step;            /* of the reference's phase over s->common */
};

static void begin(const struct sweep *s, double ticks, const struct sweep_state *at, struct meter *m)
{
    uint64_t n = (uint64_t)ticks;
    m->n = (int64_t)n * (s->measure / 2);
    m->start = at->phase[s->reference] / s->common;
    m->step = UINT64_MAX / (n * s->common);
    for (int i = 0; i < s->n_harmonics; i++)
        lockin_start(&m->lockin[i], (uint32_t)m->n, s->harmonic[i].n * (s->common / s->harmonic[i].m));
}

/* The largest contact force up to here: a touchdown forgets it, but a lift-off has told. */
static double peak_of(struct plant *pl)
{
    struct event e;
    double peak = pl->peak_force * pl->scale.force_N;
    while (plant_take_event(pl, &e))
        peak = fmax(peak, e.peak_force);
    return peak;
}

static void add(const struct sweep *s, struct meter *m, int half, int64_t tick, double y)
{
    double c, d;
    cos_sin_turns(m->start + (uint64_t)tick * m->step, &c, &d);
    for (int i = 0; i < s->n_harmonics; i++)
        (void)lockin_add(&m->lockin[i], y, c, d, &m->z[half][i][0], &m->z[half][i][1]);
}

/* Three samples of an output, the last one now. */
struct trace {
    double y[3];
};

/* A sample more: the top of the parabola through three, where the middle one is the highest or lowest, else the last one. */
static double top(struct trace *t, double y)
{
    t->y[0] = t->y[1], t->y[1] = t->y[2], t->y[2] = y;
    double before = t->y[1] - t->y[0], after = t->y[2] - t->y[1], slope = 0.5 * (before + after);
    bool turns = (before > 0.0 && after <= 0.0) || (before < 0.0 && after >= 0.0);
    return turns ? t->y[1] - 0.5 * slope * slope / (after - before) : y;
}

/* One half; what is told in *r is of this half. */
static bool measure(struct sweep *s, struct meter *m, int half, struct sweep_result *r)
{
    enum { FORCE = 3 }; /* of every model's outputs, see models/model.h */
    struct plant *pl = &s->plant;
    double output[MODEL_OUTPUTS];
    int asked = (int)s->scene.observable;
    plant_output(pl, output);
    struct trace y = {{output[asked], output[asked], output[asked]}},
                 force = {{output[FORCE], output[FORCE], output[FORCE]}};
    r->mean = r->peak_force = pl->peak_force = pl->loss_time = pl->total_time = 0.0;
    r->lowest = (double)INFINITY;
    r->highest = -(double)INFINITY;
    for (int64_t i = 1; i <= m->n; i++) {
        if (!plant_run(pl, 1))
            return false;
        plant_output(pl, output);
        double extreme = top(&y, output[asked]);
        add(s, m, half, half * m->n + i, output[asked]);
        r->mean += output[asked] / (double)m->n;
        r->lowest = fmin(r->lowest, extreme);
        r->highest = fmax(r->highest, extreme);
        r->peak_force = fmax(r->peak_force, fmax(peak_of(pl), top(&force, output[FORCE])));
    }
    r->out_of_contact = pl->loss_time / pl->total_time;
    return true;
}

static void compare(const struct sweep *s, const struct meter *m, struct sweep_result *r)
{
    double change = 0.0, largest = 0.0;
    for (int i = 0; i < s->n_harmonics; i++) {
        const double *a = m->z[0][i], *b = m->z[1][i];
        r->amplitude[i] = b[0];
        r->phase[i] = b[1];
        change =
            fmax(change, hypot(b[0] * cos(b[1]) - a[0] * cos(a[1]), b[0] * sin(b[1]) - a[0] * sin(a[1])));
        largest = fmax(largest, b[0]);
    }
    r->settled = largest > 0.0 ? change / largest : 0.0;
}

/* ---- points ---- */

const char *sweep_check(struct sweep *s, const struct scene *scene)
{
    struct setup u;
    struct sweep_state at;
    int which;
    scenes_resolve(scene, u.si, u.drive);
    const char *why = plant_check(scene->model, u.si, &which);
    if (why)
        return why;
    if (!(u.drive[s->reference].omega > 0.0))
        return "the drive that counts the periods has no frequency there";
    set_up(s, scene, &u);
    for (int i = 0; i < scene->model->n_inputs; i++)
        if (fabs(u.drive[i].amplitude) >
            DRIVE_LIMIT * scale_of(&u.scale, scene->model->input_signal[i].quantity))
            return "a drive is above what a plant takes";
    scene_start(scene, &u, &at);
    why = place(s, scene, &u, ticks_of(s, scene, &u, &fine), &at);
    return why ? why : place(s, scene, &u, ticks_of(s, scene, &u, &coarse), &at);
}

const char *sweep_point(struct sweep *s, const struct scene *scene, double value,
                        const struct sweep_state *from, struct sweep_result *r)
{
    struct setup u;
    struct meter m;
    set_up(s, scene, &u);
    *r = (struct sweep_result){.value = value, .escaped = true};
    if (from)
        r->end = *from;
    else
        scene_start(scene, &u, &r->end);
    double ticks = ticks_of(s, scene, &u, &coarse);
    const char *why = place(s, scene, &u, ticks, &r->end);
    maps_drop_books(&s->plant);
    if (why || !plant_run(&s->plant, (uint64_t)ticks * (uint64_t)s->settle))
        return why;
    uint32_t unlocated = s->plant.counts.budget;
    leave(&s->plant, &r->end);
    ticks = ticks_of(s, scene, &u, &fine);
    why = place(s, scene, &u, ticks, &r->end);
    if (why)
        return why;
    begin(s, ticks, &r->end, &m);
    if (!measure(s, &m, 0, r) || !measure(s, &m, 1, r))
        return NULL;
    compare(s, &m, r);
    r->unlocated = unlocated + s->plant.counts.budget;
    r->escaped = false;
    leave(&s->plant, &r->end);
    return NULL;
}
