/* test_models_check.c - parameters that make no sense are refused with a reason; facts of the tip in SI. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/app/parameters.h"
#include "firmware/plant/plant_change.h"
#include "models/reduced/afm_tip_reduced.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/models.h"
#include "models/reduced/shaft_mode.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/exact.h"
#include "tests/fixture/paper.h"

#define TWO_PI 6.283185307179586477
/* Instead of a value: the end of the parameter's own range. */
#define MIN -1e99
#define MAX 1e99

/* Units of the rig: static compression, inverse of the linear eigenfrequency, preload; the others follow
 * by dimension. */
TEST(models_scale)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct scale s;
    for (int i = 0; i < hertz_rig.n_parameters; i++)
        si[i] = hertz_rig.parameter[i].initial;
    hertz_rig.prepare(si, p, &s);
    double k = si[RIG_CONTACT_STIFFNESS], N = si[RIG_PRELOAD], m = si[RIG_MASS];
    double length = pow(N / k, 2.0 / 3.0), time = 1.0 / sqrt(1.5 * cbrt(k * k * N) / m);
    check_near("length", scale_of(&s, QUANTITY_LENGTH) / length, 1.0, 1e-14);
    check_near("time", scale_of(&s, QUANTITY_TIME) / time, 1.0, 1e-14);
    check_near("velocity", scale_of(&s, QUANTITY_VELOCITY) / (length / time), 1.0, 1e-14);
    check_near("force", scale_of(&s, QUANTITY_FORCE) / N, 1.0, 1e-14);
    check_near("frequency, Hz", scale_of(&s, QUANTITY_FREQUENCY) / (1.0 / (TWO_PI * time)), 1.0, 1e-14);
    check_near("a ratio has no unit", scale_of(&s, QUANTITY_RATIO), 1.0, 0.0);
}

/* SI defaults, each inside its range, but some together give
 * units that the plant does not take: both ends of each. */
TEST(models_units)
{
    static const struct {
        const struct model *m;
        const char *part;
        int n, index[4];
        double value[4];
    } bad[] = {
        {&hertz_rig, "compression", 2, {RIG_CONTACT_STIFFNESS, RIG_PRELOAD}, {1e18, 1e-9}},
        {&hertz_rig, "compression", 2, {RIG_CONTACT_STIFFNESS, RIG_PRELOAD}, {1e-3, 1e6}},
        {&hertz_rig, "eigenfrequency", 3, {RIG_MASS, RIG_CONTACT_STIFFNESS, RIG_PRELOAD}, {1e-9, 1e18, 1e6}},
        {&hertz_rig, "eigenfrequency", 3, {RIG_MASS, RIG_CONTACT_STIFFNESS, RIG_PRELOAD}, {1e6, 1e-3, 1e-9}},
        {&afm_tip,
         "outside 1e-9..1e9",
         3,
         {TIP_SIGN, TIP_CONTACT_STIFFNESS, TIP_LEVER_STIFFNESS},
         {-1.0, MAX, MIN}},
        {&afm_tip, "outside 1e-9..1e9", 2, {TIP_CONTACT_STIFFNESS, TIP_LEVER_STIFFNESS}, {MIN, MAX}},
        {&shaft_bearing, "time unit", 3, {SHAFT_M1, SHAFT_KAPPA, SHAFT_LENGTH}, {MAX, MIN, MAX}},
        {&shaft_bearing, "time unit", 3, {SHAFT_M1, SHAFT_KAPPA, SHAFT_LENGTH}, {MIN, MAX, MIN}},
    };
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        double si[MODEL_PARAMETERS];
        int which;
        for (int i = 0; i < bad[k].m->n_parameters; i++)
            si[i] = bad[k].m->parameter[i].initial;
        for (int i = 0; i < bad[k].n; i++) {
            const struct parameter *p = &bad[k].m->parameter[bad[k].index[i]];
            si[bad[k].index[i]] = bad[k].value[i] == MAX   ? p->max
                                  : bad[k].value[i] == MIN ? p->min
                                                           : bad[k].value[i];
        }
        const char *why = plant_check(bad[k].m, si, &which);
        check_true(bad[k].part, why && which < 0 && strstr(why, bad[k].part));
    }
}

/* The paper's defaults with up to two values set. */
static const char *reason(const struct model *m, const char *name, double value, const char *name2,
                          double value2)
{
    double paper[MODEL_PARAMETERS], si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    int which;
    paper_defaults(m, paper);
    paper[paper_index(m, name)] = value;
    if (name2)
        paper[paper_index(m, name2)] = value2;
    m->from_paper(paper, si, drive);
    const char *why = plant_check(m, si, &which);
    return why ? why : "taken";
}

static void refused(const struct model *m, const char *part, const char *name, double value,
                    const char *name2, double value2)
{
    const char *why = reason(m, name, value, name2, value2);
    if (strstr(why, part))
        check_string(m->name, why, why);
    else
        check_string(m->name, why, part);
}

TEST(models_refused)
{
    refused(&afm_tip, "below 1 with the published sign", "beta", 1.0, NULL, 0);
    refused(&afm_tip, "taken", "beta", 0.9999, NULL, 0);
    refused(&afm_tip, "taken", "beta", 29.7, "sign", -1.0);
    refused(&afm_tip, "sign must be", "sign", 0.5, NULL, 0);
    refused(&afm_tip, "sign must be", "sign", 0.0, NULL, 0);
    refused(&afm_tip_linear, "below 1 with the published sign", "beta", 1.5, NULL, 0);
    refused(&afm_tip_cubic, "below 1 with the published sign", "beta", 1.5, NULL, 0);
    refused(&afm_tip_averaged, "below 1 with the published sign", "beta", 1.5, NULL, 0);
    refused(&afm_tip_averaged, "needs a frequency", "r", 0.5, "Omega", 0.0);
    refused(&afm_tip_averaged, "taken", "r", 0.0, "Omega", 0.0);
    refused(&afm_tip_averaged, "no stable equilibrium", "r", 30.0, "Omega", 1.0);
    refused(&hertz_rig_averaged, "one fast drive only", "a_force", 1.0, "a_base", 1.0);
    refused(&hertz_rig_averaged, "one fast drive only", "a_stiff", 1.0, "a_base", 1.0);
    refused(&hertz_rig_averaged, "needs a frequency", "a_stiff", 1.0, "Omega", 0.0);
    refused(&hertz_rig_averaged, "no stable equilibrium", "a_force", 900.0, NULL, 0);
    refused(&hertz_rig_averaged, "taken", "a_force", 60.0, NULL, 0);
    refused(&shaft_bearing_mode, "mode must be", "mode", 1.5, NULL, 0);
    refused(&shaft_bearing, "outside its range", "g1", 0.0, NULL, 0);
    refused(&shaft_bearing, "outside its range", "m2", 0.0, NULL, 0);
    refused(&shaft_bearing, "outside its range", "kg3", -1.0, NULL, 0);
    refused(&shaft_bearing, "outside its range", "L", -0.1, NULL, 0);
    refused(&shaft_bearing, "gaps differ", "g3", 1e-12, NULL, 0);
    refused(&shaft_bearing, "differ too much", "m3", 1e-9, "kg3", 1e15);
    refused(&rolling_contact, "outside its range", "zeta", -0.1, NULL, 0);
}

/* Every corner of every parameter alone is either taken, and then prepared to finite numbers, or refused. */
TEST(models_ranges)
{
    int not_finite = 0, wrong = 0;
    for (int k = 0; k < MODELS; k++) {
        const struct model *m = model_table[k];
        for (int i = 0; i < 2 * m->n_parameters; i++) {
            const struct parameter *edge = &m->parameter[i / 2];
            double si[MODEL_PARAMETERS], p[MODEL_DERIVED] = {0}, x[MODEL_STATES] = {0}, x_dot[MODEL_STATES];
            struct input u[MODEL_INPUTS] = {{0.0, 0.0}};
            struct scale s;
            int which;
            for (int j = 0; j < m->n_parameters; j++)
                si[j] = m->parameter[j].initial;
            si[i / 2] = i % 2 ? edge->max : edge->min;
            if (plant_check(m, si, &which)) {
                wrong += which >= 0;
                continue;
            }
            m->prepare(si, p, &s);
            for (int j = 0; j < MODEL_DERIVED; j++)
                not_finite += !isfinite(p[j]);
            m->rest(p, x);
            m->rhs(p, u, x, x_dot);
            for (int j = 0; j < m->n_states; j++)
                not_finite += !(fabs(x_dot[j]) < 1e-9);
            not_finite += !(m->eigenfrequency(p) > 0.0) || !isfinite(m->eigenfrequency(p));
        }
    }
    check_int("edges of ranges that are not in range", wrong, 0);
    check_int("numbers not finite, or motion at rest", not_finite, 0);
}

/* The lever of 30.09 kHz; by default beta = 3 k0 sqrt(Delta)/(2 k) = 15.65, repulsive. With the paper's tip
 * of k0 = 1.57e7 beta is 29.7 at the published 0.26 pm. */
TEST(models_tip_si)
{
    double si[TIP_PARAMETERS], p[MODEL_DERIVED];
    struct scale s;
    for (int i = 0; i < TIP_PARAMETERS; i++)
        si[i] = afm_tip.parameter[i].initial;
    afm_tip.prepare(si, p, &s);
    check_near("lever, Hz", 1.0 / (TWO_PI * s.time_s), 30.09e3, 20.0);
    check_near("beta", pow(afm_tip.eigenfrequency(p), 2.0) - 1.0, 15.65, 0.01);
    check_near("force at rest, k0 Delta^(3/2), nN", 15.65 / 1.5 * s.force_N * 1e9, 4.215, 0.005);
    si[TIP_CONTACT_STIFFNESS] = 1.570e7;
    si[TIP_INDENTATION] = 0.26e-12;
    afm_tip.prepare(si, p, &s);
    check_near("beta at 0.26 pm", pow(afm_tip.eigenfrequency(p), 2.0) - 1.0, 29.7, 0.1);
    check_near("unit of force k Delta, N", s.force_N, 0.404 * 0.26e-12, 1e-27);
}

/* The saddle behind which the published sign escapes is an equilibrium. A little before it the tip returns. A
 * little behind it the tip runs away until the plant refuses to go on, with the last state finite. */
TEST(models_tip_saddle)
{
    double a[TIP_PAPER], n = 2.0 / 3.0 * 0.8;
    double y = (1.0 - n + sqrt((1.0 - n) * (1.0 + 3.0 * n))) / (2.0 * n), saddle = 1.0 - y * y;
    paper_defaults(&afm_tip, a);
    check_near("saddle at beta = 0.8, in u", saddle, -1.1614, 5e-5);
    for (int side = -1; side <= 1; side += 2) {
        struct plant pl;
        double state[2], q[2];
        paper_start(&pl, &afm_tip, a, 1e-2, (double[]){saddle + 1e-3 * side, 0.0});
        bool fine = plant_run(&pl, 4000);
        paper_now(&pl, q);
        memcpy(state, q, sizeof state);
        check_int(side < 0 ? "behind the saddle: finite to the end" : "before the saddle", fine, side > 0);
        check_true("the state that stands is finite", isfinite(state[0]) && isfinite(state[1]));
        check_true("where it is", side > 0 ? state[0] > saddle : state[0] < saddle);
    }
}

/* How far two plants come apart at most, in so many ticks. */
static void run_apart(struct plant *a, struct plant *b, int ticks, double *worst)
{
    for (int i = 0; i < ticks; i++) {
        if (!plant_run(a, 1) || !plant_run(b, 1))
            check_true("finite", 0);
        exact_worst(worst, (long double)(fabs(a->x[0] - b->x[0])));
    }
}

/* Without drives the two dampers do the same; waviness is minus the base for a rig without damper. */
TEST(models_rolling_and_rig)
{
    double zeta[4] = {0.05, 0.0, 1.0, 0.0}, rig[8];
    struct plant a, b;
    double worst = 0.0;
    paper_defaults(&hertz_rig, rig);
    rig[RIG_PAPER_XI] = 0.05;
    paper_start(&a, &rolling_contact, zeta, 1e-2, (double[]){2.5, 0.0});
    paper_start(&b, &hertz_rig, rig, 1e-2, (double[]){2.25, 0.0});
    run_apart(&a, &b, 3000, &worst);
    check_below("rolling contact off the rig, no drives", worst, 1e-13);
    zeta[0] = rig[RIG_PAPER_XI] = 0.0;
    zeta[1] = -0.2, zeta[2] = 0.8;
    rig[RIG_PAPER_BASE] = 0.3, rig[RIG_PAPER_FAST_OMEGA] = 0.8;
    paper_start(&a, &rolling_contact, zeta, 1e-2, (double[]){0.8, 0.0}); /* eta = 1 - 0.2 */
    paper_start(&b, &hertz_rig, rig, 1e-2, (double[]){0.0, 0.0});
    run_apart(&a, &b, 3000, &worst);
    check_below("waviness is minus the base", worst, 1e-12);
}

/* Reduced models agree with the full model for small motion: off by the square of the amplitude (linear), by
 * its fourth power (cubic). */
static double reduced_error(const struct model *full, const struct model *reduced, double amplitude)
{
    struct plant a, b;
    double paper[MODEL_PARAMETERS], worst = 0.0, rest[MODEL_STATES] = {0}, x[MODEL_STATES];
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct scale s;
    paper_defaults(full, paper);
    paper_prepare(full, paper, si, p, &s);
    full->rest(p, x);
    full->paper_state(p, (struct input[MODEL_INPUTS]){{0.0, 0.0}}, x, rest);
    rest[0] += amplitude;
    paper_start(&a, full, paper, 1e-2, rest);
    paper_start(&b, reduced, paper, 1e-2, rest);
    run_apart(&a, &b, 1000, &worst);
    return worst;
}

static void check_order(const struct model *full, const struct model *reduced, double order)
{
    double slope = log(reduced_error(full, reduced, 0.04) / reduced_error(full, reduced, 0.02)) / log(2.0);
    check_near(reduced->name, slope, order, 0.15);
}

TEST(models_rung_of_rung)
{
    check_order(&hertz_rig, &hertz_rig_linear, 2.0);
    check_order(&hertz_rig, &hertz_rig_cubic, 4.0);
    check_order(&rolling_contact, &rolling_contact_linear, 2.0);
    check_order(&afm_tip, &afm_tip_linear, 2.0);
    check_order(&afm_tip, &afm_tip_cubic, 4.0);
}

/* The app starts with its default settings whatever inputs and outputs the model has. */
TEST(models_settings)
{
    for (int k = 0; k < MODELS; k++) {
        double setting[SETTINGS];
        for (int i = 0; i < SETTINGS; i++)
            setting[i] = setting_initial(i, model_table[k], 1e-3);
        const char *why = parameters_check_settings(model_table[k], setting);
        check_string(model_table[k]->name, why ? why : "taken", "taken");
    }
    check_near("the rig keeps its own: slot 1 follows the base",
               setting_initial(SET_LOCKIN_CHANNEL + 1, &hertz_rig, 1e-3), RIG_BASE, 0.0);
}
