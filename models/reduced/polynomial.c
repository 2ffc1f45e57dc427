/* polynomial.c - the common functions of the reduced models with a polynomial force; see polynomial.h. */
#include "models/reduced/polynomial.h"

#include <math.h>
#include <string.h>

const struct signal polynomial_outputs[POLYNOMIAL_OUTPUTS] = {
    {"displacement", "m", "mass position from first touch, positive into the contact", QUANTITY_LENGTH, NULL},
    {"velocity", "m/s", "mass velocity", QUANTITY_VELOCITY, NULL},
    {"penetration", "m", "compression of the contact; below 0 this model has left its range", QUANTITY_LENGTH,
     NULL},
    {"contact_force", "N", "contact force as this model has it", QUANTITY_FORCE, NULL},
};

/* ---- prepare ---- */

void polynomial_begin(double *p, double damping, double load, double gain)
{
    memset(p, 0, POLYNOMIAL_NUMBERS * sizeof *p);
    p[POLYNOMIAL_DAMPING] = damping;
    p[POLYNOMIAL_LOAD] = load;
    p[POLYNOMIAL_GAIN] = gain;
}

void polynomial_put(const double *d, double *c)
{
    c[0] = d[0] - d[1] + d[2] - d[3];
    c[1] = d[1] - 2.0 * d[2] + 3.0 * d[3];
    c[2] = d[2] - 3.0 * d[3];
    c[3] = d[3];
}

static double slope_at(const double *c, double x)
{
    return (3.0 * c[3] * x + 2.0 * c[2]) * x + c[1];
}

void polynomial_find_rest(double *p)
{
    enum { ITERATIONS = 50 };
    const double *c = &p[POLYNOMIAL_C];
    double x = 1.0, slope = slope_at(c, x), move = 1.0;
    for (int i = 0; i < ITERATIONS && slope < 0.0 && fabs(move) > 1e-15; i++) {
        move = polynomial_at(c, x) / slope;
        x -= move;
        slope = slope_at(c, x);
    }
    bool found = slope < 0.0 && fabs(move) <= 1e-9 && x > 0.0;
    p[POLYNOMIAL_REST] = found ? x : 0.0;
    p[POLYNOMIAL_EIGENFREQUENCY] = found ? sqrt(-slope) : 1.0;
}

/* ---- members of struct model ---- */

void polynomial_rest(const double *p, double *x)
{
    x[0] = p[POLYNOMIAL_REST];
    x[1] = 0.0;
}

void polynomial_climb(const double *p, const double *x, double *full_x)
{
    (void)p;
    full_x[0] = x[0];
    full_x[1] = x[1];
}

double polynomial_eigenfrequency(const double *p)
{
    return p[POLYNOMIAL_EIGENFREQUENCY];
}

double polynomial_energy(const double *p, const struct input *u, const double *x)
{
    const double *c = &p[POLYNOMIAL_C];
    const double integral[4] = {c[0], 0.5 * c[1], c[2] / 3.0, 0.25 * c[3]};
    (void)u;
    return 0.5 * x[1] * x[1] - x[0] * polynomial_at(integral, x[0]);
}

void polynomial_view(const double *p, struct polynomial_form *f)
{
    *f = (struct polynomial_form){.damping = p[POLYNOMIAL_DAMPING]};
    for (int k = 0; k < 4; k++) {
        f->constant[k] = p[POLYNOMIAL_C + k];
        for (int i = 0; i < MODEL_INPUTS; i++)
            f->modulation[k][i] = p[POLYNOMIAL_M + 4 * i + k];
    }
    for (int i = 0; i < MODEL_INPUTS; i++)
        f->rate[0][i] = p[POLYNOMIAL_R + i];
}

int polynomial_degree(const struct model *m)
{
    if (m->polynomial_form != polynomial_view)
        return 0;
    return m->linear ? 1 : 3;
}

bool polynomial_linear(const double *p, unsigned regime, struct linear *l)
{
    *l = (struct linear){.a = {{0.0, 1.0}, {p[POLYNOMIAL_C + 1], -p[POLYNOMIAL_DAMPING]}},
                         .c = {0.0, p[POLYNOMIAL_C]}};
    for (int i = 0; i < MODEL_INPUTS; i++) {
        l->b[1][i] = p[POLYNOMIAL_M + 4 * i];
        l->b_rate[1][i] = p[POLYNOMIAL_R + i];
    }
    return regime == 0;
}

/* For both degrees: the further coefficients of a linear model are 0. */
static void output(const double *p, const struct input *u, int n_forces, int n_inputs, const double *x,
                   double *out)
{
    double contact = p[POLYNOMIAL_LOAD] - p[POLYNOMIAL_LEVER] * x[0] - polynomial_at(&p[POLYNOMIAL_C], x[0]);
    for (int i = n_forces; i < n_inputs; i++)
        contact -= polynomial_at(&p[POLYNOMIAL_M + 4 * i], x[0]) * u[i].value;
    out[0] = x[0];
    out[1] = x[1];
    out[2] = x[0] + p[POLYNOMIAL_BASE] * u[(int)p[POLYNOMIAL_BASE_INPUT]].value;
    out[3] = p[POLYNOMIAL_GAIN] * contact;
}

/* ---- by number of inputs ---- */

void polynomial_output_1(const double *p, const struct input *u, const double *x, double *out)
{
    output(p, u, 1, 1, x, out);
}

void polynomial_output_2(const double *p, const struct input *u, const double *x, double *out)
{
    output(p, u, 1, 2, x, out);
}

void polynomial_output_4(const double *p, const struct input *u, const double *x, double *out)
{
    output(p, u, 2, 4, x, out);
}
