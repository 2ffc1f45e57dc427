/* choose_json.c - see choose_json.h. */
#include <math.h>

#include "host_sim/choose/choose_json.h"
#include "host_sim/choose/choose_climb.h"
#include "host_sim/choose/choose_tell.h"
#include "host_sim/choose/choose_watch.h"
#include "host_sim/out/json.h"

static double known(bool is_known, double value)
{
    return is_known ? value : HUGE_VAL;
}

/* Members of an object that is open. */
static void put_attempt(struct json *j, const struct choose_attempt *t, int method)
{
    bool run = t->error >= 0.0;
    json_put(j, "'method': %s, 'met': %b, 'substeps': %e, 'tolerance': %e", choose_method[method]->name,
             t->met, known(run, t->scene.substeps), known(run, t->scene.tolerance));
    json_put(j, ", 'error': %e, 'instructions_a_frame': %e, 'why': %s", known(run, t->error),
             known(run, choose_frame_cost(t, 0)), t->why);
}

static void put_question(struct json *j, const struct choose_certificate *c)
{
    const struct choose_facts *f = &c->facts;
    json_item(j, "'scene': %s, 'tolerance_met': %b, 'deadline_met': %b", c->title, c->met, c->in_time);
    json_item(j, "\n 'asked': {'observable': %s, 'over': %e, 'tolerance': %e, 'frame_s': %e, 'budget_s': %e}",
              c->scene.model->output_signal[(int)c->scene.observable].name, c->scene.over, c->scene.tolerance,
              c->scene.frame_s, c->budget_s);
    json_item(j, "\n 'truth': {'model': %s, 'measure': %s, 'span': %e, 'error': %e, 'neighbours': %e",
              c->scene.model->name, c->statistics ? "statistics" : "largest difference", c->span,
              c->truth_error, c->neighbours);
    if (c->statistics)
        json_item(j, " 'mean': %e, 'rms': %e, 'peak': %e, 'loss': %e", c->mean[STATISTIC_MEAN],
                  c->mean[STATISTIC_RMS], c->mean[STATISTIC_PEAK], c->mean[STATISTIC_LOSS]);
    json_put(j, "},\n 'facts': {'amplitude': %e, 'fast_over_slow': %e, 'floquet_multiplier': %e",
             known(f->amplitude > 0.0, f->amplitude), known(f->fast > 0.0, f->fast / f->slow), f->multiplier);
    json_put(j, ", 'compression_low': %e, 'compression_high': %e, 'switches': %e, 'apart': %e}", c->low,
             c->high, c->switches, c->loss);
}

/* Members of an object that is open: which candidate it is. */
static void put_name(struct json *j, const struct choose_certificate *c, const struct choose_candidate *of)
{
    json_put(j, "'candidate': %s, 'model': %s, 'reduced': %b", of->name, of->scene.model->name,
             of->scene.model != c->scene.model);
}

static void put_choice(struct json *j, const struct choose_certificate *c)
{
    const struct choose_verdict *v = &c->verdict[c->choice];
    const struct choose_attempt *t = &v->attempt[c->method];
    json_item(j, "\n ");
    put_name(j, c, &v->candidate);
    json_put(j, ", 'choice': {");
    put_attempt(j, t, c->method);
    json_put(j, "},\n 'instructions_as_given': %e, 'measured_ns_a_step': %e, 'cost': [", c->given_cost,
             t->ns);
    for (int i = 0; i < CHOOSE_MACHINES; i++) {
        double time_s = choose_time_s(t, c->method, i);
        json_item(j, "\n  {'machine': %s, 'instructions_a_step': %e, 'frame_s': %e, 'of_deadline': %e}",
                  choose_machine[i].name, t->cost[i], known(time_s > 0.0, time_s),
                  known(time_s > 0.0, time_s / c->budget_s));
    }
    json_put(j, "],\n 'void_by': [");
    for (int i = 0; i < c->n_conditions; i++)
        json_item(j, "\n  {'when': %s, 'factor': %e, 'guard': %s}", c->condition[i].text,
                  c->condition[i].factor, choose_guard_name[c->condition[i].guard]);
    json_put(j, "]");
}

static void put_watch(struct json *j, const struct choose_certificate *c)
{
    const struct scene_watch *w = choose_watched(c);
    if (!w)
        return;
    json_item(j, "\n 'watch': {'observable': %s, 'below': %e, 'above': %e",
              model_observable(c->verdict[c->choice].candidate.scene.model, (int)w->observable)->name,
              known(w->below > -SCENE_UNBOUNDED, w->below), known(w->above < SCENE_UNBOUNDED, w->above));
    if (w->promote)
        json_item(j, " 'promote': %s", w->promote->name);
    json_put(j, "}");
}

static void put_candidate(struct json *j, const struct choose_certificate *c, const struct choose_verdict *v)
{
    json_item(j, "\n  {");
    put_name(j, c, &v->candidate);
    json_put(j, ", 'refused': %s, 'predicted': %e, 'error': %e, 'methods': [", v->refused,
             known(v->predicted >= 0.0, v->predicted), known(v->error >= 0.0, v->error));
    for (int k = 0; k < CHOOSE_METHODS && !*v->refused; k++) {
        if (!choose_takes(v->candidate.scene.model, k))
            continue;
        json_item(j, "\n   {");
        put_attempt(j, &v->attempt[k], k);
        json_put(j, "}");
    }
    json_put(j, "]}");
}

void choose_json(FILE *out, const struct choose_certificate *c)
{
    struct json j;
    const char *warning[CHOOSE_WARNINGS];
    int n = choose_warnings(c, warning);
    json_begin_file(&j, out);
    json_put(&j, "{");
    put_question(&j, c);
    if (c->choice >= 0)
        put_choice(&j, c);
    put_watch(&j, c);
    json_item(&j, "\n 'warnings': [");
    for (int i = 0; i < n; i++)
        json_item(&j, "%s", warning[i]);
    json_put(&j, "],\n 'candidates': [");
    for (int i = 0; i < c->n_candidates; i++)
        put_candidate(&j, c, &c->verdict[i]);
    json_put(&j, "]}\n");
}
