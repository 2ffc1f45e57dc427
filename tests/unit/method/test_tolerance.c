/* test_tolerance.c - a tolerance is relative to the motion: small motions on their closed form, down to 1e-9
 * static compressions, and what auto takes under fast drives. Random scenes:
 * tests/tolerance/tolerance_scenes.c. */
#include "tests/unit/test.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/method/auto.h"
#include "firmware/plant/plant.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/rolling_contact.h"

#define TWO_PI 6.283185307179586477

static double scratch[METHOD_SCRATCH];
static const double damping = 0.03; /* 2 xi */

/* A rig of unit scale, step h. */
static void start_unit(struct plant *pl, const struct model *m, const struct method *method, double h,
                       double tol)
{
    double si[MODEL_PARAMETERS] = {0.0};
    for (int i = 0; i < m->n_parameters; i++)
        si[i] = m->parameter[i].initial;
    hertz_rig_unit_scale(0.5 * damping, si);
    struct plant_config c = {
        .model = m, .si = si, .method = method, .tick_s = h, .dilation = 1.0, .tol = tol, .scratch = scratch};
    const char *why = plant_init(pl, &c);
    check_string("plant_init", why ? why : "taken", "taken");
}

/* On the response a = X cos(omega t) of the linearised contact from
 * its start on: the worst error over X, the speed's over omega X. */
static double error_of(struct plant *pl, double omega, double size, int ticks)
{
    double complex response =
        1.0 - omega * omega + (double complex)I * damping * omega; /* force 2/3 u of it */
    double worst = 0.0, step = pl->h;
    plant_drive_start(pl, 0, 1.5 * size * cabs(response), omega / TWO_PI, carg(response));
    plant_set_state(pl, (const double[]){1.0 + size, 0.0});
    for (int i = 1; i <= ticks; i++) {
        if (!plant_run(pl, 1))
            return (double)NAN;
        double t = i * step, x = size * cos(omega * t), v = -omega * size * sin(omega * t);
        worst = fmax(worst, fabs((pl->x[0] - 1.0) - x) / size);
        worst = fmax(worst, fabs(pl->x[1] - v) / (omega * size));
    }
    return worst;
}

/* Sizes whose square is far below the tolerance: there the contact is linear. */
TEST(tolerance_small)
{
    static const struct model *const models[] = {&hertz_rig, &hertz_rig_linear, &hertz_rig_cubic,
                                                 &hertz_rig_averaged, &rolling_contact};
    static const double sizes[] = {1e-9, 1e-8, 1e-6}, tols[] = {1e-3, 1e-4}, omegas[] = {0.3, 0.65, 3.0};
    struct plant pl;
    for (unsigned m = 0; m < sizeof models / sizeof *models; m++)
        for (int k = 0; k < 36; k++) {
            double size = sizes[k % 3], tol = tols[k / 3 % 2], omega = omegas[k / 6 % 3];
            const struct method *method = k % 2 ? &auto_method : &taylor;
            start_unit(&pl, models[m], method, k < 18 ? 0.098 : 0.024, tol);
            check_below(check_name("%s, %s, size %g at %g: error over tolerance %g", models[m]->name,
                                   method->name, size, omega, tol),
                        error_of(&pl, omega, size, 200) / tol, 1.0);
        }
}

/* A small motion after a large one, put in its place: the tolerance is that of the small one. */
TEST(tolerance_anew)
{
    struct plant pl;
    start_unit(&pl, &hertz_rig, &taylor, 0.098, 1e-4);
    plant_set_state(&pl, (const double[]){3.0, 0.0});
    check_true("a large motion", plant_run(&pl, 300));
    check_below("error over tolerance of the small one", error_of(&pl, 0.65, 1e-7, 200) / 1e-4, 1.0);
}

static void check_taken(const char *text, struct plant *pl, const struct method *expected)
{
    check_true("finite", plant_run(pl, 3));
    check_string(text, auto_now(scratch)->name, expected->name);
}

/* auto on a step that rk4 takes at this tolerance: by what sounds, and anew when that changes. */
TEST(tolerance_drives)
{
    const double h = 0.01, tol = 1e-4;
    struct harmonic none[MODEL_INPUTS] = {{0.0, 0.0, 0.0}}, drive[MODEL_INPUTS] = {{0.0, 0.0, 0.0}};
    struct plant pl;
    start_unit(&pl, &hertz_rig, &auto_method, h, tol);
    check_taken("silence", &pl, &rk4);
    plant_drive(&pl, RIG_FORCE, 0.3, 0.9 / TWO_PI, 0.0, 0.0);
    check_taken("a slow drive", &pl, &rk4);
    plant_drive(&pl, RIG_FAST_FORCE, 5000.0, 1.0 / (4.2 * h), 0.0, 0.0);
    check_taken("and a fast one, four ticks a period", &pl, &taylor);
    plant_drive(&pl, RIG_FAST_FORCE, 1e-6, 1.0 / (4.2 * h), 0.0, 0.0);
    check_taken("that has next to no part in the motion", &pl, &rk4);
    plant_drive(&pl, RIG_FORCE, 0.0, 0.9 / TWO_PI, 0.0, 0.0);
    check_taken("it alone", &pl, &taylor);
    plant_drive(&pl, RIG_FAST_FORCE, 0.0, 0.0, 0.0, 0.0);
    check_taken("silence again", &pl, &rk4);
    plant_drive(&pl, RIG_BASE, 1e-3, 1.0 / (4.2 * h), 0.0, 0.0);
    check_taken("a fast base", &pl, &taylor);
    plant_reset(&pl);
    plant_drive(&pl, RIG_STIFFNESS, 0.1, 1.0 / (4.2 * h), 0.0, 0.0);
    check_taken("a fast stiffness", &pl, &taylor);
    drive[RIG_FAST_FORCE] = (struct harmonic){5000.0, TWO_PI / (4.2 * h), 0.0};
    check_string("beforehand: silence", auto_choice(&hertz_rig, pl.p, h, tol, none, &pl.scale)->name, "rk4");
    check_string("beforehand: a fast drive", auto_choice(&hertz_rig, pl.p, h, tol, drive, &pl.scale)->name,
                 "taylor");
}

/* The next ticks run by this method, and the books close. */
static void check_serves(const char *text, struct plant *pl, const struct method *expected)
{
    check_true("finite", plant_run(pl, 100));
    check_string(text, auto_now(scratch)->name, expected->name);
    check_near("residual over what has flowed", plant_residual(pl) / pl->ledger.gross, 0.0, 1e-3);
}

/* At 1e-3 and short steps adams has forces that stay for a while; what moves the contact or changes from tick
 * to tick is rk4's. Each keeps its own books. */
TEST(tolerance_steady_forces)
{
    const double h = 0.02;
    struct plant pl;
    start_unit(&pl, &hertz_rig, &auto_method, h, 1e-3);
    plant_drive_start(&pl, RIG_FORCE, 2.0, 0.9 / TWO_PI, 0.0);
    check_serves("a force, from the start on", &pl, &adams);
    plant_drive(&pl, RIG_FAST_FORCE, 5000.0, 1.0 / (4.2 * h), 0.0, 0.0);
    check_serves("and a fast one, four ticks a period", &pl, &adams);
    plant_drive(&pl, RIG_FAST_FORCE, 0.0, 0.0, 0.0, 0.0);
    plant_drive(&pl, RIG_BASE, 1e-3, 0.9 / TWO_PI, 0.0, 20.0 * h);
    check_serves("a base", &pl, &rk4);
    plant_drive(&pl, RIG_BASE, 0.0, 0.0, 0.0, 20.0 * h);
    check_serves("silent again", &pl, &adams);
    plant_drive(&pl, RIG_FORCE, 1.0, 0.9 / TWO_PI, 0.0, 200.0 * h);
    check_serves("a ramp", &pl, &rk4);
    check_true("finite", plant_run(&pl, 100));
    check_serves("behind it", &pl, &adams);
    for (int k = 0; k < 50; k++) {
        plant_sample(&pl, RIG_FORCE, 0.1 * (k % 3), 0);
        check_true("finite", plant_run(&pl, 1));
    }
    check_string("a value a tick", auto_now(scratch)->name, "rk4");
    check_true("finite", plant_run(&pl, 100));
    plant_sample(&pl, RIG_FORCE, 0.1, 0);
    check_serves("one in a frame", &pl, &adams);
    check_above("switches", pl.counts.switches, 2);
    double si[MODEL_PARAMETERS];
    memcpy(si, pl.si, sizeof si);
    si[RIG_DAMPING] *= 10.0;
    check_no_error("a strong damper", plant_change(&pl, si));
    check_serves("with it", &pl, &rk4);
}
