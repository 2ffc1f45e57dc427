/* shaft_bearing.h - a flexible shaft of three masses on two bearings with radial clearance: piecewise linear.
 *
 *   M x'' + C x' + K x + f_gap = p,   M = diag(m1, m2, m3), C = diag(c1, c2, c3), kL = kappa/L^2,
 *   K = [[2 ks1 + kL, -2 kL, kL], [-2 kL, 4 kL, -2 kL], [kL, -2 kL, 2 ks3 + kL]],
 *   f_gap,i = kg_i (x_i - g_i) above g_i, kg_i (x_i + g_i) below -g_i, i = 1, 3
 *
 * This is the paper's eq 1; its eq 1b lacks the /L^2 of the coupling terms. The flexure acts through the
 * bending e = x1 - 2 x2 + x3 alone. Units: length g1, mass m1, stiffness kL; so the time is sqrt(m1/kL), the
 * force kL g1:
 *
 *   mu_i x_i'' = u_i - d_i x_i' - k_i x_i - (1, -2, 1)_i e - h_i over(x_i, g_i),
 *   k_i = 2 ks_i/kL, h_i = kg_i/kL, d_i = c_i/sqrt(kL m1), over(x, g) = (x - g)_+ - (-x - g)_+
 *
 * Contacts 0 and 1 are the positive and the negative side of bearing 1, contacts 2 and 3 those of bearing 3.
 * State: x1, x2, x3, v1, v2, v3. The paper's parameters and states are SI. With symmetric data a symmetric
 * motion stays symmetric to the last bit.
 *
 * shaft_bearing_linear has no gap springs.
 *
 * shaft_bearing_mode keeps one mode of the open shaft, x = phi q (Galerkin). The shape phi is scaled so that
 * the bearing that moves more moves by q, bearing 1 with its sign. Mode 1 is translation, 2 rotation, 3
 * bending. Gaps, springs, dampers and forces act as they do on that motion. */
#ifndef MODELS_SHAFT_BEARING_H
#define MODELS_SHAFT_BEARING_H

#include <math.h>
#include "models/lanes.h"
#include "models/model.h"

extern const struct model shaft_bearing, shaft_bearing_linear;

/* SI parameters, in the order of their table and of the first of the paper's. */
enum {
    SHAFT_M1,
    SHAFT_M2,
    SHAFT_M3,
    SHAFT_C1,
    SHAFT_C2,
    SHAFT_C3,
    SHAFT_KS1,
    SHAFT_KS3,
    SHAFT_KAPPA,
    SHAFT_LENGTH,
    SHAFT_G1,
    SHAFT_G3,
    SHAFT_KG1,
    SHAFT_KG3,
    SHAFT_PARAMETERS
};
enum { SHAFT_MODE = SHAFT_PARAMETERS, SHAFT_MODE_PARAMETERS };
enum { SHAFT_INPUTS = 3, SHAFT_CONTACTS = 4, SHAFT_OUTPUTS = 10 };

/* Prepared numbers. Arrays of three by mass; those of the middle mass without bearing are 0. */
enum {
    SHAFT_P_MASS = 0,
    SHAFT_P_INVERSE_MASS = 3,
    SHAFT_P_DAMPING = 6,
    SHAFT_P_SUPPORT = 9,
    SHAFT_P_CONTACT = 12,
    SHAFT_P_GAP = 15,
    SHAFT_P_EIGENFREQUENCY = 18,
    SHAFT_P_LENGTH_M,
    SHAFT_P_VELOCITY_M_PER_S,
    SHAFT_P_SHAPE, /* phi, of the mode */
    SHAFT_P_MODE_INVERSE_MASS = SHAFT_P_SHAPE + 3,
    SHAFT_P_MODE_STIFFNESS, /* stiffness of the mode while the gaps are open */
    SHAFT_P_MODE_DAMPING,
    SHAFT_NUMBERS
};

/* Inlined into each use: left alone, gcc would call them. */
#define SHAFT_INLINE static inline __attribute__((always_inline))

#define real       double
#define REAL(name) name
#include "models/shaft_text.h"
#undef real
#undef REAL

SHAFT_INLINE void shaft_bearing_gap(const double *p, const struct input *u, const double *x,
                                    struct input *gap)
{
    double g1 = p[SHAFT_P_GAP], g3 = p[SHAFT_P_GAP + 2];
    (void)u;
    gap[0] = (struct input){g1 - x[0], -x[3]};
    gap[1] = (struct input){g1 + x[0], x[3]};
    gap[2] = (struct input){g3 - x[2], -x[5]};
    gap[3] = (struct input){g3 + x[2], x[5]};
}

/* ---- one mode: positions phi_i q ---- */

SHAFT_INLINE void shaft_mode_gap(const double *p, const struct input *u, const double *x, struct input *gap)
{
    const double *phi = &p[SHAFT_P_SHAPE];
    const double full[6] = {phi[0] * x[0], 0.0, phi[2] * x[0], phi[0] * x[1], 0.0, phi[2] * x[1]};
    shaft_bearing_gap(p, u, full, gap);
}

#endif
