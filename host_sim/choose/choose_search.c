/* choose_search.c - see choose_search.h. */
#include "host_sim/choose/choose_search.h"
#include "host_sim/choose/choose_climb.h"
#include "host_sim/choose/choose_ladder.h"
#include "host_sim/choose/choose_refuse.h"
#include "host_sim/choose/choose_run.h"
#include "host_sim/choose/choose_steps.h"

#include <math.h>
#include "firmware/method/auto.h"
#include "host_sim/choose/choose_tell.h"
#include "host_sim/choose/choose_truth.h"
#include "host_sim/choose/choose_watch.h"
#include "host_sim/cli/clock.h"
#include "models/afm_lever.h"

/* The scatter of the statistics themselves: no run can be known better. */
static double largest_scatter(const struct choose_certificate *c)
{
    double most = 0.0;
    for (int k = 0; k < STATISTICS; k++)
        most = fmax(most, c->spread[k]);
    return most;
}

/* Times the tolerance: a reduced model that differs so much is refused before its run is over. */
static const double far_off = 10.0;

/* Runs a reduced model beside the full one: its error. */
static double judge_reduced(const struct search *o, struct choose_verdict *v, const struct scene *s)
{
    const struct choose_certificate *c = o->c;
    const struct choose_beside beside = {&o->truth, far_off * c->scene.tolerance * c->span};
    struct choose_record r;
    const char *why =
        c->statistics ? choose_run(s, &c->sweep, 0.0, &r) : choose_run_beside(s, &c->sweep, &beside, &r);
    double error = why ? HUGE_VAL : choose_error(o, &r);
    if (r.is_apart)
        choose_say(v->refused, "its error in a run beside the full model is above %.2g",
                   far_off * c->scene.tolerance);
    else if (isfinite(error) && !choose_meets(o, error))
        choose_say(v->refused, "its error in a run beside the full model is %.2g", error);
    else if (!isfinite(error))
        choose_say(v->refused, "it escapes in a run beside the full model");
    choose_record_free(&r);
    return error;
}

static void judge(struct search *o, struct choose_verdict *v)
{
    bool full = v->candidate.kind == KIND_OWN;
    struct scene s = v->candidate.scene;
    char reason[SCENE_CHECK_REASON];
    double most = HUGE_VAL;
    v->best = -1;
    v->predicted = v->error = -1.0;
    for (int i = 0; i < CHOOSE_METHODS; i++)
        v->attempt[i] = (struct choose_attempt){.error = -1.0, .why = "not tried"};
    choose_refuse(o, v);
    if (*v->refused || !choose_tighten(&s, CHOOSE_LOOSE, 1.0, reason))
        return;
    choose_tell(o, "trying", &s);
    v->error = full ? choose_error(o, &o->truth) : judge_reduced(o, v, &s);
    if (*v->refused)
        return;
    static const int order[CHOOSE_METHODS] = {3, 2, 0, 4, 1, 5}; /* dearest by run time last */
    bool hopeless = o->c->statistics && !choose_meets(o, largest_scatter(o->c));
    for (int k = 0, tried = 0; k < CHOOSE_METHODS && !(hopeless && tried); k++) {
        int i = order[k];
        if (!choose_takes(v->candidate.scene.model, i))
            continue;
        choose_climb(o, v, i, most);
        if (v->attempt[i].met && choose_rank(o->c, &v->attempt[i], i) < most) {
            most = choose_rank(o->c, &v->attempt[i], i);
            v->best = i;
        }
        tried = v->attempt[i].error >= 0.0;
    }
}

/* ---- the choice ---- */

static void pick(struct choose_certificate *c)
{
    double least = HUGE_VAL, nearest = HUGE_VAL;
    c->choice = -1;
    for (int i = 0; i < c->n_candidates; i++) {
        const struct choose_verdict *v = &c->verdict[i];
        if (v->best >= 0 && choose_rank(c, &v->attempt[v->best], v->best) < least) {
            least = choose_rank(c, &v->attempt[v->best], v->best);
            c->choice = i;
            c->method = v->best;
            c->met = true;
        }
        for (int k = 0; k < CHOOSE_METHODS && !c->met; k++) {
            if (v->attempt[k].error >= 0.0 && v->attempt[k].error < nearest) {
                nearest = v->attempt[k].error;
                c->choice = i;
                c->method = k;
            }
        }
    }
    if (c->choice < 0)
        return;
    double time_s = choose_time_s(&c->verdict[c->choice].attempt[c->method], c->method, c->machine);
    c->in_time = time_s <= c->budget_s;
}

/* The cost of a frame as the scene is given, with auto resolved. */
static double given(const struct search *o)
{
    struct choose_attempt t = {.scene = o->c->scene};
    struct scene_point at;
    const struct method *m = method_find(t.scene.method);
    point_of_scene(&t.scene, &at);
    if (t.scene.model->modal_form)
        m = &modal; /* rk4 is its check, and is priced so */
    else if (m == &auto_method)
        m = auto_choice(t.scene.model, at.p, scene_check_step(&t.scene) / at.scale.time_s, t.scene.tolerance,
                        at.drive, &at.scale);
    if (m == &adams)
        m = &rk4; /* whose tick costs as much or more */
    if (m == &taylor || m == &modal) {
        struct choose_record r;
        t.scene.method = m->name;
        if (!choose_run(&t.scene, &o->c->sweep, 0.0, &r))
            t.series = r.series;
        choose_record_free(&r);
    }
    for (int i = 0; i < CHOOSE_METHODS; i++)
        if (choose_method[i] == m)
            choose_price(o, &t, i);
    return choose_frame_cost(&t, o->c->machine);
}

const char *choose_search(struct choose_certificate *c, FILE *progress, bool *escaped)
{
    struct search o = {.c = c, .progress = progress, .begin_s = clock_now_s()};
    struct choose_candidate candidate[CHOOSE_CANDIDATES];
    struct scene *s = &c->scene;
    *escaped = false;
    s->watch = (struct scene_watch){.on = false}; /* that of the certificate is another */
    c->heat &= s->model->modal_form && s->value[LEVER_TEMPERATURE] > 0.0;
    if (s->model->modal_form && !c->heat)
        s->value[LEVER_TEMPERATURE] = 0.0;
    c->budget_s = s->cost_s > 0.0 ? s->cost_s * s->substeps : s->frame_s;
    for (int i = 0; i < s->model->n_inputs; i++)
        if (s->drive[i].noise > 0.0 && !(s->drive[i].noise_hold > 0.0))
            s->drive[i].noise_hold = scene_check_step(s); /* every step sees equal noise */
    struct scene free_of_cost = *s;
    free_of_cost.cost_s = 0.0; /* the budget is for one step of the scene's length: other steps differ */
    c->n_candidates = choose_ladder(&free_of_cost, candidate);
    choose_facts_of(candidate, c->n_candidates, &c->sweep, &c->facts);
    const char *why = choose_truth(&o, escaped);
    for (int i = 0; i < c->n_candidates && !why; i++) {
        c->verdict[i] = (struct choose_verdict){.candidate = candidate[i]};
        judge(&o, &c->verdict[i]);
    }
    if (!why) {
        c->given_cost = given(&o);
        pick(c);
        choose_watch(c);
    }
    choose_record_free(&o.truth);
    return why;
}
