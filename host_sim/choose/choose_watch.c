/* choose_watch.c - see choose_watch.h. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "firmware/method/rk4.h"
#include "firmware/plant/drive.h"
#include "host_sim/choose/choose_beyond.h"
#include "host_sim/choose/choose_climb.h"
#include "host_sim/choose/choose_watch.h"
#include "host_sim/choose/choose_tell.h"
#include "models/afm_lever.h"
#include "models/math/elementary.h"
#include "models/shaft_bearing.h"

#define TURN_RAD (2.0 * ELEMENTARY_PI)

enum { WORDS = 48, BLANKS = 4, POSITION = SHAFT_OUTPUTS /* a mode's state */ };
#define FAR_GAP 10.0                /* times nearer: farther than any law is carried over */
static const double time_far = 1e6; /* times the time asked: no growth at all */

struct watched {
    struct choose_certificate *c;
    const struct choose_verdict *v;
    const struct choose_attempt *t;
    const struct model *m;
    bool dimensionless, series, touches;
    struct scene_point at;
    double rate_Hz, drive_Hz,
        drive_most_Hz; /* eigenfrequency; fastest drive, and the fastest that the step allows */
};

/* A condition that was found: how far it is, its watch, and the words for the blanks of its sentence. */
struct found {
    double factor;
    struct scene_watch watch; /* not on: the bus refuses it */
    char word[BLANKS][WORDS];
};

const char *const choose_guard_name[3] = {"not watched", "refused on the bus", "watched"};

static void fill(struct found *f, int blank, int digits, double value, const char *unit)
{
    snprintf(f->word[blank], WORDS, "%.*g%s", digits, value, unit);
}

static void limit(struct found *f, double observable, double below, double above, const struct model *promote)
{
    f->watch = (struct scene_watch){
        .on = true, .observable = observable, .below = below, .above = above, .promote = promote};
}

static const char *unit(const struct watched *o, const char *si)
{
    return o->dimensionless ? "" : si;
}

/* A frequency in Hz as the scene has it: dimensionless ones are angular. */
static double as_given(const struct watched *o, double Hz)
{
    return o->dimensionless ? TURN_RAD * Hz : Hz;
}

static void limit_frequency(const struct watched *o, struct found *f, double observable, double Hz)
{
    limit(f, observable, -SCENE_UNBOUNDED, as_given(o, Hz), NULL);
    fill(f, 0, 4, as_given(o, Hz), unit(o, " Hz"));
}

/* By what a quantity may grow until an error that goes with its n-th power reaches the tolerance. */
static double room(const struct watched *o, double error, double power)
{
    return error > 0.0 ? pow(o->c->scene.tolerance / error, 1.0 / power) : HUGE_VAL;
}

/* Any change but those that the sweep of the certified motion makes: one for each hold. */
static void limit_changes(const struct watched *o, struct found *f)
{
    const struct model *full = o->c->scene.model;
    limit(f, MODEL_CHANGES, -SCENE_UNBOUNDED, 2.0 * o->c->sweep.Hz.n, o->m == full ? NULL : full);
}

/* The compressions up to which the force law is good enough, within the contact. A motion that was good
 * enough beyond is the limit itself. */
static bool find_law(const struct watched *o, struct found *f)
{
    const struct choose_certificate *c = o->c;
    const double *reach = o->t->reach;
    double away = fmax(c->high - 1.0, 1.0 - c->low), unit_m = o->at.scale.length_m;
    if (!(away > 0.0))
        return false;
    bool linear = o->v->candidate.kind == KIND_LINEAR;
    double most = fmin(room(o, o->v->error, linear ? 1.0 : 3.0), 1.0 / away);
    bool beyond = reach[0] < 1.0 - most * away || reach[1] > 1.0 + most * away;
    f->factor = beyond ? 1.0 : most;
    limit(f, OUTPUT_PENETRATION, fmin(1.0 - most * away, reach[0]) * unit_m,
          fmax(1.0 + most * away, reach[1]) * unit_m, c->scene.model);
    fill(f, 0, 4, f->watch.below, unit(o, " m"));
    fill(f, 1, 4, f->watch.above, unit(o, " m"));
    snprintf(f->word[2], WORDS, "%s", linear ? "linear" : "cubic");
    snprintf(f->word[3], WORDS, "%s", beyond ? "may exceed" : "exceeds");
    return true;
}

/* Up to the first touch the linear model is the shaft itself. */
static bool find_gap(const struct watched *o, struct found *f)
{
    f->factor = 1.0 / (1.0 + o->c->high);
    limit(f, OUTPUT_PENETRATION, -SCENE_UNBOUNDED, 0.0, o->c->scene.model);
    return !o->touches;
}

/* Where some touching was good enough: up to what runs with larger drives found. */
static bool find_touch(const struct watched *o, struct found *f)
{
    double reach[2];
    if (!o->touches)
        return false;
    f->factor = choose_beyond(o->c, reach);
    limit(f, OUTPUT_PENETRATION, -SCENE_UNBOUNDED, reach[1] * o->at.scale.length_m, o->c->scene.model);
    fill(f, 0, 4, f->watch.above, " m");
    fill(f, 1, 3, f->factor, "");
    return true;
}

/* One mode: the kept one's motion up to which the others were found to matter less than the tolerance. */
static bool find_mode(const struct watched *o, struct found *f)
{
    double reach[2], now = fmax(-o->t->reach[0], o->t->reach[1]);
    if (!(now > 0.0))
        return false;
    fill(f, 1, 3, choose_beyond(o->c, reach), "");
    double most = fmax(-reach[0], reach[1]), most_m = most * o->at.scale.length_m;
    f->factor = most / now;
    limit(f, POSITION, -most_m, most_m, o->c->scene.model);
    fill(f, 0, 4, most_m, " m");
    return true;
}

/* The reduced model does not feel what moves the dropped modes. */
static bool find_dropped(const struct watched *o, struct found *f)
{
    double dropped = 2.0 * o->v->predicted;
    if (!(dropped > 0.0))
        return false;
    f->factor = room(o, o->v->error, 1.0);
    limit_changes(o, f);
    fill(f, 0, 2, dropped * f->factor, "");
    fill(f, 1, 2, dropped, "");
    return true;
}

static bool find_drive(const struct watched *o, struct found *f)
{
    f->factor = o->drive_most_Hz / o->drive_Hz;
    f->watch.on = false;
    fill(f, 0, 4, as_given(o, o->drive_most_Hz), unit(o, " Hz"));
    return o->drive_Hz > 0.0;
}

/* A third of the fast drive's frequency. */
static double slow_most_Hz(const struct watched *o)
{
    return o->c->facts.fast / (3.0 * TURN_RAD * o->at.scale.time_s);
}

static bool find_slow_motion(const struct watched *o, struct found *f)
{
    f->factor = slow_most_Hz(o) / o->rate_Hz;
    limit_frequency(o, f, MODEL_EIGENFREQUENCY, slow_most_Hz(o));
    return true;
}

/* A slow drive may have that third itself, to the last bits. */
static bool find_slow_drive(const struct watched *o, struct found *f)
{
    double Hz = fmax(slow_most_Hz(o), o->drive_Hz * (1.0 + 1e-9));
    f->factor = Hz / o->drive_Hz;
    limit_frequency(o, f, MODEL_DRIVE_FREQUENCY, Hz);
    return Hz < o->drive_most_Hz;
}

/* Without attraction: gaps down to which that is small enough. It grows with the inverse square of the gap,
 * its gradient with the cube. In contact no gap says how much it matters. */
static bool find_attraction(const struct watched *o, struct found *f)
{
    double closest = o->t->reach[0] * o->at.scale.length_m, times = fmin(room(o, o->t->error, 3.0), FAR_GAP);
    f->factor = times;
    limit(f, LEVER_GAP, closest / times, SCENE_UNBOUNDED, NULL);
    fill(f, 0, 4, f->watch.below, " m");
    return o->c->high < 0.0 && closest > 0.0;
}

/* The modes left out answer to drives near their own frequencies, to impacts, and to steps of a force. */
static bool find_fewer(const struct watched *o, struct found *f)
{
    f->factor = room(o, fmax(o->t->error, DBL_EPSILON), 1.0);
    limit_changes(o, f);
    fill(f, 0, 3, f->factor, "");
    return true;
}

/* A step that is too long is so for the full model as well. The bus refuses what a method's guard refuses. */
static bool find_step(const struct watched *o, struct found *f)
{
    bool lost = o->c->loss > 0.0 && o->m->n_contacts > 0,
         whole = choose_method[o->c->method] == &rk4_unlocated && o->m->linear;
    double grown = room(o, o->t->error, !lost ? 4.0 : whole ? 2.0 : 2.5);
    double guard = RK4_ANGLE_MAX / (o->rate_Hz * TURN_RAD * scene_check_step(&o->t->scene));
    if (choose_method[o->c->method] == &modal) { /* its guards have limits of their own */
        grown = room(o, o->t->error, 2.0);
        guard = HUGE_VAL;
    }
    f->factor = fmin(grown, guard);
    limit_frequency(o, f, MODEL_EIGENFREQUENCY, o->rate_Hz * f->factor);
    f->watch.on = grown < guard;
    return !o->series;
}

/* The state itself is off by then. Statistics do not part. */
static bool find_time(const struct watched *o, struct found *f)
{
    const struct choose_certificate *c = o->c;
    double growth = fmax(o->t->growth, c->growth), rate = CHOOSE_SPELLS * log(growth);
    f->factor = rate > 0.0 ? 1.0 + log(room(o, o->t->error, 1.0) / CHOOSE_ROOM) / rate : HUGE_VAL;
    limit(f, MODEL_TIME, -SCENE_UNBOUNDED, f->factor * c->scene.over, NULL);
    fill(f, 0, 4, f->watch.above, unit(o, " s"));
    fill(f, 1, 3, growth, "");
    fill(f, 2, 4, c->scene.over / CHOOSE_SPELLS, unit(o, " s"));
    return !c->statistics && f->factor < time_far;
}

static bool has_watch(const struct choose_certificate *c)
{
    for (int i = 0; i < c->n_conditions; i++)
        if (c->condition[i].guard == GUARD_WATCH)
            return true;
    return false;
}

/* The full model by taylor or exact has no other limit to its error over the time asked; any other choice
 * has this condition where no observable has a limit. */
static bool find_motion(const struct watched *o, struct found *f)
{
    f->factor = room(o, fmax(o->t->error, DBL_EPSILON), 1.0);
    limit_changes(o, f);
    fill(f, 0, 3, f->factor, "");
    return (o->m == o->c->scene.model && o->series) || !has_watch(o->c);
}

/* The name, the kinds of models that may have this condition, whether the choice has it, and its sentence:
 * blanks %1$s to %4$s. The last row asks what the others found. */
static const struct {
    const char *name;
    unsigned kinds;
    bool (*find)(const struct watched *o, struct found *f);
    const char *sentence;
} condition[] = {
    {"force law", KIND_LINEAR | KIND_AVERAGED, find_law,
     "penetration falls below %1$s or rises above %2$s: outside, the error of the %3$s force law %4$s the "
     "tolerance"},
    {"gap", KIND_GAPLESS, find_gap,
     "penetration rises above 0 m: a gap closes, and this reduced model has no gaps"},
    {"touch", KIND_GAPLESS, find_touch,
     "penetration rises above %1$s: no run went farther and kept the tolerance, with drives up to %2$s times "
     "as large"},
    {"mode", KIND_MODE, find_mode,
     "position leaves +-%1$s: no run went farther and kept the tolerance, with drives up to %2$s times as "
     "large"},
    {"dropped modes", KIND_MODE, find_dropped,
     "an asymmetry, a force elsewhere or another frequency moves the dropped modes more than %1$s times as "
     "far as the kept one (now %2$s)"},
    {"attraction", KIND_BARE, find_attraction,
     "gap falls below %1$s: there the attraction that this model leaves out may matter more than the "
     "tolerance"},
    {"fewer modes", KIND_FEWER, find_fewer,
     "drives or parameters change, and the modes left out then matter more than %1$s times as much"},
    {"drive frequency", KIND_ANY, find_drive, "a drive goes above %1$s: " DRIVE_TICKS_TOO_FEW "it"},
    {"averaged motion", KIND_AVERAGED, find_slow_motion,
     "the eigenfrequency rises above %1$s: the fast drive is not fast beside it"},
    {"averaged drive", KIND_AVERAGED, find_slow_drive,
     "a slow drive goes above %1$s: the fast drive is not fast beside it"},
    {"step", KIND_ANY, find_step,
     "the eigenfrequency rises above %1$s, by a stiffer contact or a lighter mass: the step is too long"},
    {"time", KIND_ANY, find_time,
     "the time rises above %1$s: errors that multiply by %2$s in %3$s reach the tolerance"},
    {"motion", KIND_ANY, find_motion,
     "drives or parameters change, and the error of the new motion is more than %1$s times this one's"},
};

/* Into its place: the nearest first. */
static void add(struct choose_certificate *c, const char *name, const char *sentence, const struct found *f)
{
    struct choose_condition *k = c->condition;
    int i = c->n_conditions;
    if (i == CHOOSE_CONDITIONS || !isfinite(f->factor))
        return;
    for (; i > 0 && k[i - 1].factor > f->factor; i--)
        k[i] = k[i - 1];
    k[i] = (struct choose_condition){
        .name = name, .factor = f->factor, .guard = f->watch.on ? GUARD_WATCH : GUARD_BUS, .watch = f->watch};
    choose_say(k[i].text, sentence, f->word[0], f->word[1], f->word[2], f->word[3]);
    c->n_conditions++;
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
        snprintf(k->text + n, CHOOSE_TEXT - n, "; no signal shows this, so any change%s counts",
                 c->sweep.Hz.n > 0 ? " but the sweep's" : "");
}

const struct scene_watch *choose_watched(const struct choose_certificate *c)
{
    return c->n_conditions > 0 && c->condition[0].guard == GUARD_WATCH ? &c->condition[0].watch : NULL;
}

void choose_watch(struct choose_certificate *c)
{
    if (c->choice < 0 || !c->met)
        return;
    struct watched o = {.c = c, .v = &c->verdict[c->choice], .drive_Hz = choose_swept_Hz(c)};
    o.t = &o.v->attempt[c->method];
    o.m = o.v->candidate.scene.model;
    o.series = choose_method[c->method]->order == 0;
    o.dimensionless = scenes_dimensionless(&o.t->scene);
    o.touches = c->high > 0.0 || o.t->reach[1] > 0.0;
    point_of_scene(&o.v->candidate.scene, &o.at);
    o.rate_Hz = o.m->eigenfrequency(o.at.p) / o.at.scale.time_s / TURN_RAD;
    o.drive_most_Hz = 1.0 / (DRIVE_TICKS_MIN * scene_check_step(&o.t->scene));
    for (int i = 0; i < o.m->n_inputs; i++)
        if (fabs(o.at.drive[i].amplitude) > 0.0)
            o.drive_Hz = fmax(o.drive_Hz, o.at.drive[i].omega / TURN_RAD);
    for (int i = 0; i < (int)(sizeof condition / sizeof condition[0]); i++) {
        struct found f = {.factor = HUGE_VAL};
        if ((condition[i].kinds & o.v->candidate.kind) && condition[i].find(&o, &f))
            add(c, condition[i].name, condition[i].sentence, &f);
    }
    put_first(c);
}
