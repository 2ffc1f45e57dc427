/* test_balance.c - the energy balance as it is judged: sound motions of any size balance, spoiled ones do
 * not, and what is not seen has a bound. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/app/plant_scene.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/hertz_rig.h"
#include "models/models.h"
#include "models/rolling_contact.h"
#include "models/scenes/scenes_table.h"

enum { FRAMES = 100 /* from one look to the next */ };

/* The default of the setting ledger_alarm. */
static const double alarm = 0.01;

static struct plant plant;
static double balance_scratch[METHOD_SCRATCH];

/* The scene, or with `tol` another tolerance, with drives and
 * start `size` times as far from rest. False: the method refuses. */
static bool start_scaled(const struct scene *s, const struct method *method, double tol, double size)
{
    double si[MODEL_PARAMETERS], rest[MODEL_STATES], x[MODEL_STATES];
    struct harmonic drive[MODEL_INPUTS];
    struct scene small = *s;
    scenes_resolve(s, si, drive);
    for (int i = 0; i < MODEL_INPUTS; i++) {
        drive[i].amplitude *= size;
        small.drive[i].noise *= size;
    }
    const struct plant_config c = {.model = s->model,
                                   .si = si,
                                   .method = method,
                                   .tick_s = s->frame_s / s->substeps,
                                   .dilation = s->dilation,
                                   .tol = tol > 0.0 ? tol : s->tolerance,
                                   .scratch = balance_scratch};
    if (plant_init(&plant, &c))
        return false;
    plant_scene_begin(&plant, &small, si, drive);
    s->model->rest(plant.p, rest);
    for (int i = 0; i < s->model->n_states; i++)
        x[i] = rest[i] + size * (plant.x[i] - rest[i]);
    plant_set_state(&plant, x);
    return true;
}

/* So many looks, drives off from the middle on: the worst. A motion that escapes is judged until then. */
static double worst_of(const struct scene *s, int looks)
{
    double worst = 0.0, residual_J = 0.0;
    for (int i = 0; i < looks; i++) {
        if (i == looks / 2)
            plant_drives_to_zero(&plant, 0.0);
        if (!plant_run(&plant, (uint64_t)(FRAMES * s->substeps)))
            return worst;
        worst = fmax(worst, plant_imbalance(&plant, &residual_J));
    }
    return worst;
}

/* Presets and bare models by every method that takes them, sounding, and dying away afterwards. Every other
 * size by turns: each method has each size in half of the scenes. */
TEST(balance_quiet)
{
    static const double size[] = {1.0, 1e-2, 1e-4, 1e-6, 1e-9};
    for (int i = 0; i < SCENES; i++) {
        double worst = 0.0;
        int runs = 0;
        for (int m = 0; m < METHODS; m++)
            for (int k = (i + m) % 2;
                 k < 5 && start_scaled(&scenes_table[i].scene, method_table[m], 0.0, size[k]); k += 2, runs++)
                worst = fmax(worst, worst_of(&scenes_table[i].scene, 10));
        /* modal alone, and auto that takes it, for a lever */
        check_above("methods and sizes", runs, scenes_table[i].scene.model->modal_form ? 4 : 6);
        check_below(scenes_table[i].name, worst, alarm);
    }
}

/* A decayed motion keeps what the tolerance is relative to, its largest past: a coarse one raises nothing. */
TEST(balance_decayed)
{
    static const double tol[] = {1e-3, 1e-6};
    for (int i = 0; i < SCENES; i += 3)
        for (int k = 0; k < 2; k++)
            if (start_scaled(&scenes_table[i].scene, &auto_method, tol[k], 1.0))
                check_below(scenes_table[i].name, worst_of(&scenes_table[i].scene, 20), alarm);
}

/* ---- spoiled ---- */

/* rk4, and afterwards all velocities times this. */
static double spoil_factor;
static enum step_status spoiled(const struct model *m, const double *p, double *w, const struct segment *e,
                                unsigned regime, double *x, struct crossing *c)
{
    enum step_status s = rk4.bind(m)(m, p, w, e, regime, x, c);
    for (int i = m->n_states / 2; i < m->n_states; i++)
        x[i] *= spoil_factor;
    return s;
}

enum { LOOK_TICKS = FRAMES * 64 };

/* The model's default swings freely from `size` units off its rest, 126 ticks a period; the method takes or
 * makes `share` of its energy from one look to the next. */
static void swing(const struct model *m, double size, double share)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], x[MODEL_STATES];
    struct scale scale;
    for (int i = 0; i < m->n_parameters; i++)
        si[i] = m->parameter[i].initial;
    m->prepare(si, p, &scale);
    const struct plant_config c = {.model = m,
                                   .method = &rk4,
                                   .tick_s = 0.05 / m->eigenfrequency(p) * scale.time_s,
                                   .dilation = 1.0,
                                   .scratch = balance_scratch};
    check_no_error(m->name, plant_init(&plant, &c));
    m->rest(p, x);
    x[0] += size;
    plant_set_state(&plant, x);
    plant.step = spoiled;
    plant.bind_run = NULL;
    spoil_factor =
        1.0 + share / LOOK_TICKS; /* twice that share of the kinetic energy, which is half of all */
}

static double look(double *residual_J)
{
    if (!plant_run(&plant, LOOK_TICKS))
        check_true("a finite motion", 0);
    return plant_imbalance(&plant, residual_J);
}

/* A brake that takes half the energy. Contacts that rest at 1 hide motions below 1e-6 of that behind the
 * rounding of the stored energy; shafts, which rest at 0, hide none. */
TEST(balance_spoiled)
{
    static const double size[] = {100.0, 1.0, 1e-2, 1e-4, 1e-6, 1e-9, 1e-30};
    for (int i = 0; i < MODELS; i++) {
        const struct model *m = model_table[i];
        bool at_zero = m->n_inputs == 3;
        /* Cubics, and contacts that attract, let go of larger motions. */
        double largest = at_zero || m == &hertz_rig || m == &rolling_contact ? 100.0 : 0.1;
        for (int k = 0; k < (at_zero ? 7 : 5); k++) {
            double residual_J = 0.0;
            if (size[k] > largest)
                continue;
            swing(m, size[k], 0.0);
            check_below(m->name, look(&residual_J), 0.1 * alarm);
            swing(m, size[k], -0.5);
            residual_J = 0.0;
            printf("      %s, %g units from rest\n", m->name, size[k]);
            check_above("spoiled", look(&residual_J), alarm);
        }
    }
}

/* A method that makes energy is noticed before the motion has grown to 1e-6, however small it began. */
TEST(balance_growing)
{
    for (int i = 0; i < MODELS; i++) {
        const struct model *m = model_table[i];
        double residual_J = 0.0, rest[MODEL_STATES], most = 0.0;
        swing(m, 1e-9, 3.0);
        m->rest(plant.p, rest);
        for (int k = 0; k < 40 && look(&residual_J) <= alarm; k++)
            most = fmax(most, fabs(plant.x[0] - rest[0]));
        check_below(m->name, most, 1e-6);
    }
}

/* ---- after a long run ---- */

/* 1e9 units have flowed in and were lost. */
static void run_for_years(void)
{
    sum_add(&plant.ledger.damping, 1e9);
    sum_add(&plant.ledger.work[0], 1e9 - 123456789.125);
    sum_add(&plant.ledger.work[1], 123456789.125);
}

TEST(balance_long_run)
{
    double si[MODEL_PARAMETERS], residual_J = 0.0, after_J = 0.0;
    swing(model_table[0], 1e-6, 0.0);
    run_for_years();
    check_near("residual over the unit of energy", plant_residual(&plant) / plant.scale.energy_J, 0.0, 1e-15);
    check_below("sound", look(&residual_J), 0.1 * alarm);
    double most_J = plant.ledger.most * plant.scale.energy_J;
    memcpy(si, plant.si, sizeof si);
    for (int i = 0; i < plant.model->n_parameters; i++)
        si[i] *= 1.0 + 0.1 * i; /* the unit of energy too */
    check_no_error("other parameters", plant_change(&plant, si));
    check_near("the energy of the largest motion so far, over that before",
               plant.ledger.most * plant.scale.energy_J / most_J, 1.0, 1e-15);
    after_J = plant_residual(&plant);
    check_near("what they change of the residual", (after_J - residual_J) / plant.scale.energy_J, 0.0, 1e-15);
    swing(model_table[0], 1e-6, -0.1);
    run_for_years();
    residual_J = 0.0;
    check_above("spoiled", look(&residual_J), alarm);
}
