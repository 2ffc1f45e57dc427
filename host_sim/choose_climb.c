/* choose_climb.c - a method on a rung: its cost, and the coarsest step that keeps the tolerance; see choose.h. */
#include <math.h>

#include "firmware/drive.h"
#include "firmware/settings.h"
#include "host_sim/choose_parts.h"
#include "models/elementary.h"

enum { ATTEMPTS = 24 /* runs of one method on one rung */ };
static const double ticks_max = 4e7;                 /* in one run */
static const double tol_min = 1e-13, tol_max = 1e-2; /* of taylor */

double choose_swept_Hz(const struct choose_certificate *c)
{
    return c->sweep.steps > 0 ? fmax(c->sweep.from_Hz, c->sweep.to_Hz) : 0.0;
}

/* A frame, of the real plant. */
static double frame_s(const struct scene *s)
{
    return s->frame_s / s->dilation;
}

static void find_work(const struct search *o, const struct scene *s, struct choose_work *w)
{
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    scenes_resolve(s, si, drive);
    *w = (struct choose_work){.scene = s};
    for (int i = 0; i < s->model->n_inputs; i++) {
        bool wakes = fabs(drive[i].amplitude) > 0.0 || s->drive[i].noise > 0.0;
        w->drives += wakes;
        w->moved |= wakes && s->model->input_signal[i].quantity != QUANTITY_FORCE;
    }
    w->switches = s->model->n_contacts > 0 ? o->c->switches / (choose_frames(s) * frame_s(s)) : 0.0;
}

void choose_price(const struct search *o, struct choose_trial *t, int method)
{
    struct choose_work w;
    find_work(o, &t->scene, &w);
    w.series = t->series;
    for (int i = 0; i < CHOOSE_MACHINES; i++)
        t->cost[i] = choose_cost_step(&w, method, i);
}

double choose_frame_cost(const struct choose_trial *t, int machine)
{
    return t->cost[machine] * t->scene.substeps;
}

/* What rungs are ranked by: time on the machine, instructions where that is not known. */
double choose_rank(const struct choose_certificate *c, const struct choose_trial *t, int method)
{
    double s = choose_time_s(t, method, c->machine);
    return s > 0.0 ? s : choose_frame_cost(t, c->machine);
}

double choose_time_s(const struct choose_trial *t, int method, int machine)
{
    return choose_frame_cost(t, machine) * choose_machine[machine].ns[method] * 1e-9;
}

/* rk4's error where contact is lost is about (h omega)^(5/2), else at least a thousandth of (h omega)^4 (firmware/auto.c,
 * docs/ACCURACY.md): a step below which there is no use in trying. */
static double worth_trying(const struct search *o, const struct scene *s)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], tol = o->c->scene.tolerance;
    struct harmonic drive[MODEL_INPUTS];
    struct scale scale;
    scenes_resolve(s, si, drive);
    s->model->prepare(si, p, &scale);
    double rate =
        fmax(s->model->eigenfrequency(p) / scale.time_s, 2.0 * ELEMENTARY_PI * choose_swept_Hz(o->c));
    for (int i = 0; i < s->model->n_inputs; i++)
        rate = fmax(rate, fabs(drive[i].amplitude) > 0.0 ? drive[i].omega : 0.0);
    bool lost = s->model->n_contacts > 0 && o->c->loss > 0.0;
    double angle = lost ? pow(100.0 * tol, 0.4) : pow(1000.0 * tol, 0.25);
    return rate * frame_s(s) / angle;
}

static bool balances(const struct choose_trial *t)
{
    return t->imbalance <= setting_table[SET_LEDGER_ALARM].initial;
}

/* After an error that is small enough, but an energy balance that is not, the ledger's fault or the method's: false when there
 * is no finer step. */
static bool rebalance(struct choose_trial *t, int method, char why[SCENE_CHECK_REASON])
{
    struct scene *s = &t->scene;
    if (choose_method[method] == &taylor)
        s->tolerance = fmax(0.1 * s->tolerance, tol_min);
    return choose_allow(s, fmax(s->substeps + 1.0, 1.25 * s->substeps), why) > 0;
}

/* After an error that is too large: the next step or tolerance; false when there is none. */
static bool refine(const struct search *o, struct choose_trial *t, int method, char why[SCENE_CHECK_REASON])
{
    struct scene *s = &t->scene;
    if (choose_meets(o, t->error))
        return rebalance(t, method, why);
    if (o->c->statistics) {
        snprintf(why, SCENE_CHECK_REASON, "a finer step does not help: the motion is chaotic");
        return false;
    }
    double wanted = o->c->scene.tolerance / CHOOSE_ROOM, n = s->substeps;
    if (choose_method[method] == &taylor) {
        s->tolerance *= 0.1;
        snprintf(why, SCENE_CHECK_REASON, "tighter series do not help");
        return s->tolerance >= fmax(tol_min, 1e-5 * o->c->scene.tolerance);
    }
    double factor = isfinite(t->error) ? 0.9 * pow(t->error / wanted, 0.25) : 1.5;
    if (n * fmax(factor, 1.0) > CHOOSE_SUBSTEPS) {
        snprintf(why, SCENE_CHECK_REASON, "more than %d substeps would be needed", CHOOSE_SUBSTEPS);
        return false;
    }
    return choose_allow(s, fmax(n + 1.0, n * fmax(factor, 1.1)), why) > 0;
}

static double ticks(const struct scene *s)
{
    return choose_frames(s) * s->substeps;
}

/* One run; true when it meets the tolerance, and the energy balance of the bus stays quiet. */
static bool attempt(struct search *o, struct choose_trial *t, int method)
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

/* The coarsest step of a method that meets the tolerance, unless it costs more than `most`. */
void choose_climb(struct search *o, struct choose_verdict *v, int method, double most)
{
    struct choose_trial *t = &v->trial[method], failed = {.error = -1.0};
    char why[SCENE_CHECK_REASON] = "";
    const struct method *m = choose_method[method];
    t->scene = v->rung.scene;
    t->scene.method = m->name;
    t->scene.tolerance = m == &taylor ? fmin(fmax(t->scene.tolerance, tol_min), tol_max) : t->scene.tolerance;
    double least = fmax(DRIVE_TICKS_MIN * frame_s(&t->scene) * choose_swept_Hz(o->c),
                        m->order > 0 ? worth_trying(o, &t->scene) : 1.0);
    bool go = choose_allow(&t->scene, least, why) > 0;
    for (int i = 0; i < ATTEMPTS && go && !t->met; i++) {
        t->series = (struct taylor_count){.time = 0.0};
        choose_price(o, t, method);
        if (choose_rank(o->c, t, method) >= most || ticks(&t->scene) > ticks_max) {
            snprintf(why, sizeof why, "%g substeps, which it needs at least, cost more", t->scene.substeps);
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
    if (t->met && failed.error >= 0.0 && choose_meets(o, failed.error))
        choose_say(t->why, "%g substeps: the energy balance, by Simpson's rule, is off by %.2g",
                   failed.scene.substeps, failed.imbalance);
    else if (t->met && failed.error >= 0.0)
        choose_say(t->why, "%g substeps at tolerance %.2g: error %.2g", failed.scene.substeps,
                   failed.scene.tolerance, failed.error);
    else if (t->met)
        choose_say(t->why, DRIVE_TICKS_TOO_FEW "a drive, or refused by the method's step guard");
    else {
        if (failed.error >= 0.0) {
            failed.coarser = t->coarser;
            *t = failed;
        }
        choose_say(t->why, "%.200s", *why ? why : "no step met the tolerance");
    }
}
