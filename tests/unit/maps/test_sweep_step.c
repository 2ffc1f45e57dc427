/* test_sweep_step.c - a step of a sweep on a model whose jumps and unsettled ranges stand in its equation. */
#include "host_sim/maps/sweep/sweep_step.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/reduced/polynomial.h"
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* q'' + 2 c q' + q = sigma cos(omega tau), as hertz_rig_linear, but for two things that xi decides. Where the
 * motion does not settle c is that of van der Pol's oscillator, whose own motion beats with the drive. The
 * output is 1, 2 or 4 times the displacement: below, between and above two places. */
static const double wild_from = 0.021, wild_to = 0.0355, first = 0.028, second = 0.0513;

static double xi_of(const double *p)
{
    return p[POLYNOMIAL_DAMPING] / (2.0 * p[POLYNOMIAL_EIGENFREQUENCY]);
}

static void own_rhs(const double *p, const struct input *u, const double *x, double *x_dot)
{
    double xi = xi_of(p), q = 10.0 * (x[0] - p[POLYNOMIAL_REST]);
    double c = xi > wild_from && xi < wild_to ? 0.2 * (q * q - 1.0) : 0.05;
    hertz_rig_linear.rhs(p, u, x, x_dot);
    x_dot[1] += (p[POLYNOMIAL_DAMPING] - 2.0 * p[POLYNOMIAL_EIGENFREQUENCY] * c) * x[1];
}

static void own_output(const double *p, const struct input *u, const double *x, double *output)
{
    hertz_rig_linear.output(p, u, x, output);
    output[0] *= xi_of(p) < first ? 1.0 : xi_of(p) < second ? 2.0 : 4.0;
}

/* 1 up to a place, then growing as a root: 15 % in a bracket's width, 4 % in the shortest step of a search.
 * The place is in the first sixteenth of the bracket that halving 0.02 to 0.06 gives. */
static const double root_at = 0.02 + 0.04 * (8000.0 + 0.004) / 16384.0;

static void root_output(const double *p, const struct input *u, const double *x, double *output)
{
    hertz_rig_linear.output(p, u, x, output);
    output[0] *= 1.0 + 96.0 * sqrt(fmax(xi_of(p) - root_at, 0.0));
}

static struct model model;
static struct sweep s;

/* The scene, swept from xi = 0.02 to 0.06 in one step. */
static void begin_step(void)
{
    static const struct usage usage = {.name = "sweep"};
    char why[SCENE_REASON], path[] = "/tmp/contactplant_step_XXXXXX";
    FILE *f = fdopen(mkstemp(path), "w");
    fputs("[ask]\nobservable = displacement\n[deadline]\nframe = 1 ms\ndilation = 0.001\n[plant]\nmodel = "
          "hertz_rig_linear\n[paper]\nxi = 0.02\nsigma = 0.01\nomega = 0.71\n",
          f);
    fclose(f);
    s = (struct sweep){.settle = 60,
                       .measure = 12,
                       .harmonic = {{1, 1}},
                       .n_harmonics = 1,
                       .common = 1,
                       .bracket = 1e-4,
                       .m = {.method = &rk4, .tol = 1e-9}};
    check_true("scene", scene_load(path, &s.m.scene, why) != SCENE_OF_NOTHING);
    unlink(path);
    model = hertz_rig_linear;
    model.polynomial_form = NULL; /* else the method takes the equation from there */
    s.m.scene.model = &model;
    check_int("range", scene_range_read(&usage, &s.m.scene, "sweep", "xi=0.02:0.06:2", &s.range), 0);
    s.scratch = calloc(rk4.n_scratch(&model) + 1, sizeof *s.scratch);
}

/* The step up or down. */
static void take(struct step *c, bool down)
{
    struct sweep_result last, now;
    *c = (struct step){.s = &s, .scene = &s.m.scene};
    check_true("begins", sweep_settle(c, SOME, down ? 0.06 : 0.02, NULL, &last));
    check_true("steps", sweep_step(c, &last, down ? 0.02 : 0.06, &now));
    check_true("and settles there", sweep_steady(&now));
}

/* One step over both places and the range: the range is told, and the search goes on behind it. */
TEST(sweep_step_behind_a_range)
{
    struct step c;
    begin_step();
    model.rhs = own_rhs;
    model.output = own_output;
    for (int down = 0; down < 2; down++) {
        int ranges = 0, places = 0;
        take(&c, down);
        for (int i = 0; i < c.n; i++) {
            double low = fmin(c.jump[i].from.value, c.jump[i].to.value),
                   high = fmax(c.jump[i].from.value, c.jump[i].to.value);
            ranges += c.jump[i].lost && low < wild_to && high > wild_from;
            if (c.jump[i].lost || low > second || high < second)
                continue;
            places++;
            check_below("width over place", (high - low) / second, 1e-4);
        }
        check_int("ranges that meet the one without settling", ranges, 1);
        check_int("jumps at the second place", places, 1);
    }
    free(s.scratch);
}

/* An output without a jump, whose sides differ by 15 % as far apart as a bracket is wide. */
TEST(sweep_step_over_a_root)
{
    struct step c;
    begin_step();
    model.output = root_output;
    take(&c, false);
    check_int("jumps up", c.n, 0);
    take(&c, true);
    check_int("jumps down", c.n, 0);
    free(s.scratch);
}

/* An output that is larger by a share beyond a place: a jump from 5 % on. */
static double share;

static void larger_output(const double *p, const struct input *u, const double *x, double *output)
{
    hertz_rig_linear.output(p, u, x, output);
    output[0] *= xi_of(p) < second ? 1.0 : 1.0 + share;
}

TEST(sweep_step_size_of_a_jump)
{
    static const double size[] = {0.04, 0.065}; /* 3.8 and 6.1 % of the larger side */
    struct step c;
    for (int i = 0; i < 4; i++) {
        begin_step();
        model.output = larger_output;
        share = size[i / 2];
        take(&c, i % 2);
        check_int(i < 2 ? "smaller than 5 %: jumps" : "larger: jumps", c.n, i / 2);
        if (i >= 2 && c.n == 1)
            check_near("its place", c.jump[0].to.value, second, 1e-4 * second);
        free(s.scratch);
    }
}
