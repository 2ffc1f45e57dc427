/* afm_tip_reduced.h - the reduced models of the AFM tip.
 *
 * Symbols of models/afm_tip.h, in the paper's u = 1 - eta.
 *
 * afm_tip_linear is linear in state and inputs together:
 *   u'' + c u' + (1 - s beta) u + s (2/3) beta r cos W tau = f cos w tau
 * afm_tip_cubic (Kirrou & Belhaq eq 3) is valid for u < 1:
 *   u'' + c u' + (1 - s beta) u + s (beta/4) u^2 + s (beta/24) u^3
 *     + s r [(2/3) beta - beta u + (beta/4) u^2 + (beta/24) u^3] cos W tau = f cos w tau
 * afm_tip_averaged is the slow motion under the fast stiffness r cos W tau, a parameter here (direct
 * partition of motion). It holds in contact, for W of at least three times every slow frequency, and while
 * the unaveraged linear part is stable:
 *   z'' + c z' + w1^2 z + rho1 z^2 + rho2 z^3 + H = f cos w tau
 * with w1, rho1, rho2, H of docs/reference/models.md.
 *
 * Inputs, states, outputs and the paper's parameters are those of the full model. The averaged model has the
 * force only. */
#ifndef MODELS_AFM_TIP_REDUCED_H
#define MODELS_AFM_TIP_REDUCED_H

#include "models/afm_tip.h"

extern const struct model afm_tip_linear, afm_tip_cubic, afm_tip_averaged;

/* SI parameters of afm_tip_averaged after those of the tip. */
enum { TIP_FAST_HZ = TIP_PARAMETERS, TIP_FAST_STIFFNESS, TIP_AVERAGED_PARAMETERS };

#endif
