/* choose_json.c - the certificate as JSON (RFC 8259); a number that is not finite or not known is null. */
#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "host_sim/choose/choose.h"

/* Where it is written, and what stands before the next member or element. */
struct json {
    FILE *out;
    const char *before;
};

static void put_text(FILE *out, const char *value)
{
    fputc('"', out);
    for (; *value; value++) {
        if ((unsigned char)*value < 0x20)
            fprintf(out, "\\u%04x", (unsigned char)*value);
        else
            fprintf(out, "%s%c", *value == '"' || *value == '\\' ? "\\" : "", *value);
    }
    fputc('"', out);
}

static void put_value(FILE *out, char type, va_list *a)
{
    double number = type == 'n' ? va_arg(*a, double) : 0.0;
    if (type == 's')
        put_text(out, va_arg(*a, const char *));
    else if (type == 'b')
        fputs(va_arg(*a, int) ? "true" : "false", out);
    else if (isfinite(number))
        fprintf(out, "%.17g", number);
    else
        fputs("null", out);
}

/* Writes words of a row. `name:s`, `name:n` and `name:b` are members with a text, a double and a bool from
 * the arguments. `:s` is an element. `name:{` and `name:[` open an object or a list; the brackets alone
 * open and close them. */
static void put(struct json *j, const char *row, ...)
{
    va_list a;
    va_start(a, row);
    while (*(row += strspn(row, " "))) {
        int length = (int)strcspn(row, " "), name = (int)strcspn(row, ": ");
        char type = row[length - 1];
        bool closes = type == '}' || type == ']', opens = type == '{' || type == '[';
        fputs(closes ? "" : j->before, j->out);
        if (name > 0 && name < length)
            fprintf(j->out, "\"%.*s\": ", name, row);
        if (closes || opens)
            fputc(type, j->out);
        else
            put_value(j->out, type, &a);
        j->before = closes ? ",\n  " : opens ? "" : ", ";
        row += length;
    }
    va_end(a);
}

static double known(bool is_known, double value)
{
    return is_known ? value : HUGE_VAL;
}

static void put_trial(struct json *j, const struct choose_trial *t, int method)
{
    bool run = t->error >= 0.0;
    put(j, "method:s met:b substeps:n tolerance:n error:n instructions_a_frame:n why:s }",
        choose_method[method]->name, t->met, known(run, t->scene.substeps), known(run, t->scene.tolerance),
        known(run, t->error), known(run, choose_frame_cost(t, 0)), t->why);
}

static void put_question(struct json *j, const struct choose_certificate *c)
{
    const struct choose_facts *f = &c->facts;
    put(j, "scene:s tolerance_met:b deadline_met:b", c->title, c->met, c->in_time);
    put(j, "asked:{ observable:s over:n tolerance:n frame_s:n budget_s:n }",
        c->scene.model->output_signal[(int)c->scene.observable].name, c->scene.over, c->scene.tolerance,
        c->scene.frame_s, c->budget_s);
    put(j, "truth:{ model:s measure:s span:n error:n neighbours:n", c->scene.model->name,
        c->statistics ? "statistics" : "largest difference", c->span, c->truth_error, c->twins);
    if (c->statistics)
        put(j, "mean:n rms:n peak:n loss:n", c->mean[STATISTIC_MEAN], c->mean[STATISTIC_RMS],
            c->mean[STATISTIC_PEAK], c->mean[STATISTIC_LOSS]);
    put(j, "} facts:{ amplitude:n fast_over_slow:n floquet_multiplier:n",
        known(f->amplitude > 0.0, f->amplitude), known(f->fast > 0.0, f->fast / f->slow), f->multiplier);
    put(j, "compression_low:n compression_high:n switches:n apart:n }", c->low, c->high, c->switches,
        c->loss);
}

static void put_choice(struct json *j, const struct choose_certificate *c)
{
    const struct choose_verdict *v = &c->verdict[c->choice];
    const struct choose_trial *t = &v->trial[c->method];
    put(j, "rung:s model:s choice:{", v->candidate.name, v->candidate.scene.model->name);
    put_trial(j, t, c->method);
    put(j, "instructions_as_given:n measured_ns_a_step:n cost:[", c->given_cost, t->ns);
    for (int i = 0; i < CHOOSE_MACHINES; i++) {
        double time_s = choose_time_s(t, c->method, i);
        put(j, "{ machine:s instructions_a_step:n frame_s:n of_deadline:n }", choose_machine[i].name,
            t->cost[i], known(time_s > 0.0, time_s), known(time_s > 0.0, time_s / c->budget_s));
    }
    put(j, "] void_by:[");
    for (int i = 0; i < c->n_conditions; i++)
        put(j, "{ when:s factor:n guard:s }", c->condition[i].text, c->condition[i].factor,
            choose_guard_name[c->condition[i].guard]);
    put(j, "]");
}

static void put_watch(struct json *j, const struct choose_certificate *c)
{
    const struct scene_watch *w = choose_watched(c);
    if (!w)
        return;
    put(j, "watch:{ observable:s below:n above:n",
        model_observable(c->verdict[c->choice].candidate.scene.model, (int)w->observable)->name,
        known(w->below > -SCENE_UNBOUNDED, w->below), known(w->above < SCENE_UNBOUNDED, w->above));
    if (w->promote)
        put(j, "promote:s", w->promote->name);
    put(j, "}");
}

static void put_candidate(struct json *j, const struct choose_verdict *v)
{
    put(j, "{ rung:s model:s refused:s predicted:n error:n methods:[", v->candidate.name,
        v->candidate.scene.model->name, v->refused, known(v->predicted >= 0.0, v->predicted),
        known(v->error >= 0.0, v->error));
    for (int k = 0; k < CHOOSE_METHODS && !*v->refused; k++) {
        if (!choose_takes(v->candidate.scene.model, k))
            continue;
        put(j, "{");
        put_trial(j, &v->trial[k], k);
    }
    put(j, "] }");
}

void choose_json(FILE *out, const struct choose_certificate *c)
{
    struct json j = {out, ""};
    const char *warning[CHOOSE_WARNINGS];
    int n = choose_warnings(c, warning);
    put(&j, "{");
    put_question(&j, c);
    if (c->choice >= 0)
        put_choice(&j, c);
    put_watch(&j, c);
    put(&j, "warnings:[");
    for (int i = 0; i < n; i++)
        put(&j, ":s", warning[i]);
    put(&j, "] rungs:[");
    for (int i = 0; i < c->n_candidates; i++)
        put_candidate(&j, &c->verdict[i]);
    put(&j, "] }");
    fputc('\n', out);
}
