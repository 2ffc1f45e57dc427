/* test_choose.c - contactplant choose: its tables, its cheap tests,
 * its verdicts; tests/choose/choose_scenes.c has many scenes. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "host_sim/choose/choose_climb.h"
#include "host_sim/choose/choose_ladder.h"
#include "host_sim/choose/choose_run.h"
#include "host_sim/choose/choose_search.h"
#include "host_sim/choose/choose_steps.h"
#include "host_sim/choose/choose_theory.h"
#include "host_sim/choose/choose_truth.h"
#include "host_sim/choose/choose_watch.h"
#include "models/afm_tip.h"
#include "models/math/elementary.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/shaft_bearing.h"
#include "tests/unit/test.h"
#include "tests/fixture/trajectory.h"

enum { LINE = 256, PARTS = 16 /* frames from one stored sample to the next */ };

static const struct scene *preset(const char *name)
{
    return &scenes_find(name)->scene;
}

static const char *choose(struct choose_certificate *c, const struct scene *s)
{
    bool escaped;
    memset(c, 0, sizeof *c);
    c->title = "test";
    c->scene = *s;
    return choose_search(c, NULL, &escaped);
}

static const struct choose_attempt *chosen(const struct choose_certificate *c)
{
    return &c->verdict[c->choice].attempt[c->method];
}

/* A number of a file of counts: the first one behind `key`; NaN without it. */
static double count_of(const char *path, const char *key)
{
    char line[LINE];
    double value = (double)NAN;
    FILE *f = fopen(path, "r");
    check_true("the counts are there (run from the project's top folder)", f != NULL);
    while (f && fgets(line, sizeof line, f))
        if (!strncmp(line, key, strlen(key)) && line[strlen(key)] == ' ')
            sscanf(line + strlen(key), "%lf", &value);
    if (f)
        fclose(f);
    return value;
}

/* Why no cubic model is a candidate for rig and tip: with
 * the same method and step a tick of it saves little. */
TEST(choose_cubic)
{
    static const char *const family[] = {"rig", "tip"}, *const scratch[] = {"rk4", "float32", "taylor",
                                                                            "coarse", "short"};
    double least = 1.0;
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 5; k++) {
            char full[40], cubic[40];
            snprintf(full, sizeof full, "%s_%s", family[i], scratch[k]);
            snprintf(cubic, sizeof cubic, "%s_cubic_%s", family[i], scratch[k]);
            least = fmin(least, count_of("tests/data/instructions.txt", cubic) /
                                    count_of("tests/data/instructions.txt", full));
        }
    }
    check_above("instructions of a cubic tick over those of a contact's, the least", least, 0.85);
}

/* The candidates for a paper's figure are the presets of its other curves. */
TEST(choose_ladder)
{
    struct choose_candidate candidate[CHOOSE_CANDIDATES];
    int n = choose_ladder(preset("bbp-fig2-force"), candidate);
    check_int("candidates of the rig: linear, averaged, itself", n, 3);
    check_string("the lowest", candidate[0].scene.model->name, "hertz_rig_linear");
    check_string("the highest is the scene's own", candidate[2].scene.model->name, "hertz_rig");
    double si[2][MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    check_no_error("averaging is possible", candidate[1].refused);
    scenes_resolve(&candidate[1].scene, si[0], drive);
    scenes_resolve(preset("bbp-fig2-force-slow"), si[1], drive);
    for (int i = 0; i < RIG_AVERAGED_PARAMETERS; i++)
        check_near(candidate[1].scene.model->parameter[i].name, si[0][i], si[1][i], 0.0);
    /* q = 0 at the start less the fast motion -60/64 cos 8 tau of a free mass */
    check_near("the slow motion's start, in q", candidate[1].scene.start[0], 60.0 / 64.0, 1e-12);
    check_int("candidates of a scene that is cubic itself",
              choose_ladder(preset("bbp-fig2-force-cubic"), candidate), 3);
    check_int("candidates of the shaft", choose_ladder(preset("shaft"), candidate), 5);
    check_int("candidates of a reduced model", choose_ladder(preset("bbp-fig2-force-slow"), candidate), 1);
}

static double multiplier(double r)
{
    struct choose_candidate candidate[CHOOSE_CANDIDATES];
    struct choose_facts f;
    struct scene s = *preset("kb-fig7");
    s.value[TIP_PAPER_R] = r;
    int n = choose_ladder(&s, candidate);
    choose_facts_of(candidate, n, NULL, &f);
    return f.multiplier;
}

/* Kirrou & Belhaq's linear part at beta 0.8, W = 1 is unstable from about r = 0.12
 * (docs/reference/models.md); Liouville's theorem and linear theory of one degree of freedom. */
TEST(choose_facts)
{
    struct choose_candidate candidate[CHOOSE_CANDIDATES];
    struct choose_facts f;
    check_below("multiplier at r 0.11", multiplier(0.11), 1.0);
    check_above("multiplier at r 0.13", multiplier(0.13), 1.0);
    check_near("multiplier without modulation to speak of", multiplier(1e-9),
               exp(-0.01 * 2.0 * ELEMENTARY_PI), 1e-7);
    struct scene s = *preset("bbp-fig2-force");
    s.value[RIG_PAPER_FORCE] = 0.0;
    s.value[RIG_PAPER_OMEGA] = 0.5;
    int n = choose_ladder(&s, candidate);
    choose_facts_of(candidate, n, NULL, &f);
    check_near("amplitude by linear theory", f.amplitude, 2.0 / 3.0 * 0.04 / hypot(0.75, 0.01), 1e-12);
    check_near("W over the slow frequency without a fast drive", f.fast, 0.0, 0.0);
    /* F = eta^(3/2) on 1 +- 0.5 against its tangent: the
     * larger miss is 1.75 - 1.5^(3/2) .. at the lower end */
    double low = pow(0.5, 1.5), high = pow(1.5, 1.5);
    check_near("mismatch of the linear law", choose_mismatch(&s, &candidate[0].scene, 0.5),
               fmax(low - 0.25, high - 1.75) / (high - low), 1e-12);
}

/* A verdict is the same each time, and its scene gives the error that it says. */
TEST(choose_repeats)
{
    static struct choose_certificate a, b;
    struct choose_record r;
    check_no_error("a certificate", choose(&a, preset("kb-fig16")));
    check_true("a certificate", a.met);
    check_true("a certificate", a.in_time);
    check_no_error("another one", choose(&b, preset("kb-fig16")));
    check_true("another one", b.met);
    check_true("another one", b.in_time);
    check_near("the same error", a.verdict[a.choice].attempt[a.method].error, chosen(&b)->error, 0.0);
    check_near("the same step", chosen(&a)->scene.substeps, chosen(&b)->scene.substeps, 0.0);
    check_near("the same cost", choose_frame_cost(chosen(&a), 0), choose_frame_cost(chosen(&b), 0), 0.0);
    check_below("cheaper than as given", choose_frame_cost(chosen(&a), 0), a.given_cost);
    check_is("what would void it", a.n_conditions, >, 0);
    check_is("what would void it", a.condition[0].factor, >, 1.0);
    check_no_error("runs as it stands", choose_run(&chosen(&a)->scene, NULL, 0.0, &r));
    check_is("runs as it stands", r.n, ==, r.wanted);
    choose_record_free(&r);
}

/* Small motion is linear, and the certificate says up to where; beyond, it is not. */
TEST(choose_watch)
{
    static struct choose_certificate c;
    struct scene s = *preset("rig");
    s.drive[RIG_FORCE].amplitude = 0.2;
    s.tolerance = 0.01;
    s.over = 0.5;
    check_no_error("a certificate", choose(&c, &s));
    check_true("a certificate", c.met);
    check_string("of small motion", chosen(&c)->scene.model->name, "hertz_rig_linear");
    const struct scene_watch *w = choose_watched(&c);
    check_true("with a watch", w && w->observable == 2.0 && w->below > 0.0 && w->below < w->above);
    check_true("that climbs", w->promote == &hertz_rig);
    double rest = 0.5 * (w->below + w->above), away = fmax(c.high - 1.0, 1.0 - c.low) * rest;
    s.drive[RIG_FORCE].amplitude *= 2.0 * (w->above - rest) / away;
    check_no_error("beyond it", choose(&c, &s));
    check_true("beyond it", c.met);
    check_true("another model", chosen(&c)->scene.model != &hertz_rig_linear);
}

/* A step is long enough for this mass, and the certificate says for which others: hertz_rig's
 * eigenfrequency is 1 in its own units. Masses that the step guard refuses are not watched. */
TEST(choose_watch_step)
{
    static struct choose_certificate c;
    struct scene s = *preset("bbp-fig2-force");
    s.tolerance = 0.01;
    check_no_error("a certificate", choose(&c, &s));
    check_true("a certificate", c.met);
    check_string("of a step that may be too long", chosen(&c)->scene.method, "rk4_unlocated");
    const struct scene_watch *w = choose_watched(&c);
    check_true("with a watch", w && w->observable == MODEL_EIGENFREQUENCY && !w->promote);
    check_is("from above only", w->below, <=, -SCENE_UNBOUNDED);
    check_near("where the error of order 5/2 is the tolerance", chosen(&c)->error * pow(w->above, 2.5), 0.01,
               1e-12);
    s = *preset("bbp-fig2-force-cubic");
    s.tolerance = 0.01;
    check_no_error("an easy one", choose(&c, &s));
    check_true("an easy one", c.met);
    check_string("by rk4 too", chosen(&c)->scene.method, "rk4");
    for (int i = 0; i < c.n_conditions; i++)
        check_true("that the guard ends first is not watched",
                   strcmp(c.condition[i].name, "step") != 0 || c.condition[i].guard == GUARD_BUS);
}

/* A demand that cannot be met gets no certificate: the closest choice is shown. */
TEST(choose_refusals)
{
    static struct choose_certificate c;
    struct scene s = *preset("kb-fig16");
    s.cost_s = 1e-12;
    check_no_error("a deadline nothing meets", choose(&c, &s));
    check_true("a deadline nothing meets", c.met);
    check_true("a deadline nothing meets", !c.in_time);
    s = *preset("kb-fig16");
    s.tolerance = 1e-15;
    check_no_error("a tolerance nothing meets", choose(&c, &s));
    check_true("a tolerance nothing meets", !c.met);
    check_true("which is no chaos: the truth is not known to ten times better",
               !c.chaotic && c.truth_error > 0.1 * s.tolerance);
    check_is("a tolerance nothing meets", c.choice, >=, 0);
    check_above("the closest and its error", chosen(&c)->error, 1e-15);
    s = *preset("kb-fig7");
    bool escaped = false;
    memset(&c, 0, sizeof c);
    c.scene = s;
    check_true("an escape", choose_search(&c, NULL, &escaped) != NULL && escaped);
    s = *preset("shaft-fig9");
    s.over = 0.5;
    check_no_error("chaos", choose(&c, &s));
    check_true("chaos", c.statistics && c.chaotic);
    check_true("chaos", !c.met);
}

/* The budget is a frame, or what the scene gives a step times its steps; a quarter more than the choice takes
 * is enough, and a quarter less is not. */
TEST(choose_budget)
{
    static struct choose_certificate c;
    struct scene s = *preset("kb-fig16");
    s.cost_s = 0.0;
    check_no_error("without a cost", choose(&c, &s));
    check_near("the budget is the frame", c.budget_s, s.frame_s, 0.0);
    double time_s = choose_time_s(chosen(&c), c.method, c.machine);
    check_above("the choice takes time", time_s, 0.0);
    for (double share = 0.75; share < 1.5; share += 0.5) {
        s.cost_s = share * time_s / s.substeps;
        check_no_error("with a cost", choose(&c, &s));
        check_true("it keeps the tolerance", c.met);
        check_near("the budget", c.budget_s, share * time_s, 1e-12 * time_s);
        check_near("the same choice", choose_time_s(chosen(&c), c.method, c.machine), time_s, 0.0);
        check_int("in time", c.in_time, share > 1.0);
    }
}

/* A run that ended early, or had trouble at its end, has no error that any tolerance would let pass, however
 * near it was until then; neither has its statistics. */
TEST(choose_escaped)
{
    static struct choose_certificate c;
    double value[2][6] = {{0.0, 1.0, 0.0, 1.0, 0.0, 1.0}, {0.0, 1.0, 0.0, 1.0, 0.0, 1.0}};
    struct search o = {.c = &c, .truth = {.value = value[0], .n_values = 6, .n = 2, .wanted = 2}};
    const struct choose_record whole = {.value = value[1], .n_values = 6, .n = 2, .wanted = 2};
    for (int k = 0; k < 2; k++) {
        c = (struct choose_certificate){.statistics = k == 1, .span = 1.0};
        c.scene.tolerance = 1e-2;
        choose_statistics(&o.truth, c.span, c.mean);
        struct choose_record early = whole, troubled = whole;
        early.n = 1;
        early.n_values = 3;
        troubled.trouble = "the motion escapes";
        check_near("the same motion has no error", choose_error(&o, &whole), 0.0, 1e-15);
        check_true("and meets the tolerance", choose_meets(&o, choose_error(&o, &whole)));
        check_true("one that ended early has infinite error", isinf(choose_error(&o, &early)));
        check_true("and one with trouble", isinf(choose_error(&o, &troubled)));
        check_true("which no tolerance lets pass", !choose_meets(&o, choose_error(&o, &troubled)));
    }
}

/* Without contacts exact is as good at any step; the ledger's Simpson rule is not. Where bending rings at
 * 700 Hz, ticks of two milliseconds would raise its alarm. Under slow forces they do not. */
TEST(choose_balance)
{
    static struct choose_certificate c;
    struct scene s;
    scenes_default(&s, &shaft_bearing_linear);
    s.drive[1] = (struct scene_drive){.amplitude = 5.0, .frequency_Hz = 24.0};
    s.over = 0.5;
    s.tolerance = 1e-3;
    check_no_error("slow forces", choose(&c, &s));
    check_true("slow forces", c.met);
    check_near("ticks in a frame", chosen(&c)->scene.substeps, 1.0, 0.0);
    s.frame_s = 2e-3;
    s.started = true;
    s.start[0] = s.start[2] = 1e-4;
    s.start[1] = -1e-4;
    check_no_error("ringing", choose(&c, &s));
    check_true("ringing", c.met);
    check_above("ticks in a frame", chosen(&c)->scene.substeps, 1.5);
    check_contains("fewer would do but for the balance", chosen(&c)->why, "energy balance");
    check_below("energy out of balance", chosen(&c)->imbalance, 0.01);
}

/* There and back over the resonance: what holds at the start does not hold there. */
TEST(choose_sweep)
{
    static struct choose_certificate c;
    struct scene s = *preset("rig");
    struct choose_sweep w = {.input = RIG_FORCE, .Hz = {150.0, 240.0, 8, false}};
    s.drive[RIG_FORCE].amplitude = 2.0;
    s.tolerance = 0.02;
    check_no_error("without the sweep", choose(&c, &s));
    check_true("without the sweep", c.met);
    check_string("linear", chosen(&c)->scene.model->name, "hertz_rig_linear");
    memset(&c, 0, sizeof c);
    c.scene = s;
    c.sweep = w;
    bool escaped;
    check_no_error("with it", choose_search(&c, NULL, &escaped));
    check_true("with it", c.met);
    check_string("not linear", chosen(&c)->scene.model->name, "hertz_rig");
    check_below("4 steps in the fastest period, of 4 ms", 4.0 * 0.24, chosen(&c)->scene.substeps);
}

/* ---- against the stored reference trajectories ---- */

static int certificates;

/* The case as a scene, a frame for each part of the way from sample to sample. */
static void scene_of(const struct trajectory *r, double tolerance, struct scene *s)
{
    scenes_default(s, r->model);
    s->paper = s->started = true;
    memcpy(s->value, r->paper, sizeof s->value);
    memcpy(s->start, r->start, sizeof s->start);
    s->observable = 0.0;
    s->tolerance = tolerance;
    s->over = r->t[r->n_samples - 1];
    s->dilation = s->frame_s / (s->over / r->n_samples / PARTS);
}

/* The stored displacement, SI on the bus. */
static double stored(const struct trajectory *r, int i)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], x[MODEL_STATES], output[MODEL_OUTPUTS];
    struct harmonic drive[MODEL_INPUTS];
    struct input u[MODEL_INPUTS] = {{0.0, 0.0}};
    struct scale scale;
    r->model->from_paper(r->paper, si, drive);
    r->model->prepare(si, p, &scale);
    for (int k = 0; k < r->model->n_inputs; k++) {
        double unit = scale_of(&scale, r->model->input_signal[k].quantity),
               at = drive[k].omega * r->t[i] + drive[k].phase;
        u[k] = (struct input){drive[k].amplitude / unit * cos(at),
                              -drive[k].amplitude / unit * drive[k].omega * scale.time_s * sin(at)};
    }
    r->model->state_from_paper(p, u, r->state[i], x);
    r->model->output(p, u, x, output);
    return output[0] * scale.length_m;
}

static void follow(const struct trajectory *r)
{
    static struct choose_certificate c;
    static const double tolerance[2] = {1e-2, 1e-5};
    for (int k = 0; k < 2; k++) {
        struct scene s;
        struct choose_record record;
        double most = 0.0;
        scene_of(r, tolerance[k], &s);
        const char *why = choose(&c, &s);
        if (why || !c.met || c.statistics)
            continue;
        check_no_error(r->name, choose_run(&chosen(&c)->scene, NULL, 0.0, &record));
        check_is(r->name, record.n, ==, PARTS * r->n_samples);
        for (int i = 0; i < r->n_samples && record.n == PARTS * r->n_samples; i++)
            most = fmax(most, fabs(record.value[record.looks * PARTS * (i + 1) - 1] - stored(r, i)));
        check_below("its certificate against the stored samples", most / c.span, tolerance[k]);
        choose_record_free(&record);
        certificates++;
    }
}

TEST(choose_reference)
{
    certificates = 0;
    int n = trajectory_each("tests/data/rig_trajectories.txt", follow) +
            trajectory_each("tests/data/model_trajectories.txt", follow);
    check_above("certificates of the stored cases", certificates, n);
}
