/* hertz_rig.c - tables and scale of the preloaded Hertzian rig; equations in hertz_rig.h. */
#include "models/hertz_rig.h"

#include <stddef.h>
#include "models/elementary.h"

static const struct signal states[] = {
    {"position", "m", "mass position from first touch, positive into the contact", QUANTITY_LENGTH, "q"},
    {"velocity", "m/s", "mass velocity", QUANTITY_VELOCITY, "q_dot"},
};

static const struct signal inputs[] = {
    {"force", "N", "slow force on the mass, positive into the contact", QUANTITY_FORCE, NULL},
    {"fast_force", "N", "fast force on the mass, positive into the contact", QUANTITY_FORCE, NULL},
    {"base", "m", "base displacement, positive away from the mass", QUANTITY_LENGTH, NULL},
    {"stiffness", "1", "relative modulation of the contact stiffness", QUANTITY_RATIO, NULL},
};

static const struct signal outputs[] = {
    {"displacement", "m", "mass position from first touch, positive into the contact", QUANTITY_LENGTH, "q"},
    {"velocity", "m/s", "mass velocity", QUANTITY_VELOCITY, "q_dot"},
    {"penetration", "m", "compression of the contact, 0 apart", QUANTITY_LENGTH, NULL},
    {"contact_force", "N", "elastic contact force, 0 apart", QUANTITY_FORCE, NULL},
    {"in_contact", "1", "1 in contact, 0 apart", QUANTITY_RATIO, NULL},
};

/* The default rig: two steel bodies, contact resonance 230 Hz, preload about the weight of the mass, 1 % damping. */
static const struct parameter parameters[] = {
    {"mass_kg", "kg", 1e-9, 1e6, 6.5, "moving mass"},
    {"stiffness_N_per_m1_5", "N/m^1.5", 1e-3, 1e18, 3.4e9, "Hertz constant k of F = k z^1.5"},
    {"preload_N", "N", 1e-9, 1e6, 64.0, "static normal load"},
    {"damping_N_s_per_m", "N s/m", 0.0, 1e6, 188.0, "viscous damping between mass and base"},
};

static const struct parameter paper[] = {
    {"xi", "1", 0.0, 1.0, 0.01, "damping ratio"},
    {"sigma", "1", -1e6, 1e6, 0.0, "slow force amplitude over the preload"},
    {"omega", "1", 0.0, 1e3, 1.0, "slow frequency over the contact eigenfrequency"},
    {"phi", "rad", -1e3, 1e3, 0.0, "phase of the slow force"},
    {"Omega", "1", 0.0, 1e3, 8.0, "fast frequency over the contact eigenfrequency"},
    {"a_force", "1", -1e6, 1e6, 0.0, "fast force amplitude over the preload"},
    {"a_base", "1", -1e6, 1e6, 0.0, "fast base amplitude, in units of 2 zs/3"},
    {"a_stiff", "1", -1e6, 1e6, 0.0, "fast stiffness amplitude over the stiffness"},
};

static void prepare(const double *si, double *p, struct scale *scale)
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

static const char *check(const double *si)
{
    double p[MODEL_DERIVED];
    struct scale s;
    prepare(si, p, &s);
    if (!(s.length_m >= 1e-15 && s.length_m <= 1.0))
        return "static compression (preload/stiffness)^(2/3) outside 1e-15..1 m";
    if (!(s.time_s >= 1e-9 && s.time_s <= 1e3))
        return "contact eigenfrequency outside 1.6e-4..1.6e8 Hz";
    if (p[RIG_P_TWO_XI] > 2.0)
        return "overdamped: damping ratio c/(2 m nu) above 1";
    return NULL;
}

static void from_paper(const double *q, double *si, struct harmonic *drive)
{
    enum { XI, SIGMA, OMEGA, PHI, FAST_OMEGA, A_FORCE, A_BASE, A_STIFF };
    /* mass 1.5, stiffness 1, preload 1: zs = nu = 1 and c = 2 xi m nu = 3 xi. */
    si[RIG_MASS] = 1.5;
    si[RIG_CONTACT_STIFFNESS] = 1.0;
    si[RIG_PRELOAD] = 1.0;
    si[RIG_DAMPING] = 3.0 * q[XI];
    drive[RIG_FORCE] = (struct harmonic){q[SIGMA], q[OMEGA], q[PHI]};
    drive[RIG_FAST_FORCE] = (struct harmonic){q[A_FORCE], q[FAST_OMEGA], 0.0};
    drive[RIG_BASE] = (struct harmonic){(2.0 / 3.0) * q[A_BASE], q[FAST_OMEGA], 0.0};
    drive[RIG_STIFFNESS] = (struct harmonic){q[A_STIFF], q[FAST_OMEGA], 0.0};
}

/* q = (3/2)(y - 1). */
static void paper_state(const double *p, const struct input *u, const double *x, double *q)
{
    (void)p, (void)u;
    q[0] = 1.5 * x[0] - 1.5;
    q[1] = 1.5 * x[1];
}

static void state_from_paper(const double *p, const struct input *u, const double *q, double *x)
{
    (void)p, (void)u;
    x[0] = 1.0 + (2.0 / 3.0) * q[0];
    x[1] = (2.0 / 3.0) * q[1];
}

static void rest(const double *p, double *x)
{
    (void)p;
    x[0] = 1.0;
    x[1] = 0.0;
}

static double eigenfrequency(const double *p)
{
    (void)p;
    return 1.0;
}

static void flow(const double *p, const struct input *u, const double *x, struct flow *f)
{
    double modulation = u[RIG_STIFFNESS].value;
    double contact = (2.0 / 3.0) * hertz_rig_contact(x[0] - u[RIG_BASE].value);
    double relative = x[1] - u[RIG_BASE].rate; /* penetration rate */
    double damper = p[RIG_P_TWO_XI] * relative;
    double elastic = (1.0 + modulation) * contact;
    double drive = (2.0 / 3.0) * (1.0 + (u[RIG_FORCE].value + u[RIG_FAST_FORCE].value));
    f->x_dot[0] = x[1];
    f->x_dot[1] = drive - elastic - damper;
    f->work[RIG_FORCE] = (2.0 / 3.0) * u[RIG_FORCE].value * x[1];
    f->work[RIG_FAST_FORCE] = (2.0 / 3.0) * u[RIG_FAST_FORCE].value * x[1];
    f->work[RIG_BASE] = -(elastic + damper) * u[RIG_BASE].rate;
    f->work[RIG_STIFFNESS] = -modulation * contact * relative;
    f->damping = damper * relative;
    f->force = 1.5 * elastic;
}

static double energy(const double *p, const struct input *u, const double *x)
{
    double eta = x[0] - u[RIG_BASE].value;
    double e = eta > 0.0 ? eta : 0.0;
    (void)p;
    return 0.5 * x[1] * x[1] + (2.0 / 3.0) * (0.4 * e * hertz_rig_contact(e) - x[0]);
}

static void output(const double *p, const struct input *u, const double *x, double *out)
{
    double eta = x[0] - u[RIG_BASE].value;
    (void)p;
    out[0] = x[0];
    out[1] = x[1];
    out[2] = eta > 0.0 ? eta : 0.0;
    out[3] = (1.0 + u[RIG_STIFFNESS].value) * hertz_rig_contact(eta);
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

enum { COUNT_STATES = 2, COUNT_INPUTS = 4, COUNT_OUTPUTS = 5, COUNT_PARAMETERS = 4, COUNT_PAPER = 8 };

const struct model hertz_rig = {
    .name = "hertz_rig",
    .title = "mass on a preloaded, single-sided Hertzian contact (Nayak 1972; Bichri et al. 2011 eqs 1, 2, "
             "19, 25)",
    .n_states = COUNT_STATES,
    .n_inputs = COUNT_INPUTS,
    .n_outputs = COUNT_OUTPUTS,
    .n_contacts = 1,
    .n_parameters = COUNT_PARAMETERS,
    .n_paper = COUNT_PAPER,
    .state_signal = states,
    .input_signal = inputs,
    .output_signal = outputs,
    .parameter = parameters,
    .paper = paper,
    .check = check,
    .prepare = prepare,
    .from_paper = from_paper,
    .paper_state = paper_state,
    .state_from_paper = state_from_paper,
    .rest = rest,
    .eigenfrequency = eigenfrequency,
    .rhs = hertz_rig_rhs,
    .gap = hertz_rig_gap,
    .flow = flow,
    .energy = energy,
    .output = output,
    .hertz_form = hertz_form,
};
