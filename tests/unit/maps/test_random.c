/* test_random.c - realisations against the closed forms, and
 * these against quadrature elsewhere and the normal law. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "host_sim/commands.h"
#include "host_sim/maps/random/random.h"
#include "host_sim/maps/random/random_law.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/maps_run.h"

#define PI 3.14159265358979323846
enum { DISPLACEMENT, VELOCITY, PENETRATION, BINS = 16 };
static struct random_law law;

/* The rolling contact under all but white noise, in the paper's numbers. */
static struct scene rolling(const struct model *m, double zeta, double Phi)
{
    struct scene s = scenes_find("nayak-random")->scene;
    s.model = m;
    s.value[0] = zeta;
    s.observable = DISPLACEMENT;
    s.frame_s = 1e-5 * s.substeps * s.dilation;
    s.drive[ROLLING_FORCE].noise = 1.5 * sqrt(2.0 * PI * Phi / 1e-5);
    s.drive[ROLLING_FORCE].noise_hold = 0.0;
    return s;
}

static void solve(const struct scene *s)
{
    const char *why = random_law_of(s, &law);
    if (why)
        check_string("random_law_of", why, "a law");
}

/* Phi/zeta = 0.1: shares of time, crossings and exceedances by quadrature elsewhere with 15 digits. */
TEST(random_nayak)
{
    static const double level[4] = {0.0, 1.0, 2.0, 2.5},
                        above[4] = {0.9817519963223, 0.4698028409735, 0.002910788321784, 1.22584077702e-05},
                        crossing[4] = {0.01224543530104, 0.1562773523805, 0.004015022019209,
                                       2.57088170778e-05};
    struct scene s = rolling(&rolling_contact, 0.05, 0.005);
    double mean, variance;
    solve(&s);
    random_law_moments(&law, &mean, &variance);
    check_near("mean", mean, 0.9507496200122, 1e-6);
    check_near("variance", variance, 0.1747065428916, 1e-6);
    for (int i = 0; i < 4; i++) {
        check_near("share above 0, 1, 2, 2.5", random_law_above(&law, level[i]) / above[i], 1.0, 1e-4);
        check_near("up-crossings", random_law_crossing(&law, level[i]) / crossing[i], 1.0, 1e-4);
    }
    check_near("out of contact", random_law_open(&law), 0.018248003677698, 1e-6);
    check_near("touchdowns", random_law_touches(&law), crossing[0], 1e-6);
    s.observable = PENETRATION;
    solve(&s);
    check_near("a penetration is never below 0", random_law_above(&law, -0.1), 1.0, 0.0);
    check_near("and does not cross it", random_law_crossing(&law, -0.1), 0.0, 0.0);
    check_near("above 0 it is the same", random_law_above(&law, 1.0) / above[1], 1.0, 1e-4);
}

/* y'' + 2 zeta y' + y = f: normal with variance pi Phi/(2 zeta), its mean crossed once a period of 2 pi. */
TEST(random_gauss)
{
    const double zeta = 0.1, Phi = 0.001, sigma = sqrt(PI * Phi / (2.0 * zeta));
    struct scene s = rolling(&rolling_contact_linear, zeta, Phi);
    double mean, variance;
    solve(&s);
    random_law_moments(&law, &mean, &variance);
    check_near("mean", mean, 1.0, 1e-9);
    check_near("variance", variance / (sigma * sigma), 1.0, 1e-5);
    for (int k = -3; k <= 3; k++) {
        check_near("share above k standard deviations", random_law_above(&law, 1.0 + k * sigma),
                   0.5 * erfc(k / sqrt(2.0)), 1e-5);
        check_near("up-crossings", random_law_crossing(&law, 1.0 + k * sigma) * 2.0 * PI, exp(-0.5 * k * k),
                   1e-5);
    }
    check_nan("a model without contact is not told to lose it", random_law_open(&law));
}

/* The numbers in SI: a rate per second and a length in metres. */
static void check_si(void)
{
    struct scene s;
    double mean, variance, w = 2.0 * PI * 229.9317;
    scenes_default(&s, &hertz_rig_linear);
    s.observable = DISPLACEMENT;
    s.drive[RIG_FORCE].noise = 2.0;
    solve(&s);
    random_law_moments(&law, &mean, &variance);
    double step = s.frame_s / s.substeps, Phi = 4.0 * step / (2.0 * PI), m = s.value[RIG_MASS],
           c = s.value[RIG_DAMPING];
    check_near("rig: variance pi Phi/(c k), Phi = sigma^2 T/(2 pi)", variance / (PI * Phi / (c * m * w * w)),
               1.0, 1e-3);
    check_near("rig: crossings of the mean per second", random_law_crossing(&law, mean), w / (2.0 * PI), 0.1);
}

static void check_refusal(const char *name, const struct scene *s, const char *part)
{
    const char *why = random_law_of(s, &law);
    check_contains(name, why, part);
    printf("      %s\n", why ? why : "no reason");
}

TEST(random_no_law)
{
    struct scene s = rolling(&rolling_contact, 0.05, 0.005);
    check_si();
    s.observable = VELOCITY;
    check_refusal("a velocity", &s, "not a position");
    s.observable = DISPLACEMENT;
    s.value[0] = 0.0;
    check_refusal("no damping", &s, "damping");
    s = rolling(&rolling_contact, 0.05, 0.0);
    check_refusal("no noise", &s, "no noise");
    scenes_default(&s, &hertz_rig);
    s.observable = DISPLACEMENT;
    s.drive[RIG_BASE].noise = 1e-7;
    check_refusal("a base in straight lines", &s, "force alone");
    s.drive[RIG_BASE].noise = 0.0;
    s.drive[RIG_FORCE] = (struct scene_drive){.amplitude = 1.0, .frequency_Hz = 100.0, .noise = 1.0};
    check_refusal("a harmonic drive besides", &s, "harmonic");
    scenes_default(&s, &shaft_bearing);
    check_refusal("three degrees of freedom", &s, "degree of freedom");
    s = scenes_find("kb-fig16")->scene;
    s.value[4] = 0.0; /* f */
    s.value[2] = 0.0; /* r */
    s.observable = DISPLACEMENT;
    s.drive[TIP_FORCE].noise = 1.0;
    check_refusal("the published tip, its saddle within e^-80", &s, "escapes");
}

/* ---- realisations ---- */

/* Mean and standard error of a column's sum from..to. */
static double average(const struct maps_table *t, int from, int to, double *error)
{
    double mean = 0.0, square = 0.0;
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < t->n; i++) {
            double sum = 0.0;
            for (int k = from; k <= to; k++)
                sum += t->cell[i * t->columns + k];
            mean += pass ? 0.0 : sum / t->n;
            square += pass ? (sum - mean) * (sum - mean) : 0.0;
        }
    *error = sqrt(square / (t->n - 1.0) / t->n);
    return mean;
}

/* Within four standard errors, and these below a share of the value: else the check would prove nothing. */
static void check_column(const char *name, const struct maps_table *t, int from, int to, double expected,
                         double share)
{
    double error, mean = average(t, from, to, &error);
    check_near(name, mean, expected, 4.0 * error);
    check_below("      its standard error, relative", error / fabs(expected), share);
}

static void realise(const char *model, const struct model *m, double Phi, int n, const char *arguments,
                    struct maps_table *t)
{
    char text[512];
    double deviation = 1.5 * sqrt(2.0 * PI * Phi / 0.05);
    snprintf(text, sizeof text,
             "[plant]\nmodel = %s\nmethod = rk4\n[paper]\nzeta = 0.2\n[drive force]\nnoise = %.17g\n"
             "noise_hold = 0.05\nnoise_seed = 1\n[ask]\nobservable = displacement\nover = 1500\n"
             "[deadline]\nframe = 1 ms\nsubsteps = 20\ndilation = 0.001\n",
             model, deviation);
    check_int("status", maps_run(cmd_random, text, arguments, RANDOM_BIN + 2 * BINS + 2, t), 0);
    struct scene s = rolling(m, 0.2, Phi);
    s.frame_s = 0.05 * s.substeps * s.dilation;
    s.drive[ROLLING_FORCE].noise = deviation;
    solve(&s);
    check_int("realisations", t->n, n);
}

/* Levels from -1 to 3 in quarters, where the closed form is not too rare to be met. */
static void check_levels(const struct maps_table *t, double rare)
{
    for (int i = 0; i <= BINS; i++) {
        double level = -1.0 + 0.25 * i, above = random_law_above(&law, level);
        if (!(above > rare && above < 1.0 - rare))
            continue;
        printf("      level %g\n", level);
        check_column("share above", t, RANDOM_BIN + i, RANDOM_BIN + BINS, above, 0.2);
        check_column("up-crossings", t, RANDOM_BIN + BINS + 1 + i, RANDOM_BIN + BINS + 1 + i,
                     random_law_crossing(&law, level), 0.2);
    }
}

TEST(random_contact)
{
    struct maps_table t;
    double mean, variance;
    realise("rolling_contact", &rolling_contact, 0.02, 40, "--seeds=40 --bins=16 --range=-1:3 --shard=1/1",
            &t);
    random_law_moments(&law, &mean, &variance);
    check_column("mean", &t, RANDOM_MEAN, RANDOM_MEAN, mean, 0.01);
    check_column("mean square about 1", &t, RANDOM_SQUARE, RANDOM_SQUARE,
                 variance + (mean - 1.0) * (mean - 1.0), 0.03);
    check_column("out of contact", &t, RANDOM_OPEN, RANDOM_OPEN, random_law_open(&law), 0.1);
    check_column("touchdowns", &t, RANDOM_TOUCHES, RANDOM_TOUCHES, random_law_touches(&law), 0.1);
    check_levels(&t, 1e-3);
    free(t.cell);
}

TEST(random_linear)
{
    struct maps_table t;
    realise("rolling_contact_linear", &rolling_contact_linear, 0.02, 40,
            "--seeds=40 --bins=16 --range=-1:3 --shard=1/1", &t);
    check_levels(&t, 1e-3);
    free(t.cell);
}

/* Looked at for less than a fall by e, 5 here, it is steady noise all the same. */
TEST(random_short)
{
    struct maps_table t;
    realise("rolling_contact_linear", &rolling_contact_linear, 0.02, 400,
            "--seeds=400 --bins=16 --range=-1:3 --over=3 --shard=1/1", &t);
    double mean, variance;
    random_law_moments(&law, &mean, &variance);
    check_column("mean square about 1", &t, RANDOM_SQUARE, RANDOM_SQUARE,
                 variance + (mean - 1.0) * (mean - 1.0), 0.1);
    free(t.cell);
}
