/* test_models_equations.c - each right-hand side against its equation as docs/reference/models.md writes it
 * in the paper's symbols, and the averaged coefficients against published and recomputed numbers. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "models/reduced/afm_tip_reduced.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/rolling_contact.h"
#include "tests/fixture/exact.h"
#include "tests/fixture/paper.h"

enum { EQUATION_TRIALS = 300 };

/* A moment of a motion in the paper's symbols: parameters, state q and q', time. */
struct moment {
    const struct model *m;
    double a[MODEL_PARAMETERS], q[2], t;
    double accel; /* q'' as the model has it */
};

static double parameter(const struct moment *k, const char *name)
{
    return k->a[paper_index(k->m, name)];
}

/* q'' from the model's rhs. `carried`: q = factor y + that input (Nayak's eta), else -1. */
static void ask_model(struct moment *k, double factor, int carried)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], x[MODEL_STATES], x_dot[MODEL_STATES];
    struct harmonic drive[MODEL_INPUTS];
    struct input u[MODEL_INPUTS];
    struct scale scale;
    k->m->from_paper(k->a, si, drive);
    k->m->prepare(si, p, &scale);
    for (int i = 0; i < k->m->n_inputs; i++) {
        double angle = drive[i].omega * k->t + drive[i].phase;
        u[i].value = (double)(drive[i].amplitude * cos(angle));
        u[i].rate = (double)(-drive[i].amplitude * drive[i].omega * sin(angle));
    }
    k->m->state_from_paper(p, u, k->q, x);
    k->m->rhs(p, u, x, x_dot);
    k->accel = factor * x_dot[1];
    if (carried >= 0)
        k->accel -= drive[carried].omega * drive[carried].omega * u[carried].value;
}

static void report_equation(const char *name, double worst)
{
    check_below(check_name("%s: worst acceleration error", name), worst, 2e-14);
}

/* ---- Hertz rig ---- */

/* Left side without q'' less right side, so that q'' is minus this. */
typedef double equation(const struct moment *k);

static double rig_force(const struct moment *k)
{
    return parameter(k, "sigma") * cos(parameter(k, "omega") * k->t + parameter(k, "phi")) +
           parameter(k, "a_force") * cos(parameter(k, "Omega") * k->t);
}

static double rig_full(const struct moment *k)
{
    double W = parameter(k, "Omega"), xi = parameter(k, "xi");
    double base = parameter(k, "a_base") * cos(W * k->t);
    double base_rate = -parameter(k, "a_base") * W * sin(W * k->t);
    double eta = fmax(0.0, 1.0 + 2.0 / 3.0 * (k->q[0] - base));
    return 2.0 * xi * (k->q[1] - base_rate) +
           (1.0 + parameter(k, "a_stiff") * cos(W * k->t)) * eta * sqrt(eta) - 1.0 - rig_force(k);
}

static double rig_linear(const struct moment *k)
{
    double W = parameter(k, "Omega"), xi = parameter(k, "xi");
    double base = parameter(k, "a_base") * cos(W * k->t);
    double base_rate = -parameter(k, "a_base") * W * sin(W * k->t);
    return 2.0 * xi * (k->q[1] - base_rate) + (k->q[0] - base) + parameter(k, "a_stiff") * cos(W * k->t) -
           rig_force(k);
}

static double rig_cubic(const struct moment *k)
{
    double W = parameter(k, "Omega"), xi = parameter(k, "xi"), q = k->q[0];
    double base = parameter(k, "a_base") * cos(W * k->t);
    double base_rate = -parameter(k, "a_base") * W * sin(W * k->t);
    double F = q + q * q / 6.0 - q * q * q / 54.0;
    return 2.0 * xi * k->q[1] + F + parameter(k, "a_stiff") * (1.0 + F) * cos(W * k->t) - rig_force(k) -
           2.0 * xi * base_rate - (1.0 + q / 3.0 - q * q / 18.0 + q * q * q / 54.0) * base;
}

static void check_rig(const struct model *m, equation *f)
{
    uint64_t seed = 21;
    double worst = 0.0;
    for (int n = 0; n < EQUATION_TRIALS; n++) {
        struct moment k = {.m = m};
        const double high[8] = {0.3, 1.0, 2.0, 6.0, 9.0, 3.0, 2.0, 2.0};
        for (int i = 0; i < 8; i++)
            k.a[i] = exact_between(&seed, 0.0, high[i]);
        k.q[0] = exact_between(&seed, -3.0, 3.0);
        k.q[1] = exact_between(&seed, -3.0, 3.0);
        k.t = exact_between(&seed, 0.0, 6.0);
        ask_model(&k, 1.5, -1);
        double expected = -f(&k);
        exact_worst(&worst, (long double)(fabs((k.accel - expected) / (1.0 + fabs(expected)))));
    }
    report_equation(m->name, worst);
}

TEST(models_rig_equations)
{
    check_rig(&hertz_rig, rig_full);
    check_rig(&hertz_rig_linear, rig_linear);
    check_rig(&hertz_rig_cubic, rig_cubic);
}

/* ---- rolling contact: eta'' + 2 zeta eta' + (2/3) (eta_+^{3/2} - 1) = xi'' + 2 zeta xi' ---- */

static void check_rolling(const struct model *m)
{
    uint64_t seed = 22;
    double worst = 0.0;
    for (int n = 0; n < EQUATION_TRIALS; n++) {
        struct moment k = {
            .m = m,
            .a = {exact_between(&seed, 0, 0.3), exact_between(&seed, 0, 2), exact_between(&seed, 0, 3), 0.4}};
        k.q[0] = exact_between(&seed, -2.0, 4.0);
        k.q[1] = exact_between(&seed, -3.0, 3.0);
        k.t = exact_between(&seed, 0.0, 6.0);
        ask_model(&k, 1.0, ROLLING_WAVINESS);
        double W = parameter(&k, "Omega"), zeta = parameter(&k, "zeta"), xi0 = parameter(&k, "xi0");
        double angle = W * k.t + parameter(&k, "phi"), eta = fmax(0.0, k.q[0]);
        double spring = m == &rolling_contact ? 2.0 / 3.0 * (eta * sqrt(eta) - 1.0) : k.q[0] - 1.0;
        double expected =
            -2.0 * zeta * k.q[1] - spring - W * W * xi0 * cos(angle) - 2.0 * zeta * W * xi0 * sin(angle);
        exact_worst(&worst, (long double)(fabs((k.accel - expected) / (1.0 + fabs(expected)))));
    }
    report_equation(m->name, worst);
}

TEST(models_rolling_equations)
{
    check_rolling(&rolling_contact);
    check_rolling(&rolling_contact_linear);
}

/* ---- AFM tip ---- */

static double tip_force(const struct moment *k)
{
    return parameter(k, "f") * cos(parameter(k, "omega") * k->t + parameter(k, "phi"));
}

static double tip_full(const struct moment *k)
{
    double eta = fmax(0.0, 1.0 - k->q[0]), r = parameter(k, "r") * cos(parameter(k, "Omega") * k->t);
    return parameter(k, "c") * k->q[1] + k->q[0] +
           parameter(k, "sign") * 2.0 / 3.0 * parameter(k, "beta") * ((1.0 + r) * eta * sqrt(eta) - 1.0) -
           tip_force(k);
}

static double tip_linear(const struct moment *k)
{
    double s = parameter(k, "sign"), beta = parameter(k, "beta");
    return parameter(k, "c") * k->q[1] + (1.0 - s * beta) * k->q[0] +
           s * 2.0 / 3.0 * beta * parameter(k, "r") * cos(parameter(k, "Omega") * k->t) - tip_force(k);
}

static double tip_cubic(const struct moment *k)
{
    double s = parameter(k, "sign"), b = parameter(k, "beta"), u = k->q[0];
    double r = parameter(k, "r") * cos(parameter(k, "Omega") * k->t);
    double bent = b / 4.0 * u * u + b / 24.0 * u * u * u;
    return parameter(k, "c") * k->q[1] + u - s * b * u + s * bent + s * r * (2.0 / 3.0 * b - b * u + bent) -
           tip_force(k);
}

static void check_tip(const struct model *m, equation *f)
{
    uint64_t seed = 23;
    double worst = 0.0;
    for (int n = 0; n < EQUATION_TRIALS; n++) {
        struct moment k = {.m = m};
        const double high[7] = {0.95, 0.3, 1.0, 3.0, 1.0, 2.0, 6.0};
        for (int i = 0; i < 7; i++)
            k.a[i] = exact_between(&seed, 0.01, high[i]);
        k.a[7] = n % 2 ? 1.0 : -1.0;
        k.q[0] = exact_between(&seed, -2.0, 2.0);
        k.q[1] = exact_between(&seed, -2.0, 2.0);
        k.t = exact_between(&seed, 0.0, 6.0);
        ask_model(&k, -1.0, -1);
        double expected = -f(&k);
        exact_worst(&worst, (long double)(fabs((k.accel - expected) / (1.0 + fabs(expected)))));
    }
    report_equation(m->name, worst);
}

TEST(models_tip_equations)
{
    check_tip(&afm_tip, tip_full);
    check_tip(&afm_tip_linear, tip_linear);
    check_tip(&afm_tip_cubic, tip_cubic);
}

/* ---- averaged: the slow equation's coefficients, read back from the model ---- */

/* q'' + damping q' + c1 q + c2 q^2 + c3 q^3 + c0 = 0 from
 * accelerations at q = -1, 0, 1, 2 (a cubic, exactly). */
static void coefficients(const struct model *m, const double *paper, double factor, double c[4])
{
    double y[4];
    for (int i = 0; i < 4; i++) {
        struct moment k = {.m = m, .q = {i - 1.0, 0.0}};
        memcpy(k.a, paper, (size_t)m->n_paper * sizeof *paper);
        ask_model(&k, factor, -1);
        y[i] = -k.accel;
    }
    c[0] = y[1];
    c[2] = 0.5 * (y[0] + y[2]) - y[1];
    c[3] = (y[3] - 3.0 * y[2] + 3.0 * y[1] - y[0]) / 6.0;
    c[1] = 0.5 * (y[2] - y[0]) - c[3];
}

static void rig_paper_set(double *a, double xi, double W, double force, double base, double stiffness)
{
    const double set[8] = {xi, 0.0, 0.9, 0.0, W, force, base, stiffness};
    memcpy(a, set, sizeof set);
}

/* w2, b, g and G for a force of 60, base motion of 5 and stiffness of 4 at W = 8, computed elsewhere. */
TEST(models_rig_averaged_numbers)
{
    static const double drive[3][3] = {{60, 0, 0}, {0, 5, 0}, {0, 0, 4}};
    static const double expected[3][4] = {
        {0.0732421875, 0.9755859375, 0.16666666666666666, -0.018518518518518517},
        {0.06564279450310602, 1.0001818999537715, 0.16655637452631822, -0.012490653697355294},
        {0.12531873914930555, 1.1671888563368058, 0.2224155002170139, -0.020894745249807098}};
    for (int i = 0; i < 3; i++) {
        double a[8], c[4];
        rig_paper_set(a, 0.01, 8.0, drive[i][0], drive[i][1], drive[i][2]);
        coefficients(&hertz_rig_averaged, a, 1.5, c);
        check_near("G", c[0], expected[i][0], 1e-14);
        check_near("w2", c[1], expected[i][1], 1e-14);
        check_near("b", c[2], expected[i][2], 1e-14);
        check_near("-g", c[3], expected[i][3], 1e-14);
    }
}

/* The averaged equation gives the mean of the fast motion: driven fast, the cubic model is on average at
 * the slow rest. The difference is of relative order 1/W^2 and xi^2: the base's G, as published, neglects
 * the fast damper's phase. */
static double mean_under_fast_drive(const double *a)
{
    enum { PERIODS = 200, STEPS = 256 };
    struct plant pl;
    double sum = 0.0, state[2];
    double h = 6.283185307179586477 / a[4] / STEPS;
    paper_start(&pl, &hertz_rig_cubic, a, h, (double[]){0.0, 0.0});
    for (int i = 0; i < 3 * PERIODS * STEPS; i++) {
        if (!plant_run(&pl, 1))
            return (double)NAN;
        paper_now(&pl, state);
        sum += i < 2 * PERIODS * STEPS ? 0.0 : state[0];
    }
    return sum / (PERIODS * STEPS);
}

TEST(models_rig_averaged)
{
    static const double drive[3][3] = {{20, 0, 0}, {0, 0, 3}, {0, 2, 0}};
    for (int i = 0; i < 3; i++) {
        double a[8], si[MODEL_PARAMETERS], p[MODEL_DERIVED], x[2], q[2], mean;
        struct scale scale;
        rig_paper_set(a, 0.05, 16.0, drive[i][0], drive[i][1], drive[i][2]);
        paper_prepare(&hertz_rig_averaged, a, si, p, &scale);
        hertz_rig_averaged.rest(p, x);
        hertz_rig_averaged.paper_state(p, NULL, x, q);
        mean = mean_under_fast_drive(a);
        printf("      fast drive %d: mean of the cubic model %.6f, rest of the averaged %.6f\n", i, mean,
               q[0]);
        check_below("rest of the averaged model off the cubic's mean, over it", fabs(q[0] / mean - 1.0),
                    0.02);
    }
}

/* As published, for each sign; W is the fast frequency. */
static void tip_formulas(double b, double r, double W, double sign, double c[4])
{
    double W2 = W * W, W4 = W2 * W2, W6 = W4 * W2, r2 = r * r, r4 = r2 * r2, b2 = b * b, b3 = b2 * b,
           b4 = b2 * b2;
    if (sign > 0.0) {
        c[1] = 1 - b + 2 * b2 * r2 / (3 * W2) - 5 * b3 * r2 / (36 * W4) - b4 * r4 / (48 * W6);
        c[2] = b / 4 - b2 * r2 / (3 * W2) + b3 * r2 / (12 * W4) + 7 * b4 * r4 / (192 * W6);
        c[3] = b / 24 - b2 * r2 / (48 * W2) + b3 * r2 / (36 * W4) - 35 * b4 * r4 / (1152 * W6);
        c[0] = -b2 * r2 / (3 * W2) + b3 * r2 / (18 * W4) + b4 * r4 / (216 * W6);
        return;
    }
    c[1] = 1 + b + 2 * b2 * r2 / (3 * W2) + 5 * b3 * r2 / (36 * W4) - b4 * r4 / (48 * W6);
    c[2] = -b / 4 - b2 * r2 / (3 * W2) - b3 * r2 / (12 * W4) + 7 * b4 * r4 / (192 * W6);
    c[3] = -b / 24 - b2 * r2 / (48 * W2) - b3 * r2 / (36 * W4) - 35 * b4 * r4 / (1152 * W6);
    c[0] = -b2 * r2 / (3 * W2) - b3 * r2 / (18 * W4) + b4 * r4 / (216 * W6);
}

TEST(models_tip_averaged)
{
    uint64_t seed = 24;
    double worst = 0.0;
    for (int n = 0; n < EQUATION_TRIALS; n++) {
        double c[4], expected[4], sign = n % 2 ? 1.0 : -1.0;
        double a[8] = {exact_between(&seed, 0.1, 0.95),
                       0.02,
                       exact_between(&seed, 0, 1),
                       exact_between(&seed, 0.8, 4),
                       0.0,
                       1.0,
                       0.0,
                       sign};
        coefficients(&afm_tip_averaged, a, -1.0, c);
        tip_formulas(a[0], a[2], a[3], sign, expected);
        for (int i = 0; i < 4; i++)
            exact_worst(&worst, (long double)(fabs(c[i] - expected[i])));
    }
    check_below("afm_tip_averaged: coefficients off the formulas, both signs", worst, 2e-14);
}

/* omega1, rho_n = 10 rho1^2/(3 w1^2) - 3 rho2 and rho_l = 2 rho1 H/w1^2, computed elsewhere. */
TEST(models_tip_averaged_numbers)
{
    static const double row[][6] = {
        /* beta, r, Omega, omega1, rho_n, rho_l */
        {0.8, 0.0, 1.0, 0.44721359549995787, 0.5666666666666669, 0.0},
        {0.8, 0.5, 1.5, 0.49381061700684253, 0.3380165354498964, -0.03262833438750625},
        {0.8, 0.4, 1.0, 0.5066265247256164, 0.2895515691508645, -0.039829750161075705},
        {0.8, 1.0, 1.0, 0.7396095065791287, -0.05339269851587044, -0.029616610695843707},
        {0.8, 0.7, 0.6, 0.6840798558646622, 0.14084478888173216, -0.10931853978421265},
        {0.95, 0.7, 1.0, 0.531406912435472, 0.09809554626552265, -0.11534275802316518}};
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        double a[8] = {row[i][0], 0.02, row[i][1], row[i][2], 0.0, 1.0, 0.0, 1.0}, c[4];
        coefficients(&afm_tip_averaged, a, -1.0, c);
        check_near("omega1", sqrt(c[1]), row[i][3], 1e-13);
        check_near("rho_n", 10.0 * c[2] * c[2] / (3.0 * c[1]) - 3.0 * c[3], row[i][4], 1e-12);
        check_near("rho_l", 2.0 * c[2] * c[0] / c[1], row[i][5], 1e-13);
    }
}
