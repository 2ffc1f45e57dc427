/* rk4_float32.h - what rk4_float32 computes with: the model's view as float coefficients in deviations from rest.
 *
 * z = x - reference, the positions at rest without drives. A float keeps 24 bits of what it holds: of a deviation they are
 * digits of the motion, of a position most of them would be spent on the preload. What the coefficients that tune the plant
 * have lost as floats is kept beside them (lost): without it the plant would be another one, off by up to 6e-8, and a motion
 * with little damping would add that up over all the periods that it remembers. */
#ifndef FIRMWARE_RK4_FLOAT32_H
#define FIRMWARE_RK4_FLOAT32_H

#include "firmware/method/method.h"

enum { FLOAT32_HALF = MODEL_STATES / 2 };

/* struct hertz_form with eta = 1 + d:
 *   z'' = rest + sum (force_i u_i + drag_i u_i') - damping z' - stiffness d - (hertz + sum modulation_i u_i) g(d),
 *   d = side z + sum shift_i u_i,   g(d) = (1 + d)_+^{3/2} - 1. */
struct float32_law {
    float damping, stiffness, hertz;
};
struct float32_hertz {
    float side, rest;
    struct float32_law law, lost;
    float shift[MODEL_INPUTS], force[MODEL_INPUTS], drag[MODEL_INPUTS], modulation[MODEL_INPUTS];
};

/* What rest and inputs do to each of four numbers: constant + sum (value_i u_i + rate_i u_i'). */
struct float32_affine {
    float constant[4], value[MODEL_INPUTS][4], rate[MODEL_INPUTS][4];
};

/* struct polynomial_form in powers of z: the four coefficients. */
struct float32_polynomial {
    struct float32_affine coefficient;
    float damping, lost[4], lost_damping;
};

/* gap = constant + slope z[position]; below zero it pushes by push[i] times the gap on row i. */
struct float32_contact {
    float constant, slope, push[FLOAT32_HALF];
    int position;
};

/* struct linear, the contacts apart:
 *   z_i'' = drive_i + sum_i z_i + sum_j (couple_ij (z_j - z_i) + damp_ij z_j') + pushes.
 * Differences and row sums: a stiff coupling does not round away the soft support that it hides. */
struct float32_matrix {
    float sum[FLOAT32_HALF], couple[FLOAT32_HALF][FLOAT32_HALF], damp[FLOAT32_HALF][FLOAT32_HALF];
};
struct float32_linear {
    struct float32_affine drive;
    struct float32_matrix law, lost;
    int n_contacts;
    struct float32_contact contact[MODEL_CONTACTS];
};

/* What a step computes with. */
struct float32_form {
    float h, h_rest; /* a whole tick, and what it loses as a float */
    unsigned rated;  /* bit i: the rate of input i has an effect */
    union {
        struct float32_hertz hertz;
        struct float32_polynomial polynomial;
        struct float32_linear linear;
    } of;
};

/* What the method keeps in scratch memory. It ends with the kind of form that the model has. */
struct float32_scratch {
    double reference[FLOAT32_HALF]; /* the positions at rest */
    double h;                       /* length of a tick */
    struct float32_form form;
};

/* NULL, or why no form fits this model; then the form, without h (rk4_float32_forms.c). */
const char *rk4_float32_refuse_model(const struct model *m, const double *p);
void rk4_float32_prepare_form(const struct model *m, const double *p, double *reference,
                              struct float32_form *form);

#endif
