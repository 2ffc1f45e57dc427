/* afm_lever.c - the AFM lever over a sample; equations in afm_lever.h. */
#include "models/afm_lever.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include "models/check.h"
#include "models/math/elementary.h"
#include "models/tip_law.h"

/* A gap below this, in metres, is near the surface: there `modal` cuts its ticks. */
#define NEAR_M 1.5e-9

/* Length units in range_m: so the numbers of 24 bits on the bus reach over it. */
#define UNITS_IN_RANGE 30.0

enum { REST_STEPS = 200 };

/* Prepared numbers, model units. */
enum {
    P_MODES,
    P_OMEGA,
    P_DAMPING = P_OMEGA + MODEL_MODES,
    P_BASE = P_DAMPING + MODEL_MODES,
    P_SENSOR = P_BASE + MODEL_MODES,
    P_SENSOR_REST = P_SENSOR + MODEL_MODES, /* sensor reading per force that the modes left out give */
    P_REST,                                 /* 1/k_res */
    P_STATIC,                               /* stiffness of the whole lever */
    P_RISE,                                 /* 1 - sum G_n: gap per base at constant y_n */
    P_ATTRACTION,                           /* H R/6 */
    P_OUT,                                  /* hamaker_out_J/hamaker_J - 1 */
    P_A0,
    P_RELEASE,
    P_HERTZ,
    P_VISCOUS,
    P_HEIGHT,
    P_HEAT, /* standard deviation of each modal velocity */
    P_SEED,
    P_NEAR, /* 0: permanent contact */
    P_STIFFEST,
    P_NUMBERS
};
STATIC_ASSERT((int)P_NUMBERS <= (int)LEVER_DERIVED && (int)LEVER_DERIVED <= (int)MODEL_DERIVED,
              lever_numbers_fit);

/* Roots by Newton's method in 50 digits; sensor = (2/3) phi'(L)/phi(L), base = integral of phi over that of
 * phi^2, with phi(L) = 1. */
const struct beam_mode beam_modes[MODEL_MODES] = {
    {1.8751040687119611664, 0.917670323115023185, 1.56598351207925147},
    {4.6940911329741745764, 3.18718560680775601, -0.867871790221438544},
    {7.8547574382376125649, 5.23244403099300215, 0.508850593732211423},
    {10.995540734875466991, 7.33060644734764613, -0.363796043274097171},
};

static const struct signal states[LEVER_STATES] = {
    {"mode_1", "m", "tip deflection by mode 1, plus its share of the base's motion", QUANTITY_LENGTH, NULL},
    {"mode_2", "m", "by mode 2", QUANTITY_LENGTH, NULL},
    {"mode_3", "m", "by mode 3", QUANTITY_LENGTH, NULL},
    {"mode_4", "m", "by mode 4", QUANTITY_LENGTH, NULL},
    {"branch", "1", "0: adhesion of the way in, 1: of the way out", QUANTITY_RATIO, NULL},
    {"mode_1_rate", "m/s", "rate of mode_1", QUANTITY_VELOCITY, NULL},
    {"mode_2_rate", "m/s", "rate of mode_2", QUANTITY_VELOCITY, NULL},
    {"mode_3_rate", "m/s", "rate of mode_3", QUANTITY_VELOCITY, NULL},
    {"mode_4_rate", "m/s", "rate of mode_4", QUANTITY_VELOCITY, NULL},
    {"branch_rate", "1", "0", QUANTITY_RATIO, NULL},
};

static const struct signal inputs[LEVER_INPUTS] = {
    {"force", "N", "force on the tip, positive away from the sample", QUANTITY_FORCE, NULL},
    {"force_2", "N", "second force on the tip", QUANTITY_FORCE, NULL},
    {"z", "m", "base of the lever, positive away from the sample", QUANTITY_LENGTH, NULL},
    {"stiffness", "1", "relative modulation of the contact stiffness", QUANTITY_RATIO, NULL},
};

static const struct signal outputs[LEVER_OUTPUTS] = {
    {"displacement", "m", "tip against the base, positive away from the sample", QUANTITY_LENGTH, NULL},
    {"velocity", "m/s", "its rate", QUANTITY_VELOCITY, NULL},
    {"penetration", "m", "indentation of the sample, 0 apart", QUANTITY_LENGTH, NULL},
    {"contact_force", "N", "force of the sample on the tip, negative where it attracts", QUANTITY_FORCE,
     NULL},
    {"in_contact", "1", "1 where the gap is below a0, 0 apart", QUANTITY_RATIO, NULL},
    {"gap", "m", "distance of tip and sample, negative where the tip is in the sample", QUANTITY_LENGTH,
     NULL},
    {"deflection", "m", "reading of a sensor of the slope, calibrated by a static force", QUANTITY_LENGTH,
     NULL},
    {"tip_position", "m", "tip over the sample's surface, without indentation of that", QUANTITY_LENGTH,
     NULL},
    {"base", "m", "height of the undeflected tip over the sample", QUANTITY_LENGTH, NULL},
};

static const struct parameter parameters[LEVER_PARAMETERS] = {LEVER_ROWS};

/* ---- tip and sample ---- */

ALWAYS_INLINE struct tip_law law_of(const double *p)
{
    return (struct tip_law){.attraction = p[P_ATTRACTION],
                            .out = p[P_OUT],
                            .a0 = p[P_A0],
                            .hertz = p[P_HERTZ],
                            .viscous = p[P_VISCOUS],
                            .rest = p[P_REST]};
}

NEVER_INLINE void tip_pull(const double *p, double branch, double gap, struct tip_pull *l)
{
    struct tip_law w = law_of(p);
    struct tip_side s = tip_side_of(&w, 0.0, branch);
    (void)tip_pull_behind(&w, &s, gap, l);
}

/* On the way in, without the spring. */
static void pull_in(const double *p, double d, struct tip_pull *l)
{
    struct tip_law w = law_of(p);
    struct tip_side s = tip_side_of(&w, 0.0, 0.0);
    tip_pull_at(&w, &s, d, l);
}

/* The gap of the rigid tip (its spring not stretched), and its rate. */
static struct input rigid_gap(const double *p, const struct input *u, const double *x)
{
    int n = (int)p[P_MODES];
    struct input gap = {p[P_HEIGHT] + p[P_RISE] * u[LEVER_Z].value, p[P_RISE] * u[LEVER_Z].rate};
    for (int i = 0; i < n; i++) {
        gap.value += x[i];
        gap.rate += x[LEVER_RATE + i];
    }
    return gap;
}

static void tip_force(const double *p, const struct input *u, double branch, double gap, struct tip_force *f)
{
    struct tip_law w = law_of(p);
    struct tip_side s = tip_side_of(&w, u[LEVER_STIFFNESS].value, branch);
    tip_force_at(&w, &s, gap, f);
    if (u[LEVER_STIFFNESS].value != 0.0)
        f->modulation = tip_modulation(&w, branch, gap, f);
}

/* The way out begins where the tip turns back in contact, the way in beyond release_m. */
static double tip_branch(const double *p, double branch, double gap, double rate, double *loss)
{
    struct tip_pull in, out;
    bool leaves = branch == 0.0 && gap <= p[P_A0] && rate > 0.0;
    bool arrives = branch != 0.0 && gap > p[P_RELEASE];
    *loss = 0.0;
    if (p[P_OUT] == 0.0 || !(leaves || arrives))
        return branch;
    tip_pull(p, 0.0, gap, &in);
    tip_pull(p, 1.0, gap, &out);
    *loss = leaves ? in.energy - out.energy : out.energy - in.energy;
    return leaves ? 1.0 : 0.0;
}

/* ---- the lever ---- */

static void rhs(const double *p, const struct input *u, const double *x, double *x_dot)
{
    int n = (int)p[P_MODES];
    struct input gap = rigid_gap(p, u, x);
    struct tip_force f;
    tip_force(p, u, x[LEVER_BRANCH], gap.value, &f);
    double drive = (f.force - f.drag * gap.rate) + (u[LEVER_FORCE].value + u[LEVER_FORCE_2].value);
    for (int i = 0; i < LEVER_RATE; i++) {
        x_dot[i] = i == LEVER_BRANCH ? 0.0 : x[LEVER_RATE + i];
        x_dot[LEVER_RATE + i] = 0.0;
    }
    for (int i = 0; i < n; i++) {
        double omega = p[P_OMEGA + i], base = p[P_BASE + i];
        double rate = x[LEVER_RATE + i] - base * u[LEVER_Z].rate;
        double stretch = x[i] - base * u[LEVER_Z].value;
        x_dot[LEVER_RATE + i] = (drive - p[P_DAMPING + i] * rate) - omega * omega * stretch;
    }
}

static void gap_of(const double *p, const struct input *u, const double *x, struct input *gap)
{
    struct tip_force f;
    *gap = rigid_gap(p, u, x);
    tip_force(p, u, x[LEVER_BRANCH], gap->value, &f);
    gap->value = f.gap;
}

static void flow(const double *p, const struct input *u, const double *x, struct flow *f)
{
    int n = (int)p[P_MODES];
    double z_rate = u[LEVER_Z].rate, sum = 0.0;
    struct input gap = rigid_gap(p, u, x);
    struct tip_force t;
    tip_force(p, u, x[LEVER_BRANCH], gap.value, &t);
    rhs(p, u, x, f->x_dot);
    double contact = t.force - t.drag * gap.rate;
    f->damping = t.drag * gap.rate * gap.rate;
    f->work[LEVER_Z] = -p[P_RISE] * z_rate * contact;
    for (int i = 0; i < n; i++) {
        double omega = p[P_OMEGA + i], base = p[P_BASE + i], rate = x[LEVER_RATE + i] - base * z_rate;
        double stretch = x[i] - base * u[LEVER_Z].value;
        sum += x[LEVER_RATE + i];
        f->damping += p[P_DAMPING + i] * rate * rate;
        f->work[LEVER_Z] -= base * z_rate * (omega * omega * stretch + p[P_DAMPING + i] * rate);
    }
    f->work[LEVER_FORCE] = u[LEVER_FORCE].value * sum;
    f->work[LEVER_FORCE_2] = u[LEVER_FORCE_2].value * sum;
    f->work[LEVER_STIFFNESS] = t.modulation * gap.rate;
    f->force = t.force > 0.0 ? t.force : 0.0;
}

static double energy(const double *p, const struct input *u, const double *x)
{
    int n = (int)p[P_MODES];
    struct tip_pull l;
    tip_pull(p, x[LEVER_BRANCH], rigid_gap(p, u, x).value, &l);
    for (int i = 0; i < n; i++) {
        double rate = x[LEVER_RATE + i];
        double stretch = p[P_OMEGA + i] * (x[i] - p[P_BASE + i] * u[LEVER_Z].value);
        l.energy += 0.5 * (rate * rate + stretch * stretch);
    }
    return l.energy;
}

/* The reading of a sensor of the slope, where this force acts at the tip. */
static double sensed(const double *p, double z, const double *x, double force)
{
    int n = (int)p[P_MODES];
    double sensor = 0.0;
    for (int i = 0; i < n; i++)
        sensor += p[P_SENSOR + i] * (x[i] - p[P_BASE + i] * z);
    return sensor + p[P_SENSOR_REST] * force;
}

double afm_lever_deflection(const double *p, const struct input *z, const double *x)
{
    const struct input u[LEVER_INPUTS] = {[LEVER_Z] = *z};
    struct input gap = rigid_gap(p, u, x);
    struct tip_force f;
    tip_force(p, u, x[LEVER_BRANCH], gap.value, &f);
    return sensed(p, z->value, x, f.force - f.drag * gap.rate);
}

static void output(const double *p, const struct input *u, const double *x, double *out)
{
    double base = p[P_HEIGHT] + u[LEVER_Z].value;
    struct input gap = rigid_gap(p, u, x);
    struct tip_force f;
    tip_force(p, u, x[LEVER_BRANCH], gap.value, &f);
    double d = f.gap + p[P_A0], force = f.force - f.drag * gap.rate;
    out[0] = d - base;
    out[1] = gap.rate - u[LEVER_Z].rate;
    out[2] = f.gap < 0.0 ? -f.gap : 0.0;
    out[3] = force;
    out[LEVER_IN_CONTACT] = f.gap < 0.0 ? 1.0 : 0.0;
    out[LEVER_GAP] = d;
    out[LEVER_DEFLECTION] = sensed(p, u[LEVER_Z].value, x, force);
    out[LEVER_POSITION] = d;
    out[LEVER_BASE] = base;
}

/* ---- parameters ---- */

static double square(double x)
{
    return x * x;
}

/* k_n/k of a beam. */
static double modal_stiffness(int i)
{
    return square(square(beam_modes[i].beta)) / 12.0;
}

static void prepare_modes(const double *si, double *p)
{
    int n = (int)si[LEVER_MODES];
    double first = modal_stiffness(0), flexibility = 1.0, slope = 1.0, rise = 1.0;
    for (int i = 0; i < n; i++) {
        double omega = square(beam_modes[i].beta / beam_modes[0].beta);
        p[P_OMEGA + i] = omega;
        p[P_DAMPING + i] = omega / si[LEVER_Q];
        p[P_BASE + i] = beam_modes[i].base;
        p[P_SENSOR + i] = n > 1 ? beam_modes[i].sensor : 1.0;
        flexibility -= 1.0 / modal_stiffness(i);
        slope -= beam_modes[i].sensor / modal_stiffness(i);
        rise -= beam_modes[i].base;
    }
    p[P_MODES] = n;
    p[P_RISE] = rise;
    p[P_STATIC] = n > 1 ? 1.0 / first : 1.0;
    p[P_REST] = n > 1 ? flexibility * first : 0.0;
    p[P_SENSOR_REST] = n > 1 ? slope * first : 0.0;
}

/* The steepest force: at a0 outside, or at the largest indentation. */
static double stiffest(const double *p, double indentation)
{
    double attraction = 2.0 * p[P_ATTRACTION] * (1.0 + p[P_OUT]) / (p[P_A0] * p[P_A0] * p[P_A0]);
    double repulsion = 1.5 * p[P_HERTZ] * sqrt(indentation);
    return attraction > repulsion ? attraction : repulsion;
}

static void prepare(const double *si, double *p, struct scale *s)
{
    double L = si[LEVER_RANGE] / UNITS_IN_RANGE, k = si[LEVER_K];
    prepare_modes(si, p);
    if (si[LEVER_MODES] > 1.0)
        k *= modal_stiffness(0);
    s->length_m = L;
    s->time_s = 1.0 / (2.0 * ELEMENTARY_PI * si[LEVER_F0]);
    s->force_N = k * L;
    s->energy_J = k * L * L;
    p[P_ATTRACTION] = si[LEVER_HAMAKER] * si[LEVER_RADIUS] / (6.0 * L * s->energy_J);
    p[P_OUT] = si[LEVER_HAMAKER] > 0.0 ? si[LEVER_HAMAKER_OUT] / si[LEVER_HAMAKER] - 1.0 : 0.0;
    p[P_A0] = si[LEVER_A0] / L;
    p[P_RELEASE] = si[LEVER_RELEASE] / L;
    p[P_HERTZ] = (4.0 / 3.0) * si[LEVER_MODULUS] * sqrt(si[LEVER_RADIUS] * L) * L / s->force_N;
    p[P_VISCOUS] = si[LEVER_VISCOSITY] * sqrt(si[LEVER_RADIUS] * L) / (k * s->time_s);
    p[P_HEIGHT] = si[LEVER_HEIGHT] / L;
    p[P_HEAT] = sqrt(BOLTZMANN_J_PER_K * si[LEVER_TEMPERATURE] / s->energy_J);
    p[P_SEED] = si[LEVER_SEED];
    p[P_NEAR] = si[LEVER_PERMANENT] != 0.0 ? 0.0 : NEAR_M / L;
    p[P_STIFFEST] = stiffest(p, si[LEVER_INDENTATION_MAX] / L);
}

static bool whole(double x)
{
    return x == (double)(int64_t)x;
}

/* Deflection at rest on the way in: the outermost equilibrium,
 * or that in contact where there is none outside. */
static double rest_gap(const double *p)
{
    double d = p[P_HEIGHT], k = p[P_STATIC], low, high = p[P_A0];
    struct tip_pull l;
    for (int i = 0; i < REST_STEPS && d > p[P_A0]; i++) {
        pull_in(p, d, &l);
        double slope = k - l.slope, step = (k * (d - p[P_HEIGHT]) - l.force) / slope;
        if (!(slope > 0.0))
            break;
        d -= step;
        if (fabs(step) <= 1e-15 * fabs(d))
            return d;
    }
    low = p[P_HEIGHT] < high ? p[P_HEIGHT] : high;
    for (int i = 0; i < REST_STEPS;
         i++) { /* below `low` the spring would pull, too: the sample repels there */
        pull_in(p, low, &l);
        if (k * (low - p[P_HEIGHT]) - l.force <= 0.0)
            break;
        low -= p[P_A0] + (high - low);
    }
    for (int i = 0; i < REST_STEPS; i++) {
        d = 0.5 * (low + high);
        pull_in(p, d, &l);
        if (k * (d - p[P_HEIGHT]) - l.force > 0.0)
            high = d;
        else
            low = d;
    }
    return d;
}

static const char *check(const double *si)
{
    double p[MODEL_DERIVED];
    struct scale s;
    if (!whole(si[LEVER_MODES]))
        return "modes must be 1, 2, 3 or 4";
    if (!whole(si[LEVER_PERMANENT]))
        return "permanent_contact must be 0 or 1";
    if (!whole(si[LEVER_SEED]))
        return "heat_seed must be a whole number";
    if (si[LEVER_HAMAKER_OUT] < si[LEVER_HAMAKER])
        return "hamaker_out_J below hamaker_J: adhesion would make energy; give at least hamaker_J";
    if (si[LEVER_HAMAKER] == 0.0 && si[LEVER_HAMAKER_OUT] > 0.0)
        return "hamaker_out_J without hamaker_J: give hamaker_J as well, or 0 for both";
    if (!(si[LEVER_RELEASE] > si[LEVER_A0]))
        return "release_m must be above a0_m";
    prepare(si, p, &s);
    if (!(p[P_A0] - rest_gap(p) <= si[LEVER_INDENTATION_MAX] / s.length_m))
        return "the lever is inside the surface at the start: at rest it would indent the sample more than "
               "indentation_max_m; raise height_m or indentation_max_m";
    return NULL;
}

static void rest(const double *p, double *x)
{
    int n = (int)p[P_MODES];
    struct tip_pull l;
    pull_in(p, rest_gap(p), &l);
    for (int i = 0; i < LEVER_STATES; i++)
        x[i] = i < n ? l.force / square(p[P_OMEGA + i]) : 0.0;
}

/* The fastest mode on the steepest force of the sample. */
static double eigenfrequency(const double *p)
{
    int n = (int)p[P_MODES];
    return sqrt(square(p[P_OMEGA + n - 1]) + n * p[P_STIFFEST]);
}

static void modal_form(const double *p, struct modal_form *f)
{
    *f = (struct modal_form){.n_modes = (int)p[P_MODES],
                             .forces = 1u << LEVER_FORCE | 1u << LEVER_FORCE_2,
                             .base = LEVER_Z,
                             .stiffness = LEVER_STIFFNESS,
                             .height = p[P_HEIGHT],
                             .near = p[P_NEAR],
                             .stiffest = p[P_STIFFEST],
                             .heat = p[P_HEAT],
                             .seed = (uint64_t)p[P_SEED],
                             .latched = p[P_OUT] > 0.0,
                             .law = law_of(p)};
    for (int i = 0; i < f->n_modes; i++) {
        f->omega[i] = p[P_OMEGA + i];
        f->damping[i] = p[P_DAMPING + i];
        f->participation[i] = p[P_BASE + i];
    }
}

static const int side[] = {-1};

const struct model afm_lever = {
    .name = "afm_lever",
    .title = "AFM lever of 1 to 4 beam modes with heat over a sample (van der Waals, DMT; Rabe 1996)",
    .n_states = LEVER_STATES,
    .n_inputs = LEVER_INPUTS,
    .n_outputs = LEVER_OUTPUTS,
    .n_contacts = 1,
    .n_parameters = LEVER_PARAMETERS,
    .state_signal = states,
    .input_signal = inputs,
    .output_signal = outputs,
    .contact_side = side,
    .parameter = parameters,
    .check = check,
    .prepare = prepare,
    .rest = rest,
    .eigenfrequency = eigenfrequency,
    .rhs = rhs,
    .gap = gap_of,
    .flow = flow,
    .energy = energy,
    .output = output,
    .modal_form = modal_form,
    .tip_branch = tip_branch,
};
