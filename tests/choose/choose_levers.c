/* choose_levers.c - contactplant choose over random AFM levers, each certificate judged by another integrator
 * of the lever's equations (tests/choose/lever_judge.h): choose_levers N SEED.
 *
 * Levers have one to four modes, a quality of 20 to 300, soft to hard samples with and without attraction,
 * some with two branches of it or a viscosity. They swing freely, tap, or stay pressed on. Any output is
 * asked for, to 1e-3 to 0.1. It ends with `N passed, N failed`. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "host_sim/choose/choose.h"
#include "models/afm_lever.h"
#include "host_sim/choose/choose_climb.h"
#include "host_sim/choose/choose_run.h"
#include "host_sim/choose/choose_search.h"
#include "host_sim/scene/scene_check.h"
#include "tests/choose/choose_judge.h"
#include "tests/choose/choose_out.h"
#include "tests/choose/lever_judge.h"
#include "tests/fixture/draw.h"

static void draw_lever(struct scene *s)
{
    double *v = s->value;
    scenes_default(s, &afm_lever);
    v[LEVER_F0] = spread(1e4, 5e5);
    v[LEVER_K] = spread(0.1, 50.0);
    v[LEVER_Q] = spread(20.0, 300.0);
    v[LEVER_TEMPERATURE] = 295.0;
    v[LEVER_MODES] = floor(uniform(1.0, 4.999));
    v[LEVER_RADIUS] = spread(5e-9, 30e-9);
    v[LEVER_HAMAKER] = v[LEVER_HAMAKER_OUT] = chance(0.2) ? 0.0 : spread(1e-20, 2e-19);
    if (v[LEVER_HAMAKER] > 0.0 && chance(0.2))
        v[LEVER_HAMAKER_OUT] *= uniform(1.1, 2.0);
    v[LEVER_MODULUS] = spread(1e8, 2e10);
    v[LEVER_VISCOSITY] = v[LEVER_MODES] > 1.0 || chance(0.7) ? 0.0 : spread(0.1, 50.0);
}

/* Free, tapping or pressed on. */
static void draw_motion(struct scene *s)
{
    double *v = s->value, swing = spread(1e-9, 50e-9),
           high = chance(0.4) ? uniform(2.0, 6.0) : uniform(0.6, 1.1);
    bool pressed = chance(0.2);
    v[LEVER_HEIGHT] = pressed ? -uniform(0.0, 3e-9) : high * swing;
    s->drive[LEVER_FORCE] = (struct scene_drive){
        .amplitude = (pressed ? 0.05 : 1.0 / v[LEVER_Q]) * v[LEVER_K] * swing,
        .frequency_Hz = v[LEVER_F0] * (pressed ? uniform(0.2, 2.0) : uniform(0.98, 1.02))};
    if (chance(0.2))
        s->drive[LEVER_FORCE_2] = (struct scene_drive){.amplitude = 0.02 * v[LEVER_K] * swing,
                                                       .frequency_Hz = v[LEVER_F0] * uniform(2.0, 7.0)};
    if (chance(0.2))
        s->drive[LEVER_Z] =
            (struct scene_drive){.amplitude = 0.1 * swing, .frequency_Hz = v[LEVER_F0] * uniform(0.01, 0.05)};
    if (pressed && chance(0.5))
        s->drive[LEVER_STIFFNESS] = (struct scene_drive){.amplitude = uniform(0.01, 0.3),
                                                         .frequency_Hz = v[LEVER_F0] * uniform(0.5, 4.0)};
    s->started = !pressed && chance(0.7);
    for (int i = 0; i < LEVER_STATES; i++)
        s->start[i] = 0.0;
    s->start[0] = 0.9 * swing;
}

static void draw(struct scene *s)
{
    static const int asked[] = {0, 1, 2, 3, LEVER_GAP, LEVER_DEFLECTION};
    char why[SCENE_CHECK_REASON];
    do {
        draw_lever(s);
        draw_motion(s);
        s->observable = asked[(int)uniform(0.0, 5.999)];
        s->tolerance = spread(1e-3, 0.1);
        s->cost_s = 0.0;
        s->frame_s = 1e-3;
        s->substeps = 256;
        s->dilation = s->frame_s * s->value[LEVER_F0] / uniform(0.5, 1.5);
        s->over = uniform(15.0, 60.0) / s->value[LEVER_F0];
    } while (scene_check(s, why));
}

static struct {
    int scenes, certified, wrong, unknown, unmet, cheaper, loud, other_run, fewer, bare, statistics;
    double worst, saved;
} count;

static double apart(const struct choose_values *a, const struct lever_judged *j, double span)
{
    double most = 0.0;
    for (int i = 0; i < a->n; i++)
        most = fmax(most, fabs(a->value[i] - j->value[i]));
    return a->good ? most / span : HUGE_VAL;
}

static double statistics_apart(const struct choose_values *a, const struct lever_judged *j, double span)
{
    struct choose_record ra = {.n = a->n, .n_values = a->n, .value = a->value, .loss = a->loss};
    struct choose_record rb = {.n = a->n, .n_values = a->n, .value = j->value, .loss = j->loss};
    double sa[STATISTICS], sb[STATISTICS], most = 0.0;
    choose_statistics(&ra, span, sa);
    choose_statistics(&rb, span, sb);
    for (int k = 0; k < STATISTICS; k++)
        most = fmax(most, fabs(sa[k] - sb[k]));
    return a->good ? most : HUGE_VAL;
}

/* The chosen scene's error; *known: how well the judge knows its own motion. */
static double judged(const struct choose_certificate *c, double *known)
{
    struct choose_values v = choose_judge_run(&c->verdict[c->choice].attempt[c->method].scene);
    struct lever_judged j[2];
    double frame = c->scene.frame_s / c->scene.dilation, error = HUGE_VAL;
    double *at = calloc((size_t)v.n + 1, sizeof *at);
    bool good = true;
    for (int i = 0; i < v.n; i++)
        at[i] = (i + choose_judge_part(&c->scene, i)) * frame;
    for (int i = 0; i < 2; i++) {
        j[i].value = calloc((size_t)v.n + 1, sizeof(double));
        good &= lever_judge(&c->scene, i ? 1e-9 : 1e-7, at, v.n, &j[i]);
    }
    double span = j[1].span + 1e-6 * c->unit;
    *known = HUGE_VAL;
    if (good) {
        struct choose_values coarse = {.n = v.n, .value = j[0].value, .good = true, .loss = j[0].loss};
        *known = (c->statistics ? statistics_apart : apart)(&coarse, &j[1], span);
        error = (c->statistics ? statistics_apart : apart)(&v, &j[1], span);
    }
    free(at);
    free(j[0].value);
    free(j[1].value);
    free(v.value);
    return error;
}

static void look(int i, const struct scene *s)
{
    static struct choose_certificate c;
    bool escaped;
    memset(&c, 0, sizeof c);
    c.title = "lever";
    c.scene = *s;
    const char *why = choose_search(&c, NULL, &escaped);
    count.scenes++;
    if (why || c.choice < 0 || !c.met) {
        printf("      %d: %s\n", i, why ? why : "not met");
        count.unmet++;
        return;
    }
    const struct choose_verdict *v = &c.verdict[c.choice], *full = &c.verdict[c.n_candidates - 1];
    const struct choose_attempt *t = &v->attempt[c.method];
    double known, error = judged(&c, &known);
    bool decided = known <= 0.1 * c.scene.tolerance, wrong = decided && !(error <= c.scene.tolerance);
    count.certified++;
    count.statistics += c.statistics;
    count.unknown += !decided;
    count.wrong += wrong;
    if (decided)
        count.worst = fmax(count.worst, error / c.scene.tolerance);
    count.fewer += (v->candidate.kind & KIND_FEWER) != 0;
    count.bare += (v->candidate.kind & KIND_BARE) != 0;
    count.cheaper += c.choice < c.n_candidates - 1;
    count.saved += log(
        full->best >= 0 ? choose_frame_cost(&full->attempt[full->best], 0) / choose_frame_cost(t, 0) : 1.0);
    count.loud += !choose_judge_quiet(&c);
    count.other_run += choose_out_differs(&c) != 0;
    printf("      %d: %g modes, %s, %s: %s, %u steps a frame, tolerance %.2g, error %.2g, judged %.2g (known "
           "to %.1g)%s%s\n",
           i, s->value[LEVER_MODES], afm_lever.output_signal[(int)s->observable].name,
           c.statistics ? "statistics" : "trajectory", v->candidate.name, t->scene.substeps,
           c.scene.tolerance, t->error, error, known, decided ? "" : ": NOT DECIDED", wrong ? ": FALSE" : "");
}

static int verdict(const char *text, double got, bool good)
{
    printf("%s  %s: %g\n", good ? "ok  " : "FAIL", text, got);
    return !good;
}

int main(int argc, char **argv)
{
    struct scene s;
    int failed = 0;
    if (argc < 3) {
        fprintf(stderr, "usage: choose_levers N SEED\n");
        return 2;
    }
    state = strtoull(argv[2], NULL, 10);
    for (int i = 0; i < atoi(argv[1]); i++) {
        draw(&s);
        look(i, &s);
    }
    double all = count.certified;
    printf(
        "      %d scenes: %d certified (%d by statistics), %d not met; chosen with fewer modes %d, without "
        "attraction %d; largest judged error over tolerance %.3g\n",
        count.scenes, count.certified, count.statistics, count.unmet, count.fewer, count.bare, count.worst);
    failed += verdict("false certificates", count.wrong, count.wrong == 0);
    failed += verdict("certificates that the judge does not know to a tenth of their tolerance",
                      count.unknown, count.unknown <= 0.1 * all);
    failed += verdict("share of scenes without a certificate", (double)count.unmet / count.scenes,
                      count.unmet <= 0.1 * count.scenes);
    failed += verdict("share of certificates with a cheaper model", count.cheaper / all,
                      count.cheaper >= 0.3 * all);
    double saved = exp(count.saved / all);
    failed += verdict("mean cost saved against the full model at its best", saved, saved >= 1.3);
    failed += verdict("watches that trip in the motion that was certified", count.loud, count.loud == 0);
    failed += verdict("scenes whose --out is another run than the one judged", count.other_run,
                      count.other_run == 0);
    printf("%d passed, %d failed\n", 7 - failed, failed);
    return failed > 0;
}
