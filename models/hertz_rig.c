/* hertz_rig.c - tables and scale of the preloaded Hertzian rig; equations in hertz_rig.h. */
#include "models/hertz_rig.h"

#include <stddef.h>
#include "models/flows.h"
#include "models/math/elementary.h"

const struct signal hertz_rig_states[2] = {
    {"position", "m", "mass position from first touch, positive into the contact", QUANTITY_LENGTH, "q"},
    {"velocity", "m/s", "mass velocity", QUANTITY_VELOCITY, "q_dot"},
};

const struct signal hertz_rig_inputs[RIG_INPUTS] = {
    {"force", "N", "slow force on the mass, positive into the contact", QUANTITY_FORCE, NULL},
    {"fast_force", "N", "fast force on the mass, positive into the contact", QUANTITY_FORCE, NULL},
    {"base", "m", "base displacement, positive away from the mass", QUANTITY_LENGTH, NULL},
    {"stiffness", "1", "relative modulation of the contact stiffness", QUANTITY_RATIO, NULL},
};

const struct signal hertz_rig_outputs[5] = {
    {"displacement", "m", "mass position from first touch, positive into the contact", QUANTITY_LENGTH, "q"},
    {"velocity", "m/s", "mass velocity", QUANTITY_VELOCITY, "q_dot"},
    {"penetration", "m", "compression of the contact, 0 apart", QUANTITY_LENGTH, NULL},
    {"contact_force", "N", "elastic contact force, 0 apart", QUANTITY_FORCE, NULL},
    {"in_contact", "1", "1 in contact, 0 apart", QUANTITY_RATIO, NULL},
};

const struct parameter hertz_rig_parameters[RIG_PARAMETERS] = {HERTZ_RIG_PARAMETERS("base")};

const struct parameter hertz_rig_paper[RIG_PAPER] = {
    {"xi", "1", 0.0, 1.0, 0.01, "damping ratio"},
    {"sigma", "1", -1e6, 1e6, 0.0, "slow force amplitude over the preload"},
    {"omega", "1", 0.0, 1e3, 1.0, "slow frequency over the contact eigenfrequency"},
    {"phi", "rad", -1e3, 1e3, 0.0, "phase of the slow force"},
    {"Omega", "1", 0.0, 1e3, 8.0, "fast frequency over the contact eigenfrequency"},
    {"a_force", "1", -1e6, 1e6, 0.0, "fast force amplitude over the preload"},
    {"a_base", "1", -1e6, 1e6, 0.0, "fast base amplitude, in units of 2 zs/3"},
    {"a_stiff", "1", -1e6, 1e6, 0.0, "fast stiffness amplitude over the stiffness"},
};

void hertz_rig_prepare(const double *si, double *p, struct scale *scale)
{
    double root = cube_root(si[RIG_PRELOAD] / si[RIG_CONTACT_STIFFNESS]);
    double compression = root * root;
    double nu = sqrt(1.5 * si[RIG_PRELOAD] / (si[RIG_MASS] * compression));
    p[RIG_P_TWO_XI] = si[RIG_DAMPING] / (si[RIG_MASS] * nu);
    scale->length_m = compression;
    scale->time_s = 1.0 / nu;
    scale->force_N = si[RIG_PRELOAD];
    scale->energy_J = 1.5 * si[RIG_PRELOAD] * compression; /* m zs^2 nu^2 */
}

const char *hertz_rig_check(const double *si)
{
    double p[MODEL_DERIVED];
    struct scale s;
    hertz_rig_prepare(si, p, &s);
    if (!(s.length_m >= 1e-15 && s.length_m <= 1.0))
        return "static compression (preload/stiffness)^(2/3) outside 1e-15..1 m";
    if (!(s.time_s >= 1e-9 && s.time_s <= 1e3))
        return "contact eigenfrequency outside 1.6e-4..1.6e8 Hz";
    if (p[RIG_P_TWO_XI] > 2.0)
        return "overdamped: damping ratio c/(2 m nu) above 1";
    return NULL;
}

/* mass 1.5, stiffness 1, preload 1: zs = nu = 1 and c = 2 xi m nu = 3 xi. */
void hertz_rig_unit_scale(double damping_ratio, double *si)
{
    si[RIG_MASS] = 1.5;
    si[RIG_CONTACT_STIFFNESS] = 1.0;
    si[RIG_PRELOAD] = 1.0;
    si[RIG_DAMPING] = 3.0 * damping_ratio;
}

void hertz_rig_from_paper(const double *q, double *si, struct harmonic *drive)
{
    double fast = q[RIG_PAPER_FAST_OMEGA];
    hertz_rig_unit_scale(q[RIG_PAPER_XI], si);
    drive[RIG_FORCE] = (struct harmonic){q[RIG_PAPER_SIGMA], q[RIG_PAPER_OMEGA], q[RIG_PAPER_PHI]};
    drive[RIG_FAST_FORCE] = (struct harmonic){q[RIG_PAPER_FORCE], fast, 0.0};
    drive[RIG_BASE] = (struct harmonic){(2.0 / 3.0) * q[RIG_PAPER_BASE], fast, 0.0};
    drive[RIG_STIFFNESS] = (struct harmonic){q[RIG_PAPER_STIFFNESS], fast, 0.0};
}

/* q = (3/2)(y - 1). */
void hertz_rig_paper_state(const double *p, const struct input *u, const double *x, double *q)
{
    (void)p, (void)u;
    q[0] = 1.5 * x[0] - 1.5;
    q[1] = 1.5 * x[1];
}

void hertz_rig_state_from_paper(const double *p, const struct input *u, const double *q, double *x)
{
    (void)p, (void)u;
    x[0] = 1.0 + (2.0 / 3.0) * q[0];
    x[1] = (2.0 / 3.0) * q[1];
}

void hertz_rig_rest(const double *p, double *x)
{
    (void)p;
    x[0] = 1.0;
    x[1] = 0.0;
}

double hertz_rig_eigenfrequency(const double *p)
{
    (void)p;
    return 1.0;
}

static double energy(const double *p, const struct input *u, const double *x)
{
    (void)p;
    return 0.5 * x[1] * x[1] + (2.0 / 3.0) * (hertz_contact_energy(x[0] - u[RIG_BASE].value) - x[0]);
}

static void output(const double *p, const struct input *u, const double *x, double *out)
{
    double eta = x[0] - u[RIG_BASE].value;
    (void)p;
    out[0] = x[0];
    out[1] = x[1];
    out[2] = eta > 0.0 ? eta : 0.0;
    out[3] = (1.0 + u[RIG_STIFFNESS].value) * hertz_contact_force(eta);
    out[4] = eta > 0.0 ? 1.0 : 0.0;
}

static void hertz_form(const double *p, struct hertz_form *f)
{
    *f = (struct hertz_form){
        .side = 1.0, .constant = 2.0 / 3.0, .damping = p[RIG_P_TWO_XI], .hertz = 2.0 / 3.0};
    f->shift[RIG_BASE] = -1.0;
    f->force[RIG_FORCE] = f->force[RIG_FAST_FORCE] = 2.0 / 3.0;
    f->modulation[RIG_STIFFNESS] = 1.0;
}

static const int side[] = {1};

const struct model hertz_rig = {
    .name = "hertz_rig",
    .title = "mass on a preloaded, single-sided Hertzian contact (Nayak 1972; Bichri et al. 2011 eqs 1, 2, "
             "19, 25)",
    .n_states = 2,
    .n_inputs = RIG_INPUTS,
    .n_outputs = 5,
    .n_contacts = 1,
    .n_parameters = RIG_PARAMETERS,
    .n_paper = RIG_PAPER,
    .state_signal = hertz_rig_states,
    .input_signal = hertz_rig_inputs,
    .output_signal = hertz_rig_outputs,
    .contact_side = side,
    .parameter = hertz_rig_parameters,
    .paper = hertz_rig_paper,
    .check = hertz_rig_check,
    .prepare = hertz_rig_prepare,
    .from_paper = hertz_rig_from_paper,
    .paper_state = hertz_rig_paper_state,
    .state_from_paper = hertz_rig_state_from_paper,
    .rest = hertz_rig_rest,
    .eigenfrequency = hertz_rig_eigenfrequency,
    .rhs = hertz_rig_rhs,
    .gap = hertz_rig_gap,
    .flow = hertz_rig_flow,
    .energy = energy,
    .output = output,
    .hertz_form = hertz_form,
};
