/* choose_json.c - the certificate as JSON (RFC 8259); a number that is not finite or not known is null. */
#include <math.h>

#include "host_sim/choose/choose.h"

/* Where it is written, and what stands before the next member or element. */
struct json {
    FILE *out;
    const char *before;
};

static void member(struct json *j, const char *name)
{
    fprintf(j->out, "%s", j->before);
    if (name)
        fprintf(j->out, "\"%s\": ", name);
    j->before = ", ";
}

static void text(struct json *j, const char *name, const char *value)
{
    member(j, name);
    fputc('"', j->out);
    for (; *value; value++) {
        if ((unsigned char)*value < 0x20)
            fprintf(j->out, "\\u%04x", (unsigned char)*value);
        else
            fprintf(j->out, "%s%c", *value == '"' || *value == '\\' ? "\\" : "", *value);
    }
    fputc('"', j->out);
}

static void number(struct json *j, const char *name, double value)
{
    member(j, name);
    if (isfinite(value))
        fprintf(j->out, "%.17g", value);
    else
        fprintf(j->out, "null");
}

/* null unless `known`. */
static void known(struct json *j, const char *name, bool known, double value)
{
    number(j, name, known ? value : HUGE_VAL);
}

static void flag(struct json *j, const char *name, bool value)
{
    member(j, name);
    fprintf(j->out, "%s", value ? "true" : "false");
}

static void open_with(struct json *j, const char *name, char bracket)
{
    member(j, name);
    fputc(bracket, j->out);
    j->before = "";
}

static void close_with(struct json *j, char bracket)
{
    fputc(bracket, j->out);
    j->before = ",\n  ";
}

static void asked(struct json *j, const struct choose_certificate *c)
{
    open_with(j, "asked", '{');
    text(j, "observable", c->scene.model->output_signal[(int)c->scene.observable].name);
    number(j, "over", c->scene.over);
    number(j, "tolerance", c->scene.tolerance);
    number(j, "frame_s", c->scene.frame_s);
    number(j, "budget_s", c->budget_s);
    close_with(j, '}');
}

static void truth(struct json *j, const struct choose_certificate *c)
{
    open_with(j, "truth", '{');
    text(j, "model", c->scene.model->name);
    text(j, "measure", c->statistics ? "statistics" : "largest difference");
    number(j, "span", c->span);
    number(j, "error", c->truth_error);
    number(j, "neighbours", c->twins);
    for (int k = 0; k < STATISTICS && c->statistics; k++)
        number(j, choose_statistic_name[k], c->mean[k]);
    close_with(j, '}');
}

/* The numbers behind the tests before runs, and those that the truth has shown. */
static void facts(struct json *j, const struct choose_certificate *c)
{
    const struct choose_facts *f = &c->facts;
    open_with(j, "facts", '{');
    known(j, "amplitude", f->amplitude > 0.0, f->amplitude);
    known(j, "fast_over_slow", f->fast > 0.0, f->fast / f->slow);
    number(j, "floquet_multiplier", f->multiplier);
    number(j, "compression_low", c->low);
    number(j, "compression_high", c->high);
    number(j, "switches", c->switches);
    number(j, "apart", c->loss);
    close_with(j, '}');
}

static void trial(struct json *j, const char *name, const struct choose_trial *t, int method)
{
    bool run = t->error >= 0.0;
    open_with(j, name, '{');
    text(j, "method", choose_method[method]->name);
    flag(j, "met", t->met);
    known(j, "substeps", run, t->scene.substeps);
    known(j, "tolerance", run, t->scene.tolerance);
    known(j, "error", run, t->error);
    known(j, "instructions_a_frame", run, choose_frame_cost(t, 0));
    text(j, "why", t->why);
    close_with(j, '}');
}

static void candidate(struct json *j, const struct choose_verdict *v)
{
    open_with(j, NULL, '{');
    text(j, "rung", v->candidate.name);
    text(j, "model", v->candidate.scene.model->name);
    text(j, "refused", v->refused);
    known(j, "predicted", v->predicted >= 0.0, v->predicted);
    known(j, "error", v->error >= 0.0, v->error);
    open_with(j, "methods", '[');
    for (int k = 0; k < CHOOSE_METHODS && !*v->refused; k++)
        trial(j, NULL, &v->trial[k], k);
    close_with(j, ']');
    close_with(j, '}');
}

static void costs(struct json *j, const struct choose_certificate *c)
{
    const struct choose_trial *t = &c->verdict[c->choice].trial[c->method];
    open_with(j, "cost", '[');
    for (int i = 0; i < CHOOSE_MACHINES; i++) {
        double time_s = choose_time_s(t, c->method, i);
        open_with(j, NULL, '{');
        text(j, "machine", choose_machine[i].name);
        number(j, "instructions_a_step", t->cost[i]);
        known(j, "frame_s", time_s > 0.0, time_s);
        known(j, "of_deadline", time_s > 0.0, time_s / c->budget_s);
        close_with(j, '}');
    }
    close_with(j, ']');
}

static void conditions(struct json *j, const struct choose_certificate *c)
{
    open_with(j, "void_by", '[');
    for (int i = 0; i < c->n_conditions; i++) {
        open_with(j, NULL, '{');
        text(j, "when", c->condition[i].text);
        number(j, "factor", c->condition[i].factor);
        text(j, "guard", choose_guard_name[c->condition[i].guard]);
        close_with(j, '}');
    }
    close_with(j, ']');
}

static void watch(struct json *j, const struct choose_certificate *c)
{
    const struct scene_watch *w = choose_watched(c);
    open_with(j, "watch", '{');
    text(j, "observable",
         model_observable(c->verdict[c->choice].candidate.scene.model, (int)w->observable)->name);
    known(j, "below", w->below > -SCENE_UNBOUNDED, w->below);
    known(j, "above", w->above < SCENE_UNBOUNDED, w->above);
    if (w->promote)
        text(j, "promote", w->promote->name);
    close_with(j, '}');
}

static void warnings(struct json *j, const struct choose_certificate *c)
{
    const char *warning[CHOOSE_WARNINGS];
    int n = choose_warnings(c, warning);
    open_with(j, "warnings", '[');
    for (int i = 0; i < n; i++)
        text(j, NULL, warning[i]);
    close_with(j, ']');
}

void choose_json(FILE *out, const struct choose_certificate *c)
{
    struct json j = {out, ""};
    open_with(&j, NULL, '{');
    text(&j, "scene", c->title);
    flag(&j, "tolerance_met", c->met);
    flag(&j, "deadline_met", c->in_time);
    asked(&j, c);
    truth(&j, c);
    facts(&j, c);
    if (c->choice >= 0) {
        const struct choose_verdict *v = &c->verdict[c->choice];
        text(&j, "rung", v->candidate.name);
        text(&j, "model", v->candidate.scene.model->name);
        trial(&j, "choice", &v->trial[c->method], c->method);
        number(&j, "instructions_as_given", c->given_cost);
        number(&j, "measured_ns_a_step", v->trial[c->method].ns);
        costs(&j, c);
        conditions(&j, c);
        if (choose_watched(c))
            watch(&j, c);
    }
    warnings(&j, c);
    open_with(&j, "rungs", '[');
    for (int i = 0; i < c->n_candidates; i++)
        candidate(&j, &c->verdict[i]);
    close_with(&j, ']');
    close_with(&j, '}');
    fputc('\n', out);
}
