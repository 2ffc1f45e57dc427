/* choose_scenes.c - contactplant choose against a judge that shares nothing with its measurements: all presets, then
 * random scenes until there are N. choose_scenes N SEED [-v]
 *
 * The judge runs the full model by rk4 with steps of 0.005 rad of its fastest motion where that converges to a tenth of the tolerance,
 * and else by the method of choose's truth at other steps and tolerance; it compares in the middle of the frames,
 * where choose does not look, and not at their ends. A rung that choose certified and the judge finds outside the tolerance is
 * a false certificate; a rung that it refused for its error, or the last coarser step of the chosen one, and that
 * the judge finds inside, is a wrong refusal. Chaotic scenes are judged by the statistics of another start.
 * Prints one line a scene, then checks; ends with `N passed, N failed`. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/plant_scene.h"
#include "host_sim/choose.h"
#include "host_sim/scene_check.h"
#include "models/afm_tip.h"
#include "models/elementary.h"
#include "models/hertz_rig.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"

enum { SUBSTEPS_MAX = 1 << 20 };
static const double fine_angle = 0.005, coarse_tolerance = 1e-4;

/* ---- random scenes ---- */

static uint64_t state;

static double uniform(double low, double high)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * ((double)(state >> 11) / 9007199254740992.0);
}

static double spread(double low, double high)
{
    return exp(uniform(log(low), log(high)));
}

static bool chance(double share)
{
    return uniform(0.0, 1.0) < share;
}

/* A rig of its own size, at 5 to 60 % of... any amplitude, some with a fast drive, some kicked. */
static void random_rig(struct scene *s)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct harmonic none[MODEL_INPUTS];
    struct scale scale;
    scenes_default(s, &hertz_rig);
    s->value[RIG_MASS] = spread(1.0, 40.0);
    s->value[RIG_PRELOAD] = spread(10.0, 400.0);
    scenes_resolve(s, si, none);
    hertz_rig.prepare(si, p, &scale);
    double Hz = 1.0 / (2.0 * ELEMENTARY_PI * scale.time_s);
    s->value[RIG_DAMPING] = 2.0 * spread(0.005, 0.1) * s->value[RIG_MASS] / scale.time_s;
    s->drive[RIG_FORCE] = (struct scene_drive){.amplitude = spread(1e-3, 0.5) * scale.force_N,
                                               .frequency_Hz = uniform(0.2, 1.6) * Hz,
                                               .phase_rad = uniform(0.0, 6.0)};
    double W = uniform(5.0, 12.0);
    if (chance(0.2))
        s->drive[RIG_FAST_FORCE] =
            (struct scene_drive){.amplitude = spread(0.01, 20.0) * scale.force_N, .frequency_Hz = W * Hz};
    else if (chance(0.2))
        s->drive[RIG_STIFFNESS] =
            (struct scene_drive){.amplitude = spread(1e-3, 2.0), .frequency_Hz = W * Hz};
    if (chance(0.3)) {
        s->started = true;
        s->start[0] = (1.0 + uniform(-0.5, 0.5)) * scale.length_m;
    }
    s->over = uniform(30.0, 100.0) / Hz;
    s->frame_s = 0.2 / Hz;
}

static void random_rolling(struct scene *s)
{
    scenes_default(s, &rolling_contact);
    s->paper = true;
    s->value[ROLLING_PAPER_ZETA] = spread(0.005, 0.1);
    s->value[ROLLING_PAPER_XI0] = spread(1e-3, 1.0);
    s->value[ROLLING_PAPER_OMEGA] = uniform(0.3, 1.7);
    s->value[ROLLING_PAPER_PHI] = 0.0;
    s->over = uniform(150.0, 500.0);
    s->dilation = 1e-3;
}

static void random_tip(struct scene *s)
{
    bool attracts = chance(0.3);
    scenes_default(s, &afm_tip);
    s->paper = true;
    s->value[TIP_PAPER_BETA] = attracts ? uniform(0.2, 0.8) : spread(0.2, 5.0);
    s->value[TIP_PAPER_C] = spread(0.01, 0.1);
    s->value[TIP_PAPER_R] = chance(0.5) ? 0.0 : spread(1e-3, 0.5);
    s->value[TIP_PAPER_FAST_OMEGA] = uniform(6.0, 12.0);
    s->value[TIP_PAPER_F] = attracts ? spread(1e-4, 0.005) : spread(1e-3, 0.5);
    s->value[TIP_PAPER_OMEGA] = uniform(0.2, 1.8);
    s->value[TIP_PAPER_PHI] = 0.0;
    s->value[TIP_PAPER_SIGN] = attracts ? 1.0 : -1.0;
    s->over = uniform(150.0, 400.0);
    s->dilation = 1e-3;
}

static void random_shaft(struct scene *s)
{
    static const double gap_stiffness[3] = {2.626e4, 1.4e6, 3.502e7};
    scenes_default(s, &shaft_bearing);
    s->value[SHAFT_KG1] = s->value[SHAFT_KG3] = gap_stiffness[(int)uniform(0.0, 2.999)];
    double c = spread(4.0, 100.0);
    s->value[SHAFT_C1] = s->value[SHAFT_C2] = s->value[SHAFT_C3] = c;
    s->drive[chance(0.8) ? 1 : 0] =
        (struct scene_drive){.amplitude = spread(0.5, 15.0), .frequency_Hz = uniform(8.0, 120.0)};
    s->over = uniform(0.3, 0.8);
}

static void random_scene(struct scene *s)
{
    static void (*const make[])(struct scene *) = {random_rig, random_rig, random_rolling, random_tip,
                                                   random_shaft};
    char why[SCENE_CHECK_REASON];
    do {
        make[(int)uniform(0.0, 4.999)](s);
        s->observable = (int)uniform(0.0, 3.999);
        s->tolerance = spread(3e-4, 0.05);
        s->cost_s = 0.0;
    } while (scene_check(s, why));
}

/* ---- the judge ---- */

static struct {
    int scenes, certified, false_certificates, cheaper, coarser, refusals, wrong_refusals, escaped, unmet,
        statistics, by_rk4;
    int n_saved;
    double saved[4096], saved_full[4096], worst;
} count;

struct values {
    int n;
    double *value, loss;
    bool good;
};

struct pair {
    struct plant plant, ahead;
    double work[METHOD_WORK], work_ahead[METHOD_WORK];
};

/* The observable in the middle of each frame: a copy goes half a frame further than the plant, which never stops there. */
static void middle(struct pair *o, const struct scene *s, double substeps, struct values *v)
{
    double output[MODEL_OUTPUTS];
    uint64_t half = (uint64_t)substeps / 2;
    struct instant to = {o->plant.now.tick + half, (uint64_t)substeps % 2 ? 32768u : 0u};
    o->ahead = o->plant;
    o->ahead.work = o->work_ahead;
    memcpy(o->work_ahead, o->work, sizeof o->work);
    v->good &= plant_advance(&o->ahead, to);
    plant_output(&o->ahead, output);
    v->value[v->n++] = output[(int)s->observable];
}

static struct values follow(const struct scene *s, const char *method, double substeps, double tol,
                            double nudge)
{
    struct values v = {.value = calloc((size_t)choose_frames(s), sizeof(double)), .good = true};
    struct pair *o = calloc(1, sizeof *o);
    double si[MODEL_PARAMETERS], x[MODEL_STATES];
    struct harmonic drive[MODEL_INPUTS];
    scenes_resolve(s, si, drive);
    const struct plant_config c = {.model = s->model,
                                   .si = si,
                                   .method = method_find(method),
                                   .tick_s = s->frame_s / substeps,
                                   .dilation = s->dilation,
                                   .tol = tol,
                                   .work = o->work};
    v.good = !plant_init(&o->plant, &c);
    if (v.good) {
        plant_scene_begin(&o->plant, s, si, drive);
        memcpy(x, o->plant.x, sizeof x);
        x[0] += nudge;
        plant_set_state(&o->plant, x);
    }
    for (int i = 0; i < (int)choose_frames(s) && v.good; i++) {
        middle(o, s, substeps, &v);
        v.good = v.good && plant_run(&o->plant, (uint64_t)substeps);
    }
    v.loss = o->plant.total_time > 0.0 ? o->plant.loss_time / o->plant.total_time : 0.0;
    free(o);
    return v;
}

static double span_of(const struct values *v, double unit)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int i = 0; i < v->n; i++) {
        low = fmin(low, v->value[i]);
        high = fmax(high, v->value[i]);
    }
    return high - low + 1e-6 * unit;
}

static double statistics_apart(const struct values *a, const struct values *b, double span)
{
    struct choose_record ra = {.n = a->n, .n_values = a->n, .value = a->value, .loss = a->loss};
    struct choose_record rb = {.n = b->n, .n_values = b->n, .value = b->value, .loss = b->loss};
    double sa[STATISTICS], sb[STATISTICS], most = 0.0;
    choose_statistics(&ra, span, sa);
    choose_statistics(&rb, span, sb);
    for (int k = 0; k < STATISTICS; k++)
        most = fmax(most, fabs(sa[k] - sb[k]));
    return most;
}

static double apart(const struct values *a, const struct values *truth, double unit, bool statistics)
{
    double most = 0.0, span = span_of(truth, unit);
    if (!a->good || !truth->good)
        return HUGE_VAL;
    if (statistics)
        return statistics_apart(a, truth, span);
    for (int i = 0; i < a->n; i++)
        most = fmax(most, fabs(a->value[i] - truth->value[i]));
    return most / span;
}

/* Substeps by which a frame is cut into steps of `angle` rad of the fastest motion, a multiple of the scene's own. */
static double cut(const struct scene *s, double angle)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], rate;
    struct harmonic drive[MODEL_INPUTS];
    struct scale scale;
    scenes_resolve(s, si, drive);
    s->model->prepare(si, p, &scale);
    rate = s->model->eigenfrequency(p) / scale.time_s;
    for (int i = 0; i < s->model->n_inputs; i++)
        rate = fabs(drive[i].amplitude) > 0.0 ? fmax(rate, drive[i].omega) : rate;
    return ceil(rate * s->frame_s / s->dilation / angle / s->substeps) * s->substeps;
}

static bool noisy(const struct scene *s)
{
    double noise = 0.0;
    for (int i = 0; i < s->model->n_inputs; i++)
        noise += s->drive[i].noise;
    return noise > 0.0;
}

/* By rk4 if that knows it well enough, by what it says with steps twice as long. */
static bool judge_by_rk4(const struct scene *s, struct values *v)
{
    if (s->tolerance < coarse_tolerance || noisy(s))
        return false;
    *v = follow(s, "rk4", cut(s, fine_angle), 0.0, 0.0);
    struct values coarse = follow(s, "rk4", cut(s, 2.0 * fine_angle), 0.0, 0.0);
    bool good = apart(&coarse, v, 1.0, false) < 0.1 * s->tolerance;
    free(coarse.value);
    if (!good)
        free(v->value);
    return good;
}

/* As choose's truth, but otherwise: see the top. Noise starts over one step of the scene's own. */
static struct values judge(const struct scene *s, bool statistics)
{
    struct values v;
    if (statistics)
        return follow(s, "rk4", cut(s, 0.05), 0.0, 7e-9);
    if (judge_by_rk4(s, &v)) {
        count.by_rk4++;
        return v;
    }
    return follow(s, s->model->linear ? "exact" : "taylor", (noisy(s) ? 1.0 : 5.0) * s->substeps, 1e-13, 0.0);
}

static double error_of(const struct choose_certificate *c, const struct scene *s, const struct values *truth)
{
    struct values v = follow(s, s->method, s->substeps, s->tolerance, 0.0);
    double error = apart(&v, truth, c->unit, c->statistics);
    free(v.value);
    return error;
}

/* ---- the count ---- */

static void refusals(const struct choose_certificate *c, const struct values *truth, bool verbose)
{
    for (int i = 0; i < c->n_rungs - 1; i++) {
        const struct choose_verdict *v = &c->verdict[i];
        struct scene s = v->rung.scene;
        if (v->rung.refused || !*v->refused)
            continue;
        s.method = s.model->linear ? "exact" : "taylor";
        s.tolerance = 1e-10;
        double error = error_of(c, &s, truth);
        count.refusals++;
        count.wrong_refusals += error <= c->scene.tolerance;
        if (verbose && error <= c->scene.tolerance)
            printf("      wrongly refused: %s, error %.3g, because %s\n", s.model->name, error, v->refused);
    }
    const struct choose_trial *t = &c->verdict[c->rung].trial[c->method];
    if (!t->met || !t->coarser.model)
        return;
    double error = error_of(c, &t->coarser, truth);
    count.refusals++;
    count.wrong_refusals += error <= c->scene.tolerance;
    if (verbose && error <= c->scene.tolerance)
        printf("      wrongly refused: %g substeps of %s, error %.3g\n", t->coarser.substeps,
               t->coarser.method, error);
}

static void certified(const struct choose_certificate *c, double error)
{
    const struct choose_trial *t = &c->verdict[c->rung].trial[c->method];
    const struct choose_verdict *full = &c->verdict[c->n_rungs - 1];
    count.certified++;
    count.statistics += c->statistics;
    count.false_certificates += !(error <= c->scene.tolerance);
    count.worst = fmax(count.worst, error / c->scene.tolerance);
    count.cheaper += c->rung < c->n_rungs - 1;
    count.coarser += choose_frame_cost(t, 0) < c->given_cost;
    count.saved[count.n_saved] = c->given_cost / choose_frame_cost(t, 0);
    count.saved_full[count.n_saved++] =
        full->best >= 0 ? choose_frame_cost(&full->trial[full->best], 0) / choose_frame_cost(t, 0) : HUGE_VAL;
}

static void look(const char *name, const struct scene *s, bool verbose)
{
    static struct choose_certificate c;
    bool escaped;
    memset(&c, 0, sizeof c);
    c.title = name;
    c.scene = *s;
    const char *why = choose_search(&c, NULL, &escaped);
    count.scenes++;
    count.escaped += escaped;
    if (why || c.rung < 0) {
        printf("      %s: %s\n", name, why ? why : "no rung");
        return;
    }
    struct values truth = judge(&c.scene, c.statistics);
    const struct choose_trial *t = &c.verdict[c.rung].trial[c.method];
    double error = error_of(&c, &t->scene, &truth);
    printf("      %s: %s %s %s %g of %g substeps, tolerance %.2g, error %.2g, judged %.2g\n", name,
           c.met ? "certified" : "closest", t->scene.model->name, t->scene.method, t->scene.substeps,
           c.scene.substeps, c.scene.tolerance, t->error, error);
    if (c.met)
        certified(&c, error);
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

static double median(double *v, int n)
{
    qsort(v, (size_t)n, sizeof *v, ascending);
    return n > 0 ? v[n / 2] : 0.0;
}

static int verdict(const char *text, double got, bool good)
{
    printf("%s  %s: %g\n", good ? "ok  " : "FAIL", text, got);
    return !good;
}

int main(int argc, char **argv)
{
    int wanted = argc > 1 ? atoi(argv[1]) : 60, failed = 0;
    bool verbose = argc > 3;
    char name[40];
    struct scene s;
    state = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    for (int i = 0; i < SCENES && i < wanted; i++)
        look(scenes_table[i].name, &scenes_table[i].scene, verbose);
    for (int i = 0; i < SCENES && wanted > SCENES; i++) {
        s = scenes_table[i].scene;
        s.tolerance = 0.1;
        s.over *= 2.0;
        if (!strncmp(scenes_table[i].name, "shaft-fig9", 10))
            look("the same at tolerance 0.1, twice as long", &s, verbose);
    }
    for (int i = SCENES; i < wanted; i++) {
        snprintf(name, sizeof name, "random-%d", i - SCENES);
        random_scene(&s);
        look(name, &s, verbose);
    }
    double saved = median(count.saved, count.n_saved), saved_full = median(count.saved_full, count.n_saved);
    double cheaper = (double)count.cheaper / count.certified,
           coarser = (double)count.coarser / count.certified,
           wrong = (double)count.wrong_refusals / count.refusals;
    printf("      %d scenes: %d certified (%d by statistics), %d not met, %d escape; %d refusals\n",
           count.scenes, count.certified, count.statistics, count.unmet, count.escaped, count.refusals);
    failed += verdict("false certificates", count.false_certificates, count.false_certificates == 0);
    failed +=
        verdict("share of certificates that cost less than the scene as given", coarser, coarser >= 0.5);
    printf("      share of certificates with a cheaper model: %.3g\n", cheaper);
    failed += verdict("median cost saved against the scene as given", saved, saved >= 5.0);
    failed += verdict("the same against the full model at its own best", saved_full, saved_full >= 1.0);
    failed += verdict("share of wrong refusals", wrong, wrong <= 0.1);
    printf("      largest judged error over tolerance: %.3g\n", count.worst);
    printf("%d passed, %d failed\n", 5 - failed, failed);
    return failed > 0;
}
