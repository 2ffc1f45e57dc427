/* afm_tip.h - the tip of an AFM cantilever on a Hertzian sample (Kirrou & Belhaq 2013, eqs 1, 2).
 *
 *   m x'' + c1 x' + k x = -s k0 (1 + u_stiffness) (z0 - x)_+^{3/2} + m g + F cos w t
 *
 * Delta is the static indentation z0 - xs, so that k (z0 - Delta) = -s k0 Delta^{3/2} + m g. State: eta and
 * its rate. The compression eta = (z0 - x)/Delta is 0 at first touch and positive into the contact. The
 * paper's u = (x - xs)/Delta is 1 - eta; its force F pulls away from the sample, so u_force = -f. Units:
 * Delta, forces in k Delta, time in 1/omega0 of the lever with omega0^2 = k/m. With beta = 3 k0
 * sqrt(Delta)/(2 k), c = c1/(m omega0):
 *
 *   eta'' = 1 + b - eta + u_force - c eta' - b (1 + u_stiffness) eta_+^{3/2},    b = -s (2/3) beta
 *
 * s = 1, the published sign: the contact pulls the tip in; eigenfrequency sqrt(1 - beta), beta < 1. Beyond
 * the saddle at
 *   eta = y^2, y = (1 - n + sqrt((1 - n)(1 + 3 n)))/(2 n), n = (2/3) beta
 * (2.1614, so u = -1.1614, at beta = 0.8)
 * the motion escapes to infinity in finite time, and the step reports that.
 *
 * s = -1, repulsive as a real sample: eigenfrequency sqrt(1 + beta), any beta. Contact is lost for eta < 0;
 * at rest eta = 1. */
#ifndef MODELS_AFM_TIP_H
#define MODELS_AFM_TIP_H

#include "models/hertz_contact.h"
#include "models/lanes.h"
#include "models/model.h"

extern const struct model afm_tip;

/* Inputs, SI parameters, the paper's parameters and prepared numbers, in the order of their tables. */
enum { TIP_FORCE, TIP_STIFFNESS, TIP_INPUTS };
enum {
    TIP_MASS,
    TIP_LEVER_STIFFNESS,
    TIP_DAMPING,
    TIP_CONTACT_STIFFNESS,
    TIP_INDENTATION,
    TIP_SIGN,
    TIP_PARAMETERS
};
enum {
    TIP_PAPER_BETA,
    TIP_PAPER_C,
    TIP_PAPER_R,
    TIP_PAPER_FAST_OMEGA,
    TIP_PAPER_F,
    TIP_PAPER_OMEGA,
    TIP_PAPER_PHI,
    TIP_PAPER_SIGN,
    TIP_PAPER
};
enum { TIP_P_DAMPING, TIP_P_HERTZ };

#define real       double
#define number     double
#define REAL(name) name
#include "models/afm_tip_text.h"
#undef real
#undef number
#undef REAL

/* ---- what the reduced models share with the full one ---- */

/* Rows of the SI parameter tables: the silicon lever of 51 x 1.5 x 262 um (30.09 kHz) of the paper's section
 * 3.3, on a polymer as that of afm_lever: k0 = (4/3) E* sqrt(R) with E* 1 GPa and R 10 nm. It rests 1 nm
 * deep, which takes 4.2 nN; beta is 15.7, and the contact resonance 122.8 kHz. */
#define AFM_TIP_PARAMETERS                                                                                   \
    {"mass_kg", "kg", 1e-18, 1.0, 1.13e-11, "effective mass of the lever"},                                  \
        {"lever_stiffness_N_per_m", "N/m", 1e-9, 1e9, 0.404, "stiffness of the lever"},                      \
        {"damping_N_s_per_m", "N s/m", 0.0, 1e6, 4.2733e-8, "viscous damping of the lever"},                 \
        {"stiffness_N_per_m1_5", "N/m^1.5", 1e-9, 1e18, 1.333e5, "Hertz constant k0 of F = k0 z^1.5"},       \
        {"indentation_m", "m", 1e-20, 1.0, 1e-9, "static indentation"},                                      \
    {                                                                                                        \
        "sign", "1", -1.0, 1.0, -1.0, "-1: the contact repels; 1: it attracts, as published"                 \
    }

extern const struct signal afm_tip_states[2], afm_tip_inputs[TIP_INPUTS];
extern const struct parameter afm_tip_parameters[TIP_PARAMETERS], afm_tip_paper[TIP_PAPER];

void afm_tip_prepare(const double *si, double *p, struct scale *scale);
const char *afm_tip_check(const double *si);
void afm_tip_from_paper(const double *paper, double *si, struct harmonic *drive);
void afm_tip_paper_state(const double *p, const struct input *u, const double *x, double *paper);
void afm_tip_state_from_paper(const double *p, const struct input *u, const double *paper, double *x);

#endif
