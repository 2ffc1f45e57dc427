/* rolling_contact.c - tables of the rolling contact and its linear model; equations in rolling_contact.h. */
#include "models/rolling_contact.h"

#include <stddef.h>
#include "models/flows.h"
#include "models/reduced/polynomial.h"

static const struct signal states[] = {
    {"position", "m", "mass position from first touch, positive into the contact", QUANTITY_LENGTH, "q"},
    {"velocity", "m/s", "mass velocity", QUANTITY_VELOCITY, "q_dot"},
};

static const struct signal inputs[ROLLING_INPUTS] = {
    {"force", "N", "force on the mass, positive into the contact; also broadband", QUANTITY_FORCE, NULL},
    {"waviness", "m", "height of the surface under the contact, positive towards the mass", QUANTITY_LENGTH,
     NULL},
};

static const struct parameter parameters[RIG_PARAMETERS] = {HERTZ_RIG_PARAMETERS("ground")};

static const struct parameter paper[ROLLING_PAPER] = {
    {"zeta", "1", 0.0, 1.0, 0.01, "damping ratio"},
    {"xi0", "1", -1e6, 1e6, 0.0, "waviness amplitude over the static compression"},
    {"Omega", "1", 0.0, 1e3, 1.0, "frequency of the waviness over the contact eigenfrequency"},
    {"phi", "rad", -1e3, 1e3, 0.0, "phase of the waviness"},
};

static void from_paper(const double *q, double *si, struct harmonic *drive)
{
    hertz_rig_unit_scale(q[ROLLING_PAPER_ZETA], si);
    drive[ROLLING_FORCE] = (struct harmonic){0.0, 0.0, 0.0};
    drive[ROLLING_WAVINESS] =
        (struct harmonic){q[ROLLING_PAPER_XI0], q[ROLLING_PAPER_OMEGA], q[ROLLING_PAPER_PHI]};
}

static void paper_state(const double *p, const struct input *u, const double *x, double *q)
{
    (void)p;
    q[0] = x[0] + u[ROLLING_WAVINESS].value;
    q[1] = x[1] + u[ROLLING_WAVINESS].rate;
}

static void state_from_paper(const double *p, const struct input *u, const double *q, double *x)
{
    (void)p;
    x[0] = q[0] - u[ROLLING_WAVINESS].value;
    x[1] = q[1] - u[ROLLING_WAVINESS].rate;
}

static double energy(const double *p, const struct input *u, const double *x)
{
    (void)p;
    return 0.5 * x[1] * x[1] + (2.0 / 3.0) * (hertz_contact_energy(x[0] + u[ROLLING_WAVINESS].value) - x[0]);
}

static void output(const double *p, const struct input *u, const double *x, double *out)
{
    double eta = x[0] + u[ROLLING_WAVINESS].value;
    (void)p;
    out[0] = x[0];
    out[1] = x[1];
    out[2] = eta > 0.0 ? eta : 0.0;
    out[3] = hertz_contact_force(eta);
    out[4] = eta > 0.0 ? 1.0 : 0.0;
}

static void hertz_form(const double *p, struct hertz_form *f)
{
    *f = (struct hertz_form){
        .side = 1.0, .constant = 2.0 / 3.0, .damping = p[ROLLING_P_TWO_ZETA], .hertz = 2.0 / 3.0};
    f->shift[ROLLING_WAVINESS] = 1.0;
    f->drag[ROLLING_WAVINESS] = p[ROLLING_P_TWO_ZETA]; /* the damper follows y', not eta' */
    f->force[ROLLING_FORCE] = 2.0 / 3.0;
}

static const int side[] = {1};

/* Members that both models share. */
#define ROLLING                                                                                              \
    .n_parameters = RIG_PARAMETERS, .n_paper = ROLLING_PAPER, .state_signal = states,                        \
    .input_signal = inputs, .parameter = parameters, .paper = paper, .check = hertz_rig_check,               \
    .from_paper = from_paper, .paper_state = paper_state, .state_from_paper = state_from_paper

const struct model rolling_contact = {
    .name = "rolling_contact",
    .title = "body on a wavy surface, preloaded Hertzian contact, damper to ground (Nayak 1972 eqs 21-26)",
    .n_states = 2,
    .n_inputs = ROLLING_INPUTS,
    .n_outputs = 5,
    .n_contacts = 1,
    .output_signal = hertz_rig_outputs,
    .contact_side = side,
    .prepare = hertz_rig_prepare,
    .rest = hertz_rig_rest,
    .eigenfrequency = hertz_rig_eigenfrequency,
    .rhs = rolling_contact_rhs,
    .gap = rolling_contact_gap,
    .flow = rolling_contact_flow,
    .energy = energy,
    .output = output,
    .hertz_form = hertz_form,
    ROLLING,
};

static void prepare_linear(const double *si, double *p, struct scale *scale)
{
    double full[MODEL_DERIVED];
    hertz_rig_prepare(si, full, scale);
    polynomial_begin(p, full[ROLLING_P_TWO_ZETA], 2.0 / 3.0, 1.5);
    polynomial_put((const double[4]){0.0, -1.0, 0.0, 0.0}, &p[POLYNOMIAL_C]);
    p[POLYNOMIAL_M + 4 * ROLLING_FORCE] = 2.0 / 3.0;
    p[POLYNOMIAL_M + 4 * ROLLING_WAVINESS] = -1.0;
    p[POLYNOMIAL_BASE] = 1.0;
    p[POLYNOMIAL_BASE_INPUT] = ROLLING_WAVINESS;
    polynomial_find_rest(p);
}

const struct model rolling_contact_linear = {
    .name = "rolling_contact_linear",
    .title = "rolling_contact, linear; no contact loss",
    .prepare = prepare_linear,
    .linear = polynomial_linear,
    .full = &rolling_contact,
    .climb = polynomial_climb,
    ROLLING,
    POLYNOMIAL_MODEL(linear_2, 2),
};
