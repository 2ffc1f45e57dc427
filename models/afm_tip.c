/* afm_tip.c - tables and scale of the AFM tip; equations in afm_tip.h. */
#include "models/afm_tip.h"

#include <stddef.h>
#include "models/flows.h"

const struct signal afm_tip_states[2] = {
    {"position", "m", "tip position from first touch, positive into the contact", QUANTITY_LENGTH, "q"},
    {"velocity", "m/s", "tip velocity", QUANTITY_VELOCITY, "q_dot"},
};

const struct signal afm_tip_inputs[TIP_INPUTS] = {
    {"force", "N", "force on the tip, positive into the contact", QUANTITY_FORCE, NULL},
    {"stiffness", "1", "relative modulation of the contact stiffness", QUANTITY_RATIO, NULL},
};

static const struct signal outputs[] = {
    {"displacement", "m", "tip position from first touch, positive into the contact", QUANTITY_LENGTH, NULL},
    {"velocity", "m/s", "tip velocity", QUANTITY_VELOCITY, NULL},
    {"penetration", "m", "indentation of the sample, 0 apart", QUANTITY_LENGTH, NULL},
    {"contact_force", "N", "elastic contact force, 0 apart; see sign for its direction", QUANTITY_FORCE,
     NULL},
    {"in_contact", "1", "1 in contact, 0 apart", QUANTITY_RATIO, NULL},
};

const struct parameter afm_tip_parameters[TIP_PARAMETERS] = {AFM_TIP_PARAMETERS};

const struct parameter afm_tip_paper[TIP_PAPER] = {
    {"beta", "1", 1e-6, 1e6, 0.8, "contact stiffness 3 k0 sqrt(Delta)/(2 k)"},
    {"c", "1", 0.0, 2.0, 0.02, "damping c1/(m omega0)"},
    {"r", "1", -1e6, 1e6, 0.0, "stiffness amplitude over the stiffness"},
    {"Omega", "1", 0.0, 1e3, 1.0, "frequency of the stiffness over that of the lever"},
    {"f", "1", -1e6, 1e6, 0.0, "force amplitude over k Delta, positive away from the sample"},
    {"omega", "1", 0.0, 1e3, 1.0, "frequency of the force over that of the lever"},
    {"phi", "rad", -1e3, 1e3, 0.0, "phase of the force"},
    {"sign", "1", -1.0, 1.0, 1.0, "1: the contact attracts, as published; -1: it repels"},
};

static double beta_of(const double *si)
{
    return 1.5 * si[TIP_CONTACT_STIFFNESS] * sqrt(si[TIP_INDENTATION]) / si[TIP_LEVER_STIFFNESS];
}

void afm_tip_prepare(const double *si, double *p, struct scale *scale)
{
    double k = si[TIP_LEVER_STIFFNESS];
    p[TIP_P_DAMPING] = si[TIP_DAMPING] / sqrt(k * si[TIP_MASS]);
    p[TIP_P_HERTZ] = -(2.0 / 3.0) * si[TIP_SIGN] * beta_of(si);
    scale->length_m = si[TIP_INDENTATION];
    scale->time_s = sqrt(si[TIP_MASS] / k);
    scale->force_N = k * si[TIP_INDENTATION];
    scale->energy_J = scale->force_N * si[TIP_INDENTATION];
}

const char *afm_tip_check(const double *si)
{
    double p[MODEL_DERIVED], beta = beta_of(si);
    struct scale s;
    if (si[TIP_SIGN] != 1.0 && si[TIP_SIGN] != -1.0)
        return "sign must be 1 (published, the contact attracts) or -1 (repulsive)";
    if (si[TIP_SIGN] > 0.0 && !(beta < 1.0))
        return "Kirrou & Belhaq 2013 leave their range (29.7 in section 3.3): beta = "
               "3 k0 sqrt(indentation)/(2 k) must be below 1 with the published sign, from there on no rest "
               "is stable; lower it or give sign -1";
    if (!(beta >= 1e-9 && beta <= 1e9))
        return "beta = 3 k0 sqrt(indentation)/(2 k) outside 1e-9..1e9";
    afm_tip_prepare(si, p, &s);
    if (!(s.time_s >= 1e-9 && s.time_s <= 1e3))
        return "eigenfrequency of the lever outside 1.6e-4..1.6e8 Hz";
    if (p[TIP_P_DAMPING] > 2.0)
        return "overdamped: damping c1/(m omega0) above 2";
    return NULL;
}

/* mass, lever stiffness and indentation 1: all scales are 1, and k0 = (2/3) beta. */
void afm_tip_from_paper(const double *q, double *si, struct harmonic *drive)
{
    si[TIP_MASS] = 1.0;
    si[TIP_LEVER_STIFFNESS] = 1.0;
    si[TIP_DAMPING] = q[TIP_PAPER_C];
    si[TIP_CONTACT_STIFFNESS] = q[TIP_PAPER_BETA] / 1.5;
    si[TIP_INDENTATION] = 1.0;
    si[TIP_SIGN] = q[TIP_PAPER_SIGN];
    drive[TIP_FORCE] = (struct harmonic){-q[TIP_PAPER_F], q[TIP_PAPER_OMEGA], q[TIP_PAPER_PHI]};
    drive[TIP_STIFFNESS] = (struct harmonic){q[TIP_PAPER_R], q[TIP_PAPER_FAST_OMEGA], 0.0};
}

void afm_tip_paper_state(const double *p, const struct input *u, const double *x, double *q)
{
    (void)p, (void)u;
    q[0] = 1.0 - x[0];
    q[1] = -x[1];
}

void afm_tip_state_from_paper(const double *p, const struct input *u, const double *q, double *x)
{
    afm_tip_paper_state(p, u, q, x); /* its own inverse */
}

static void rest(const double *p, double *x)
{
    (void)p;
    x[0] = 1.0;
    x[1] = 0.0;
}

static double eigenfrequency(const double *p)
{
    return sqrt(1.0 + 1.5 * p[TIP_P_HERTZ]);
}

static double energy(const double *p, const struct input *u, const double *x)
{
    double b = p[TIP_P_HERTZ];
    (void)u;
    return 0.5 * x[1] * x[1] + x[0] * (0.5 * x[0] - (1.0 + b)) + b * hertz_contact_energy(x[0]);
}

static void output(const double *p, const struct input *u, const double *x, double *out)
{
    out[0] = x[0];
    out[1] = x[1];
    out[2] = x[0] > 0.0 ? x[0] : 0.0;
    out[3] = fabs(p[TIP_P_HERTZ]) * (1.0 + u[TIP_STIFFNESS].value) * hertz_contact_force(x[0]);
    out[4] = x[0] > 0.0 ? 1.0 : 0.0;
}

static void hertz_form(const double *p, struct hertz_form *f)
{
    double b = p[TIP_P_HERTZ];
    *f = (struct hertz_form){
        .side = 1.0, .constant = 1.0 + b, .damping = p[TIP_P_DAMPING], .stiffness = 1.0, .hertz = b};
    f->force[TIP_FORCE] = 1.0;
    f->modulation[TIP_STIFFNESS] = 1.0;
}

static const int side[] = {1};

const struct model afm_tip = {
    .name = "afm_tip",
    .title = "tip of an AFM cantilever on a Hertzian sample (Kirrou & Belhaq 2013 eqs 1, 2)",
    .n_states = 2,
    .n_inputs = TIP_INPUTS,
    .n_outputs = 5,
    .n_contacts = 1,
    .n_parameters = TIP_PARAMETERS,
    .n_paper = TIP_PAPER,
    .state_signal = afm_tip_states,
    .input_signal = afm_tip_inputs,
    .output_signal = outputs,
    .contact_side = side,
    .parameter = afm_tip_parameters,
    .paper = afm_tip_paper,
    .check = afm_tip_check,
    .prepare = afm_tip_prepare,
    .from_paper = afm_tip_from_paper,
    .paper_state = afm_tip_paper_state,
    .state_from_paper = afm_tip_state_from_paper,
    .rest = rest,
    .eigenfrequency = eigenfrequency,
    .rhs = afm_tip_rhs,
    .gap = afm_tip_gap,
    .flow = afm_tip_flow,
    .energy = energy,
    .output = output,
    .hertz_form = hertz_form,
};
