/* choose_watch.c - the conditions under which a certificate is void, nearest first. Errors are carried over by their leading power: of a force law cut off after order n
 * they grow with amplitude^n relative to the motion, of rk4 with (h omega)^(5/2) where contact is lost, else ^4. */
#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "firmware/drive.h"
#include "host_sim/choose_parts.h"
#include "models/elementary.h"
#include "models/shaft_bearing.h"

enum { WORDS = 48 };

struct watched {
    struct choose_certificate *c;
    const struct choose_verdict *v;
    const struct choose_trial *t;
    double p[MODEL_DERIVED];
    struct harmonic drive[MODEL_INPUTS];
    struct scale scale;
};

enum { PENETRATION = 2 /* the output */ };

static const struct scene_watch unseen = {.on = 0.0};

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
    k[i].watch = watch;
    o->c->n_conditions++;
}

/* By what a quantity may grow until an error that goes with its n-th power reaches the tolerance. */
static double room(const struct watched *o, double error, double power)
{
    return error > 0.0 ? pow(o->c->scene.tolerance / error, 1.0 / power) : HUGE_VAL;
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

/* The force law: the compressions up to which it is good enough, within the contact. */
static void watch_law(struct watched *o)
{
    struct choose_certificate *c = o->c;
    double away = fmax(c->high - 1.0, 1.0 - c->low), factor = room(o, o->v->error, o->v->rung.order);
    if (!(away > 0.0))
        return;
    factor = fmin(factor, 1.0 / away);
    const struct scene_watch w = {.on = 1.0,
                                  .observable = PENETRATION,
                                  .above = (1.0 + factor * away) * o->scale.length_m,
                                  .below = (1.0 - factor * away) * o->scale.length_m,
                                  .promote = c->scene.model};
    const char *unit = scenes_dimensionless(&c->scene) ? "" : " m";
    add(o, factor, w,
        "penetration below %.4g%s or above %.4g%s: beyond, the error of the %s force law passes the "
        "tolerance",
        w.below, unit, w.above, unit, o->v->rung.order == 1 ? "linear" : "cubic");
}

static void watch_gaps(struct watched *o)
{
    const struct scene_watch w = {.on = 1.0,
                                  .observable = PENETRATION,
                                  .above = 0.0,
                                  .below = -SCENE_UNBOUNDED,
                                  .promote = o->c->scene.model};
    add(o, 1.0 / (1.0 + o->c->high), w, "penetration above 0 m: a gap closes, which this rung does not know");
}

static void watch_modes(struct watched *o)
{
    double dropped = 2.0 * o->v->predicted;
    if (dropped > 0.0)
        add(o, room(o, o->v->error, 1.0), unseen,
            "asymmetry or forces by which the dropped modes move more than %.2g of the one kept (now %.2g)",
            dropped * room(o, o->v->error, 1.0), dropped);
}

static void watch_drives(struct watched *o)
{
    const struct choose_facts *f = &o->c->facts;
    double step = scene_check_step(&o->t->scene), Hz = 0.0;
    char text[WORDS];
    for (int i = 0; i < o->v->rung.scene.model->n_inputs; i++)
        Hz = fabs(o->drive[i].amplitude) > 0.0 ? fmax(Hz, o->drive[i].omega / (2.0 * ELEMENTARY_PI)) : Hz;
    if (Hz > 0.0)
        add(o, 1.0 / (DRIVE_TICKS_MIN * step * Hz), unseen, "a drive of %s: " DRIVE_TICKS_TOO_FEW "it",
            frequency_above(o, 1.0 / (DRIVE_TICKS_MIN * step), text));
    if (o->v->rung.order == 3 && o->v->rung.scene.model->n_inputs == 1)
        add(o, f->fast / (3.0 * f->slow), unseen, "a slow %s: the fast drive is not fast beside it",
            frequency_above(o, f->fast / (6.0 * ELEMENTARY_PI * o->scale.time_s), text));
}

/* A step that is too long is so for the full model as well: nothing to climb to. What a method's guard refuses, the bus does. */
static void watch_step(struct watched *o)
{
    double power = o->c->loss > 0.0 && o->v->rung.scene.model->n_contacts > 0 ? 2.5 : 4.0;
    double rate = o->v->rung.scene.model->eigenfrequency(o->p) / o->scale.time_s / (2.0 * ELEMENTARY_PI);
    double factor = room(o, o->t->error, power);
    char text[WORDS];
    double limit = 0.2 / (rate * 2.0 * ELEMENTARY_PI * scene_check_step(&o->t->scene));
    const struct scene_watch w = {.on = factor < limit,
                                  .observable = MODEL_EIGENFREQUENCY,
                                  .above = as_given(o, rate * factor),
                                  .below = -SCENE_UNBOUNDED};
    if (choose_method[o->c->method]->order > 0)
        add(o, fmin(factor, limit), w, "an eigen%s (a stiffer contact, a lighter mass): the step is too long",
            frequency_above(o, rate * fmin(factor, limit), text));
    else if (o->v->rung.scene.model == o->c->scene.model && o->t->error > 0.0)
        add(o, o->c->scene.tolerance / o->t->error, unseen,
            "a motion that multiplies errors %.3g times more than this one",
            o->c->scene.tolerance / o->t->error);
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
    if (m == &shaft_bearing_linear && c->scene.model != m)
        watch_gaps(&o);
    else if (m == &shaft_bearing_mode && c->scene.model != m)
        watch_modes(&o);
    else if (o.v->rung.order > 0)
        watch_law(&o);
    watch_drives(&o);
    watch_step(&o);
    for (int i = c->n_conditions; i > 0; i--)
        c->watch = c->condition[i - 1].watch.on > 0.0 ? c->condition[i - 1].watch : c->watch;
}
