/* test_rk4_float32_motion.c - rk4_float32 over many periods: its order, its floor, contact, energy.
 *
 * Compared with taylor at 1e-13, for the shaft with exact, and with the stored multi-precision trajectories.
 */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/app/plant_scene.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/scenes/scenes_table.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/exact.h"
#include "tests/fixture/paper.h"
#include "tests/fixture/slope.h"
#include "tests/fixture/trajectory.h"

#define TWO_PI 6.283185307179586477

static double scratch[METHOD_SCRATCH], fine_scratch[METHOD_SCRATCH];

/* One motion, its drive's period in the paper's time, and this many ticks in it. */
struct motion {
    const char *name;
    const struct model *model;
    const struct method *reference;
    struct {
        const char *name;
        double value;
    } set[5]; /* besides the paper's defaults, up to the first without a name */
    double start[MODEL_STATES];
    double period;
    int periods, ticks, fine_ticks;
};

static void paper_of(const struct motion *c, double *paper)
{
    paper_defaults(c->model, paper);
    for (int i = 0; i < 5 && c->set[i].name; i++)
        paper[paper_index(c->model, c->set[i].name)] = c->set[i].value;
}

static void motion_start(struct plant *pl, const struct motion *c, const struct method *method, double h)
{
    double paper[MODEL_PARAMETERS];
    paper_of(c, paper);
    paper_start_by(pl, c->model, method, method == &taylor ? 1e-13 : 0.0,
                   method == c->reference ? fine_scratch : scratch, paper, h, c->start);
}

static void run(struct plant *pl, uint64_t ticks)
{
    if (!plant_run(pl, ticks))
        check_true("the plant stays finite", 0);
}

/* The worst error at the ends of the drive's periods, each state over its largest deviation from rest. */
static double worst_error(const struct motion *c)
{
    static struct plant pl, fine;
    double error[MODEL_STATES] = {0.0}, largest[MODEL_STATES] = {0.0}, rest[MODEL_STATES], worst = 0.0;
    motion_start(&pl, c, &rk4_float32, c->period / c->ticks);
    motion_start(&fine, c, c->reference, c->period / c->fine_ticks);
    c->model->rest(pl.p, rest);
    for (int k = 0; k < c->periods; k++) {
        run(&pl, (uint64_t)c->ticks);
        run(&fine, (uint64_t)c->fine_ticks);
        for (int i = 0; i < c->model->n_states; i++) {
            error[i] = fmax(error[i], fabs(pl.x[i] - fine.x[i]));
            largest[i] = fmax(largest[i], fabs(fine.x[i] - rest[i]));
        }
    }
    for (int i = 0; i < c->model->n_states; i++)
        worst = fmax(worst, error[i] / largest[i]);
    check_int("no switch", (int64_t)pl.counts.switches, 0);
    return worst;
}

/* At least a hundred periods of drive and plant; the steps
 * are so fine that rounding is what is seen, or nearly. */
TEST(rk4_float32_smooth)
{
    static const struct motion motions[] = {
        {"rig, drive at 8",
         &hertz_rig,
         &taylor,
         {{"xi", 0.01}, {"sigma", 0.04}, {"omega", 8.0}},
         {0.5},
         TWO_PI / 8.0,
         800,
         64,
         16},
        {"repulsive tip",
         &afm_tip,
         &taylor,
         {{"beta", 0.8}, {"sign", -1.0}, {"f", 0.05}, {"omega", 1.3}},
         {0.1},
         TWO_PI / 1.3,
         100,
         192,
         48},
        {"attractive tip",
         &afm_tip,
         &taylor,
         {{"beta", 0.4}, {"sign", 1.0}, {"f", 0.05}, {"omega", 0.7}},
         {0.1},
         TWO_PI / 0.7,
         100,
         256,
         48},
        {"shaft between its gaps",
         &shaft_bearing,
         &exact,
         {{"p2", 2.0}, {"freq_hz", 25.0}},
         {0.1 * 2.54e-4},
         1.0 / 25.0,
         100,
         8192,
         256},
    };
    for (size_t i = 0; i < sizeof motions / sizeof *motions; i++) {
        check_below(check_name("%s: worst error over its column's maximum, %d periods", motions[i].name,
                               motions[i].periods),
                    worst_error(&motions[i]), 1e-5);
    }
}

/* ---- order and floor ---- */

static const struct motion free_rig = {"free rig", &hertz_rig, &taylor, {{"xi", 0.01}}, {0.5}, 2.1,
                                       30,         0,          11};

/* Worst error over 63 time units of free motion, ten
 * periods of it, at 30 instants with n steps between them. */
static double free_error(int n)
{
    struct motion c = free_rig;
    c.ticks = n;
    return worst_error(&c);
}

TEST(rk4_float32_order)
{
    static const int steps[] = {11, 13, 16, 19, 23, 28};
    double x[6], y[6], floor = 0.0;
    for (int i = 0; i < 6; i++) {
        x[i] = log(1.0 / steps[i]);
        y[i] = log(free_error(steps[i]));
    }
    check_near("order above the floor", slope(x, y, 6), 4.0, 0.2);
    for (int n = 100; n < 10000; n = n * 7 / 3)
        floor = fmax(floor, free_error(n));
    check_below("floor: error over the column's maximum, 3e3 to 2e5 steps", floor, 5e-7);
}

/* ---- long runs ---- */

/* A million steps and more: the error at the end is that at
 * the beginning, and the drive's phase is the integer's. */
TEST(rk4_float32_long)
{
    static const struct motion steady = {
        "steady rig", &hertz_rig,   &taylor, {{"xi", 0.01}, {"sigma", 0.04}, {"omega", 0.9}},
        {0.0},        TWO_PI / 0.9, 8192,    128,
        128};
    static struct plant pl, fine;
    double early = 0.0, late = 0.0, largest[2] = {0.0, 0.0};
    motion_start(&pl, &steady, &rk4_float32, steady.period / steady.ticks);
    motion_start(&fine, &steady, &taylor, steady.period / steady.ticks);
    for (int k = 0; k < steady.periods; k++) {
        run(&pl, (uint64_t)steady.ticks);
        run(&fine, (uint64_t)steady.ticks);
        for (int i = 0; i < 2; i++) {
            double error = fabs(pl.x[i] - fine.x[i]);
            largest[i] = fmax(largest[i], fabs(fine.x[i] - (i == 0 ? 1.0 : 0.0)));
            if (k < 300)
                early = fmax(early, error);
            if (k >= steady.periods - 300)
                late = fmax(late, error);
        }
    }
    run(&pl, 37);
    check_hex("phase of the drive after 1,048,613 ticks", pl.drive[RIG_FORCE].carrier,
              exact_phase(0.9 / TWO_PI * pl.tick_s, 8192 * 128 + 37));
    check_below("error over the last 300 periods, of the deviation's maximum",
                late / fmin(largest[0], largest[1]), 2e-6);
    check_below("late over early error", late / early, 1.0);
}

/* Energy made or lost by a free mass without damping in 1e6 steps, of the energy of its motion. */
static double energy_change(double h)
{
    static const struct motion undamped = {
        "undamped rig", &hertz_rig, &taylor, {{"xi", 0.0}}, {0.5}, 0.0, 0, 0, 0};
    static struct plant pl;
    double worst = 0.0;
    motion_start(&pl, &undamped, &rk4_float32, h);
    double begin = plant_energy(&pl);
    double rest = hertz_rig.energy(pl.p, pl.segment.at[2], (double[]){1.0, 0.0}) * pl.scale.energy_J;
    for (int i = 0; i < 1000; i++) {
        run(&pl, 1000);
        worst = fmax(worst, fabs(plant_energy(&pl) - begin) / (begin - rest));
    }
    return worst;
}

/* Without damping nothing forgets. At these steps rk4 itself loses 1e-8 at most; a factor of the method that
 * is off by a float's rounding would be a damper that takes 1e-5. */
TEST(rk4_float32_energy)
{
    static const double h[] = {0.0078125, 0.01, 0.0107, 0.0113, 0.0123};
    for (int i = 0; i < 5; i++)
        check_below("energy made or lost in 1e6 steps, of the energy of the motion", energy_change(h[i]),
                    2e-6);
}

/* Phase lost against rk4 at the same step, rad per period over 1000 free undamped ones. */
static double phase_lost(const struct motion *c)
{
    static struct plant pl[2];
    static const struct method *const method[2] = {&rk4, &rk4_float32};
    double phase[2], rest[MODEL_STATES];
    for (int i = 0; i < 2; i++) {
        motion_start(&pl[i], c, method[i], 0.01);
        double omega = c->model->eigenfrequency(pl[i].p);
        c->model->rest(pl[i].p, rest);
        run(&pl[i], (uint64_t)(1000.0 * TWO_PI / omega / 0.01));
        phase[i] = atan2(pl[i].x[1] / omega, pl[i].x[0] - rest[0]);
    }
    return fabs(remainder(phase[1] - phase[0], TWO_PI)) / 1000.0;
}

/* Coefficients rounded to float would detune the plant: 1.5e-7 rad for the rig, 1e-6 for the attractive tip,
 * whose stiffness is a difference. */
TEST(rk4_float32_detuning)
{
    static const struct motion rig = {"", &hertz_rig, &taylor, {{"xi", 0.0}}, {0.15}, 0.0, 0, 0, 0};
    static const struct motion tip = {
        "", &afm_tip, &taylor, {{"c", 0.0}, {"beta", 0.8}, {"sign", 1.0}, {"f", 0.0}}, {-0.1}, 0.0, 0, 0, 0};
    check_below("phase lost by the undamped rig, rad per period", phase_lost(&rig), 3e-8);
    check_below("phase lost by the undamped tip, rad per period", phase_lost(&tip), 1e-7);
}

/* ---- contact ---- */

/* Along the stored trajectories that do not multiply rounding by more than 100; where contact is lost the
 * step has its share as well: 2.5th order from 1e-5 at 256 steps. */
static void check_case(const struct trajectory *r)
{
    double growth = fmax(r->growth, 1.0);
    if (r->growth > 100.0)
        return;
    struct trajectory_errors worst = trajectory_run(r, &rk4_float32, 0.0, scratch, 1024.0);
    trajectory_check(r, "", &worst, 5e-6 * growth, 2e-5 * growth, 1e-4 * growth);
    if (r->n_events_total > 0)
        check_int("roots that did not converge", worst.residual, 0);
}

TEST(rk4_float32_reference)
{
    trajectory_all(check_case);
}

/* Contact lost in every cycle, 8 cycles: order 2.5 as rk4,
 * with the same errors while they are above the floor. */
TEST(rk4_float32_contact_order)
{
    static const struct motion thrown = {
        "thrown", &hertz_rig, &taylor, {{"xi", 0.01}, {"sigma", 0.3}, {"omega", 0.9}}, {0.75}, 55.9, 0, 0, 0};
    static struct plant pl, fine;
    static const struct method *const method[2] = {&rk4, &rk4_float32};
    double x[16], y[2][16], apart = 0.0;
    int n = 0;
    motion_start(&fine, &thrown, &taylor, thrown.period / 400);
    run(&fine, 400);
    for (int steps = 340; n < 16; steps = steps * 14 / 13, n++) {
        double end[2][2];
        for (int i = 0; i < 2; i++) {
            motion_start(&pl, &thrown, method[i], thrown.period / steps);
            run(&pl, (uint64_t)steps);
            memcpy(end[i], pl.x, sizeof end[i]);
            y[i][n] = log(hypot(pl.x[0] - fine.x[0], pl.x[1] - fine.x[1]));
        }
        x[n] = log(1.0 / steps);
        apart = fmax(apart, hypot(end[0][0] - end[1][0], end[0][1] - end[1][1]));
    }
    check_above("contact switches", (double)pl.counts.switches, 10);
    check_int("roots that did not converge", (int64_t)pl.counts.residual, 0);
    check_near("order over 16 steps", slope(x, y[1], 16), 2.5, 0.5);
    check_near("order, beside that of rk4", slope(x, y[1], 16), slope(x, y[0], 16), 0.1);
    check_below("from rk4 at the same step", apart, 5e-6);
}

/* The ledger audits it as it audits rk4: the residual is
 * that of the same step in double, and float rounding. */
TEST(rk4_float32_ledger)
{
    static const struct motion thrown = {
        "thrown", &hertz_rig, &taylor, {{"xi", 0.01}, {"sigma", 0.3}, {"omega", 0.9}}, {0.75}, 0.01, 0, 0, 0};
    static struct plant pl;
    double share[2];
    static const struct method *const method[2] = {&rk4, &rk4_float32};
    for (int i = 0; i < 2; i++) {
        motion_start(&pl, &thrown, method[i], 0.01);
        run(&pl, 200000);
        share[i] = fabs(plant_residual(&pl)) / (pl.ledger.gross * pl.scale.energy_J);
    }
    check_below("residual over gross energy, rk4", share[0], 1e-6);
    check_below("residual over gross energy, rk4_float32", share[1], 1e-6);
    check_above("contact switches", (double)pl.counts.switches, 300);
}

/* ---- contacts that close together ---- */

static double exact_scratch[METHOD_SCRATCH], nudged_scratch[METHOD_SCRATCH];

/* A preset's plant by this method at the preset's own steps. */
static void start_preset(struct plant *pl, const struct scene *s, const struct method *method, double *memory)
{
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    struct plant_config c = {.model = s->model,
                             .si = si,
                             .method = method,
                             .tick_s = s->frame_s / s->substeps,
                             .dilation = s->dilation,
                             .scratch = memory};
    scenes_resolve(s, si, drive);
    const char *why = plant_init(pl, &c);
    if (why)
        check_string(method->name, why, "");
    else
        plant_scene_begin(pl, s, si, drive);
}

static double distance(const struct plant *a, const struct plant *b)
{
    double most = 0.0;
    for (int i = 0; i < a->model->n_states / 2; i++)
        most = fmax(most, fabs(a->x[i] - b->x[i]));
    return most;
}

/* Both sides of a symmetric shaft close at once, in each period. Every instant must be located, and the
 * motion stay as near to exact's as rk4's at the same steps, and float's rounding, which grows as a nudge of
 * 1e-6 gaps does. Returns switches. */
static uint32_t check_preset(const struct preset *p)
{
    static struct plant pl, in_double, right, nudged;
    double x[MODEL_STATES], error = 0.0, steps = 0.0, growth = 1.0;
    start_preset(&pl, &p->scene, &rk4_float32, scratch);
    start_preset(&in_double, &p->scene, &rk4, NULL);
    start_preset(&right, &p->scene, &exact, exact_scratch);
    start_preset(&nudged, &p->scene, &exact, nudged_scratch);
    memcpy(x, nudged.x, sizeof x);
    for (int i = 0; i < pl.model->n_states / 2; i++)
        x[i] += 1e-6;
    plant_set_state(&nudged, x);
    for (int i = 0; i < 40 && growth < 100.0; i++) {
        run(&pl, 500);
        run(&in_double, 500);
        run(&right, 500);
        run(&nudged, 500);
        growth = fmax(growth, distance(&nudged, &right) / 1e-6);
        error = fmax(error, distance(&pl, &right));
        steps = fmax(steps, distance(&in_double, &right));
    }
    check_below("from exact's motion, beyond what rk4 is at these steps, gaps, of the growth",
                (error - 1.2 * steps) / growth, 1e-5);
    run(&pl, 50000);
    check_int("instants that were not located", (int64_t)pl.counts.residual, 0);
    check_int("ticks with too many pieces", (int64_t)pl.counts.budget, 0);
    return pl.counts.switches;
}

TEST(rk4_float32_symmetric)
{
    uint32_t switches = 0;
    int n = 0;
    for (int i = 0; i < SCENES; i++) {
        const struct preset *p = &scenes_table[i];
        if (p->scene.model != &shaft_bearing)
            continue;
        printf("      %s\n", p->name);
        switches += check_preset(p);
        n++;
    }
    check_int("presets of shaft_bearing", n, 22);
    check_above("contact switches in all", switches, 5000);
}
