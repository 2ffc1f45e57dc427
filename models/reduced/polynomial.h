/* polynomial.h - the reduced models with a polynomial force (linear, cubic, averaged): no contact, no square
 * root.
 *
 *   x'' = C(x) + sum_i (M_i(x) u_i + R_i u_i') - damping x',   C and M_i cubic polynomials in x.
 *
 * As in the full models, x = 0 is the first touch and x = 1 the static compression, positive into the
 * contact. For x < 0 a full model loses contact; a reduced model does not, and so has left its range there:
 * its output `penetration` is negative. Its prepare fills the numbers below. */
#ifndef MODELS_POLYNOMIAL_H
#define MODELS_POLYNOMIAL_H

#include "models/model.h"

/* Prepared numbers of such a model. */
enum {
    POLYNOMIAL_DAMPING,
    POLYNOMIAL_C,                                   /* coefficients of C(x), constant first */
    POLYNOMIAL_M = POLYNOMIAL_C + 4,                /* coefficients of M_i(x), four for each input */
    POLYNOMIAL_R = POLYNOMIAL_M + 4 * MODEL_INPUTS, /* coefficient of each input's rate */
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

/* Inlined into each shape: left alone, gcc would call them. */
#define POLYNOMIAL_INLINE static inline __attribute__((always_inline))

/* The shape of a model, known when it is compiled. There are one or two forces, then up to two other inputs.
 *   degree    of C, 1 or 3
 *   n_forces  these inputs stand first; their M is constant and their R is 0
 *   n_inputs  with degree 1 the M of the others are constant; with degree 3 they are cubic, and the last of
 *             them is the contact's stiffness, whose R is 0. LEVER is then 0 beside two forces, 1 beside
 *             one
 *   silent    the first of two others is silent and left out */
struct polynomial_shape {
    int degree, n_forces, n_inputs;
    bool silent;
};

/* Is input i the contact's stiffness? */
#define POLYNOMIAL_STIFFNESS(s, i) ((s).degree == 3 && (i) == ((s).n_forces > 1 ? 3 : 1))

/* C(x) */
POLYNOMIAL_INLINE double polynomial_restore(struct polynomial_shape s, const double *p, double x)
{
    const double *c = &p[POLYNOMIAL_C];
    return s.degree == 1 ? c[1] * x + c[0] : polynomial_at(c, x);
}

/* LOAD - LEVER x - C(x), the contact's part of C. A relative change of its stiffness scales it: M = -this. */
POLYNOMIAL_INLINE double polynomial_contact(struct polynomial_shape s, const double *p, double x)
{
    double load = p[POLYNOMIAL_LOAD];
    if (s.n_forces == 1)
        load -= s.degree == 3 && s.n_inputs == 2 ? x : p[POLYNOMIAL_LEVER] * x;
    return load - polynomial_restore(s, p, x);
}

/* M_i(x) u_i */
POLYNOMIAL_INLINE double polynomial_product(struct polynomial_shape s, const double *p, const struct input *u,
                                            int i, double x)
{
    const double *m = &p[POLYNOMIAL_M + 4 * i];
    if (POLYNOMIAL_STIFFNESS(s, i))
        return -(polynomial_contact(s, p, x) * u[i].value);
    return (i < s.n_forces || s.degree == 1 ? m[0] : polynomial_at(m, x)) * u[i].value;
}

/* M_i(x) u_i + R_i u_i' */
POLYNOMIAL_INLINE double polynomial_push(struct polynomial_shape s, const double *p, const struct input *u,
                                         int i, double x)
{
    double product = polynomial_product(s, p, u, i, x);
    return i < s.n_forces || POLYNOMIAL_STIFFNESS(s, i) ? product : product + p[POLYNOMIAL_R + i] * u[i].rate;
}

POLYNOMIAL_INLINE void polynomial_rhs(struct polynomial_shape s, const double *p, const struct input *u,
                                      const double *x, double *x_dot)
{
    double force = polynomial_restore(s, p, x[0]) + polynomial_push(s, p, u, 0, x[0]);
    if (s.n_inputs > 1)
        force += polynomial_push(s, p, u, 1, x[0]);
    if (s.n_inputs > 2 && !s.silent)
        force += polynomial_push(s, p, u, 2, x[0]);
    if (s.n_inputs > 2)
        force += polynomial_push(s, p, u, 3, x[0]);
    x_dot[0] = x[1];
    x_dot[1] = force - p[POLYNOMIAL_DAMPING] * x[1];
}

/* The contact force, in units of force. */
POLYNOMIAL_INLINE double polynomial_contact_force(struct polynomial_shape s, const double *p,
                                                  const struct input *u, double x)
{
    double rest = polynomial_contact(s, p, x);
    if (s.n_forces < s.n_inputs && !s.silent)
        rest -= polynomial_product(s, p, u, s.n_forces, x);
    if (s.n_forces + 1 < s.n_inputs)
        rest -= polynomial_product(s, p, u, s.n_forces + 1, x);
    return p[POLYNOMIAL_GAIN] * rest;
}

POLYNOMIAL_INLINE void polynomial_flow(struct polynomial_shape s, const double *p, const struct input *u,
                                       const double *x, struct flow *f)
{
    polynomial_rhs(s, p, u, x, f->x_dot);
    f->work[0] = x[1] * polynomial_push(s, p, u, 0, x[0]);
    if (s.n_inputs > 1)
        f->work[1] = x[1] * polynomial_push(s, p, u, 1, x[0]);
    if (s.n_inputs > 2) {
        f->work[2] = s.silent ? 0.0 : x[1] * polynomial_push(s, p, u, 2, x[0]);
        f->work[3] = x[1] * polynomial_push(s, p, u, 3, x[0]);
    }
    f->damping = p[POLYNOMIAL_DAMPING] * x[1] * x[1];
    f->force = polynomial_contact_force(s, p, u, x[0]);
}

/* rhs and flow of a shape: members of struct model that instances.h inlines, too. */
#define POLYNOMIAL_KERNELS(name, ...)                                                                        \
    POLYNOMIAL_INLINE void polynomial_rhs_##name(const double *p, const struct input *u, const double *x,    \
                                                 double *x_dot)                                              \
    {                                                                                                        \
        polynomial_rhs((struct polynomial_shape){__VA_ARGS__}, p, u, x, x_dot);                              \
    }                                                                                                        \
    POLYNOMIAL_INLINE void polynomial_flow_##name(const double *p, const struct input *u, const double *x,   \
                                                  struct flow *f)                                            \
    {                                                                                                        \
        polynomial_flow((struct polynomial_shape){__VA_ARGS__}, p, u, x, f);                                 \
    }
POLYNOMIAL_KERNELS(linear_2, 1, 1, 2, false)
POLYNOMIAL_KERNELS(linear_4, 1, 2, 4, false)
POLYNOMIAL_KERNELS(cubic_2, 3, 1, 2, false)
POLYNOMIAL_KERNELS(cubic_4, 3, 2, 4, false)
/* For the first force alone, for both, and for both with the last input: the same bits without the silent
 * ones. */
POLYNOMIAL_KERNELS(linear_force, 1, 1, 1, false)
POLYNOMIAL_KERNELS(linear_forces, 1, 2, 2, false)
POLYNOMIAL_KERNELS(cubic_force, 3, 1, 1, false)
POLYNOMIAL_KERNELS(cubic_forces, 3, 2, 2, false)
POLYNOMIAL_KERNELS(linear_last, 1, 2, 4, true)
POLYNOMIAL_KERNELS(cubic_last, 3, 2, 4, true)

/* For prepare, in this order. First all numbers: these three, the others 0. */
void polynomial_begin(double *p, double damping, double load, double gain);
/* A polynomial in the deviation x - 1, constant first, as one in x. */
void polynomial_put(const double *deviation, double *c);
/* With C in place: rest (the zero of C that Newton's method finds from x = 1) and eigenfrequency. */
void polynomial_find_rest(double *p);

/* Members of struct model. */
enum { POLYNOMIAL_OUTPUTS = 4 };
extern const struct signal polynomial_outputs[POLYNOMIAL_OUTPUTS];
void polynomial_rest(const double *p, double *x);
double polynomial_eigenfrequency(const double *p);
/* Kinetic energy less the integral of C. The inputs bring work; they store nothing. */
double polynomial_energy(const double *p, const struct input *u, const double *x);
/* Only for a model with rhs and flow of one of the shapes above. */
void polynomial_view(const double *p, struct polynomial_form *f);
/* The degree of a model of this file: 1 if it has `linear`, else 3. 0 for any other model. */
__attribute__((pure)) int polynomial_degree(const struct model *m);
/* Only for a model without products of state and input. */
bool polynomial_linear(const double *p, unsigned regime, struct linear *l);

/* The state of the full model, which is the same. */
void polynomial_climb(const double *p, const double *x, double *full_x);

/* The common part of the initialisers of struct model. `shape` is one of the kernels above for this number of
 * inputs. Beside it stand name, title, prepare and what the model has of its family. */
#define POLYNOMIAL_MODEL(shape, inputs)                                                                      \
    .n_states = 2, .n_inputs = (inputs), .n_outputs = POLYNOMIAL_OUTPUTS, .n_contacts = 0,                   \
    .output_signal = polynomial_outputs, .rest = polynomial_rest,                                            \
    .eigenfrequency = polynomial_eigenfrequency, .rhs = polynomial_rhs_##shape, .gap = model_no_gap,         \
    .flow = polynomial_flow_##shape, .energy = polynomial_energy, .output = polynomial_output_##inputs,      \
    .polynomial_form = polynomial_view

/* For a reduced model of `family`: its tables and functions are family_states, family_check and so on, its
 * numbers FAMILY_PAPER and FAMILY_PARAMETERS. The second macro is for a model that has also the parameters,
 * the drives and the state of the full one. */
#define POLYNOMIAL_REDUCED(family, FAMILY, shape, inputs)                                                    \
    .full = &family, .n_paper = FAMILY##_PAPER, .state_signal = family##_states,                             \
    .input_signal = family##_inputs, .paper = family##_paper, .paper_state = family##_paper_state,           \
    .state_from_paper = family##_state_from_paper, POLYNOMIAL_MODEL(shape, inputs)
#define POLYNOMIAL_SAME_STATE(family, FAMILY, shape, inputs)                                                 \
    .n_parameters = FAMILY##_PARAMETERS, .parameter = family##_parameters, .check = family##_check,          \
    .from_paper = family##_from_paper, .climb = polynomial_climb,                                            \
    POLYNOMIAL_REDUCED(family, FAMILY, shape, inputs)

/* Outputs for 1, 2 and 4 inputs, of which the first 1, 1 and 2 are forces. */
void polynomial_output_1(const double *p, const struct input *u, const double *x, double *output);
void polynomial_output_2(const double *p, const struct input *u, const double *x, double *output);
void polynomial_output_4(const double *p, const struct input *u, const double *x, double *output);

#endif
