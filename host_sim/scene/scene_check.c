/* scene_check.c - see scene_check.h. */
#include "host_sim/scene/scene_check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/plant/plant.h"
#include "firmware/plant/plant_change.h"
#include "firmware/stage/stages.h"
#include "host_sim/scene/scene_keys.h"
#include "host_sim/scene/scene_name.h"
#include "models/math/elementary.h"

static const double rows_max = 1e8;         /* frames in a scene */
static const double tolerance_usual = 1e-6; /* one that every method takes */
static const double whole_steps = 1e-6;     /* steps by which a hold time may miss a whole number */

double scene_check_step(const struct scene *s)
{
    return s->frame_s / s->substeps / s->dilation;
}

static const void *check_deadline(const struct scene *s, char *why)
{
    if (s->cost_s * s->substeps > s->frame_s) {
        snprintf(why, SCENE_CHECK_REASON,
                 "%u steps of %g us take longer than the frame of %g us; at most %g us a step fit",
                 (unsigned)s->substeps, s->cost_s * 1e6, s->frame_s * 1e6, s->frame_s / s->substeps * 1e6);
        return &s->cost_s;
    }
    if (s->over * s->dilation / s->frame_s > rows_max) {
        snprintf(why, SCENE_CHECK_REASON, "more than 1e8 frames; give at most %g",
                 rows_max * s->frame_s / s->dilation);
        return &s->over;
    }
    return NULL;
}

static const void *check_plant(const struct scene *s, const double *si, char *why)
{
    int which;
    const char *reason = plant_check(s->model, si, &which);
    if (!reason)
        return NULL;
    if (which < 0 && scene_kind(s->model)->check)
        reason = scene_kind(s->model)->check(si, &which);
    snprintf(why, SCENE_CHECK_REASON, "%s%s%s", which >= 0 ? s->model->parameter[which].name : "",
             which >= 0 ? ": " : "", reason);
    return which >= 0 && !s->paper ? (const void *)&s->value[which] : (const void *)&s->model;
}

static const void *check_noise(const struct scene *s, int i, double unit, char *why)
{
    const struct scene_drive *d = &s->drive[i];
    double step = scene_check_step(s), steps = d->noise_hold / step;
    if (d->noise > NOISE_LIMIT * unit) {
        snprintf(why, SCENE_CHECK_REASON, "more than a plant takes; give at most %g", NOISE_LIMIT * unit);
        return &d->noise;
    }
    if (scenes_dimensionless(s) && s->model->input_signal[i].quantity == QUANTITY_LENGTH && d->noise > 0.0) {
        snprintf(why, SCENE_CHECK_REASON, "noise of a length needs a scene in SI, without [paper]");
        return &d->noise;
    }
    if (d->noise_hold > 0.0 && (steps > NOISE_HOLD_MAX + 0.5 || fabs(steps - round(steps)) > whole_steps ||
                                steps < 1.0 - whole_steps)) {
        snprintf(why, SCENE_CHECK_REASON, "not a whole number of steps, 1 to %d; a step is %.9g",
                 NOISE_HOLD_MAX, step);
        return &d->noise_hold;
    }
    return NULL;
}

static const void *check_drive(const struct scene *s, int i, const struct harmonic *h, double unit, char *why)
{
    double step = scene_check_step(s), turns = h->omega / (2.0 * ELEMENTARY_PI) * step;
    if (fabs(h->amplitude) > DRIVE_LIMIT * unit) {
        snprintf(why, SCENE_CHECK_REASON, "the drive of %s is more than a plant takes; give at most %g",
                 s->model->input_signal[i].name, DRIVE_LIMIT * unit);
        return s->paper ? (const void *)&s->model : (const void *)&s->drive[i].amplitude;
    }
    if ((h->amplitude < 0.0 || h->amplitude > 0.0) && turns * DRIVE_TICKS_MIN > 1.0 + 1e-9) {
        double enough = ceil(s->substeps * turns * DRIVE_TICKS_MIN - 1e-9);
        int n = snprintf(why, SCENE_CHECK_REASON, DRIVE_TICKS_TOO_FEW "the drive of %s; ",
                         s->model->input_signal[i].name);
        if (enough <= SCENE_SUBSTEPS_MAX)
            snprintf(why + n, (size_t)(SCENE_CHECK_REASON - n), "%.0f substeps would do", enough);
        else
            snprintf(why + n, (size_t)(SCENE_CHECK_REASON - n),
                     "%d substeps, the most, do up to %.3g times this frequency", SCENE_SUBSTEPS_MAX,
                     SCENE_SUBSTEPS_MAX / enough);
        return s->paper ? (const void *)&s->substeps : (const void *)&s->drive[i].frequency_Hz;
    }
    return check_noise(s, i, unit, why);
}

static const void *check_start(const struct scene *s, const double *si, const struct harmonic *drive,
                               char *why)
{
    double x[MODEL_STATES], size = 0.0;
    if (s->started && scene_kind(s->model)->from_rest) {
        snprintf(why, SCENE_CHECK_REASON, "a %s begins at rest; leave [start] out", s->model->name);
        return &s->start[0];
    }
    scenes_begin(s, si, drive, x);
    for (int i = 0; i < s->model->n_states; i++)
        size += fabs(x[i]);
    if (size <= PLANT_STATE_LIMIT)
        return NULL;
    snprintf(why, SCENE_CHECK_REASON, "more than 1e12 times the contact's own length; begin nearer");
    return &s->start[0];
}

/* The step guard; a tolerance that the method does not take is one where another would do. */
static const void *check_method(const struct scene *s, const double *p, double time_s, char *why)
{
    const struct method *m = scene_find_method(s->model, s->method);
    const char *reason =
        m ? m->refuse(s->model, p, scene_check_step(s) / time_s, s->tolerance) : "no such method";
    if (!reason)
        return NULL;
    snprintf(why, SCENE_CHECK_REASON, "%s", reason);
    if (m && !m->refuse(s->model, p, scene_check_step(s) / time_s, tolerance_usual))
        return &s->tolerance;
    return &s->method;
}

static const void *check_own_method(const struct scene *s, char *why)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct harmonic drive[MODEL_INPUTS];
    struct scale scale;
    scenes_resolve(s, si, drive);
    s->model->prepare(si, p, &scale);
    return check_method(s, p, scale.time_s, why);
}

/* The full model takes over parameters, method and step as they are. */
static const void *check_promote(const struct scene *s, const double *si, char *why)
{
    const struct model *to = s->watch.promote;
    double p[MODEL_DERIVED];
    struct scale scale;
    int which;
    const char *reason = model_climb_refused(s->model, to);
    reason = reason ? reason : plant_check(to, si, &which);
    if (!reason) {
        to->prepare(si, p, &scale);
        reason = method_find(s->method)->refuse(to, p, scene_check_step(s) / scale.time_s, s->tolerance);
    }
    if (!reason)
        return NULL;
    snprintf(why, SCENE_CHECK_REASON, "%s", reason);
    return &s->watch.promote;
}

static const void *check_watch(const struct scene *s, const double *si, const struct harmonic *drive,
                               char *why)
{
    const struct scene_watch *w = &s->watch;
    const struct signal *g = model_observable(s->model, w->observable);
    double start = scenes_watched(s, si, drive);
    const char *unit = scenes_dimensionless(s) ? "" : g->unit;
    if (w->above >= SCENE_UNBOUNDED && w->below <= -SCENE_UNBOUNDED) {
        snprintf(why, SCENE_CHECK_REASON, "no limit; give above, below or both");
        return &w->on;
    }
    if (!(w->below < w->above)) {
        snprintf(why, SCENE_CHECK_REASON, "not less than above; give a smaller one");
        return &w->below;
    }
    if (!(start >= w->below && start <= w->above)) {
        snprintf(why, SCENE_CHECK_REASON, "%s starts with %g%s%s, outside; begin inside, or move the limit",
                 g->name, start, *unit ? " " : "", unit);
        return start > w->above ? &w->above : &w->below;
    }
    return w->promote ? check_promote(s, si, why) : NULL;
}

static const void *check_stages(const struct scene *s, char *why)
{
    for (int i = 0; i < SCENE_STAGES; i++) {
        double setting[SETTINGS] = {0.0};
        memcpy(&setting[SET_STAGE], s->stage[i], sizeof s->stage[i]);
        const char *reason = stages_for_plants.refuse(s->model, scene_check_step(s), setting);
        if (reason) {
            snprintf(why, SCENE_CHECK_REASON, "%s", reason);
            return &s->stage[i];
        }
    }
    return NULL;
}

const void *scene_check(const struct scene *s, char *why)
{
    const void *root = scene_check_unstepped(s, why);
    return root ? root : check_own_method(s, why);
}

const void *scene_check_unstepped(const struct scene *s, char *why)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct harmonic drive[MODEL_INPUTS];
    struct scale scale;
    scenes_resolve(s, si, drive);
    const void *root = check_deadline(s, why);
    root = root ? root : check_plant(s, si, why);
    if (root)
        return root;
    s->model->prepare(si, p, &scale);
    for (int i = 0; i < s->model->n_inputs && !root; i++)
        root = check_drive(s, i, &drive[i], scale_of(&scale, s->model->input_signal[i].quantity), why);
    root = root ? root : check_stages(s, why);
    root = root ? root : check_start(s, si, drive, why);
    return root || !s->watch.on ? root : check_watch(s, si, drive, why);
}
