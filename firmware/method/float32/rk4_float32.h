/* rk4_float32.h - the coefficients of rk4_float32: the model's view in float and in deviations from rest.
 *
 * z = x - reference, the positions at rest without drives. A float has 24 bits. In a deviation they hold
 * the motion; in a position most of them would hold the preload. `lost` keeps the parts of the
 * coefficients that floats lose. Without them the plant would be off by up to 6e-8. A motion with little
 * damping would add that up over many periods. */
#ifndef FIRMWARE_RK4_FLOAT32_H
#define FIRMWARE_RK4_FLOAT32_H

#include "firmware/method/method.h"

enum { FLOAT32_HALF = MODEL_LINEAR_STATES / 2 };

/* struct hertz_form with eta = 1 + d:
 *   z'' = rest + sum (force_i u_i + drag_i u_i') - damping z' - stiffness d
 *         - (hertz + sum modulation_i u_i) g(d),
 *   d = side z + sum shift_i u_i,   g(d) = (1 + d)_+^{3/2} - 1. */
struct float32_law {
    float damping, stiffness, hertz;
};
struct float32_hertz {
    float side, rest;
    struct float32_law law, lost;
    float shift[MODEL_INPUTS], force[MODEL_INPUTS], drag[MODEL_INPUTS], modulation[MODEL_INPUTS];
};

/* Four numbers that follow the inputs: constant + sum (value_i u_i + rate_i u_i'). */
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

/* The coefficients of one model, of one of three kinds. */
struct float32_form {
    float h, h_rest; /* a whole tick, and what it loses as a float */
    unsigned rated;  /* bit i: the rate of input i has an effect */
    union {
        struct float32_hertz hertz;
        struct float32_polynomial polynomial;
        struct float32_linear linear;
    } of;
};

/* Scratch memory of the method. It ends behind the kind of form that the model has. */
struct float32_scratch {
    double reference[FLOAT32_HALF]; /* the positions at rest */
    double h;                       /* length of a tick */
    struct float32_form form;
};

#endif
