/* choose_print.c - see choose_print.h. */
#include <math.h>

#include "host_sim/choose/choose_print.h"
#include "host_sim/choose/choose_climb.h"
#include "host_sim/choose/choose_watch.h"
#include "host_sim/cli/paragraph.h"
#include "host_sim/out/plural.h"
#include "host_sim/scene/scene_check.h"
#include "host_sim/scene/scene_print.h"
#include "models/afm_lever.h"

enum { HEAD = 11, NAME = 15 /* columns of a row's name, and of a method's within a row */ };
#define ROW(head, ...) paragraph_print(out, HEAD, head, __VA_ARGS__)

static const struct choose_attempt *chosen(const struct choose_certificate *c)
{
    return &c->verdict[c->choice].attempt[c->method];
}

static const char *time_unit(const struct choose_certificate *c)
{
    return scenes_dimensionless(&c->scene) ? "" : " s";
}

static const struct signal *observable(const struct choose_certificate *c)
{
    return &c->scene.model->output_signal[(int)c->scene.observable];
}

static double best_us(const struct choose_certificate *c)
{
    return 1e6 * choose_time_s(chosen(c), c->method, c->machine);
}

/* Why nothing is certified, and what to do about it. */
static void print_refusal(FILE *out, const struct choose_certificate *c)
{
    if (c->choice < 0)
        ROW("REFUSED", "No model could be run; MODELS says why.");
    else if (!c->met && c->statistics && !c->chaotic && !c->heat)
        ROW("REFUSED",
            "Nothing meets the tolerance of %g: the full model itself is known to %.2g only. Ask for at "
            "least ten times that. The closest is shown.",
            c->scene.tolerance, c->truth_error);
    else if (!c->met && c->heat)
        ROW("REFUSED",
            "Nothing meets the tolerance of %g: statistics of a motion by heat scatter too much over this "
            "time. Ask for a longer time or a larger tolerance, or leave out --heat. The closest is shown.",
            c->scene.tolerance);
    else if (!c->met && c->statistics)
        ROW("REFUSED",
            "Nothing meets the tolerance of %g: the motion is chaotic, and its statistics scatter too much "
            "over this time. Ask for a longer time or a larger tolerance. The closest is shown.",
            c->scene.tolerance);
    else if (!c->met)
        ROW("REFUSED", "Nothing meets the tolerance of %g. Ask for a larger one. The closest is shown.",
            c->scene.tolerance);
    else if (!c->in_time)
        ROW("REFUSED",
            "Nothing meets the deadline on %s: the fastest takes %.3g µs per frame, and %.3g µs are allowed. "
            "Allow a larger cost, frame or tolerance, or name a faster machine (--on). The fastest is shown.",
            choose_machine[c->machine].name, best_us(c), 1e6 * c->budget_s);
}

static void print_choice(FILE *out, const struct choose_certificate *c)
{
    const struct choose_attempt *t = chosen(c);
    const struct choose_verdict *v = &c->verdict[c->choice];
    char tolerance[64] = "", predicted[64] = "";
    if (method_find(t->scene.method) == &taylor)
        snprintf(tolerance, sizeof tolerance, " at tolerance %g", t->scene.tolerance);
    if (v->predicted >= 0.0)
        snprintf(predicted, sizeof predicted, "; %.2g was predicted", v->predicted);
    ROW(c->met ? "CHOSEN" : "CLOSEST", "%s by %s%s, %u step%s per frame of %g s.", v->candidate.name,
        t->scene.method, tolerance, t->scene.substeps, plural(t->scene.substeps), t->scene.frame_s);
    ROW("ERROR",
        "%.3g of %g asked, in %s over %g%s. An error of 1 is %.4g %s. The model's own error is %.3g%s.",
        t->error, c->scene.tolerance, observable(c)->name, c->scene.over, time_unit(c), c->span,
        scenes_dimensionless(&c->scene) ? "in the paper's units" : observable(c)->unit, v->error, predicted);
    if (c->met)
        ROW("WHY",
            "It takes the least time on %s of all that keep the tolerance. A longer step is not possible: "
            "%s.",
            choose_machine[c->machine].name, t->why);
    else
        ROW("WHY", "It has the smallest error. It fails the tolerance: %s.", t->why);
}

static void print_cost(FILE *out, const struct choose_certificate *c)
{
    const struct choose_attempt *t = chosen(c);
    const struct choose_verdict *full = &c->verdict[c->n_candidates - 1];
    double cost = choose_frame_cost(t, c->machine);
    char less[120] = "";
    if (full->best >= 0 && c->choice < c->n_candidates - 1)
        snprintf(less, sizeof less, ", and the full model at its best %.3g times",
                 choose_frame_cost(&full->attempt[full->best], c->machine) / cost);
    ROW("COST",
        "%.3g µs per frame on %s, %.3g %% of the %.3g µs allowed. The scene as given takes %.3g times as "
        "many instructions%s. Measured here, for information: %.0f ns per step.",
        best_us(c), choose_machine[c->machine].name, 100e-6 * best_us(c) / c->budget_s, 1e6 * c->budget_s,
        c->given_cost / cost, less, t->ns);
    fprintf(out, "           %-16s %14s %14s %15s %14s\n", "machine", "instr. a step", "instr. a frame",
            "µs a frame", "% of allowed");
    for (int i = 0; i < CHOOSE_MACHINES; i++) {
        double time_s = choose_time_s(t, c->method, i);
        fprintf(out, "           %-16s %14.0f %14.0f", choose_machine[i].name, t->cost[i],
                choose_frame_cost(t, i));
        if (time_s > 0.0)
            fprintf(out, " %14.4g %14.4g\n", time_s * 1e6, 100.0 * time_s / c->budget_s);
        else
            fprintf(out, " %14s %14s\n", "not known", "not judged");
    }
}

static void print_conditions(FILE *out, const struct choose_certificate *c)
{
    static const char *const sight[3] = {"Nothing watches it.", "The bus refuses such a command.",
                                         "The plant watches it."};
    for (int i = 0; i < c->n_conditions; i++)
        ROW(i ? "or if" : "VOID IF", "%s. Room for a factor of %.3g. %s", c->condition[i].text,
            c->condition[i].factor, sight[c->condition[i].guard]);
}

static void print_attempts(FILE *out, const struct choose_certificate *c, int i)
{
    for (int k = 0; k < CHOOSE_METHODS; k++) {
        const struct choose_attempt *t = &c->verdict[i].attempt[k];
        char head[HEAD + NAME + 1], error[80] = "";
        if (!choose_takes(c->verdict[i].candidate.scene.model, k))
            continue;
        snprintf(head, sizeof head, "%*s%s", HEAD, "", choose_method[k]->name);
        if (t->error >= 0.0)
            snprintf(error, sizeof error, "; with %u the error is %.2g", t->scene.substeps, t->error);
        if (i == c->choice && k == c->method)
            paragraph_print(out, HEAD + NAME, head, c->met ? "chosen" : "the closest");
        else if (t->met)
            paragraph_print(out, HEAD + NAME, head,
                            "%u step%s per frame keep%s the tolerance, at %.0f instructions",
                            t->scene.substeps, plural(t->scene.substeps), singular(t->scene.substeps),
                            choose_frame_cost(t, c->machine));
        else
            paragraph_print(out, HEAD + NAME, head, "%s%s", t->why, error);
    }
}

static void print_models(FILE *out, const struct choose_certificate *c)
{
    for (int i = 0; i < c->n_candidates; i++) {
        const struct choose_verdict *v = &c->verdict[i];
        if (*v->refused)
            ROW(i ? "" : "MODELS", "%s is refused: %s.", v->candidate.name, v->refused);
        else
            ROW(i ? "" : "MODELS", "%s: the error of the model itself is %.2g.", v->candidate.name, v->error);
        if (!*v->refused)
            print_attempts(out, c, i);
    }
}

static void print_lever(FILE *out, const struct choose_certificate *c)
{
    struct scene_point at;
    point_of_scene(&c->scene, &at);
    double a0 = at.si[LEVER_A0], unit_m = at.scale.length_m;
    ROW("MOTION", "gap from %.4g to %.4g m, %g contact switches, %.3g %% of the time without contact",
        a0 - c->high * unit_m, a0 - c->low * unit_m, c->switches, 100.0 * c->loss);
}

/* The motion that the choice was compared with. */
static void print_truth(FILE *out, const struct choose_certificate *c)
{
    const struct choose_facts *f = &c->facts;
    const char *unit = c->scene.model->n_states == 2 ? "the static compression" : "the gap";
    bool lever = c->scene.model->modal_form != NULL;
    ROW("TRUTH", "%s by %s, known to %.2g. Motions that start 1e-9 apart part by %.2g. Compared: %s.",
        c->scene.model->name,
        lever                    ? "fine steps of modal"
        : c->scene.model->linear ? "exact"
                                 : "taylor",
        c->truth_error, c->neighbours,
        !c->statistics ? lever ? "the largest difference at 24 instants of each period, start included"
                               : "the largest difference at three instants of each frame, start included"
        : c->heat      ? "mean, rms, peak and share of time without contact, because heat moves the lever"
        : c->chaotic
            ? "mean, rms, peak and share of time without contact, because the motion is chaotic"
            : "mean, rms, peak and share of time without contact, because the truth is not known better");
    for (int k = 0; k < STATISTICS && c->statistics; k++)
        ROW("", "%s %.4g, known to %.2g", choose_statistic_name[k], c->mean[k], c->spread[k]);
    if (lever && !c->heat)
        ROW("", "without heat, as --heat was not given: a file of --out has temperature = 0");
    if (lever) {
        print_lever(out, c);
        return;
    }
    ROW("MOTION",
        "compression from %.3g to %.3g times %s, %g contact switches, %.3g %% of the time without contact",
        c->low, c->high, unit, c->switches, 100.0 * c->loss);
    if (f->amplitude > 0.0)
        ROW("", "linear theory predicts an amplitude of %.3g times %s", f->amplitude, unit);
    if (f->fast > 0.0)
        ROW("", "the fast drive is %.3g times as fast as the fastest slow frequency", f->fast / f->slow);
    if (fabs(f->multiplier - 1.0) > 0.0)
        ROW("", "Floquet multiplier of the unaveraged linear part %.4g", f->multiplier);
}

void choose_print(FILE *out, const struct choose_certificate *c)
{
    fprintf(out, "certificate for %s\n", c->title);
    print_refusal(out, c);
    if (c->choice >= 0) {
        print_choice(out, c);
        print_cost(out, c);
        print_conditions(out, c);
    }
    print_models(out, c);
    print_truth(out, c);
}

/* The watch of the certificate, with a climb to the full model where the method takes that with this step:
 * as it is, or left to auto. Without a climb where neither does. */
static void print_watch(const struct choose_certificate *c, struct scene *s)
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
    s.cost_s = c->scene.cost_s > 0.0 ? c->budget_s / s.substeps : 0.0;
    if (choose_watched(c))
        print_watch(c, &s);
    scene_print(out,
                c->met && c->in_time ? "chosen by contactplant choose; tolerance is the method's"
                                     : "the closest that contactplant choose found, not certified",
                &s);
}
