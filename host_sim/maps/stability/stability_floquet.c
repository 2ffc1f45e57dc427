/* stability_floquet.c - multipliers of a modulated contact at rest: its linear part as a model, run by a
 * method. */
#include "host_sim/maps/stability/stability_floquet.h"

#include <math.h>
#include "firmware/plant/plant.h"
#include "firmware/plant/plant_change.h"
#include "host_sim/maps/maps.h"
#include "models/math/elementary.h"
#include "models/reduced/polynomial.h"

#define TURN_RAD (2.0 * ELEMENTARY_PI)

enum { PERIODS_MAX = 256, STEPS_EXACT = 40 };
static const double step_change = 1e-3, tol_exact = 1e-13;

/* ---- the linear part as a plant ---- */

enum { DAMPING, STIFFNESS, PARAMETERS };

static const struct signal states[2] = {{"x", "m", "position", QUANTITY_LENGTH, "x"},
                                        {"v", "m/s", "velocity", QUANTITY_VELOCITY, "v"}};
static const struct signal inputs[1] = {{"modulation", "1", "of the stiffness", QUANTITY_RATIO, NULL}};
static const struct parameter parameters[PARAMETERS] = {{"damping", "1", 0.0, 1e6, 0.02, "damping"},
                                                        {"stiffness", "1", 1e-9, 1e9, 1.0, "stiffness"}};

static const char *check(const double *si)
{
    (void)si;
    return NULL;
}

static void prepare(const double *si, double *p, struct scale *scale)
{
    polynomial_begin(p, si[DAMPING], 0.0, 0.0);
    p[POLYNOMIAL_C + 1] = -si[STIFFNESS];
    p[POLYNOMIAL_M + 1] = -1.0;
    p[POLYNOMIAL_EIGENFREQUENCY] = sqrt(si[STIFFNESS]);
    *scale = (struct scale){1.0, 1.0, 1.0, 1.0};
}

/* The equations of the reduced models, modulated as no linear one is: the one input is no force. */
static const struct polynomial_shape shape = {3, 0, 1, false};

static void rhs(const double *p, const struct input *u, const double *x, double *x_dot)
{
    polynomial_rhs(shape, p, u, x, x_dot);
}

static void flow(const double *p, const struct input *u, const double *x, struct flow *f)
{
    polynomial_flow(shape, p, u, x, f);
}

/* A function of its own, because polynomial_view itself tells the shape of a reduced model. */
static void view(const double *p, struct polynomial_form *f)
{
    polynomial_view(p, f);
}

static const struct model oscillator = {
    .name = "linear part",
    .n_states = 2,
    .n_inputs = 1,
    .n_outputs = POLYNOMIAL_OUTPUTS,
    .n_parameters = PARAMETERS,
    .state_signal = states,
    .input_signal = inputs,
    .output_signal = polynomial_outputs,
    .parameter = parameters,
    .rhs = rhs,
    .flow = flow,
    .polynomial_form = view,
    .gap = model_no_gap,
    .check = check,
    .prepare = prepare,
    .eigenfrequency = polynomial_eigenfrequency,
    .rest = polynomial_rest,
    .energy = polynomial_energy,
    .output = polynomial_output_1,
};

const char *stability_refuse(const struct method *method, double tol)
{
    double si[PARAMETERS] = {0.02, 1.0}, p[MODEL_DERIVED];
    struct scale scale;
    prepare(si, p, &scale);
    return method->refuse(&oscillator, p, 1e-2, tol);
}

/* ---- the linear part of a scene ---- */

/* The stiffness, and the change that a unit of each input and of its rate makes of it. */
struct part {
    double stiffness, value[MODEL_INPUTS], rate[MODEL_INPUTS];
};

static void part_of_hertz(const struct model *m, const double *p, double x, double *damping, struct part *l)
{
    struct hertz_form f;
    m->hertz_form(p, &f);
    double contact = 1.5 * f.hertz * sqrt(fmax(0.0, f.side * x + f.origin));
    *damping = f.damping;
    l->stiffness = f.stiffness + contact;
    for (int i = 0; i < m->n_inputs; i++)
        l->value[i] = contact * f.modulation[i];
}

static void part_of_polynomial(const struct model *m, const double *p, double x, double *damping,
                               struct part *l)
{
    struct polynomial_form f;
    double power = 1.0;
    m->polynomial_form(p, &f);
    *damping = f.damping;
    for (int k = 1; k < 4; k++, power *= x) {
        l->stiffness -= k * f.constant[k] * power;
        for (int i = 0; i < m->n_inputs; i++) {
            l->value[i] -= k * f.modulation[k][i] * power;
            l->rate[i] -= k * f.rate[k][i] * power;
        }
    }
}

static bool modulates(const struct part *l, int i)
{
    return fabs(l->value[i]) + fabs(l->rate[i]) > 0.0;
}

/* The input that modulates the stiffness: the one that sounds, else the first. -1: there is none. -2:
 * several sound. */
static int choose_input(const struct model *m, const struct part *l, const struct harmonic *drive)
{
    int first = -1, sounding = -1;
    for (int i = m->n_inputs - 1; i >= 0; i--) {
        bool sounds = fabs(drive[i].amplitude) > 0.0;
        if (modulates(l, i))
            first = i;
        if (modulates(l, i) && sounds && sounding >= 0)
            return -2;
        if (modulates(l, i) && sounds)
            sounding = i;
    }
    return sounding >= 0 ? sounding : first;
}

const char *stability_tangent_of(const struct scene *s, struct stability_tangent *t)
{
    const struct model *m = s->model;
    double x[MODEL_STATES];
    struct scene_point q;
    struct part l = {.stiffness = 0.0};
    int which;
    scenes_resolve(s, q.si, q.drive);
    const char *why = plant_check(m, q.si, &which);
    if (why)
        return why;
    if (!m->hertz_form && !m->polynomial_form)
        return "the stiffness of this model is not modulated: take one with a single Hertzian contact";
    point_of_scene(s, &q);
    m->rest(q.p, x);
    (m->hertz_form ? part_of_hertz : part_of_polynomial)(m, q.p, x[0], &t->damping, &l);
    int i = choose_input(m, &l, q.drive);
    if (i == -1)
        return "no input modulates the stiffness of this model at rest; hertz_rig, hertz_rig_cubic, afm_tip "
               "and afm_tip_cubic have one";
    if (i == -2)
        return "two inputs modulate the stiffness; take one of them away";
    if (!(l.stiffness > 0.0))
        return "the contact has no stiffness at rest; give parameters with which it rests closed";
    t->input = i;
    t->stiffness = l.stiffness;
    t->omega = q.drive[i].omega * q.scale.time_s;
    t->time_s = q.scale.time_s;
    t->modulation = fabs(q.drive[i].amplitude) / scale_of(&q.scale, m->input_signal[i].quantity) *
                    hypot(l.value[i], l.rate[i] * t->omega);
    return NULL;
}

/* ---- multipliers ---- */

bool stability_map(const struct stability_tangent *t, const struct method *method, double tol, int periods,
                   int steps, double map[2][2])
{
    static double scratch[METHOD_SCRATCH];
    static struct plant pl;
    const double si[PARAMETERS] = {t->damping, t->stiffness};
    struct plant_config c = {.model = &oscillator,
                             .si = si,
                             .method = method,
                             .tick_s = TURN_RAD / t->omega * periods / steps,
                             .dilation = 1.0,
                             .tol = tol,
                             .force = true,
                             .no_ledger = true,
                             .scratch = scratch};
    for (int j = 0; j < 2; j++) {
        if (plant_init(&pl, &c))
            return false;
        plant_drive_start(&pl, 0, t->modulation, t->omega / TURN_RAD, 0.0);
        plant_set_state(&pl, (const double[2]){1.0 - j, j});
        if (!plant_run(&pl, (uint64_t)steps))
            return false;
        map[0][j] = pl.x[0];
        map[1][j] = pl.x[1];
    }
    return true;
}

double stability_multiplier(const struct stability_tangent *t, const struct method *method, double tol,
                            int periods, int steps)
{
    double m[2][2];
    if (!stability_map(t, method, tol, periods, steps, m))
        return (double)INFINITY;
    double half = 0.5 * (m[0][0] + m[1][1]), det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    double square = half * half - det, largest = square < 0.0 ? sqrt(det) : fabs(half) + sqrt(square);
    return periods == 1 ? largest : pow(largest, 1.0 / periods);
}

double stability_exact(const struct stability_tangent *t)
{
    double fastest = sqrt(t->stiffness + t->modulation);
    return stability_multiplier(t, &taylor, tol_exact, 1,
                                (int)ceil(STEPS_EXACT * fmax(1.0, fastest / t->omega)));
}

void stability_steps(const struct stability_tangent *t, double step, int *periods, int *steps)
{
    double per_period = TURN_RAD / t->omega / step;
    for (*periods = 1; *periods < PERIODS_MAX; ++*periods) {
        double n = round(*periods * per_period);
        if (n >= 1.0 && fabs(n / (*periods * per_period) - 1.0) <= step_change)
            break;
    }
    *steps = (int)fmax(1.0, round(*periods * per_period));
}
