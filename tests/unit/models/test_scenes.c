/* test_scenes.c - the presets: complete, sound, runnable, and true to the figures they are named after. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/app/plant_scene.h"
#include "firmware/plant/plant_change.h"
#include "host_sim/scene/scene_check.h"
#include "models/afm_tip.h"
#include "models/math/elementary.h"
#include "models/hertz_rig.h"
#include "models/models.h"
#include "models/reduced/shaft_mode.h"
#include "models/scenes/scenes_range.h"
#include "models/scenes/scenes_table.h"
#include "models/shaft_views.h"

static struct plant plant;
static double scratch[METHOD_SCRATCH];

/* The plant of a scene with so many times its substeps; the step guard's word, or NULL. */
static const char *start_scene(const struct scene *s, double finer)
{
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    const struct method *method = method_find(s->method);
    if (!method || method->n_scratch(s->model) > METHOD_SCRATCH)
        return "no such method, or too much scratch memory";
    scenes_resolve(s, si, drive);
    const struct plant_config c = {.model = s->model,
                                   .si = si,
                                   .method = method,
                                   .tick_s = s->frame_s / (s->substeps * finer),
                                   .dilation = s->dilation,
                                   .tol = s->tolerance,
                                   .scratch = scratch};
    const char *reason = plant_init(&plant, &c);
    if (!reason)
        plant_scene_begin(&plant, s, si, drive);
    return reason;
}

TEST(scenes_presets)
{
    for (int i = 0; i < SCENES; i++) {
        const struct preset *p = &scenes_table[i];
        char why[SCENE_CHECK_REASON];
        bool clash = scenes_find(p->name) != p;
        for (int k = 0; k < MODELS; k++)
            clash |= !strcmp(p->name, model_table[k]->name);
        check_true(check_name("%s: named once, titled, nothing in it contradicts", p->name),
                   !clash && *p->title && !scene_check(&p->scene, why));
        const char *reason = start_scene(&p->scene, 1.0);
        bool escapes = strstr(p->title, ": escapes") != NULL;
        int frames = escapes ? 10 : 20;
        check_true(check_name("%s: %s", p->name, reason ? reason : "frames without a fault"),
                   !reason && plant_run(&plant, (uint64_t)(frames * p->scene.substeps)) &&
                       !plant.counts.not_finite && !plant.counts.budget && !plant.counts.work &&
                       !plant.counts.residual);
        if (escapes)
            check_true("and it escapes within the time asked",
                       !plant_run(&plant, (uint64_t)(p->scene.over / p->scene.frame_s * p->scene.substeps)));
    }
}

/* A bare model's scene is its defaults. */
TEST(scenes_default)
{
    struct scene s;
    char why[SCENE_CHECK_REASON];
    for (int i = 0; i < MODELS; i++) {
        scenes_default(&s, model_table[i]);
        check_true(model_table[i]->name, !scene_check(&s, why));
        check_no_error(model_table[i]->name, start_scene(&s, 1.0));
        check_true(model_table[i]->name, plant_run(&plant, 640));
        check_string("  observable", model_table[i]->output_signal[s.observable].name, "penetration");
    }
}

/* The start includes the drives at time 0: a waviness contains the state of the paper. */
TEST(scenes_begin)
{
    static const double f0[] = {1.842016, 0.0};
    const struct preset *p = scenes_find("nayak-fig3");
    check_true("free flight starts", p && !start_scene(&p->scene, 1.0));
    check_near("eta at the limit of contact loss, (5/2)^(2/3)", plant.x[0], f0[0], 0.0);
    p = scenes_find("rig");
    check_true("the rig starts", p && !start_scene(&p->scene, 1.0));
    check_near("at rest", plant.x[0], 1.0, 0.0);
    check_near("its drive sounds, N", plant.segment.at[2][RIG_FORCE].value * plant.scale.force_N, 20.0,
               1e-12);
    p = scenes_find("tip");
    check_true("the tip starts", p && !start_scene(&p->scene, 1.0));
    /* one tick is 1/64000 s on the bus, 1000 times less for the tip: 150 kHz turn by 0.00234375 */
    check_near("turns of its drive per tick", 2.0 * turns_to_double(plant.drive[TIP_FORCE].step >> 1),
               150e3 / 64e6, 1e-15);
}

/* Steady extremes of the paper's q (time 0 to 1000 left
 * out), computed elsewhere from the papers' equations. */
static const struct {
    const char *name;
    double max, min;
} figure[] = {
    {"kb-fig16", 0.2598236929481845, -0.31355659326227336},
    {"kb-fig16-cubic", 0.26020065440971063, -0.31392275753207666},
    {"kb-fig16-slow", 0.25210398445330123, -0.2952520740750315},
    {"bbp-fig2-force", 1.540307641049638, -1.7673781333334664},
    {"bbp-fig2-force-cubic", 1.6964828781658043, -1.9382302251729855},
    {"bbp-fig2-force-slow", 0.7472733457938466, -0.9953632081606644},
    {"bbp-fig8-stiff", 0.42061384062541163, -0.7049021779653329},
    {"bbp-fig8-stiff-cubic", 0.4228185997697947, -0.7068744419512883},
    {"bbp-fig8-stiff-slow", 0.25965861063103785, -0.6105305725609534},
};

static void extremes(const struct scene *s, double from, double to, double *max, double *min)
{
    double q[MODEL_STATES];
    *max = -1e300, *min = 1e300;
    bool good = plant_run(&plant, (uint64_t)(from / plant.tick_s * s->dilation));
    for (double t = from; t < to && good; t += plant.tick_s / s->dilation) {
        good = plant_run(&plant, 1);
        s->model->paper_state(plant.p, plant.segment.at[2], plant.x, q);
        *max = fmax(*max, q[0]);
        *min = fmin(*min, q[0]);
    }
    if (!good)
        *max = *min = (double)NAN;
}

TEST(scenes_figures)
{
    for (size_t i = 0; i < sizeof figure / sizeof figure[0]; i++) {
        const struct preset *p = scenes_find(figure[i].name);
        double max = 0.0, min = 0.0;
        check_true(figure[i].name, p && !start_scene(&p->scene, 2.0));
        extremes(&p->scene, 1000.0, 1650.0, &max, &min);
        check_near("  largest q", max, figure[i].max, 1e-3);
        check_near("  smallest q", min, figure[i].min, 1e-3);
    }
    const struct preset *p = scenes_find("shaft-fig12");
    double max, min;
    check_true("shaft-fig12", p && !start_scene(&p->scene, 1.0));
    extremes(&p->scene, 5.0, 5.2, &max, &min);
    /* between the branch's points 28.89753586 Hz, 11.48743983 mm and 28.90043122 Hz, 11.48887537 mm */
    check_near("  peak of x1, m", max, 0.01148866, 1e-7);
}

/* ---- warnings ---- */

static const struct {
    const char *name, *text;
} warned[] = {
    {"rig", NULL},
    {"tip", "below 1 pm (theirs is 0.26 pm)"},
    {"shaft", NULL},
    {"bbp-fig2-force", "the fast force moves the mass"},
    {"bbp-fig5-base", "a fast base motion above 3/2"},
    {"bbp-fig5-base-slow", "a fast base motion above 3/2"},
    {"bbp-fig8-stiff", "a stiffness amplitude above 1"},
    {"kb-fig16", NULL},
    {"kb-fig16-slow", NULL},
    {"kb-fig7", "below 3 times the slow frequency"},
    {"kb-fig7-slow", "below 3 times the slow frequency"},
    {"nayak-fig6", "one-term harmonic balance; for waviness 0.9 it is at 0.696"},
    {"nayak-random", NULL},
    {"shaft-fig9", "chaotic"},
    {"shaft-fig12", NULL},
    {"shaft-fig19", NULL},
};

static const char *warning(const struct scene *s, int i)
{
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    scenes_resolve(s, si, drive);
    return scenes_warning(s->model, si, drive, i);
}

/* A preset changed by one of the paper's parameters. */
static const char *with(const char *name, int parameter, double value)
{
    struct scene s = scenes_find(name)->scene;
    s.value[parameter] = value;
    const char *text = warning(&s, 0);
    return text ? text : "";
}

/* A reduced shaft under a force in the middle. */
static const char *with_drive(const char *which, double Hz, double force_N)
{
    struct scene s;
    scenes_default(&s, !strcmp(which, "mode")     ? &shaft_bearing_mode
                       : !strcmp(which, "linear") ? &shaft_bearing_linear
                                                  : &shaft_bearing);
    if (s.model == &shaft_bearing_mode) /* hard ones are another warning */
        s.value[SHAFT_KG1] = s.value[SHAFT_KG3] = 2.626e4;
    s.drive[1] = (struct scene_drive){.amplitude = force_N, .frequency_Hz = Hz};
    const char *text = warning(&s, 0);
    return text ? text : "";
}

TEST(scenes_warnings)
{
    for (size_t i = 0; i < sizeof warned / sizeof warned[0]; i++) {
        const struct preset *p = scenes_find(warned[i].name);
        const char *text = p ? warning(&p->scene, 0) : "no such preset";
        check_true(warned[i].name, warned[i].text ? text && strstr(text, warned[i].text) : !text);
        check_true("  no second one", !p || !warning(&p->scene, 1));
    }
    check_string("Omega 2 is sound", with("kb-fig7", TIP_PAPER_FAST_OMEGA, 2.0), "");
    check_string("repulsion has no such tongue", with("kb-fig7", TIP_PAPER_SIGN, -1.0), "");
    check_contains("r above 1", with("kb-fig16", TIP_PAPER_R, 1.1), "r above 1");
    check_string("base amplitude 1.4 stays in contact", with("bbp-fig5-base", RIG_PAPER_BASE, 1.4), "");
    check_contains("averaged, not fast", with("bbp-fig2-force-slow", RIG_PAPER_FAST_OMEGA, 2.0),
                   "averaging needs");
    check_contains("zeta above 0.105", with("nayak-fig12", 0, 0.12), "no jumps");
    check_contains("low frequency", with("nayak-fig12", 2, 0.2), "conclusion (vi)");
    check_string("r 0.2", with("kb-fig16-slow", TIP_PAPER_R, 0.2), "");
    check_string("r 0.59", with("kb-fig16-slow", TIP_PAPER_R, 0.59), "");
    check_contains("r 0.665", with("kb-fig16-slow", TIP_PAPER_R, 0.665), "0.665 and 0.770");
    check_string("r 0.665 of the tip itself", with("kb-fig16", TIP_PAPER_R, 0.665), "");
    check_string("r 0.81", with("kb-fig16-slow", TIP_PAPER_R, 0.81), "");
    check_string("beta 0.99 at this indentation", with("tip", TIP_CONTACT_STIFFNESS, 1.57e7 * 0.99 / 29.73),
                 "");
    check_true("beta 1.01", *with("tip", TIP_CONTACT_STIFFNESS, 1.57e7 * 1.01 / 29.73));
    check_string("an indentation of 1 nm", with("tip", TIP_INDENTATION, 1e-9), "");
    check_contains("hard, 1180 Hz", with_drive("shaft", 1180.0, 1.0), "1187.8 Hz");
    check_string("hard, 1140 Hz", with_drive("shaft", 1140.0, 1.0), "");
    check_string("41 Hz of a linear shaft", with("shaft-fig12", 17, 50.0), "");
    check_contains("one mode, 18 Hz, beyond the gap", with_drive("mode", 18.0, 25.0), "near 18, 8 and 6 Hz");
    check_true("one mode, 20 Hz", !strstr(with_drive("mode", 20.0, 25.0), "near 18, 8 and 6 Hz"));
    check_string("one mode, 18 Hz, within the gap", with_drive("mode", 18.0, 5.0), "");
    check_contains("linear, impacts at 20 Hz", with_drive("linear", 20.0, 25.0), "below 36.27 Hz");
    check_string("and not at 37 Hz", with_drive("linear", 37.0, 25.0), "");
    check_contains("soft, 41 Hz", with("shaft-fig12", 17, 41.0), "41.3 Hz");
}
