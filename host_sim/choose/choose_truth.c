/* choose_truth.c - see choose_truth.h. */
#include <float.h>
#include <math.h>

#include "host_sim/choose/choose_run.h"
#include "host_sim/choose/choose_truth.h"
#include "host_sim/choose/choose_tell.h"
#include "models/afm_lever.h"

static const double far_apart =
    1e-4; /* neighbours that part by less are no chaos, however tight the tolerance */
static const double unknown =
    0.1; /* times the tolerance: a truth that is known less well is no trajectory to compare with */
static const double far_nudge = 1e-3; /* model units */

/* Why a scene's method takes no step of its model, or `otherwise`. */
static const char *refusal(const struct scene *s, const char *otherwise)
{
    struct scene_point at;
    point_of_scene(s, &at);
    double h = s->frame_s / s->dilation / CHOOSE_SUBSTEPS / at.scale.time_s;
    const char *why = method_find(s->method)->refuse(s->model, at.p, h, s->tolerance);
    return why ? why : otherwise;
}

/* The first number of substeps from n on that the scene may have; 0 and the reason when there is none. */
int choose_allow(struct scene *s, double n, char why[SCENE_CHECK_REASON])
{
    char last[SCENE_CHECK_REASON] = "no step is left";
    for (int i = n < 1.0 ? 1 : (int)ceil(n); i <= CHOOSE_SUBSTEPS; i++) {
        s->substeps = i;
        if (!scene_check(s, last))
            return i;
    }
    snprintf(why, SCENE_CHECK_REASON, "%s", refusal(s, last));
    return 0;
}

enum {
    PACE = 64,  /* steps in a period of the free lever: a scene's usual ones */
    FINER = 16, /* times as many in the truth, half of that where it is checked */
};

static double lever_substeps(const struct scene *s, bool tight)
{
    double turns = s->frame_s / s->dilation * s->value[LEVER_F0];
    double least = ceil(fmax((double)s->substeps, PACE * turns));
    return fmin(FINER * least, CHOOSE_SUBSTEPS) / (tight ? 1.0 : 2.0);
}

/* Makes a scene's own method the tightest there is. False: why[]. */
bool choose_tighten(struct scene *s, double tol, double finer, char why[SCENE_CHECK_REASON])
{
    bool lever = s->model->modal_form != NULL;
    s->method = lever ? "modal" : s->model->linear ? "exact" : "taylor";
    s->tolerance = tol;
    s->cost_s = 0.0; /* that of one step is no bound on the truth's */
    if (lever)
        return choose_allow(s, lever_substeps(s, tol < CHOOSE_LOOSE), why) > 0;
    return choose_allow(s, s->substeps * (s->model->linear ? finer : 1.0), why) > 0;
}

double choose_error(const struct search *o, const struct choose_record *r)
{
    const struct choose_certificate *c = o->c;
    double statistic[STATISTICS], most = 0.0;
    if (!c->statistics)
        return choose_difference(r, &o->truth, c->span) + c->truth_error;
    if (r->n < r->wanted || r->trouble)
        return HUGE_VAL;
    choose_statistics(r, c->span, statistic);
    for (int k = 0; k < STATISTICS; k++)
        most = fmax(most, fabs(statistic[k] - c->mean[k]) + c->spread[k]);
    return most;
}

double choose_resolution(const struct choose_certificate *c)
{
    return c->truth_error + DBL_EPSILON;
}

bool choose_meets(const struct search *o, double error)
{
    return error * (o->c->statistics ? 1.0 : CHOOSE_ROOM) <= o->c->scene.tolerance;
}

static void next_seed(struct scene *s)
{
    double *seed = &s->value[LEVER_SEED];
    *seed = *seed < s->model->parameter[LEVER_SEED].max ? *seed + 1.0 : 0.0;
}

/* Full runs from starts so far apart that they soon know nothing of each other: what their statistics are,
 * and how they scatter. (Starts 1e-9 apart part late in a short run, and would flatter it.) With heat each
 * has its own sequence of it. */
static const char *measure_scatter(struct search *o, struct scene *s)
{
    struct choose_certificate *c = o->c;
    double all[CHOOSE_NEIGHBOURS][STATISTICS];
    const char *why = NULL;
    choose_statistics(&o->truth, c->span, all[0]);
    for (int i = 1; i < CHOOSE_NEIGHBOURS && !why; i++) {
        struct choose_record r;
        if (c->heat)
            next_seed(s);
        why = choose_run(s, &c->sweep, far_nudge * i, &r);
        if (!why && r.trouble)
            why = "a neighbouring start escapes, so the motion cannot be judged; ask for a shorter time";
        if (!why)
            choose_statistics(&r, c->span, all[i]);
        choose_record_free(&r);
    }
    for (int k = 0; k < STATISTICS && !why; k++) {
        double sum = 0.0, squares = 0.0;
        for (int i = 0; i < CHOOSE_NEIGHBOURS; i++)
            sum += all[i][k];
        c->mean[k] = sum / CHOOSE_NEIGHBOURS;
        for (int i = 0; i < CHOOSE_NEIGHBOURS; i++)
            squares += (all[i][k] - c->mean[k]) * (all[i][k] - c->mean[k]);
        c->spread[k] = 3.0 * sqrt(squares / (CHOOSE_NEIGHBOURS - 1));
    }
    return why;
}

/* A lever's truth with two branches of adhesion comes nearer by fits and starts: where a kick meets the turn
 * of the tip decides. */
static double erratic(const struct scene *s)
{
    return s->model->modal_form && s->value[LEVER_HAMAKER_OUT] > s->value[LEVER_HAMAKER] ? 4.0 : 1.0;
}

/* The observable's model unit, SI on the bus. */
static double unit_of(const struct scene *s)
{
    struct scene_point at;
    point_of_scene(s, &at);
    at.scale.time_s *= s->dilation;
    return scale_of(&at.scale, s->model->output_signal[(int)s->observable].quantity);
}

static const char *escape(struct search *o, bool *escaped)
{
    static char text[CHOOSE_TEXT];
    const struct scene *s = &o->c->scene;
    const char *unit = scenes_dimensionless(s) ? "" : " s";
    *escaped = true;
    choose_say(text, "%s in the full model after %g%s of the %g%s asked; ask for a shorter time",
               o->truth.trouble, o->truth.n * s->frame_s / s->dilation, unit, s->over, unit);
    return text;
}

/* The truth, its own error, and whether trajectories can be compared at all. */
const char *choose_truth(struct search *o, bool *escaped)
{
    struct choose_certificate *c = o->c;
    struct choose_record second = {0}, beside = {0};
    struct scene s = c->scene;
    static char reason[SCENE_CHECK_REASON];
    if (!choose_tighten(&s, CHOOSE_TIGHT, 1.0, reason))
        return reason;
    choose_tell(o, "truth:", &s);
    const char *why = choose_run(&s, &c->sweep, 0.0, &o->truth);
    if (!why && o->truth.trouble)
        return escape(o, escaped);
    s.substeps = c->scene.substeps;
    if (!why && !choose_tighten(&s, CHOOSE_LOOSE, 2.0, reason))
        why = reason;
    choose_tell(o, "truth again:", &s);
    why = why ? why : choose_run(&s, &c->sweep, 0.0, &second);
    why = why ? why : choose_run(&s, &c->sweep, CHOOSE_NUDGE, &beside);
    if (!why) {
        c->span = choose_span(&o->truth, c->unit = unit_of(&c->scene));
        c->truth_error = erratic(&s) * choose_difference(&second, &o->truth, c->span);
        c->neighbours = choose_difference(&beside, &second, c->span);
        c->growth = choose_growth(&beside, &second, c->span, choose_resolution(c));
        c->chaotic = c->neighbours > fmax(c->scene.tolerance, far_apart);
        c->statistics = c->heat || c->chaotic || c->truth_error > unknown * c->scene.tolerance;
        c->low = o->truth.low;
        c->high = o->truth.high;
        c->loss = o->truth.loss;
        c->switches = o->truth.switches;
        for (int k = 0; k < 3; k++)
            c->modes[k] = fmax(o->truth.modes[k], beside.modes[k]);
    }
    if (!why && c->statistics)
        why = measure_scatter(o, &s);
    choose_record_free(&second);
    choose_record_free(&beside);
    return why;
}
