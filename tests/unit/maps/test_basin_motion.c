/* test_basin_motion.c - attractors of rig and shaft, and how many starts reach them, against independent
 * references (tests/data/basins.txt) and symmetry. */
#include "host_sim/maps/basin/basin_clusters.h"
#include "host_sim/maps/basin/basin_starts.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/scenes/scenes.h"
#include "models/shaft_views.h"
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MOTION_STARTS = 120, SOME_STARTS = 40, LINE = 200 };

static const struct basin_patience patience = {20000, 1e-8};

/* ---- reference ---- */

/* The n numbers, 2 or 3, of the i-th line that begins with `name`. */
static void reference(const char *name, int i, int n, double *x)
{
    char line[LINE];
    size_t length = strlen(name);
    FILE *f = fopen("tests/data/basins.txt", "r");
    check_true("tests/data/basins.txt (run from the project's directory)", f != NULL);
    for (int k = 0; k < n; k++)
        x[k] = (double)NAN;
    while (f && fgets(line, sizeof line, f)) {
        if (strncmp(line, name, length) || line[length] != ' ' || i-- > 0)
            continue;
        sscanf(line + length, n == 3 ? "%lf %lf %lf" : "%lf %lf", &x[0], &x[1], &x[n - 1]);
        break;
    }
    if (f)
        fclose(f);
}

/* ---- plants ---- */

/* method: NULL for batch_taylor. */
static void begin_map(struct basin_plant *b, const struct scene *s, const struct method *method, int steps)
{
    check_no_error("the drives share a period", basin_map_read(b, s));
    b->series = !method;
    b->method = method ? method : &taylor;
    b->tol = 1e-10;
    b->steps = steps;
}

static void begin_rig(struct basin_plant *b, const struct method *method, int steps)
{
    struct scene s;
    scenes_default(&s, &hertz_rig);
    s.paper = true;
    memset(s.value, 0, sizeof s.value);
    s.value[RIG_PAPER_XI] = 0.01;
    s.value[RIG_PAPER_SIGMA] = 0.04;
    s.value[RIG_PAPER_OMEGA] = 0.9580772293;
    begin_map(b, &s, method, steps);
}

static void begin_shaft(struct basin_plant *b, const char *preset, double hz)
{
    struct scene s = scenes_find(preset)->scene;
    s.value[SHAFT_PAPER_HZ] = hz;
    begin_map(b, &s, &exact, hz > 100.0 ? 8 : 256);
}

/* Motions of n starts in the box +-reach, velocities +-speed, around rest. */
static void settle(const struct basin_plant *b, int n, double reach, double speed,
                   struct basin_motion *motion)
{
    static double x[MOTION_STARTS][MODEL_STATES];
    double rest[MODEL_STATES];
    struct basin_starts s;
    struct basin_box box;
    b->model->rest(b->p, rest);
    for (int i = 0; i < b->model->n_states; i++) {
        double side = i < b->model->n_states / 2 ? reach : speed;
        box.low[i] = rest[i] - side;
        box.high[i] = rest[i] + side;
    }
    check_true("memory for the starts", basin_starts_make(&s, n, b->model->n_states, 1, &box));
    for (int i = 0; i < n; i++)
        basin_starts_get(&s, i, x[i]);
    basin_starts_free(&s);
    check_no_error("all starts are followed", basin_motion_find(b, &patience, n, x, motion));
}

static void cluster(const struct basin_plant *b, int n, const struct basin_motion *motion,
                    struct basin_clusters *c)
{
    basin_clusters_start(c, b->model);
    for (int i = 0; i < n; i++)
        basin_clusters_add(c, &motion[i]);
    basin_clusters_finish(c, NULL);
}

static struct basin_motion settled[MOTION_STARTS], settled_other[MOTION_STARTS];
static struct basin_clusters clusters;

/* ---- the rig between its folds ---- */

static void check_branch(const char *name, const struct basin_attractor *a)
{
    double x[3];
    reference(name, 0, 3, x);
    check_int("period", a->motion.period, 1);
    check_near("largest q (at ticks: a share of 8e-5 low)", 1.5 * (a->motion.peak - 1.0), x[0], 2e-4);
    check_near("share of time out of contact", a->motion.open, x[1], 1e-6);
    check_near("growth: logarithm of the largest multiplier", a->growth, log(x[2]), 1e-3);
}

TEST(basin_rig)
{
    struct basin_plant b;
    begin_rig(&b, NULL, 8);
    settle(&b, MOTION_STARTS, 4.0, 4.0, settled);
    cluster(&b, MOTION_STARTS, settled, &clusters);
    check_int("attractors between the folds", clusters.n, 2);
    check_branch("rig high", &clusters.attractor[0]);
    check_branch("rig low", &clusters.attractor[1]);
}

/* The rig's boundary is smooth: only starts within an error of it may differ. */
TEST(basin_methods)
{
    struct basin_plant b;
    begin_rig(&b, NULL, 8);
    settle(&b, SOME_STARTS, 4.0, 4.0, settled);
    for (int k = 0; k < 2; k++) {
        int differ = 0;
        begin_rig(&b, k ? &rk4_unlocated : &taylor, k ? 256 : 8);
        settle(&b, SOME_STARTS, 4.0, 4.0, settled_other);
        for (int i = 0; i < SOME_STARTS; i++)
            differ += fabs(settled[i].peak - settled_other[i].peak) > 1e-4;
        check_below(k ? "starts that batch_taylor and rk4_unlocated lead to different attractors"
                      : "starts that batch_taylor and taylor lead to different attractors",
                    differ, 1);
    }
}

/* ---- the shaft ---- */

TEST(basin_shaft_705)
{
    struct basin_plant b;
    double x[2], count = 0.0, low, high;
    begin_shaft(&b, "shaft-fig16-705", 705.0);
    settle(&b, MOTION_STARTS, 4.0, 1.45, settled);
    cluster(&b, MOTION_STARTS, settled, &clusters);
    const struct basin_attractor *first = &clusters.attractor[0];
    reference("shaft705", 0, 2, x);
    check_int("most starts end without contact, period", first->motion.period, 1);
    check_near("share of time without contact", first->motion.open, 1.0, 1e-12);
    check_near("largest x1, against the linear shaft's", first->motion.peak * b.scale.length_m / x[0], 1.0,
               1e-4);
    check_near("growth: damping of the slowest mode", first->growth, -x[1] / 705.0, 5e-4);
    check_int("it is symmetric", first->image[IMAGE_MIRROR] == 0 && first->image[IMAGE_ENDS] == 0, 1);
    check_is("another one was seen, as in the paper's fig. 16b", clusters.n, >=, 2);
    for (int i = 1; i < clusters.n; i++)
        count += clusters.attractor[i].count;
    basin_clusters_wilson((int)count, MOTION_STARTS, &low, &high);
    check_below("it is rare there: lower end of its share", low, 0.05);
}

/* In a symmetric box a motion and its mirror image are equally likely. */
TEST(basin_shaft_pairs)
{
    struct basin_plant b;
    double low, high;
    begin_shaft(&b, "shaft-fig13-18", 18.49);
    settle(&b, SOME_STARTS, 4.0, 0.2, settled);
    cluster(&b, SOME_STARTS, settled, &clusters);
    check_int("broken symmetry: attractors", clusters.n, 2);
    check_int("each the other's mirror image", clusters.attractor[0].image[IMAGE_MIRROR], 1);
    check_int("in both directions", clusters.attractor[1].image[IMAGE_MIRROR], 0);
    check_near("equal growth", clusters.attractor[0].growth, clusters.attractor[1].growth, 1e-3);
    basin_clusters_wilson(clusters.attractor[0].count, SOME_STARTS, &low, &high);
    check_below("half is in the interval: lower end", low, 0.5);
    check_above("upper end", high, 0.5);
}

/* From starts that lead there: 45 Hz has an isola of order
 * 2 beside the main branch, 21 Hz a quasiperiodic motion. */
TEST(basin_shaft_reference)
{
    static const struct {
        double start[MODEL_STATES]; /* SI */
        int line;
    } run[] = {
        {{0.0}, 0},
        {{5.7506e-4, 9.978e-4, 7.6275e-4, -0.15571, 0.03525, 0.0949}, 1},
        {{-5.6435e-4, 2.4443e-4, 8.8808e-4, 0.13691, 0.00447, -0.08238}, 2},
        {{0.0}, 3},
    };
    for (int k = 0; k < 4; k++) {
        struct basin_plant b;
        double x[1][MODEL_STATES], wanted[3];
        reference("shaft", run[k].line, 3, wanted);
        begin_shaft(&b, "shaft-fig12", wanted[0]);
        for (int i = 0; i < 6; i++)
            x[0][i] = run[k].start[i] / scale_of(&b.scale, b.model->state_signal[i].quantity);
        check_no_error("followed", basin_motion_find(&b, &patience, 1, x, settled));
        check_int("period", settled->period, (int)wanted[1]);
        check_near("largest x1, mm", settled->peak * b.scale.length_m * 1e3, wanted[2], 5.1e-4);
    }
}

/* ---- what does not settle ---- */

TEST(basin_escape)
{
    struct basin_plant b;
    struct scene s = scenes_find("kb-fig16")->scene;
    double x[2][MODEL_STATES] = {{0.0}};
    s.value[TIP_PAPER_R] = 0.0; /* the slow force alone */
    begin_map(&b, &s, NULL, 8);
    b.model->rest(b.p, x[0]);
    b.model->rest(b.p, x[1]);
    x[1][0] += s.value[TIP_PAPER_SIGN] * -2.0; /* beyond the saddle */
    check_no_error("followed", basin_motion_find(&b, &patience, 2, x, settled));
    check_int("from rest the tip settles", settled[0].outcome, BASIN_SETTLED);
    check_int("from beyond the saddle it escapes", settled[1].outcome, BASIN_GONE);
}

TEST(basin_forcing_period)
{
    struct basin_plant b = {.model = &hertz_rig};
    check_error("no drive, no period", basin_map_period(&b));
    b.drive[0] = (struct harmonic){0.1, 0.5, 0.0};
    b.drive[1] = (struct harmonic){0.1, 4.0, 0.0};
    check_no_error("8 times the lowest", basin_map_period(&b));
    check_near("turns of the fast drive", b.turns[1], 8.0, 0.0);
    check_near("forcing period", b.period, 4.0 * acos(-1.0), 1e-14);
    b.drive[1].omega = 4.1;
    check_error("8.2 times: none in common", basin_map_period(&b));
    b.drive[1].amplitude = 0.0;
    check_no_error("a silent drive does not matter", basin_map_period(&b));
}
