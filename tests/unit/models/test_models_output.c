/* test_models_output.c - outputs in SI against Newton's law and the SI parameters themselves. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "models/reduced/afm_tip_reduced.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"
#include "firmware/plant/plant.h"
#include "tests/fixture/exact.h"

enum { OUTPUT_TRIALS = 200 };

/* A model at its default parameters in a random state with random inputs, seen from outside in SI. */
struct view {
    double si[MODEL_PARAMETERS];
    double position, velocity, acceleration; /* first state and its rates */
    double input[MODEL_INPUTS], rate[MODEL_INPUTS];
    double out[MODEL_OUTPUTS];
    double flow_force;
    double x[MODEL_STATES]; /* SI */
};

static void look(const struct model *m, double sign, uint64_t *seed, struct view *v)
{
    double p[MODEL_DERIVED], x[MODEL_STATES], x_dot[MODEL_STATES];
    struct input u[MODEL_INPUTS];
    struct flow flow;
    struct scale s;
    memset(v, 0, sizeof *v);
    for (int i = 0; i < m->n_parameters; i++)
        v->si[i] = !strcmp(m->parameter[i].name, "sign") ? sign : m->parameter[i].initial;
    m->prepare(v->si, p, &s);
    for (int i = 0; i < m->n_states; i++) {
        x[i] = 4.0 * exact_uniform(seed) - 1.5;
        v->x[i] = x[i] * scale_of(&s, m->state_signal[i].quantity);
    }
    for (int i = 0; i < m->n_inputs; i++) {
        double unit = scale_of(&s, m->input_signal[i].quantity);
        u[i] = (struct input){exact_uniform(seed) - 0.5, exact_uniform(seed) - 0.5};
        v->input[i] = u[i].value * unit;
        v->rate[i] = u[i].rate * unit / s.time_s;
    }
    m->rhs(p, u, x, x_dot);
    m->flow(p, u, x, &flow);
    m->output(p, u, x, v->out);
    for (int i = 0; i < m->n_outputs; i++)
        v->out[i] *= scale_of(&s, m->output_signal[i].quantity);
    v->position = v->x[0];
    v->velocity = v->x[m->n_states / 2];
    v->acceleration = x_dot[m->n_states / 2] * s.length_m / (s.time_s * s.time_s);
    v->flow_force = flow.force * s.force_N;
}

static void report_output(const struct model *m, const char *what, double worst)
{
    check_below(check_name("%s: %s, relative", m->name, what), worst, 2e-13);
}

/* Off `expected` by this part of `size`. */
static void off(double *worst, double got, double expected, double size)
{
    exact_worst(worst, (long double)((got - expected) / size));
}

/* Displacement and velocity are the state's, in_contact follows the compression. */
static void check_motion(const struct model *m, const struct view *v, double compression, double *worst)
{
    double size = fabs(v->position) + fabs(compression);
    bool contact = m->n_contacts > 0;
    off(worst, v->out[0], v->position, size);
    off(worst, v->out[1], v->velocity, fabs(v->velocity));
    off(worst, v->out[2], contact ? fmax(compression, 0.0) : compression, size);
    if (contact && v->out[4] != (compression > 0.0 ? 1.0 : 0.0))
        check_near("in_contact", v->out[4], compression > 0.0, 0.0);
}

/* m z'' = N + forces - contact - c (z' - ze'). */
TEST(models_output_rig)
{
    const struct model *const all[] = {&hertz_rig, &hertz_rig_linear, &hertz_rig_cubic, &hertz_rig_averaged};
    uint64_t seed = 41;
    for (int k = 0; k < 4; k++) {
        double force = 0.0, motion = 0.0;
        for (int n = 0; n < OUTPUT_TRIALS; n++) {
            struct view v;
            look(all[k], 1.0, &seed, &v);
            double applied = v.si[RIG_PRELOAD] + v.input[RIG_FORCE] + v.input[RIG_FAST_FORCE];
            double damper = v.si[RIG_DAMPING] * (v.velocity - v.rate[RIG_BASE]);
            double inertia = v.si[RIG_MASS] * v.acceleration;
            double contact = applied - damper - inertia, size = applied + fabs(damper) + fabs(inertia);
            off(&force, v.out[3], contact, size);
            off(&force, v.flow_force, contact, size);
            check_motion(all[k], &v, v.position - v.input[RIG_BASE], &motion);
        }
        report_output(all[k], "contact force off Newton's law", force);
        report_output(all[k], "motion and compression", motion);
    }
}

/* m z'' = N + force - contact - c z'. */
TEST(models_output_rolling)
{
    const struct model *const all[] = {&rolling_contact, &rolling_contact_linear};
    uint64_t seed = 42;
    for (int k = 0; k < 2; k++) {
        double force = 0.0, motion = 0.0;
        for (int n = 0; n < OUTPUT_TRIALS; n++) {
            struct view v;
            look(all[k], 1.0, &seed, &v);
            double applied = v.si[RIG_PRELOAD] + v.input[ROLLING_FORCE];
            double damper = v.si[RIG_DAMPING] * v.velocity, inertia = v.si[RIG_MASS] * v.acceleration;
            double contact = applied - damper - inertia, size = applied + fabs(damper) + fabs(inertia);
            off(&force, v.out[3], contact, size);
            off(&force, v.flow_force, contact, size);
            check_motion(all[k], &v, v.position + v.input[ROLLING_WAVINESS], &motion);
        }
        report_output(all[k], "contact force off Newton's law", force);
        report_output(all[k], "motion and compression", motion);
    }
}

/* m z'' = k (Delta - z) - c z' + force + sign (contact - k0 Delta^{3/2}), z the compression. The ledger's
 * force has no sign in the full model. */
TEST(models_output_tip)
{
    const struct model *const all[] = {&afm_tip, &afm_tip_linear, &afm_tip_cubic, &afm_tip_averaged};
    uint64_t seed = 43;
    for (int k = 0; k < 8; k++) {
        const struct model *m = all[k / 2];
        double force = 0.0, motion = 0.0, sign = k % 2 ? 1.0 : -1.0;
        for (int n = 0; n < OUTPUT_TRIALS; n++) {
            struct view v;
            look(m, sign, &seed, &v);
            double rest = v.si[TIP_CONTACT_STIFFNESS] * pow(v.si[TIP_INDENTATION], 1.5);
            double lever = v.si[TIP_LEVER_STIFFNESS] * (v.si[TIP_INDENTATION] - v.position);
            double damper = v.si[TIP_DAMPING] * v.velocity, inertia = v.si[TIP_MASS] * v.acceleration;
            double contact = rest + sign * (inertia - lever + damper - v.input[TIP_FORCE]);
            double size = rest + fabs(lever) + fabs(inertia);
            off(&force, v.out[3], contact, size);
            off(&force, v.flow_force, contact, size);
            check_motion(m, &v, v.position, &motion);
        }
        report_output(m, "contact force off Newton's law", force);
        report_output(m, "motion and compression", motion);
    }
}

/* Gap springs by their own formula; the mode's outputs are in test_models_shaft.c. */
TEST(models_output_shaft)
{
    const struct model *const all[] = {&shaft_bearing, &shaft_bearing_linear};
    uint64_t seed = 44;
    for (int k = 0; k < 2; k++) {
        double force = 0.0, motion = 0.0;
        for (int n = 0; n < OUTPUT_TRIALS; n++) {
            struct view v;
            double over[2], f[2];
            look(all[k], 1.0, &seed, &v);
            for (int i = 0; i < 2; i++) {
                double x = v.x[2 * i], gap = v.si[SHAFT_G1 + i];
                over[i] = x > gap ? x - gap : (x < -gap ? x + gap : 0.0);
                f[i] = k == 0 ? v.si[SHAFT_KG1 + i] * over[i] : 0.0;
                off(&force, v.out[8 + i], f[i], 3e-4 * v.si[SHAFT_KG1]);
                off(&motion, v.out[4 + 2 * i], x, fabs(x));
                off(&motion, v.out[5 + 2 * i], v.x[3 + 2 * i], fabs(v.x[3 + 2 * i]));
            }
            off(&motion, v.out[0], v.x[1], fabs(v.x[1]));
            off(&motion, v.out[1], v.x[4], fabs(v.x[4]));
            off(&motion, v.out[2], fmax(fabs(over[0]), fabs(over[1])), 3e-4);
            off(&force, v.out[3], fmax(fabs(f[0]), fabs(f[1])), 3e-4 * v.si[SHAFT_KG1]);
            off(&force, v.flow_force, v.out[3], 3e-4 * v.si[SHAFT_KG1]);
        }
        report_output(all[k], "gap forces", force);
        report_output(all[k], "motion and compression", motion);
    }
}

/* The share of time without contact: none for a model that has no contact to lose. */
TEST(models_contact_loss)
{
    const struct model *const pair[2] = {&hertz_rig, &hertz_rig_linear};
    for (int k = 0; k < 2; k++) {
        struct plant pl;
        struct plant_config c = {.model = pair[k], .method = &rk4, .tick_s = 1e-5, .dilation = 1.0};
        const char *why = plant_init(&pl, &c);
        if (why)
            check_string("plant_init", why, "no refusal");
        plant_set_state(&pl, (double[]){-2.0, 0.0});
        check_true("finite", plant_run(&pl, 100));
        check_near("share of time without contact", pl.loss_time / pl.total_time, k == 0, 1e-12);
    }
}
