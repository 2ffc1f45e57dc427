/* polynomial.h - what the linear, cubic and averaged rungs of one degree of freedom share: no contact, no square root.
 *
 *   x'' = C(x) + sum_i (M_i(x) u_i + R_i u_i') - damping x',   C and M_i cubic polynomials in x.
 *
 * As in the full models x = 0 is the first touch and x = 1 the static compression, positive into the contact; a rung
 * knows nothing of the side beyond x = 0, where contact would be lost. A rung's prepare fills the numbers below. */
#ifndef MODELS_POLYNOMIAL_H
#define MODELS_POLYNOMIAL_H

#include "models/model.h"

/* Prepared numbers of such a rung. */
enum {
    POLYNOMIAL_DAMPING,
    POLYNOMIAL_C,                                   /* coefficients of C(x), constant first */
    POLYNOMIAL_M = POLYNOMIAL_C + 4,                /* of M_i(x), four for each input */
    POLYNOMIAL_R = POLYNOMIAL_M + 4 * MODEL_INPUTS, /* of each input's rate */
    POLYNOMIAL_LOAD = POLYNOMIAL_R + MODEL_INPUTS,  /* contact force = GAIN (LOAD - LEVER x - C(x) - */
    POLYNOMIAL_LEVER,          /*                 sum M_i u_i of inputs at the contact) */
    POLYNOMIAL_GAIN,           /* to the unit of force */
    POLYNOMIAL_BASE,           /* compression = x + BASE u of input BASE_INPUT */
    POLYNOMIAL_BASE_INPUT,     /* 0 when there is none */
    POLYNOMIAL_REST,           /* stable zero of C near 1; 0: none was found */
    POLYNOMIAL_EIGENFREQUENCY, /* sqrt(-C') there */
    POLYNOMIAL_NUMBERS
};

static inline double polynomial_at(const double *c, double x)
{
    return ((c[3] * x + c[2]) * x + c[1]) * x + c[0];
}

/* x'' without damping. */
static inline double polynomial_force(const double *p, const struct input *u, int n_inputs, double x)
{
    double force = polynomial_at(&p[POLYNOMIAL_C], x);
    for (int i = 0; i < n_inputs; i++)
        force += polynomial_at(&p[POLYNOMIAL_M + 4 * i], x) * u[i].value + p[POLYNOMIAL_R + i] * u[i].rate;
    return force;
}

static inline void polynomial_rhs(const double *p, const struct input *u, int n_inputs, const double *x,
                                  double *x_dot)
{
    x_dot[0] = x[1];
    x_dot[1] = polynomial_force(p, u, n_inputs, x[0]) - p[POLYNOMIAL_DAMPING] * x[1];
}

/* For prepare. All numbers to zero; a polynomial in the deviation x - 1 as one in x; then, with C in place, rest and
 * eigenfrequency (the root of C that Newton's method finds from x = 1). */
void polynomial_clear(double *p);
void polynomial_put(const double *deviation, double *c);
void polynomial_find_rest(double *p);

/* Members of struct model. */
enum { POLYNOMIAL_OUTPUTS = 4 };
extern const struct signal polynomial_outputs[POLYNOMIAL_OUTPUTS];
void polynomial_rest(const double *p, double *x);
double polynomial_eigenfrequency(const double *p);
/* Kinetic energy less the integral of C; what the inputs bring is work, not stored. */
double polynomial_energy(const double *p, const struct input *u, const double *x);
void polynomial_view(const double *p, struct polynomial_form *f);
/* Only for a rung without products of state and input. */
bool polynomial_linear(const double *p, unsigned regime, struct linear *l);

/* A full model with this state, the same. */
void polynomial_climb(const double *p, const double *x, double *full_x);

/* rhs, flow and output for 1, 2 and 4 inputs, of which the first 1, 1 and 2 are forces and the others act at the
 * contact. */
void polynomial_rhs_1(const double *p, const struct input *u, const double *x, double *x_dot);
void polynomial_rhs_2(const double *p, const struct input *u, const double *x, double *x_dot);
void polynomial_rhs_4(const double *p, const struct input *u, const double *x, double *x_dot);
void polynomial_flow_1(const double *p, const struct input *u, const double *x, struct flow *flow);
void polynomial_flow_2(const double *p, const struct input *u, const double *x, struct flow *flow);
void polynomial_flow_4(const double *p, const struct input *u, const double *x, struct flow *flow);
void polynomial_output_1(const double *p, const struct input *u, const double *x, double *output);
void polynomial_output_2(const double *p, const struct input *u, const double *x, double *output);
void polynomial_output_4(const double *p, const struct input *u, const double *x, double *output);

#endif
