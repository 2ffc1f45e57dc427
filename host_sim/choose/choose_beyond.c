/* choose_beyond.c - see choose_beyond.h. */
#include <math.h>

#include "host_sim/choose/choose_beyond.h"
#include "host_sim/choose/choose_run.h"
#include "host_sim/choose/choose_truth.h"
#include "models/shaft_views.h"

enum { STEPS = 8 };
static const double drive_step = 1.189207115002721; /* 2^(1/4) */

static void scale_drives(struct scene *s, double times)
{
    for (int i = 0; i < SHAFT_INPUTS; i++) {
        s->drive[i].amplitude *= times;
        s->drive[i].noise *= times;
        if (s->paper)
            s->value[SHAFT_PAPER_P1 + i] *= times;
    }
}

/* The chosen model's error against the full model, its symmetry broken by a nudge, both with drives this
 * many times as large. */
static double error_at(const struct choose_certificate *c, double times, double reach[2])
{
    struct scene full = c->scene, candidate = c->verdict[c->choice].attempt[c->method].scene;
    struct choose_record truth = {0}, r = {0};
    char why[SCENE_CHECK_REASON];
    double error = HUGE_VAL;
    scale_drives(&full, times);
    scale_drives(&candidate, times);
    if (!scene_check(&candidate, why) && choose_tighten(&full, CHOOSE_LOOSE, 1.0, why) &&
        !choose_run(&full, &c->sweep, CHOOSE_NUDGE, &truth) && !choose_run(&candidate, &c->sweep, 0.0, &r))
        error = choose_difference(&r, &truth, choose_span(&truth, c->unit));
    reach[0] = r.reach[0];
    reach[1] = r.reach[1];
    choose_record_free(&truth);
    choose_record_free(&r);
    return error;
}

double choose_beyond(const struct choose_certificate *c, double reach[2])
{
    const struct choose_attempt *t = &c->verdict[c->choice].attempt[c->method];
    double times = 1.0, next = drive_step, found[2];
    reach[0] = t->reach[0];
    reach[1] = t->reach[1];
    for (int i = 0; i < STEPS && !c->statistics; i++, next *= drive_step) {
        if (!(error_at(c, next, found) <= c->scene.tolerance))
            break;
        times = next;
        reach[0] = fmin(reach[0], found[0]);
        reach[1] = fmax(reach[1], found[1]);
    }
    return times;
}
