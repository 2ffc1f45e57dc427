/* choose_scenes.c - contactplant choose against the judge of tests/choose/choose_judge.h: all presets,
 * then random scenes until there are N; what it saves, over these alone. With --random there are N random
 * scenes and no presets. choose_scenes N SEED force|motion [--random] [-v], by which draw of
 * tests/choose/choose_draw.h.
 *
 * A false certificate: choose certified a model that the judge finds outside the tolerance. A wrong
 * refusal: choose refused a model for its error, or the last coarser step of the chosen one, and the judge
 * finds it inside. The program prints one line a scene, then checks, then `N passed, N failed`. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "host_sim/choose/choose.h"
#include "host_sim/choose/choose_climb.h"
#include "host_sim/choose/choose_search.h"
#include "host_sim/choose/choose_watch.h"
#include "models/scenes/scenes_table.h"
#include "tests/choose/choose_draw.h"
#include "tests/choose/choose_judge.h"
#include "tests/choose/choose_out.h"

enum { CERTIFICATES = 4096 };
static const double later_most = 12.0; /* times the time asked */
/* The presets of levers are judged over a fifth of their time: whole they take more than all others together.
 * choose_levers.c judges levers. */
static const double lever_share = 0.2;

/* Over the certificates of random scenes: what their frames cost less than others. Presets have few cheaper
 * models, and are always the same ones. */
struct saving {
    int n;
    double times[CERTIFICATES];
};

enum { BY_CHANGES, BY_TIME, BY_FREQUENCY, BY_MOTION, BY };

static struct {
    int by[BY];
    int scenes, certified, false_certificates, refusals, wrong_refusals, escaped, unmet, statistics, watched,
        loud, here, later, too_late, other_run;
    int drawn, cheaper, useless, lowest, coarser; /* certificates of random scenes */
    struct saving given, full, full_cheaper;      /* the last: of those with a cheaper model */
    double worst;
} count;

static void refusals(const struct choose_certificate *c, const struct choose_values *truth, bool verbose)
{
    for (int i = 0; i < c->n_candidates - 1; i++) {
        const struct choose_verdict *v = &c->verdict[i];
        struct scene s = v->candidate.scene;
        if (v->candidate.refused || !*v->refused)
            continue;
        s.method = s.model->modal_form ? "modal" : s.model->linear ? "exact" : "taylor";
        s.substeps *= s.model->modal_form ? 16 : 1;
        s.tolerance = 1e-10;
        double error = choose_judge_error(c, &s, truth);
        count.refusals++;
        count.wrong_refusals += error <= c->scene.tolerance;
        if (verbose && error <= c->scene.tolerance)
            printf("      wrongly refused: %s, error %.3g, because %s\n", s.model->name, error, v->refused);
    }
    const struct choose_attempt *t = &c->verdict[c->choice].attempt[c->method];
    if (!t->met || !t->coarser.model)
        return;
    double error = choose_judge_error(c, &t->coarser, truth);
    count.refusals++;
    count.wrong_refusals += error <= c->scene.tolerance;
    if (verbose && error <= c->scene.tolerance)
        printf("      wrongly refused: %u substeps of %s, error %.3g\n", t->coarser.substeps,
               t->coarser.method, error);
}

static void save(struct saving *o, double times)
{
    if (o->n < CERTIFICATES)
        o->times[o->n++] = times;
}

/* A cheaper model met the tolerance, and costs no less. */
static bool useless(const struct choose_certificate *c)
{
    bool met = false;
    for (int i = 0; i < c->n_candidates - 1; i++)
        met |= c->verdict[i].best >= 0;
    return met && c->choice == c->n_candidates - 1;
}

static void watched(const struct scene_watch *w)
{
    int i = w ? (int)w->observable : -1;
    if (!w)
        return;
    count.watched++;
    count.by[i == MODEL_CHANGES                                        ? BY_CHANGES
             : i == MODEL_TIME                                         ? BY_TIME
             : i == MODEL_EIGENFREQUENCY || i == MODEL_DRIVE_FREQUENCY ? BY_FREQUENCY
                                                                       : BY_MOTION]++;
}

static void saved(const struct choose_certificate *c)
{
    double cost = choose_frame_cost(&c->verdict[c->choice].attempt[c->method], 0);
    const struct choose_verdict *full = &c->verdict[c->n_candidates - 1];
    double best = full->best >= 0 ? choose_frame_cost(&full->attempt[full->best], 0) : HUGE_VAL;
    bool cheaper = c->choice < c->n_candidates - 1;
    count.drawn++;
    count.cheaper += cheaper;
    count.useless += useless(c);
    count.lowest += c->n_candidates == 1;
    count.coarser += cost < c->given_cost;
    save(&count.given, c->given_cost / cost);
    save(&count.full, best / cost);
    if (cheaper)
        save(&count.full_cheaper, best / cost);
}

static void certified(const struct choose_certificate *c, double error, bool drawn)
{
    count.certified++;
    count.statistics += c->statistics;
    count.false_certificates += !(error <= c->scene.tolerance);
    count.worst = fmax(count.worst, error / c->scene.tolerance);
    watched(choose_watched(c));
    if (drawn)
        saved(c);
}

/* Until the time that is watched, where that is near, the error is within the tolerance. */
static void later(const struct choose_certificate *c)
{
    const struct scene_watch *w = choose_watched(c);
    struct scene s = c->scene, chosen = c->verdict[c->choice].attempt[c->method].scene;
    if (!w || (int)w->observable != MODEL_TIME || c->condition[0].factor > later_most)
        return;
    s.over = chosen.over = w->above;
    struct choose_values truth = choose_judge(&s, false);
    double error = choose_judge_error(c, &chosen, &truth);
    free(truth.value);
    count.later++;
    if (error <= s.tolerance)
        return;
    count.too_late++;
    printf("      error %.2g before its %s\n", error, c->condition[0].text);
}

static void look(const char *name, const struct scene *s, bool drawn, bool verbose)
{
    static struct choose_certificate c;
    bool escaped;
    memset(&c, 0, sizeof c);
    c.title = name;
    c.scene = *s;
    const char *why = choose_search(&c, NULL, &escaped);
    count.scenes++;
    count.escaped += escaped;
    if (why || c.choice < 0) {
        printf("      %s: %s\n", name, why ? why : "no model");
        return;
    }
    struct choose_values truth = choose_judge(&c.scene, c.statistics);
    const struct choose_attempt *t = &c.verdict[c.choice].attempt[c.method];
    double error = choose_judge_error(&c, &t->scene, &truth);
    printf("      %s: %s %s %s %u of %u substeps, tolerance %.2g, error %.2g, judged %.2g\n", name,
           c.met ? "certified" : "closest", t->scene.model->name, t->scene.method, t->scene.substeps,
           c.scene.substeps, c.scene.tolerance, t->error, error);
    if (c.met)
        certified(&c, error, drawn);
    int differ = choose_out_differs(&c);
    count.other_run += differ != 0;
    if (differ)
        printf("      its --out is another run: %d frames\n", differ);
    if (c.met && !choose_judge_quiet(&c)) {
        count.loud++;
        printf("      its watch trips: %s\n", c.condition[0].text);
    }
    later(&c);
    for (int i = 0; i < c.n_conditions; i++)
        count.here += c.condition[i].factor < 1.0;
    for (int i = 0; i < c.n_conditions && verbose; i++)
        printf("      %s %s (%.3g): %s\n", i ? "     " : "void:", c.condition[i].text, c.condition[i].factor,
               choose_guard_name[c.condition[i].guard]);
    count.unmet += !c.met;
    if (!c.statistics)
        refusals(&c, &truth, verbose);
    free(truth.value);
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(struct saving *o)
{
    qsort(o->times, (size_t)o->n, sizeof *o->times, ascending);
    return o->n > 0 ? o->times[o->n / 2] : 0.0;
}

static int verdict(const char *text, double got, bool good)
{
    printf("%s  %s: %g\n", good ? "ok  " : "FAIL", text, got);
    return !good;
}

static int conclude(void)
{
    double all = count.drawn, given = median(&count.given), full = median(&count.full);
    double coarser = count.coarser / all, wrong = (double)count.wrong_refusals / count.refusals;
    int failed = 0;
    printf("      %d scenes: %d certified (%d by statistics), %d not met, %d escape; %d refusals\n",
           count.scenes, count.certified, count.statistics, count.unmet, count.escaped, count.refusals);
    failed += verdict("false certificates", count.false_certificates, count.false_certificates == 0);
    printf("      of %d random scenes that are certified:\n", count.drawn);
    failed +=
        verdict("share of certificates that cost less than the scene as given", coarser, coarser >= 0.5);
    failed += verdict("share of certificates with a cheaper model", count.cheaper / all,
                      count.cheaper / all >= 0.4);
    printf("      one would do but costs no less: %.3g; there is none: %.3g\n", count.useless / all,
           count.lowest / all);
    failed += verdict("median cost saved against the scene as given", given, given >= 5.0);
    failed += verdict("the same against the full model at its own best", full, full >= 1.0);
    double cheaper = median(&count.full_cheaper);
    failed += verdict("the same where the model is a cheaper one", cheaper, cheaper >= 2.5);
    printf("      of all scenes:\n");
    failed += verdict("share of wrong refusals", wrong, wrong <= 0.1);
    failed += verdict("certificates without a watch", count.certified - count.watched,
                      count.watched == count.certified);
    printf("      watched: %d changes, %d time, %d a frequency, %d motion or force\n", count.by[BY_CHANGES],
           count.by[BY_TIME], count.by[BY_FREQUENCY], count.by[BY_MOTION]);
    failed += verdict("watches that trip in the motion that was certified", count.loud, count.loud == 0);
    failed += verdict("conditions that the certified motion is beyond", count.here, count.here == 0);
    double late = count.later > 0 ? (double)count.too_late / count.later : 0.0;
    printf("      watched times at most %g times the time asked: %d\n", later_most, count.later);
    failed += verdict("share of them before which the error passes the tolerance", late, late <= 0.1);
    printf("      largest judged error over tolerance: %.3g\n", count.worst);
    failed += verdict("scenes whose --out is another run than the one judged", count.other_run,
                      count.other_run == 0);
    printf("%d passed, %d failed\n", 12 - failed, failed);
    return failed > 0;
}

static void look_at_presets(int wanted, bool verbose)
{
    struct scene s;
    for (int i = 0; i < SCENES && i < wanted; i++) {
        s = scenes_table[i].scene;
        s.over *= s.model->modal_form ? lever_share : 1.0;
        look(scenes_table[i].name, &s, false, verbose);
    }
    for (int i = 0; i < SCENES && wanted > SCENES; i++) {
        s = scenes_table[i].scene;
        s.tolerance = 0.1;
        s.over *= 2.0;
        if (!strncmp(scenes_table[i].name, "shaft-fig9", 10))
            look("the same at tolerance 0.1, twice as long", &s, false, verbose);
    }
}

static bool has(const char *option, int argc, char **argv)
{
    for (int i = 4; i < argc; i++)
        if (!strcmp(argv[i], option))
            return true;
    return false;
}

int main(int argc, char **argv)
{
    char name[40];
    struct scene s;
    if (argc < 4 || (strcmp(argv[3], "force") && strcmp(argv[3], "motion"))) {
        fprintf(stderr, "usage: choose_scenes N SEED force|motion [--random] [-v]\n");
        return 2;
    }
    int wanted = atoi(argv[1]);
    bool verbose = has("-v", argc, argv);
    enum choose_draw draw = strcmp(argv[3], "force") ? DRAW_BY_MOTION : DRAW_BY_FORCE;
    choose_draw_seed(strtoull(argv[2], NULL, 10));
    if (has("--random", argc, argv))
        wanted += SCENES;
    else
        look_at_presets(wanted, verbose);
    for (int i = SCENES; i < wanted; i++) {
        snprintf(name, sizeof name, "random-%d", i - SCENES);
        choose_draw(draw, &s);
        look(name, &s, true, verbose);
    }
    return conclude();
}
