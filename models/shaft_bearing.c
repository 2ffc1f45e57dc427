/* shaft_bearing.c - tables and scale of the shaft and its linear model; equations in shaft_bearing.h. */
#include "models/shaft_views.h"

#include <math.h>
#include <stddef.h>
#include <string.h>
#include "models/math/elementary.h"
#include "models/math/symmetric3.h"

static const struct signal states[] = {
    {"position1", "m", "position of the shaft at bearing 1, 0 in the middle of the gap", QUANTITY_LENGTH,
     "x1"},
    {"position2", "m", "position of the middle mass", QUANTITY_LENGTH, "x2"},
    {"position3", "m", "position of the shaft at bearing 3", QUANTITY_LENGTH, "x3"},
    {"velocity1", "m/s", "velocity at bearing 1", QUANTITY_VELOCITY, "v1"},
    {"velocity2", "m/s", "velocity of the middle mass", QUANTITY_VELOCITY, "v2"},
    {"velocity3", "m/s", "velocity at bearing 3", QUANTITY_VELOCITY, "v3"},
};

const struct signal shaft_inputs[SHAFT_INPUTS] = {
    {"force1", "N", "force on the shaft at bearing 1", QUANTITY_FORCE, NULL},
    {"force2", "N", "force on the middle mass", QUANTITY_FORCE, NULL},
    {"force3", "N", "force on the shaft at bearing 3", QUANTITY_FORCE, NULL},
};

const struct signal shaft_outputs[SHAFT_OUTPUTS] = {
    {"displacement", "m", "position of the middle mass", QUANTITY_LENGTH, "x2"},
    {"velocity", "m/s", "velocity of the middle mass", QUANTITY_VELOCITY, "v2"},
    {"penetration", "m", "largest compression of a gap spring, 0 with both gaps open", QUANTITY_LENGTH, NULL},
    {"contact_force", "N", "largest force of a gap spring, 0 with both gaps open", QUANTITY_FORCE, NULL},
    {"position1", "m", "position of the shaft at bearing 1", QUANTITY_LENGTH, "x1"},
    {"velocity1", "m/s", "velocity at bearing 1", QUANTITY_VELOCITY, "v1"},
    {"position3", "m", "position of the shaft at bearing 3", QUANTITY_LENGTH, "x3"},
    {"velocity3", "m/s", "velocity at bearing 3", QUANTITY_VELOCITY, "v3"},
    {"force_bearing1", "N", "force of the gap spring at bearing 1, with the sign of x1", QUANTITY_FORCE,
     NULL},
    {"force_bearing3", "N", "force of the gap spring at bearing 3, with the sign of x3", QUANTITY_FORCE,
     NULL},
};

static const struct parameter parameters[SHAFT_PARAMETERS] = {SHAFT_SI_ROWS};
static const struct parameter paper[SHAFT_PAPER] = {SHAFT_PAPER_ROWS};

/* The largest eigenvalue of M^-1/2 (K + share of the gap springs) M^-1/2. All eigenvalues and the shapes of
 * the modes are written. */
static double eigen(const double *p, double contact_share, double shape[3][3], double value[3])
{
    static const double bend[3] = {1.0, -2.0, 1.0};
    double a[3][3], root[3];
    for (int i = 0; i < 3; i++)
        root[i] = sqrt(p[SHAFT_P_INVERSE_MASS + i]);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            a[i][j] = bend[i] * bend[j] * root[i] * root[j];
        a[i][i] += (p[SHAFT_P_SUPPORT + i] + contact_share * p[SHAFT_P_CONTACT + i]) * root[i] * root[i];
    }
    symmetric3_eigen(a, value, shape);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            shape[k][i] *= root[i];
    return value[2];
}

void shaft_open_modes(const double *p, double shape[3][3])
{
    double value[3];
    eigen(p, 0.0, shape, value);
}

void shaft_prepare(const double *si, double *p, struct scale *scale)
{
    double kL = si[SHAFT_KAPPA] / (si[SHAFT_LENGTH] * si[SHAFT_LENGTH]), shape[3][3], value[3];
    memset(p, 0, SHAFT_NUMBERS * sizeof *p);
    scale->length_m = si[SHAFT_G1];
    scale->time_s = sqrt(si[SHAFT_M1] / kL);
    scale->force_N = kL * si[SHAFT_G1];
    scale->energy_J = scale->force_N * si[SHAFT_G1];
    for (int i = 0; i < 3; i++) {
        p[SHAFT_P_MASS + i] = si[SHAFT_M1 + i] / si[SHAFT_M1];
        p[SHAFT_P_INVERSE_MASS + i] = si[SHAFT_M1] / si[SHAFT_M1 + i];
        p[SHAFT_P_DAMPING + i] = si[SHAFT_C1 + i] / sqrt(kL * si[SHAFT_M1]);
    }
    for (int k = 0; k < 2; k++) {
        p[SHAFT_P_SUPPORT + 2 * k] = 2.0 * si[SHAFT_KS1 + k] / kL;
        p[SHAFT_P_CONTACT + 2 * k] = si[SHAFT_KG1 + k] / kL;
        p[SHAFT_P_GAP + 2 * k] = si[SHAFT_G1 + k] / si[SHAFT_G1];
    }
    p[SHAFT_P_EIGENFREQUENCY] = sqrt(eigen(p, 1.0, shape, value));
    p[SHAFT_P_LENGTH_M] = scale->length_m;
    p[SHAFT_P_VELOCITY_M_PER_S] = scale->length_m / scale->time_s;
}

const char *shaft_check(const double *si)
{
    double p[MODEL_DERIVED];
    struct scale s;
    shaft_prepare(si, p, &s);
    if (!(s.time_s >= 1e-9 && s.time_s <= 1e3))
        return "time unit sqrt(m1 L^2/kappa) outside 1e-9..1e3 s";
    if (!(p[SHAFT_P_EIGENFREQUENCY] <= 1e6))
        return "gap springs, supports or masses differ too much: eigenfrequency above 1e6 of sqrt(kappa/(m1 "
               "L^2))";
    if (!(p[SHAFT_P_GAP + 2] >= 1e-6 && p[SHAFT_P_GAP + 2] <= 1e6))
        return "gaps differ by more than 1e6";
    return NULL;
}

void shaft_from_paper(const double *q, double *si, struct harmonic *drive)
{
    memcpy(si, q, SHAFT_PARAMETERS * sizeof *si);
    for (int i = 0; i < SHAFT_INPUTS; i++)
        drive[i] = (struct harmonic){q[SHAFT_PAPER_P1 + i], 2.0 * ELEMENTARY_PI * q[SHAFT_PAPER_HZ],
                                     q[SHAFT_PAPER_PHI]};
}

static void paper_state(const double *p, const struct input *u, const double *x, double *q)
{
    (void)u;
    for (int i = 0; i < 3; i++) {
        q[i] = x[i] * p[SHAFT_P_LENGTH_M];
        q[3 + i] = x[3 + i] * p[SHAFT_P_VELOCITY_M_PER_S];
    }
}

static void state_from_paper(const double *p, const struct input *u, const double *q, double *x)
{
    (void)u;
    for (int i = 0; i < 3; i++) {
        x[i] = q[i] / p[SHAFT_P_LENGTH_M];
        x[3 + i] = q[3 + i] / p[SHAFT_P_VELOCITY_M_PER_S];
    }
}

static void rest(const double *p, double *x)
{
    (void)p;
    memset(x, 0, 6 * sizeof *x);
}

double shaft_eigenfrequency(const double *p)
{
    return p[SHAFT_P_EIGENFREQUENCY];
}

static double larger(double a, double b)
{
    return a > b ? a : b;
}

double shaft_energy(const double *p, const struct input *u, const double *x)
{
    double bend = (x[0] + x[2]) - 2.0 * x[1], sum = bend * bend;
    (void)u;
    for (int i = 0; i < 3; i++) {
        double over = shaft_bearing_over(x[i], p[SHAFT_P_GAP + i]);
        sum += p[SHAFT_P_MASS + i] * x[3 + i] * x[3 + i] + p[SHAFT_P_SUPPORT + i] * x[i] * x[i] +
               p[SHAFT_P_CONTACT + i] * over * over;
    }
    return 0.5 * sum;
}

void shaft_output(const double *p, const struct input *u, const double *x, double *out)
{
    double over1 = shaft_bearing_over(x[0], p[SHAFT_P_GAP]),
           over3 = shaft_bearing_over(x[2], p[SHAFT_P_GAP + 2]);
    (void)u;
    out[0] = x[1];
    out[1] = x[4];
    out[2] = larger(fabs(over1), fabs(over3));
    out[4] = x[0];
    out[5] = x[3];
    out[6] = x[2];
    out[7] = x[5];
    out[8] = shaft_bearing_contact(p, x, 0);
    out[9] = shaft_bearing_contact(p, x, 2);
    out[3] = larger(fabs(out[8]), fabs(out[9]));
}

/* Row by row: the inverse mass times a force that is linear in this regime. */
bool shaft_linear(const double *p, unsigned regime, struct linear *l)
{
    static const double bend[3] = {1.0, -2.0, 1.0};
    *l = (struct linear){.c = {0.0}};
    for (int i = 0; i < 3; i++) {
        double w = p[SHAFT_P_INVERSE_MASS + i];
        unsigned closed = (regime >> i) & (i == 1 ? 0u : 3u); /* bits 0, 1 for mass 0, bits 2, 3 for mass 2 */
        double contact = closed ? p[SHAFT_P_CONTACT + i] : 0.0, side = closed == 2u ? -1.0 : 1.0;
        if (closed == 3u)
            return false;
        l->a[i][3 + i] = 1.0;
        l->a[3 + i][3 + i] = -w * p[SHAFT_P_DAMPING + i];
        for (int j = 0; j < 3; j++)
            l->a[3 + i][j] = -w * bend[i] * bend[j];
        l->a[3 + i][i] -= w * (p[SHAFT_P_SUPPORT + i] + contact);
        l->b[3 + i][i] = w;
        l->c[3 + i] = w * contact * side * p[SHAFT_P_GAP + i];
    }
    return true;
}

const int shaft_sides[SHAFT_CONTACTS] = {1, -1, 1, -1};

/* Members of struct model that the full and the linear model share. */
#define THREE_MASSES                                                                                         \
    .n_states = 6, .n_parameters = SHAFT_PARAMETERS, .n_paper = SHAFT_PAPER, .state_signal = states,         \
    .parameter = parameters, .paper = paper, .check = shaft_check, .from_paper = shaft_from_paper,           \
    .paper_state = paper_state, .state_from_paper = state_from_paper, .rest = rest, .energy = shaft_energy,  \
    .output = shaft_output, SHAFT_SAME

const struct model shaft_bearing = {
    .name = "shaft_bearing",
    .title = "flexible shaft of three masses on two bearings with clearance, piecewise linear",
    .n_contacts = SHAFT_CONTACTS,
    .contact_side = shaft_sides,
    .prepare = shaft_prepare,
    .rhs = shaft_bearing_rhs,
    .gap = shaft_bearing_gap,
    .flow = shaft_bearing_flow,
    .linear = shaft_linear,
    THREE_MASSES,
};

/* ---- the linear model ---- */

static void prepare_linear(const double *si, double *p, struct scale *scale)
{
    double shape[3][3], value[3];
    shaft_prepare(si, p, scale);
    p[SHAFT_P_CONTACT] = p[SHAFT_P_CONTACT + 2] = 0.0;
    p[SHAFT_P_EIGENFREQUENCY] = sqrt(eigen(p, 0.0, shape, value));
}

static bool linear_view(const double *p, unsigned regime, struct linear *l)
{
    return shaft_linear(p, 0, l) && regime == 0;
}

static void climb(const double *p, const double *x, double *full_x)
{
    (void)p;
    memcpy(full_x, x, 6 * sizeof *x);
}

const struct model shaft_bearing_linear = {
    .name = "shaft_bearing_linear",
    .title = "shaft_bearing without gap springs; penetration tells when it has left its range",
    .n_contacts = 0,
    .prepare = prepare_linear,
    .rhs = shaft_bearing_rhs_open,
    .gap = model_no_gap,
    .flow = shaft_bearing_flow_open,
    .linear = linear_view,
    THREE_MASSES,
    .full = &shaft_bearing,
    .climb = climb,
};
