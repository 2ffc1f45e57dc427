/* hertz_rig_reduced.h - the reduced models of the Hertz rig.
 *
 * Symbols of models/hertz_rig.h; d = y - 1, b is the base.
 *
 * hertz_rig_linear is linear in state and inputs together:
 *   y'' = (2/3) (u_force + u_fast - u_stiffness) - (d - b) - 2 xi (y' - b')
 * hertz_rig_cubic (Bichri et al. 2011 eqs 3, 21, 27) is linear in the base, and valid for 0 < eta:
 *   y'' = (2/3) (u_force + u_fast) - P - u_stiffness (2/3 + P) + (1 + d/2 - d^2/8 + d^3/16) b
 *         - 2 xi (y' - b'),
 *   P = d + d^2/4 - d^3/24
 * hertz_rig_averaged is the slow motion under one fast drive (direct partition of motion). The fast drive is
 * a parameter here, W = fast frequency/nu. The equation holds in contact, for W of at least three times every
 * slow frequency. In the paper's q:
 *   q'' + w2 q + 2 xi q' + b q^2 - g q^3 + G = (3/2) (2/3) u_force
 * with w2, b, g, G of docs/reference/models.md.
 *
 * Inputs, states, the outputs from displacement to contact_force and the paper's parameters are those of the
 * full rig. The averaged model has the slow force only. */
#ifndef MODELS_HERTZ_RIG_REDUCED_H
#define MODELS_HERTZ_RIG_REDUCED_H

#include "models/hertz_rig.h"
#include "models/reduced/polynomial.h"

extern const struct model hertz_rig_linear, hertz_rig_cubic, hertz_rig_averaged;

/* SI parameters of hertz_rig_averaged after those of the rig; amplitudes of the fast drive, at most one not
 * zero. */
enum {
    RIG_FAST_HZ = RIG_PARAMETERS,
    RIG_FAST_FORCE_N,
    RIG_FAST_BASE_M,
    RIG_FAST_STIFFNESS,
    RIG_AVERAGED_PARAMETERS
};

#endif
