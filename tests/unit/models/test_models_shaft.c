/* test_models_shaft.c - frequencies and dampings of the shaft from the linear view, and its kept modes. */
#include "tests/unit/test.h"

#include <complex.h>
#include <math.h>
#include <string.h>
#include "models/reduced/shaft_mode.h"
#include "models/shaft_bearing.h"
#include "models/math/symmetric3.h"
#include "tests/fixture/exact.h"
#include "tests/fixture/paper.h"

#define TWO_PI 6.283185307179586477

enum { BOTH_CLOSED = 5 }; /* contacts 0 and 2 */

/* The paper's defaults with some values set; prepared. */
static void shaft(const struct model *m, const char *const *name, const double *value, int n, double *p,
                  struct scale *scale)
{
    double paper[MODEL_PARAMETERS], si[MODEL_PARAMETERS];
    paper_defaults(m, paper);
    for (int i = 0; i < n; i++)
        paper[paper_index(m, name[i])] = value[i];
    paper_prepare(m, paper, si, p, scale);
}

/* det(s^2 I - s D - S) of x'' = S x + D x'. */
static double complex characteristic(const struct linear *l, double complex s)
{
    double complex a[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            a[i][j] = (i == j ? s * s : 0.0) - s * l->a[3 + i][3 + j] - l->a[3 + i][j];
    return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
           a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
           a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

/* The eigenvalue next to i omega, by the secant method. */
static double complex eigenvalue(const struct linear *l, double omega)
{
    const double complex i1 = (double complex)I;
    double complex s0 = 1e-3 * omega + i1 * omega * 0.999, s1 = i1 * omega;
    double complex f0 = characteristic(l, s0), f1 = characteristic(l, s1);
    for (int i = 0; i < 60 && s1 != s0 && f1 != f0; i++) {
        double complex s = s1 - f1 * (s1 - s0) / (f1 - f0);
        s0 = s1, f0 = f1;
        s1 = s, f1 = characteristic(l, s);
    }
    return s1;
}

/* Undamped frequency next to `guess`, Hz: damping out of the view. */
static double frequency(const double *p, const struct scale *scale, unsigned regime, double guess)
{
    struct linear l;
    check_true("a regime that occurs", shaft_bearing.linear(p, regime, &l));
    for (int i = 3; i < 6; i++)
        for (int j = 3; j < 6; j++)
            l.a[i][j] = 0.0;
    return cimag(eigenvalue(&l, guess * TWO_PI * scale->time_s)) / (TWO_PI * scale->time_s);
}

/* Against the generalised eigenvalue problem solved elsewhere to 13 digits. */
TEST(models_shaft_frequencies)
{
    static const char *const name[] = {"ks3", "kg1", "kg3"};
    static const struct {
        double ks3, kg;
        unsigned regime;
        double hz[3];
    } row[] = {{8030.0, 3.502e7, 0, {17.976663229487094, 25.431242515941566, 699.8748849627839}},
               {8030.0, 3.502e7, BOTH_CLOSED, {451.11005414569934, 1187.8249399564304, 1302.6623023476936}},
               {8030.0, 3.502e7, 10, {451.11005414569934, 1187.8249399564304, 1302.6623023476936}},
               {8030.0, 2.626e4, BOTH_CLOSED, {29.165827320473127, 41.28265673519495, 700.253439256431}},
               {8030.0, 1.4e6, BOTH_CLOSED, {163.88302586794583, 238.80072256757353, 720.8809928537396}},
               {8030.0, 35.02, BOTH_CLOSED, {17.996239297755054, 25.45895475553686, 699.8753893908644}},
               {0.803, 3.502e7, 0, {0.20764406596055715, 22.020584606713804, 699.7593375117381}},
               {0.0, 2.626e4, BOTH_CLOSED, {24.917024987350914, 38.07080616165402, 700.1376935353078}}};
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        double p[MODEL_DERIVED];
        struct scale scale;
        shaft(&shaft_bearing, name, (double[]){row[i].ks3, row[i].kg, row[i].kg}, 3, p, &scale);
        for (int k = 0; k < 3; k++)
            check_near("shaft frequency, Hz", frequency(p, &scale, row[i].regime, row[i].hz[k] * 1.002),
                       row[i].hz[k], 1e-10 * row[i].hz[2]);
    }
}

/* Published: 2.11, 1.99, 0.054 % with equal dampers, 2.8,
 * 2.0, 0.072 % with twice the damping in the middle. */
TEST(models_shaft_damping)
{
    static const double hz[3] = {17.977, 25.431, 699.875};
    static const double percent[2][3] = {{2.11, 1.99, 0.054}, {2.8, 2.0, 0.072}};
    static const double digit[2][3] = {{0.005, 0.005, 0.0005}, {0.05, 0.05, 0.0005}};
    static const char *const name[] = {"c2"};
    for (int model = 0; model < 2; model++) {
        double p[MODEL_DERIVED];
        struct scale scale;
        struct linear l;
        shaft(&shaft_bearing, name, (double[]){model ? 8.0 : 4.0}, 1, p, &scale);
        check_true("open gaps", shaft_bearing.linear(p, 0, &l));
        for (int k = 0; k < 3; k++) {
            double complex s = eigenvalue(&l, hz[k] * TWO_PI * scale.time_s);
            check_near("modal damping, %", -100.0 * creal(s) / cabs(s), percent[model][k], digit[model][k]);
        }
    }
}

/* The eigenfrequency that the step guard takes: the fastest mode with both gaps closed; without gap
 * springs, the fastest with gaps open. */
TEST(models_shaft_eigenfrequency)
{
    double p[MODEL_DERIVED];
    struct scale scale;
    shaft(&shaft_bearing, NULL, NULL, 0, p, &scale);
    check_near("closed, Hz", shaft_bearing.eigenfrequency(p) / (TWO_PI * scale.time_s), 1302.6623023476936,
               1e-9);
    shaft(&shaft_bearing_linear, NULL, NULL, 0, p, &scale);
    check_near("open, Hz", shaft_bearing_linear.eigenfrequency(p) / (TWO_PI * scale.time_s),
               699.8748849627839, 1e-9);
}

/* M x'' = p - C x' - K x - f_gap in SI, written out, everything asymmetric. */
TEST(models_shaft_equation)
{
    uint64_t seed = 31;
    double worst = 0.0;
    for (int n = 0; n < 300; n++) {
        double a[MODEL_PARAMETERS], si[MODEL_PARAMETERS], p[MODEL_DERIVED], x[6], q[6], x_dot[6];
        struct harmonic drive[MODEL_INPUTS];
        struct input u[MODEL_INPUTS];
        struct scale scale;
        paper_defaults(&shaft_bearing, a);
        for (int i = 0; i < 14; i++)
            a[i] *= 0.7 + 0.7 * exact_uniform(&seed);
        for (int i = 14; i < 19; i++)
            a[i] = 25.0 * exact_uniform(&seed);
        for (int i = 0; i < 6; i++)
            q[i] = (i < 3 ? 6e-4 : 0.5) * (2.0 * exact_uniform(&seed) - 1.0);
        double t = exact_uniform(&seed);
        shaft_bearing.from_paper(a, si, drive);
        shaft_bearing.prepare(si, p, &scale);
        for (int i = 0; i < 3; i++)
            u[i].value = drive[i].amplitude / scale.force_N * cos(drive[i].omega * t + drive[i].phase);
        shaft_bearing.state_from_paper(p, u, q, x);
        shaft_bearing.rhs(p, u, x, x_dot);
        double kL = a[8] / (a[9] * a[9]);
        double K[3][3] = {{2.0 * a[6] + kL, -2.0 * kL, kL},
                          {-2.0 * kL, 4.0 * kL, -2.0 * kL},
                          {kL, -2.0 * kL, 2.0 * a[7] + kL}};
        for (int i = 0; i < 3; i++) {
            int side = i == 2; /* index of this bearing's gap and spring */
            double over = fmax(0.0, fabs(q[i]) - a[10 + side]), size = 0.0;
            double f = a[14 + i] * cos(TWO_PI * a[17] * t + a[18]) - a[3 + i] * q[3 + i];
            for (int j = 0; j < 3; j++) {
                f -= K[i][j] * q[j];
                size += fabs(K[i][j] * q[j]);
            }
            f -= i == 1 ? 0.0 : a[12 + side] * over * (q[i] < 0.0 ? -1.0 : 1.0);
            double got = x_dot[3 + i] * scale.length_m / (scale.time_s * scale.time_s);
            exact_worst(&worst, (long double)(fabs((got * a[i] - f) / (size + fabs(f)))));
        }
    }
    check_below("force off the equation, over its terms", worst, 1e-14);
}

/* Nine regimes; a bearing is never closed on both sides. */
TEST(models_shaft_regimes)
{
    double p[MODEL_DERIVED];
    struct scale scale;
    struct linear l;
    int possible = 0;
    shaft(&shaft_bearing, NULL, NULL, 0, p, &scale);
    for (unsigned regime = 0; regime < 16; regime++) {
        bool both = (regime & 3u) == 3u || (regime & 12u) == 12u;
        check_int("a view where there is a regime", shaft_bearing.linear(p, regime, &l), !both);
        possible += shaft_bearing_linear.linear(p, regime, &l);
    }
    check_int("regimes of the linear shaft", possible, 1);
}

/* A kept mode has the shaft's own frequency while the gaps are open. The data are symmetric. In
 * translation and bending both bearings close on the same side, in rotation on opposite ones. Each gap
 * spring of stiffness kg adds kg to the modal stiffness (bearings move by q). Modal mass of translation: m
 * (2 + 2 phi2^2). */
TEST(models_shaft_modes)
{
    static const double hz[3] = {17.976663229487094, 25.431242515941566, 699.8748849627839};
    static const char *const name[] = {"mode", "kg1"};
    static const unsigned closed[3] = {5, 9, 5}, never[3] = {9, 5, 9};
    for (int mode = 1; mode <= 3; mode++) {
        double p[MODEL_DERIVED], unit, x[2] = {1.5, 0.0}, out[SHAFT_OUTPUTS];
        struct scale scale;
        struct linear l, open;
        struct input u[MODEL_INPUTS] = {{0.0, 0.0}};
        shaft(&shaft_bearing_mode, name, (double[]){mode, 3.502e7}, 2, p, &scale);
        unit = TWO_PI * scale.time_s;
        check_true("open gaps", shaft_bearing_mode.linear(p, 0, &open));
        check_near("frequency of the kept mode, Hz", sqrt(-open.a[1][0]) / unit, hz[mode - 1], 1e-10);
        check_true("a regime of this mode", shaft_bearing_mode.linear(p, closed[mode - 1], &l));
        check_true("no regime of this mode", !shaft_bearing_mode.linear(p, never[mode - 1], &l));
        double omega = shaft_bearing_mode.eigenfrequency(p);
        check_true("closed gaps", shaft_bearing_mode.linear(p, closed[mode - 1], &l));
        check_near("eigenfrequency is that of closed gaps", omega * omega, -l.a[1][0], 1e-12 * omega * omega);
        shaft_bearing_mode.output(p, u, x, out);
        check_near("bearing 1 moves by q", out[4], 1.5, 1e-12);
        check_near("bearing 3 by q, or minus q in rotation", out[6], mode == 2 ? -1.5 : 1.5, 1e-12);
        /* the mass of this motion, in units of m: 2 + 2 phi2^2 */
        double mass = 2.0 + 2.0 * (out[0] / 1.5) * (out[0] / 1.5);
        double added = 2.0 * 3.502e7 * 0.1614 * 0.1614 / 79161.0 / mass;
        check_near("what the gap springs add", omega * omega + open.a[1][0], added, 1e-12 * added);
    }
}

/* Random symmetric matrices put together from known eigenvalues and rotations. */
TEST(models_symmetric3)
{
    uint64_t seed = 32;
    double worst = 0.0, residual = 0.0;
    for (int n = 0; n < 500; n++) {
        double a[3][3], copy[3][3], value[3], vector[3][3], trace = 0.0, size = 0.0;
        for (int i = 0; i < 3; i++)
            for (int j = i; j < 3; j++)
                a[i][j] = a[j][i] = pow(10.0, 6.0 * exact_uniform(&seed)) * (exact_uniform(&seed) - 0.5);
        memcpy(copy, a, sizeof a);
        symmetric3_eigen(a, value, vector);
        for (int i = 0; i < 3; i++) {
            trace += copy[i][i];
            exact_worst(&size, (long double)(fabs(value[i])));
        }
        exact_worst(&worst, (long double)(fabs(value[0] + value[1] + value[2] - trace) / size));
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 3; i++) {
                double r = -value[k] * vector[k][i], norm = 0.0;
                for (int j = 0; j < 3; j++) {
                    r += copy[i][j] * vector[k][j];
                    norm += vector[k][j] * vector[(k + i) % 3][j];
                }
                exact_worst(&residual, (long double)(fabs(r) / size + fabs(norm - (i ? 0.0 : 1.0))));
            }
        if (!(value[0] <= value[1] && value[1] <= value[2]))
            check_true("eigenvalues ascend", 0);
    }
    check_below("symmetric3: trace", worst, 4e-15);
    check_below("symmetric3: A v - lambda v, and orthonormality", residual, 1e-14);
}
