/* test_stability.c - maps against independent tongue boundaries,
 * a Runge-Kutta step written out, and its amplification. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "host_sim/commands.h"
#include "host_sim/maps/stability/stability.h"
#include "host_sim/maps/stability/stability_floquet.h"
#include "tests/fixture/maps_run.h"

#define TWO_PI          6.283185307179586477
#define STABILITY_SCENE "[deadline]\nframe = 1 ms\ndilation = 0.001\n[plant]\nmodel = %s\n[paper]\n%s"

static double *run(struct maps_table *t, const char *model, const char *paper, const char *arguments,
                   int columns)
{
    char scene[256];
    snprintf(scene, sizeof scene, STABILITY_SCENE, model, paper);
    check_int("status", maps_run(cmd_stability, scene, arguments, columns, t), 0);
    return t->cell;
}

/* Modulations at which a multiplier is -1, from Hill's
 * equation, computed independently (an eigenvalue problem). */
TEST(stability_tongues)
{
    static const struct {
        const char *model, *paper, *name;
        double edge, omega;
    } edges[] = {{"afm_tip", "beta = 0.8\nc = 0.02\n", "r", 0.3634730702894996, 0.6},
                 {"afm_tip", "beta = 0.8\nc = 0.02\n", "r", 0.10551783031466694, 0.8},
                 {"afm_tip", "beta = 0.8\nc = 0.02\n", "r", 0.022363125327291133, 0.8944271909999159},
                 {"afm_tip", "beta = 0.8\nc = 0.02\n", "r", 0.06739905026984572, 0.95},
                 {"afm_tip", "beta = 0.8\nc = 0.02\n", "r", 0.2480344164209596, 1.1},
                 {"afm_tip", "beta = 0.8\nc = 0.02\n", "r", 0.8478710901209433, 1.5},
                 {"afm_tip", "beta = 0.8\nc = 0.02\n", "r", 1.8455118363196439, 2.0},
                 {"afm_tip", "beta = 0.95\nc = 0.02\n", "r", 0.0769542353959734, 0.3},
                 {"afm_tip_cubic", "beta = 0.95\nc = 0.02\n", "r", 0.08110324493041433, 0.6},
                 {"afm_tip", "beta = 0.95\nc = 0.02\n", "r", 0.3889144008505305, 1.0},
                 {"afm_tip", "beta = 0.7\nc = 0.02\n", "r", 0.031300713943270934, 1.0954451150103321},
                 {"hertz_rig", "xi = 0.01\n", "a_stiff", 0.7856495351758077, 1.6},
                 {"hertz_rig", "xi = 0.01\n", "a_stiff", 0.394000859961461, 1.8},
                 {"hertz_rig", "xi = 0.01\n", "a_stiff", 0.056289308152417505, 1.98},
                 {"hertz_rig", "xi = 0.01\n", "a_stiff", 0.05685485091192883, 2.02},
                 {"hertz_rig", "xi = 0.01\n", "a_stiff", 0.2069119111170403, 2.1},
                 {"hertz_rig", "xi = 0.01\n", "a_stiff", 1.0813823751574676, 2.5},
                 {"hertz_rig_cubic", "xi = 0.01\n", "a_stiff", 5.558268841362643, 4.0},
                 {"hertz_rig", "xi = 0.01\n", "a_stiff", 14.654308372920873, 6.0}};
    static const struct {
        double r, omega, multiplier;
    } tips[] = {{0.2, 0.6, 0.9005768692821451}, {0.2, 1.5, 0.9589772739360298}, {0.2, 2, 0.969072426304808},
                {0.4, 0.6, 1.6093033567491226}, {0.4, 1.5, 0.9589772739360305}, {0.4, 2, 0.9690724263048057},
                {0.5, 0.6, 2.6190946481065525}, {0.5, 1.5, 0.9589772739360302}, {0.5, 2, 0.9690724263048046},
                {0.7, 0.6, 3.7239387699896964}, {0.7, 1.5, 0.9589772739360314}, {0.7, 2, 0.9690724263048053},
                {1, 0.6, 0.9005768692821386},   {1, 1.5, 1.975531921369499},    {1, 2, 0.9690724263048069}};
    for (size_t i = 0; i < sizeof edges / sizeof *edges; i++) {
        char arguments[160];
        struct maps_table t;
        snprintf(arguments, sizeof arguments, "--y=%s=%.17g:%.17g:2 --x=Omega=%.17g:9:2 --cores=1",
                 edges[i].name, edges[i].edge * (1.0 - 1e-6), edges[i].edge * (1.0 + 1e-6), edges[i].omega);
        const double *c = run(&t, edges[i].model, edges[i].paper, arguments, FLOQUET_COLUMNS);
        printf("      %s at %g\n", edges[i].model, edges[i].omega);
        if (t.n == 4) {
            check_below("multiplier a millionth below the edge", c[FLOQUET_PLANT], STABILITY_UNIT);
            check_above("a millionth above it", c[2 * FLOQUET_COLUMNS + FLOQUET_PLANT], STABILITY_UNIT);
        }
        free(t.cell);
    }
    struct maps_table t;
    const double *c =
        run(&t, "hertz_rig", "xi = 0.01\n", "--y=a_stiff=4:5:2 --x=Omega=8:9:2", FLOQUET_COLUMNS);
    check_near("rig under fast stiffness 4: |multiplier|", c[FLOQUET_PLANT], 0.9921767802925575, 1e-9);
    check_near("frequency over the contact's", c[FLOQUET_RATIO], 8.0, 1e-9);
    free(t.cell);
    for (size_t i = 0; i < sizeof tips / sizeof *tips; i++) {
        char arguments[96];
        snprintf(arguments, sizeof arguments, "--y=r=%g:2:2 --x=Omega=%g:9:2 --cores=1", tips[i].r,
                 tips[i].omega);
        c = run(&t, "afm_tip", "beta = 0.8\nc = 0.02\n", arguments, FLOQUET_COLUMNS);
        check_near("tip: |multiplier|", c[FLOQUET_PLANT], tips[i].multiplier, 1e-9);
        free(t.cell);
    }
}

/* 1 - trace + det of the plant's map, 0 where a multiplier is 1. */
static double beside_one(struct stability_tangent t, double modulation)
{
    double map[2][2];
    t.modulation = modulation;
    if (!stability_map(&t, &taylor, 1e-13, 1, 64, map))
        return (double)NAN;
    return 1.0 - map[0][0] - map[1][1] + map[0][0] * map[1][1] - map[0][1] * map[1][0];
}

/* Smallest modulations of the tip at which a multiplier
 * is +1, from Hill's equation as above, and none before. */
TEST(stability_plus_one)
{
    static const struct {
        double beta, omega, r;
    } edges[] = {{0.8, 0.59999999999999998, 1.0856847885893894},
                 {0.8, 0.80000000000000004, 2.4511895361854195},
                 {0.8, 0.89442719099991586, 3.2169221811603612},
                 {0.8, 0.94999999999999996, 3.7058027098466866},
                 {0.8, 1.1000000000000001, 5.1687227202158912},
                 {0.8, 1.5, 10.103254029787839},
                 {0.8, 2, 18.397213247240249},
                 {0.95, 0.29999999999999999, 0.22896527963654814},
                 {0.95, 0.59999999999999998, 1.3183364543942706},
                 {0.95, 1, 3.8733023805762343},
                 {0.7, 1.0954451150103321, 5.5145038075949424}};
    for (size_t i = 0; i < sizeof edges / sizeof *edges; i++) {
        double at = edges[i].beta * edges[i].r;
        struct stability_tangent t = {
            .damping = 0.02, .stiffness = 1.0 - edges[i].beta, .omega = edges[i].omega};
        printf("      beta %g at %g, r = %g\n", edges[i].beta, edges[i].omega, edges[i].r);
        double below = beside_one(t, at * (1.0 - 1e-8)), above = beside_one(t, at * (1.0 + 1e-8));
        check_is("a multiplier passes +1 within 1e-8", below * above, <, 0.0);
        double nearer = HUGE_VAL;
        for (int k = 0; k < 100; k++)
            nearer = fmin(nearer, beside_one(t, 0.01 * k * at) * (below > 0.0 ? 1.0 : -1.0));
        check_above("and not before: least 1 - trace + det up to there", nearer, 0.0);
    }
}

/* A base under the cubic model: (1 + qe/3) q, so a_base = 3 k1 beside the edge of a stiffness k1. */
TEST(stability_base)
{
    struct maps_table t;
    const double *c = run(&t, "hertz_rig_cubic", "xi = 0.01\n",
                          "--y=a_base=0.16886:0.16888:2 --x=Omega=1.98:2:2", FLOQUET_COLUMNS);
    check_below("base: 3 x 0.0562893, below", c[FLOQUET_PLANT], STABILITY_UNIT);
    check_above("above", c[2 * FLOQUET_COLUMNS + FLOQUET_PLANT], STABILITY_UNIT);
    free(t.cell);
}

/* One step of the classical Runge-Kutta method for x'' + c x' + (k + m cos t) x = 0, written out. */
static void runge_kutta(const struct stability_tangent *t, double time, double h, double x[2])
{
    static const double at[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    double k[2] = {0.0, 0.0}, sum[2] = {0.0, 0.0};
    for (int i = 0; i < 4; i++) {
        double y = x[0] + at[i] * h * k[0], v = x[1] + at[i] * h * k[1];
        double stiffness = t->stiffness + t->modulation * cos(t->omega * (time + at[i] * h));
        k[0] = v;
        k[1] = -t->damping * v - stiffness * y;
        sum[0] += weight[i] * k[0] * h / 6.0;
        sum[1] += weight[i] * k[1] * h / 6.0;
    }
    x[0] += sum[0];
    x[1] += sum[1];
}

TEST(stability_method)
{
    static const struct {
        struct stability_tangent t;
        int periods, steps;
    } cases[] = {{{.damping = 0.02, .stiffness = 1.0, .modulation = 0.3, .omega = 1.9}, 1, 5},
                 {{.damping = 0.02, .stiffness = 1.0, .modulation = 0.3, .omega = 1.9}, 4, 13},
                 {{.damping = 0.1, .stiffness = 0.2, .modulation = 0.15, .omega = 0.9}, 1, 40}};
    for (int i = 0; i < 3; i++) {
        const struct stability_tangent *t = &cases[i].t;
        double h = TWO_PI / t->omega * cases[i].periods / cases[i].steps, map[2][2], worst = 0.0;
        check_true("finite", stability_map(t, &rk4, 0.0, cases[i].periods, cases[i].steps, map));
        for (int j = 0; j < 2; j++) {
            double x[2] = {1.0 - j, j};
            for (int k = 0; k < cases[i].steps; k++)
                runge_kutta(t, k * h, h, x);
            worst = fmax(worst, fmax(fabs(x[0] - map[0][j]), fabs(x[1] - map[1][j])));
        }
        check_below("rk4's map beside the step written out", worst, 1e-12);
    }
}

/* The step is what was asked for to 1e-3, in whole periods. */
TEST(stability_steps)
{
    const struct stability_tangent t = {.stiffness = 1.0, .omega = 1.0};
    double worst = 0.0;
    int most = 0;
    for (int i = 0; i < 1000; i++) {
        double step = 0.05 + 0.003 * i;
        int periods, steps;
        stability_steps(&t, step, &periods, &steps);
        worst = fmax(worst, fabs(TWO_PI * periods / (steps * step) - 1.0));
        most = periods > most ? periods : most;
    }
    check_below("largest change of a step", worst, 1.01e-3);
    check_below("periods that it took", most, 257.0);
}

/* Undamped and linear: rk4 multiplies the energy by 1 - z^6/72 + z^8/576 at each step z = h omega; no method
 * makes any in the plant. */
TEST(stability_linear)
{
    enum { STEPS = 3 };
    struct maps_table t;
    const double *c =
        run(&t, "hertz_rig_linear", "xi = 0\n[start]\nq = 0.3\nq_dot = 0\n",
            "--map=contact --x=step=0.5:2.9:3 --y=sigma=0:1e-9:2 --periods=20 --method=rk4", CONTACT_COLUMNS);
    check_int("cells", t.n, 2 * STEPS);
    for (int i = 0; i < STEPS && t.n == 2 * STEPS; i++, c += CONTACT_COLUMNS) {
        double z = c[1], factor = 1.0 - pow(z, 6.0) / 72.0 + pow(z, 8.0) / 576.0;
        double ticks = ceil(TWO_PI * 20.0 / z), seen = factor < 1.0 ? ceil(0.5 * ticks) + 1.0 : ticks;
        check_near("step times eigenfrequency", c[CONTACT_STEP], z, 1e-9);
        check_near("energy of rk4 over the plant's, logarithm", log(c[CONTACT_ENERGY]), seen * log(factor),
                   1e-6 * fabs(seen * log(factor)));
        check_near("switches of a model without contact", c[CONTACT_SWITCHES], 0.0, 0.0);
    }
    free(t.cell);
}

/* Switches of the free undamped contact in a time from rest at `top`: flights last 3 v, contacts twice the
 * quadrature of d eta/eta' with eta = top (1 - u^2). */
static int free_switches(double top, double time)
{
    enum { N = 100000 };
    double energy = (4.0 / 15.0) * top * top * sqrt(top) - (2.0 / 3.0) * top, half = 0.0;
    for (int i = 0; i < N; i++) {
        double u = (i + 0.5) / N, eta = top * (1.0 - u * u);
        double potential = (4.0 / 15.0) * eta * eta * sqrt(eta) - (2.0 / 3.0) * eta;
        half += 2.0 * top * u / sqrt(2.0 * (energy - potential)) / N;
    }
    double flight = 3.0 * sqrt(2.0 * energy), period = 2.0 * half + flight;
    int n = 0;
    for (double lift = half; lift < time; lift += period)
        n += 1 + (lift + flight < time);
    return n;
}

/* Fine steps count the free contact's switches as the plant does, coarse ones do not. */
TEST(stability_bounce)
{
    struct maps_table t;
    const double *c =
        run(&t, "rolling_contact", "zeta = 0\n[start]\nq = 2.5\nq_dot = 0\n",
            "--map=contact --x=step=0.01:2:2 --y=zeta=0:1e-9:2 --periods=21 --method=rk4", CONTACT_COLUMNS);
    const double *coarse = c + CONTACT_COLUMNS;
    if (t.n == 4) {
        check_near("fine: switches of the plant", c[CONTACT_SWITCHES],
                   free_switches(2.5, ceil(TWO_PI * 21.0 / 0.01) * 0.01), 0.0);
        check_near("the method's", c[CONTACT_OF_METHOD], c[CONTACT_SWITCHES], 0.0);
        check_near("fine: energy", c[CONTACT_ENERGY], 1.0, 1e-4);
        check_near("coarse: switches of the plant", coarse[CONTACT_SWITCHES],
                   free_switches(2.5, ceil(TWO_PI * 10.5) * 2.0), 0.0);
        check_above("coarse: the method loses energy", 1.0 - coarse[CONTACT_ENERGY], STABILITY_ENERGY);
        check_is("and miscounts", fabs(coarse[CONTACT_OF_METHOD] - coarse[CONTACT_SWITCHES]), >, 0.5);
    }
    free(t.cell);
}
