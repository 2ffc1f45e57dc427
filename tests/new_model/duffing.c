/* duffing.c - tables and scale of Duffing's oscillator; equation in duffing.h. */
#include "tests/new_model/duffing.h"

#include <math.h>
#include <stddef.h>

static const struct signal states[2] = {
    {"position", "m", "mass position from rest", QUANTITY_LENGTH, "x"},
    {"velocity", "m/s", "mass velocity", QUANTITY_VELOCITY, "x_dot"},
};

static const struct signal inputs[DUFFING_INPUTS] = {
    {"force", "N", "force on the mass", QUANTITY_FORCE, NULL},
};

static const struct signal outputs[4] = {
    {"displacement", "m", "mass position from rest", QUANTITY_LENGTH, NULL},
    {"velocity", "m/s", "mass velocity", QUANTITY_VELOCITY, NULL},
    {"penetration", "m", "compression of the spring", QUANTITY_LENGTH, NULL},
    {"contact_force", "N", "force of the spring", QUANTITY_FORCE, NULL},
};

/* 16 Hz, and twice as stiff at 1 mm. */
static const struct parameter parameters[DUFFING_PARAMETERS] = {
    {"mass_kg", "kg", 1e-9, 1e6, 1.0, "moving mass"},
    {"stiffness_N_per_m", "N/m", 1e-9, 1e12, 1e4, "linear stiffness k"},
    {"cubic_N_per_m3", "N/m^3", 1e-9, 1e18, 1e10, "cubic stiffness k3"},
    {"damping_N_s_per_m", "N s/m", 0.0, 1e6, 0.0, "viscous damping"},
};

static const char *check(const double *si)
{
    (void)si;
    return NULL;
}

static void prepare(const double *si, double *p, struct scale *scale)
{
    double length = sqrt(si[DUFFING_STIFFNESS] / si[DUFFING_CUBIC]);
    p[DUFFING_P_TWO_ZETA] = si[DUFFING_DAMPING] / sqrt(si[DUFFING_MASS] * si[DUFFING_STIFFNESS]);
    scale->length_m = length;
    scale->time_s = sqrt(si[DUFFING_MASS] / si[DUFFING_STIFFNESS]);
    scale->force_N = si[DUFFING_STIFFNESS] * length;
    scale->energy_J = scale->force_N * length;
}

static void rest(const double *p, double *x)
{
    (void)p;
    x[0] = x[1] = 0.0;
}

static double eigenfrequency(const double *p)
{
    (void)p;
    return 1.0;
}

static double energy(const double *p, const struct input *u, const double *x)
{
    double square = x[0] * x[0];
    (void)p, (void)u;
    return 0.5 * x[1] * x[1] + 0.5 * square + 0.25 * square * square;
}

static void output(const double *p, const struct input *u, const double *x, double *out)
{
    (void)p, (void)u;
    out[0] = out[2] = x[0];
    out[1] = x[1];
    out[3] = x[0] * (1.0 + x[0] * x[0]);
}

static void polynomial_form(const double *p, struct polynomial_form *f)
{
    *f = (struct polynomial_form){.damping = p[DUFFING_P_TWO_ZETA], .constant = {0.0, -1.0, 0.0, -1.0}};
    f->modulation[0][DUFFING_FORCE] = 1.0;
}

const struct model duffing = {
    .name = "duffing",
    .title = "mass on a spring that hardens with the cube of its deflection",
    .n_states = 2,
    .n_inputs = DUFFING_INPUTS,
    .n_outputs = 4,
    .n_contacts = 0,
    .n_parameters = DUFFING_PARAMETERS,
    .state_signal = states,
    .input_signal = inputs,
    .output_signal = outputs,
    .parameter = parameters,
    .check = check,
    .prepare = prepare,
    .rest = rest,
    .eigenfrequency = eigenfrequency,
    .rhs = duffing_rhs,
    .gap = model_no_gap,
    .flow = duffing_flow,
    .energy = energy,
    .output = output,
    .polynomial_form = polynomial_form,
};
