/* choose_watch.c - the conditions under which a certificate is void, and who sees each of them.
 *
 * A condition is a limit on an observable wherever one covers it. What no observable shows, because the rung has no trace of it or
 * because it is about motions that nobody has run, is watched as any change: the certificate is of the scene's own motion.
 *
 * Errors are carried over by their leading power: of a force law cut off after order n they grow with amplitude^n relative to the
 * motion, of rk4 with (h omega)^(5/2) where contact is lost, else ^4. Over time they grow on as in the second half of the time asked,
 * exponentially: those of the choice, or neighbouring full motions where these grow faster, for a part too small to be seen yet. How
 * far a one-mode rung is good is found by runs (choose_beyond.c). */
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "firmware/plant/drive.h"
#include "host_sim/choose/choose_steps.h"
#include "models/math/elementary.h"
#include "models/shaft_bearing.h"

enum { WORDS = 48 };
static const double time_far = 1e6; /* times the time asked: no growth at all */

struct watched {
    struct choose_certificate *c;
    const struct choose_verdict *v;
    const struct choose_trial *t;
    double p[MODEL_DERIVED];
    struct harmonic drive[MODEL_INPUTS];
    struct scale scale;
};

enum { PENETRATION = 2 /* the output */, POSITION = SHAFT_OUTPUTS /* of a mode, the state */ };

const char *const choose_guard_name[3] = {"not watched", "refused on the bus", "watched"};

/* What the bus refuses. */
static const struct scene_watch refused = {.on = false};

static void add(struct watched *o, double factor, struct scene_watch watch, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
static void add(struct watched *o, double factor, struct scene_watch watch, const char *format, ...)
{
    struct choose_condition *k = o->c->condition;
    int i = o->c->n_conditions;
    if (i == CHOOSE_CONDITIONS || !isfinite(factor))
        return;
    for (; i > 0 && k[i - 1].factor > factor; i--)
        k[i] = k[i - 1];
    va_list a;
    va_start(a, format);
    vsnprintf(k[i].text, CHOOSE_TEXT, format, a);
    va_end(a);
    k[i].factor = factor;
    k[i].guard = watch.on ? GUARD_WATCH : GUARD_BUS;
    k[i].watch = watch;
    o->c->n_conditions++;
}

/* By what a quantity may grow until an error that goes with its n-th power reaches the tolerance. */
static double room(const struct watched *o, double error, double power)
{
    return error > 0.0 ? pow(o->c->scene.tolerance / error, 1.0 / power) : HUGE_VAL;
}

/* Any change, but those that the sweep of the certified motion makes: one for each hold. */
static struct scene_watch any_change(const struct watched *o)
{
    const struct model *full = o->c->scene.model;
    return (struct scene_watch){.on = true,
                                .observable = MODEL_CHANGES,
                                .above = 2.0 * o->c->sweep.steps,
                                .below = -SCENE_UNBOUNDED,
                                .promote = o->v->rung.scene.model == full ? NULL : full};
}

/* A frequency in Hz as the scene has it: dimensionless ones are angular. */
static double as_given(const struct watched *o, double Hz)
{
    return scenes_dimensionless(&o->t->scene) ? 2.0 * ELEMENTARY_PI * Hz : Hz;
}

static const char *frequency_above(const struct watched *o, double Hz, char text[WORDS])
{
    snprintf(text, WORDS, "frequency above %.4g%s", as_given(o, Hz),
             scenes_dimensionless(&o->t->scene) ? "" : " Hz");
    return text;
}

/* The force law: the compressions up to which it is good enough, within the contact. A motion that was good enough beyond is the limit
 * itself. */
static void watch_law(struct watched *o)
{
    struct choose_certificate *c = o->c;
    const double *reach = o->t->reach;
    double away = fmax(c->high - 1.0, 1.0 - c->low), factor = room(o, o->v->error, o->v->rung.order);
    if (!(away > 0.0))
        return;
    factor = fmin(factor, 1.0 / away);
    bool beyond = reach[0] < 1.0 - factor * away || reach[1] > 1.0 + factor * away;
    const struct scene_watch w = {.on = true,
                                  .observable = PENETRATION,
                                  .above = fmax(1.0 + factor * away, reach[1]) * o->scale.length_m,
                                  .below = fmin(1.0 - factor * away, reach[0]) * o->scale.length_m,
                                  .promote = c->scene.model};
    const char *unit = scenes_dimensionless(&c->scene) ? "" : " m";
    add(o, beyond ? 1.0 : factor, w,
        "penetration below %.4g%s or above %.4g%s: beyond%s, the error of the %s force law passes the "
        "tolerance",
        w.below, unit, w.above, unit, beyond ? " this motion" : "",
        o->v->rung.order == 1 ? "linear" : "cubic");
}

/* Up to the first touch the linear rung is the shaft itself; where some was allowed, up to what was found. */
static void watch_gaps(struct watched *o)
{
    double reach[2];
    struct scene_watch w = {
        .on = true, .observable = PENETRATION, .below = -SCENE_UNBOUNDED, .promote = o->c->scene.model};
    if (!(o->c->high > 0.0 || o->t->reach[1] > 0.0)) {
        add(o, 1.0 / (1.0 + o->c->high), w,
            "penetration above 0 m: a gap closes, which this rung does not know");
        return;
    }
    double times = choose_beyond(o->c, reach);
    w.above = reach[1] * o->scale.length_m;
    add(o, times, w,
        "penetration above %.4g m: beyond what runs with drives up to %.3g times as large found good",
        w.above, times);
}

/* The dropped modes: the kept one's motion up to which they were found to matter less than the tolerance. What else may move them, it
 * does not feel. */
static void watch_modes(struct watched *o)
{
    double reach[2], dropped = 2.0 * o->v->predicted, more = room(o, o->v->error, 1.0);
    double times = choose_beyond(o->c, reach), limit = fmax(-reach[0], reach[1]),
           now = fmax(-o->t->reach[0], o->t->reach[1]);
    const struct scene_watch w = {.on = true,
                                  .observable = POSITION,
                                  .above = limit * o->scale.length_m,
                                  .below = -limit * o->scale.length_m,
                                  .promote = o->c->scene.model};
    if (now > 0.0)
        add(o, limit / now, w,
            "position beyond +-%.4g m: beyond what runs with drives up to %.3g times as large found good",
            w.above, times);
    if (dropped > 0.0)
        add(o, more, any_change(o),
            "asymmetry, or forces elsewhere or of other frequency, by which the dropped modes move more than "
            "%.2g of the one kept (now %.2g)",
            dropped * more, dropped);
}

/* What an averaged rung's fast drive is fast beside: a third of it, which a slow drive may have to the last bits. */
static void watch_average(struct watched *o, double slow_Hz, double most_Hz)
{
    double rate = o->v->rung.scene.model->eigenfrequency(o->p) / o->scale.time_s / (2.0 * ELEMENTARY_PI);
    double limit = o->c->facts.fast / (6.0 * ELEMENTARY_PI * o->scale.time_s);
    double slow = fmax(limit, slow_Hz * (1.0 + 1e-9));
    struct scene_watch w = {.on = true,
                            .observable = MODEL_EIGENFREQUENCY,
                            .above = as_given(o, limit),
                            .below = -SCENE_UNBOUNDED};
    char text[WORDS];
    add(o, limit / rate, w, "an eigen%s: the fast drive is not fast beside it",
        frequency_above(o, limit, text));
    w.observable = MODEL_DRIVE_FREQUENCY;
    w.above = as_given(o, slow);
    if (slow < most_Hz)
        add(o, slow / slow_Hz, w, "a slow drive of %s: the fast drive is not fast beside it",
            frequency_above(o, slow, text));
}

static void watch_drives(struct watched *o)
{
    const struct model *m = o->v->rung.scene.model;
    double Hz = choose_swept_Hz(o->c), most = 1.0 / (DRIVE_TICKS_MIN * scene_check_step(&o->t->scene));
    char text[WORDS];
    for (int i = 0; i < m->n_inputs; i++)
        Hz = fabs(o->drive[i].amplitude) > 0.0 ? fmax(Hz, o->drive[i].omega / (2.0 * ELEMENTARY_PI)) : Hz;
    if (Hz > 0.0)
        add(o, most / Hz, refused, "a drive of %s: " DRIVE_TICKS_TOO_FEW "it",
            frequency_above(o, most, text));
    if (o->v->rung.order == 3 && m->n_inputs == 1)
        watch_average(o, Hz, most);
}

/* A step that is too long is so for the full model as well: nothing to climb to. What a method's guard refuses, the bus does. */
static void watch_step(struct watched *o)
{
    const struct model *m = o->v->rung.scene.model;
    bool lost = o->c->loss > 0.0 && m->n_contacts > 0;
    double switched = choose_method[o->c->method] == &rk4_unlocated && m->linear ? 2.0 : 2.5,
           power = lost ? switched : 4.0;
    double rate = o->v->rung.scene.model->eigenfrequency(o->p) / o->scale.time_s / (2.0 * ELEMENTARY_PI);
    double factor = room(o, o->t->error, power);
    char text[WORDS];
    double limit = RK4_ANGLE_MAX / (rate * 2.0 * ELEMENTARY_PI * scene_check_step(&o->t->scene));
    const struct scene_watch w = {.on = factor < limit,
                                  .observable = MODEL_EIGENFREQUENCY,
                                  .above = as_given(o, rate * factor),
                                  .below = -SCENE_UNBOUNDED};
    if (choose_method[o->c->method]->order > 0)
        add(o, fmin(factor, limit), w, "an eigen%s (a stiffer contact, a lighter mass): the step is too long",
            frequency_above(o, rate * fmin(factor, limit), text));
}

/* Nothing to climb to: the state itself is off by then. Statistics do not part. */
static void watch_time(struct watched *o)
{
    const struct choose_certificate *c = o->c;
    double growth = fmax(o->t->growth, c->growth), rate = CHOOSE_SPELLS * log(growth),
           more = room(o, o->t->error, 1.0);
    double times = rate > 0.0 ? 1.0 + log(more / CHOOSE_ROOM) / rate : HUGE_VAL;
    const struct scene_watch w = {
        .on = true, .observable = MODEL_TIME, .above = times * c->scene.over, .below = -SCENE_UNBOUNDED};
    if (!c->statistics && times < time_far)
        add(o, times, w, "time above %.4g%s: errors that multiply by %.3g in %.4g reach the tolerance",
            w.above, scenes_dimensionless(&c->scene) ? "" : " s", growth, c->scene.over / CHOOSE_SPELLS);
}

static bool has_watch(const struct choose_certificate *c)
{
    for (int i = 0; i < c->n_conditions; i++)
        if (c->condition[i].guard == GUARD_WATCH)
            return true;
    return false;
}

/* Motions that nobody has run. The full model by taylor or exact has no other limit to its error over the time asked; for any other
 * choice this stands where no observable has one. */
static void watch_motion(struct watched *o)
{
    const struct choose_certificate *c = o->c;
    bool full = o->v->rung.scene.model == c->scene.model, series = choose_method[c->method]->order == 0;
    double more = room(o, fmax(o->t->error, DBL_EPSILON), 1.0);
    if ((full && series) || !has_watch(c))
        add(o, more, any_change(o),
            "another motion, of other drives or parameters, with an error %.3g times this one's", more);
}

/* The nearest condition that the bus does not refuse is watched and goes before the others. */
static void put_first(struct choose_certificate *c)
{
    struct choose_condition *k = c->condition, first;
    int i = 0;
    while (k[i].guard != GUARD_WATCH)
        i++;
    first = k[i];
    memmove(k + 1, k, (size_t)i * sizeof *k);
    k[0] = first;
    for (i = 1; i < c->n_conditions; i++)
        k[i].guard = k[i].guard == GUARD_WATCH ? GUARD_NONE : k[i].guard;
    size_t n = strlen(k->text);
    if ((int)k->watch.observable == MODEL_CHANGES)
        snprintf(k->text + n, CHOOSE_TEXT - n, ": any change%s counts as such",
                 c->sweep.steps > 0 ? " but the sweep" : "");
}

const struct scene_watch *choose_watched(const struct choose_certificate *c)
{
    return c->n_conditions > 0 && c->condition[0].guard == GUARD_WATCH ? &c->condition[0].watch : NULL;
}

void choose_watch(struct choose_certificate *c)
{
    double si[MODEL_PARAMETERS];
    if (c->rung < 0 || !c->met)
        return;
    struct watched o = {.c = c, .v = &c->verdict[c->rung]};
    const struct model *m = o.v->rung.scene.model;
    o.t = &o.v->trial[c->method];
    scenes_resolve(&o.v->rung.scene, si, o.drive);
    m->prepare(si, o.p, &o.scale);
    if (o.v->rung.order > 0 && m->n_states > 2)
        watch_gaps(&o);
    else if (o.v->rung.mode > 0)
        watch_modes(&o);
    else if (o.v->rung.order > 0)
        watch_law(&o);
    watch_drives(&o);
    watch_step(&o);
    watch_time(&o);
    watch_motion(&o);
    put_first(c);
}
