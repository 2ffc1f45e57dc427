/* choose_climb.c - see choose_climb.h. */
#include <math.h>

#include "firmware/plant/drive.h"
#include "firmware/bus/settings.h"
#include "host_sim/choose/choose_climb.h"
#include "host_sim/choose/choose_run.h"
#include "host_sim/choose/choose_tell.h"
#include "host_sim/choose/choose_truth.h"
#include "host_sim/out/plural.h"

enum { ATTEMPTS = 24 /* runs of one method on one model */ };
static const double ticks_max = 4e7;                 /* in one run */
static const double tol_min = 1e-13, tol_max = 1e-2; /* range of taylor's tolerance */

double choose_swept_Hz(const struct choose_certificate *c)
{
    return c->sweep.Hz.n > 0 ? fmax(c->sweep.Hz.from, c->sweep.Hz.to) : 0.0;
}

/* A frame, of the real plant. */
static double frame_s(const struct scene *s)
{
    return s->frame_s / s->dilation;
}

static void find_work(const struct search *o, const struct scene *s, struct choose_work *w)
{
    struct scene_point at;
    point_of_scene(s, &at);
    *w = (struct choose_work){.scene = s};
    for (int i = 0; i < s->model->n_inputs; i++) {
        bool wakes = fabs(at.drive[i].amplitude) > 0.0 || s->drive[i].noise > 0.0;
        w->drives += wakes;
        w->moved |= wakes && s->model->input_signal[i].quantity != QUANTITY_FORCE;
    }
    w->switches = s->model->n_contacts > 0 ? o->c->switches / (choose_frames(s) * frame_s(s)) : 0.0;
}

void choose_price(const struct search *o, struct choose_attempt *t, int method)
{
    struct choose_work w;
    find_work(o, &t->scene, &w);
    w.series = t->series;
    for (int i = 0; i < CHOOSE_MACHINES; i++)
        t->cost[i] = choose_cost_step(&w, method, i);
}

double choose_frame_cost(const struct choose_attempt *t, int machine)
{
    return t->cost[machine] * t->scene.substeps;
}

double choose_rank(const struct choose_certificate *c, const struct choose_attempt *t, int method)
{
    double s = choose_time_s(t, method, c->machine);
    return s > 0.0 ? s : choose_frame_cost(t, c->machine);
}

double choose_time_s(const struct choose_attempt *t, int method, int machine)
{
    return choose_frame_cost(t, machine) * choose_machine[machine].ns[method] * 1e-9;
}

/* With the eigenfrequency omega, rk4's error goes with (h omega)^(5/2) where contact is lost, else with (h
 * omega)^4 (docs/why/accuracy.md). Motions that hardly have that frequency, or hardly touch the kink, have
 * these shares of it. A coarser step is refused without a run. */
static const double kink_share = 1e-3, smooth_share = 1e-4;

/* Does a Hertzian contact open? At a gap spring a step is cut, and keeps its order. */
static bool is_lost(const struct search *o, const struct scene *s)
{
    return s->model->n_contacts > 0 && !s->model->linear && o->c->loss > 0.0;
}

static double worth_trying(const struct search *o, const struct scene *s)
{
    double tol = o->c->scene.tolerance;
    struct scene_point at;
    point_of_scene(s, &at);
    double angle = is_lost(o, s) ? pow(tol / kink_share, 0.4) : pow(tol / smooth_share, 0.25);
    return s->model->eigenfrequency(at.p) / at.scale.time_s * frame_s(s) / angle;
}

static bool balances(const struct choose_attempt *t)
{
    return t->imbalance <= setting_table[SET_LEDGER_ALARM].initial;
}

/* After an error that is small enough, and an energy balance that is not. False when there is no finer
 * step. */
static bool rebalance(struct choose_attempt *t, int method, char why[SCENE_CHECK_REASON])
{
    struct scene *s = &t->scene;
    if (choose_method[method] == &taylor)
        s->tolerance = fmax(0.1 * s->tolerance, tol_min);
    return choose_allow(s, fmax(s->substeps + 1.0, 1.25 * s->substeps), why) > 0;
}

/* After an error that is too large: the next step or tolerance; false when there is none. */
static bool refine(const struct search *o, struct choose_attempt *t, int method, char why[SCENE_CHECK_REASON])
{
    struct scene *s = &t->scene;
    if (choose_meets(o, t->error))
        return rebalance(t, method, why);
    if (o->c->statistics) {
        snprintf(why, SCENE_CHECK_REASON, "a finer step does not help where statistics are compared");
        return false;
    }
    double wanted = o->c->scene.tolerance / CHOOSE_ROOM, n = s->substeps;
    if (choose_method[method] == &taylor) {
        s->tolerance *= 0.1;
        snprintf(why, SCENE_CHECK_REASON, "a tighter tolerance of the series does not help");
        return s->tolerance >= tol_min;
    }
    double order = choose_method[method] == &modal ? 2.0 : 4.0;
    double factor = isfinite(t->error) ? 0.9 * pow(t->error / wanted, 1.0 / order) : 1.5;
    if (n * fmax(factor, 1.0) > CHOOSE_SUBSTEPS) {
        snprintf(why, SCENE_CHECK_REASON, "it needs more than %d steps per frame", CHOOSE_SUBSTEPS);
        return false;
    }
    return choose_allow(s, fmax(n + 1.0, n * fmax(factor, 1.1)), why) > 0;
}

static double ticks(const struct scene *s)
{
    return choose_frames(s) * s->substeps;
}

/* One run; true when it meets the tolerance, and the energy balance of the bus stays quiet. */
static bool attempt(struct search *o, struct choose_attempt *t, int method)
{
    struct choose_record r;
    const char *why = choose_run(&t->scene, &o->c->sweep, 0.0, &r);
    t->error = why ? HUGE_VAL : choose_error(o, &r);
    t->growth = choose_growth(&r, &o->truth, o->c->span, choose_resolution(o->c));
    t->reach[0] = r.reach[0];
    t->reach[1] = r.reach[1];
    t->ns = r.ns;
    t->imbalance = r.imbalance;
    t->series = r.series;
    choose_price(o, t, method);
    choose_record_free(&r);
    return choose_meets(o, t->error) && balances(t);
}

/* Halves the range between a step that is too long and one that does. */
static void halve(struct search *o, struct choose_attempt *t, struct choose_attempt *failed, int method)
{
    char why[SCENE_CHECK_REASON];
    while (failed->error >= 0.0 && t->scene.substeps > 1.1 * failed->scene.substeps) {
        struct choose_attempt middle = *t;
        double n = floor(0.5 * (failed->scene.substeps + t->scene.substeps));
        if (n <= failed->scene.substeps || choose_allow(&middle.scene, n, why) >= (int)t->scene.substeps)
            return;
        choose_tell(o, "trying", &middle.scene);
        middle.met = attempt(o, &middle, method);
        if (middle.met) {
            *t = middle;
            continue;
        }
        if (!choose_meets(o, middle.error))
            t->coarser = middle.scene;
        *failed = middle;
    }
}

/* Series of other tolerances near by. A looser one may do; a tighter one may cost less, in few long
 * series. */
static void trim(struct search *o, struct choose_attempt *t, int method)
{
    static const double times[] = {5.6, 3.2, 1.8, 0.56, 0.32, 0.1};
    double met = t->scene.tolerance;
    for (int i = 0; i < (int)(sizeof times / sizeof times[0]); i++) {
        struct choose_attempt other = *t;
        other.scene.tolerance = times[i] * met;
        if (other.scene.tolerance < tol_min || other.scene.tolerance > tol_max)
            continue;
        if (attempt(o, &other, method) && choose_rank(o->c, &other, method) < choose_rank(o->c, t, method))
            *t = other;
    }
}

/* Why not coarser, or why not at all; what failed last has error >= 0. */
static void explain(const struct search *o, struct choose_attempt *t, struct choose_attempt *failed,
                    const char *why)
{
    if (t->met && failed->error >= 0.0 && choose_meets(o, failed->error))
        choose_say(t->why, "with %u per frame the energy balance%s is off by %.2g", failed->scene.substeps,
                   failed->scene.model->modal_form ? "" : ", by Simpson's rule,", failed->imbalance);
    else if (t->met && failed->error >= 0.0)
        choose_say(t->why, "with %u per frame%s the error is %.2g", failed->scene.substeps,
                   failed->scene.substeps < t->scene.substeps ? "" : " and a looser tolerance of the series",
                   failed->error);
    else if (t->met && t->scene.substeps <= 1.0)
        choose_say(t->why, "a step is a frame at most");
    else if (t->met && t->bound > 0.0)
        choose_say(t->why, "the error bound of its order%s asks for %g per frame",
                   is_lost(o, &t->scene) ? " across the contact's kink" : "", t->bound);
    else if (t->met)
        choose_say(t->why, "it would leave " DRIVE_TICKS_TOO_FEW "a drive, or pass the method's own limit");
    else {
        if (failed->error >= 0.0) {
            failed->coarser = t->coarser;
            *t = *failed;
        }
        choose_say(t->why, "%.200s", *why ? why : "no step met the tolerance");
    }
}

/* The coarsest step that may be tried; false: none, and why. *bound: below which the error bound refuses. */
static bool begin_steps(const struct search *o, struct scene *s, const struct method *m, double *bound,
                        char why[SCENE_CHECK_REASON])
{
    double least = fmax(DRIVE_TICKS_MIN * frame_s(s) * choose_swept_Hz(o->c), 1.0);
    int n = choose_allow(s, least, why);
    if (n == 0 || m->order == 0 || m == &modal)
        return n > 0;
    double worth = worth_trying(o, s);
    *bound = worth > n ? ceil(worth) : 0.0;
    return worth <= n || choose_allow(s, worth, why) > 0;
}

/* The coarsest step of a method that meets the tolerance, unless it costs more than `most`. */
void choose_climb(struct search *o, struct choose_verdict *v, int method, double most)
{
    struct choose_attempt *t = &v->attempt[method], failed = {.error = -1.0};
    char why[SCENE_CHECK_REASON] = "";
    const struct method *m = choose_method[method];
    t->scene = v->candidate.scene;
    t->scene.method = m->name;
    t->scene.tolerance = m == &taylor ? tol_max : t->scene.tolerance;
    bool go = begin_steps(o, &t->scene, m, &t->bound, why);
    for (int i = 0; i < ATTEMPTS && go && !t->met; i++) {
        t->series = (struct choose_series){.time = 0.0};
        choose_price(o, t, method);
        if (choose_rank(o->c, t, method) >= most || ticks(&t->scene) > ticks_max) {
            snprintf(why, sizeof why, "it needs at least %u step%s per frame, which cost more",
                     t->scene.substeps, plural(t->scene.substeps));
            break;
        }
        choose_tell(o, "trying", &t->scene);
        t->met = attempt(o, t, method);
        if (t->met)
            break;
        failed = *t;
        if (!choose_meets(o, t->error))
            t->coarser = t->scene;
        go = refine(o, t, method, why);
    }
    if (t->met)
        halve(o, t, &failed, method);
    if (t->met && m == &taylor)
        trim(o, t, method);
    explain(o, t, &failed, why);
}
