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

#include "models/lanes.h"
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

#define real       double
#define REAL(name) name
#include "models/reduced/polynomial_text.h"
#undef real
#undef REAL

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
/* The last six are for the first force alone, for both, and for both with the last input: the same bits
 * without the silent ones. */
#define POLYNOMIAL_SHAPES(X)                                                                                 \
    X(linear_2, 1, 1, 2, false)                                                                              \
    X(linear_4, 1, 2, 4, false)                                                                              \
    X(cubic_2, 3, 1, 2, false)                                                                               \
    X(cubic_4, 3, 2, 4, false)                                                                               \
    X(linear_force, 1, 1, 1, false)                                                                          \
    X(linear_forces, 1, 2, 2, false)                                                                         \
    X(cubic_force, 3, 1, 1, false)                                                                           \
    X(cubic_forces, 3, 2, 2, false)                                                                          \
    X(linear_last, 1, 2, 4, true)                                                                            \
    X(cubic_last, 3, 2, 4, true)
POLYNOMIAL_SHAPES(POLYNOMIAL_KERNELS)

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
