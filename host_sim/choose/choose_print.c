/* choose_print.c - the certificate as text, and the chosen scene as a file. */
#include <math.h>
#include <string.h>

#include "host_sim/choose/choose.h"
#include "host_sim/scene/scene_check.h"
#include "host_sim/scene/scene_print.h"
#include "models/math/elementary.h"

static const struct choose_trial *chosen(const struct choose_certificate *c)
{
    return &c->verdict[c->rung].trial[c->method];
}

static void print_measure(FILE *out, const struct choose_certificate *c)
{
    const struct signal *o = &c->scene.model->output_signal[(int)c->scene.observable];
    fprintf(out, "asked      %s over %g%s within %g, in frames of %g s\n", o->name, c->scene.over,
            scenes_dimensionless(&c->scene) ? "" : " s", c->scene.tolerance, c->scene.frame_s);
    fprintf(out, "truth      %s by %s; known to %.2g; neighbouring starts (1e-9) part by %.2g\n",
            c->scene.model->name, c->scene.model->linear ? "exact" : "taylor", c->truth_error, c->twins);
    fprintf(out, "measure    %s; 1 is %.4g %s\n",
            c->statistics ? "mean, rms, peak and share of time without contact: the motion is chaotic"
                          : "largest difference in and at the end of each frame, start included",
            c->span, scenes_dimensionless(&c->scene) ? "in the paper's units" : o->unit);
    for (int k = 0; k < STATISTICS && c->statistics; k++)
        fprintf(out, "           %s %.4g, known to %.2g\n", choose_statistic_name[k], c->mean[k],
                c->spread[k]);
}

static void print_facts(FILE *out, const struct choose_certificate *c)
{
    const struct choose_facts *f = &c->facts;
    if (f->amplitude > 0.0)
        fprintf(out, "predicted  amplitude %.3g of %s by linear theory\n", f->amplitude,
                c->scene.model->n_states == 2 ? "the static compression" : "the gap");
    if (f->fast > 0.0)
        fprintf(out, "           fast drive %.3g times the fastest slow frequency\n", f->fast / f->slow);
    if (fabs(f->multiplier - 1.0) > 0.0)
        fprintf(out, "           Floquet multiplier %.4g of the unaveraged linear part\n", f->multiplier);
    fprintf(out,
            "found      compression %.3g to %.3g model units, %g contact switches, %.3g of the time apart\n",
            c->low, c->high, c->switches, c->loss);
}

static void print_choice(FILE *out, const struct choose_certificate *c)
{
    const struct choose_trial *t = chosen(c);
    const struct scene *s = &t->scene;
    double p[MODEL_DERIVED], si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    struct scale scale;
    scenes_resolve(s, si, drive);
    s->model->prepare(si, p, &scale);
    double angle = s->model->eigenfrequency(p) * scene_check_step(s) / scale.time_s;
    fprintf(out, "%s %s by %s, %u substeps a frame", c->met ? "CHOSEN    " : "CLOSEST   ",
            c->verdict[c->rung].rung.name, s->method, s->substeps);
    if (method_find(s->method) == &taylor)
        fprintf(out, " at tolerance %g", s->tolerance);
    fprintf(out, "\n           error %.3g of %g asked; the model's own %.3g", t->error, c->scene.tolerance,
            c->verdict[c->rung].error);
    if (c->verdict[c->rung].predicted >= 0.0)
        fprintf(out, ", predicted %.2g", c->verdict[c->rung].predicted);
    fprintf(out, "\n           h omega %.3g rad; (h omega)^(5/2) %.2g, rk4's error where contact is lost\n",
            angle, pow(angle, 2.5));
    fprintf(out, "           not coarser: %s\n", t->why);
}

static void print_trials(FILE *out, const struct choose_certificate *c, int i)
{
    const struct choose_verdict *v = &c->verdict[i];
    for (int k = 0; k < CHOOSE_METHODS; k++) {
        const struct choose_trial *t = &v->trial[k];
        if (i == c->rung && k == c->method)
            continue;
        if (t->met)
            fprintf(out, "             %-13s %u substeps do, at %.0f instructions a frame\n",
                    choose_method[k]->name, t->scene.substeps, choose_frame_cost(t, c->machine));
        else if (t->error >= 0.0)
            fprintf(out, "             %-13s %s; at %u substeps the error is %.2g\n", choose_method[k]->name,
                    t->why, t->scene.substeps, t->error);
        else
            fprintf(out, "             %-13s %s\n", choose_method[k]->name, t->why);
    }
}

static void print_rungs(FILE *out, const struct choose_certificate *c)
{
    fprintf(out, "rungs\n");
    for (int i = 0; i < c->n_rungs; i++) {
        const struct choose_verdict *v = &c->verdict[i];
        if (*v->refused)
            fprintf(out, "  %-24s refused: %s\n", v->rung.name, v->refused);
        else
            fprintf(out, "  %-24s error of the model %.2g\n", v->rung.name, v->error);
        if (!*v->refused)
            print_trials(out, c, i);
    }
}

static void print_costs(FILE *out, const struct choose_certificate *c)
{
    const struct choose_trial *t = chosen(c);
    const struct choose_verdict *full = &c->verdict[c->n_rungs - 1];
    fprintf(out, "cost       %-16s %12s %12s %14s %14s\n", "", "a step", "a frame", "time a frame",
            "of the deadline");
    for (int i = 0; i < CHOOSE_MACHINES; i++) {
        const struct choose_machine *m = &choose_machine[i];
        double time_s = choose_time_s(t, c->method, i);
        fprintf(out, "           %-16s %12.0f %12.0f", m->name, t->cost[i], choose_frame_cost(t, i));
        if (time_s > 0.0)
            fprintf(out, " %11.3g us %12.3g %%%s\n", time_s * 1e6, 100.0 * time_s / c->budget_s,
                    i == c->machine ? " <" : "");
        else
            fprintf(out, " %14s %14s%s\n", "not known", "not judged", i == c->machine ? " <" : "");
    }
    fprintf(out, "           measured here, for information: %.0f ns a step\n", t->ns);
    fprintf(out, "           as the scene is given: %.0f a frame, %.3g times as much", c->given_cost,
            c->given_cost / choose_frame_cost(t, c->machine));
    if (full->best >= 0)
        fprintf(out, "; the full model at its own best: %.3g times",
                choose_frame_cost(&full->trial[full->best], c->machine) / choose_frame_cost(t, c->machine));
    fputc('\n', out);
}

void choose_print(FILE *out, const struct choose_certificate *c)
{
    fprintf(out, "certificate for %s\n", c->title);
    print_measure(out, c);
    print_facts(out, c);
    if (c->rung < 0) {
        fprintf(out, "NONE       no rung could be run\n");
        print_rungs(out, c);
        return;
    }
    print_choice(out, c);
    print_rungs(out, c);
    print_costs(out, c);
    for (int i = 0; i < c->n_conditions; i++)
        fprintf(out, "%s %s (%.3g times from here): %s\n", i == 0 ? "VOID BY   " : "          ",
                c->condition[i].text, c->condition[i].factor, choose_guard_name[c->condition[i].guard]);
    if (!c->met)
        fprintf(out, "REFUSED    nothing meets the tolerance%s; the closest is shown\n",
                c->statistics ? " in statistics that scatter as they do over this time" : "");
    else if (!c->in_time)
        fprintf(out, "REFUSED    nothing meets the deadline on %s; the closest is shown\n",
                choose_machine[c->machine].name);
}

/* The watch of the certificate, with a climb to the full model where the method takes that with this step: as it is, or left to
 * auto. Without a climb where neither does. */
static void put_watch(const struct choose_certificate *c, struct scene *s)
{
    char why[SCENE_CHECK_REASON];
    struct scene t = *s;
    t.watch = *choose_watched(c);
    if (scene_check(&t, why)) {
        t.method = "auto";
        t.tolerance = fmin(t.tolerance, 1e-2); /* taylor, which it may need then, takes no more */
    }
    if (scene_check(&t, why)) {
        t.method = s->method;
        t.tolerance = s->tolerance;
        t.watch.promote = NULL;
    }
    if (!scene_check(&t, why))
        *s = t;
}

void choose_write(FILE *out, const struct choose_certificate *c)
{
    struct scene s = chosen(c)->scene;
    double budget = c->budget_s / s.substeps;
    s.cost_s = c->scene.cost_s > 0.0 ? budget : 0.0;
    if (choose_watched(c))
        put_watch(c, &s);
    scene_print(out,
                c->met && c->in_time ? "chosen by contactplant choose; tolerance is the method's"
                                     : "the closest that contactplant choose found, not certified",
                &s);
}
