/* shaft_mode.c - the model of one mode of the shaft: the full model seen along x = phi q; see
 * shaft_bearing.h. */
#include "models/reduced/shaft_mode.h"

#include "models/shaft_views.h"

#include <math.h>
#include <stddef.h>

static const struct signal states[] = {
    {"position", "m", "motion of the mode, at the bearing that moves more", QUANTITY_LENGTH, "q"},
    {"velocity", "m/s", "its rate", QUANTITY_VELOCITY, "q_dot"},
};

static const struct parameter parameters[SHAFT_MODE_PARAMETERS] = {
    SHAFT_SI_ROWS, {"mode", "1", 1.0, 3.0, 1.0, "mode kept: 1 translation, 2 rotation, 3 bending"}};
static const struct parameter paper[SHAFT_MODE_PAPER] = {
    SHAFT_PAPER_ROWS, {"mode", "1", 1.0, 3.0, 1.0, "mode kept: 1 translation, 2 rotation, 3 bending"}};

/* The full state of this motion. */
static void expand(const double *p, const double *x, double *full)
{
    for (int i = 0; i < 3; i++) {
        full[i] = p[SHAFT_P_SHAPE + i] * x[0];
        full[3 + i] = p[SHAFT_P_SHAPE + i] * x[1];
    }
}

static void prepare(const double *si, double *p, struct scale *scale)
{
    double shape[3][3], mass = 0.0, damping = 0.0, springs = 0.0, support, bend;
    shaft_prepare(si, p, scale);
    shaft_open_modes(p, shape);
    const double *s = shape[(int)si[SHAFT_MODE] - 1];
    double size = fabs(s[2]) > fabs(s[0]) ? fabs(s[2]) : fabs(s[0]);
    double *phi = &p[SHAFT_P_SHAPE];
    for (int i = 0; i < 3; i++) {
        phi[i] = (s[0] < 0.0 ? -s[i] : s[i]) / size;
        mass += p[SHAFT_P_MASS + i] * phi[i] * phi[i];
        damping += p[SHAFT_P_DAMPING + i] * phi[i] * phi[i];
        springs += p[SHAFT_P_CONTACT + i] * phi[i] * phi[i];
    }
    bend = (phi[0] + phi[2]) - 2.0 * phi[1];
    support = bend * bend;
    for (int i = 0; i < 3; i++)
        support += p[SHAFT_P_SUPPORT + i] * phi[i] * phi[i];
    p[SHAFT_P_MODE_INVERSE_MASS] = 1.0 / mass;
    p[SHAFT_P_MODE_STIFFNESS] = support;
    p[SHAFT_P_MODE_DAMPING] = damping;
    p[SHAFT_P_EIGENFREQUENCY] = sqrt((support + springs) / mass);
}

/* The mode's eigenfrequency needs no limit of its own: as a Rayleigh quotient it is below that of the full
 * shaft, which shaft_check limits. */
static const char *check(const double *si)
{
    const char *why = shaft_check(si);
    if (why)
        return why;
    if (si[SHAFT_MODE] != 1.0 && si[SHAFT_MODE] != 2.0 && si[SHAFT_MODE] != 3.0)
        return "mode must be 1, 2 or 3";
    return NULL;
}

static void from_paper(const double *q, double *si, struct harmonic *drive)
{
    shaft_from_paper(q, si, drive);
    si[SHAFT_MODE] = q[SHAFT_PAPER_MODE];
}

static void paper_state(const double *p, const struct input *u, const double *x, double *q)
{
    (void)u;
    q[0] = x[0] * p[SHAFT_P_LENGTH_M];
    q[1] = x[1] * p[SHAFT_P_VELOCITY_M_PER_S];
}

static void state_from_paper(const double *p, const struct input *u, const double *q, double *x)
{
    (void)u;
    x[0] = q[0] / p[SHAFT_P_LENGTH_M];
    x[1] = q[1] / p[SHAFT_P_VELOCITY_M_PER_S];
}

static void rest(const double *p, double *x)
{
    (void)p;
    x[0] = x[1] = 0.0;
}

static double energy(const double *p, const struct input *u, const double *x)
{
    double full[6];
    expand(p, x, full);
    return shaft_energy(p, u, full);
}

static void output(const double *p, const struct input *u, const double *x, double *out)
{
    double full[6];
    expand(p, x, full);
    shaft_output(p, u, full, out);
}

/* The motion's direction in which contact i closes: 1, -1, or 0 when it never does. */
static int direction(const double *p, int i)
{
    double phi = p[SHAFT_P_SHAPE + (i < 2 ? 0 : 2)];
    int sign = phi > 0.0 ? 1 : (phi < 0.0 ? -1 : 0);
    return sign * shaft_sides[i];
}

/* The rows of the full system, weighted with phi: mass times row is force. */
static bool linear_view(const double *p, unsigned regime, struct linear *l)
{
    struct linear full;
    const double *phi = &p[SHAFT_P_SHAPE];
    double inverse = p[SHAFT_P_MODE_INVERSE_MASS];
    int towards = 0;
    *l = (struct linear){.a = {{0.0, 1.0}}};
    for (int i = 0; i < SHAFT_CONTACTS; i++) {
        if (!((regime >> i) & 1u))
            continue;
        if (direction(p, i) == 0 || direction(p, i) == -towards)
            return false;
        towards = direction(p, i);
    }
    (void)shaft_linear(p, regime, &full); /* there is one: no bearing is closed on both sides */
    for (int i = 0; i < 3; i++) {
        double weight = inverse * phi[i] * p[SHAFT_P_MASS + i];
        for (int j = 0; j < 3; j++) {
            l->a[1][0] += weight * full.a[3 + i][j] * phi[j];
            l->a[1][1] += weight * full.a[3 + i][3 + j] * phi[j];
        }
        l->b[1][i] = weight * full.b[3 + i][i];
        l->c[1] += weight * full.c[3 + i];
    }
    return true;
}

const struct model shaft_bearing_mode = {
    .name = "shaft_bearing_mode",
    .title = "one mode of shaft_bearing with the gaps as they act on it",
    .n_states = 2,
    .n_contacts = SHAFT_CONTACTS,
    .n_parameters = SHAFT_MODE_PARAMETERS,
    .n_paper = SHAFT_MODE_PAPER,
    .state_signal = states,
    .contact_side = shaft_sides,
    .parameter = parameters,
    .paper = paper,
    .check = check,
    .prepare = prepare,
    .from_paper = from_paper,
    .paper_state = paper_state,
    .state_from_paper = state_from_paper,
    .rest = rest,
    SHAFT_SAME,
    .rhs = shaft_mode_rhs,
    .gap = shaft_mode_gap,
    .flow = shaft_mode_flow,
    .energy = energy,
    .output = output,
    .linear = linear_view,
    .full = &shaft_bearing,
    .climb = expand, /* exact: the other modes rest, as this model assumes */
};
