/* hertz_rig.h - a mass on a preloaded, single-sided Hertzian contact.
 *
 * Sources: Nayak 1972; Bichri, Belhaq & Perret-Liaudet 2011.
 *
 *   m z'' + c (z' - ze') + k (1 + u_stiffness) (z - ze)_+^{3/2} = N + F_force + F_fast
 *
 * z is the position of the mass, measured from first touch of the unloaded contact and positive into it; ze
 * is the displacement of the base. Units: the static compression zs = (N/k)^{2/3}, the preload N and the time
 * 1/nu with nu^2 = 3 N/(2 m zs). With xi = c/(2 m nu), y = z/zs, b = ze/zs and eta = y - b:
 *
 *   y'' = (2/3) (1 + u_force + u_fast - (1 + u_stiffness) eta_+^{3/2}) - 2 xi (y' - b')
 *
 * State: y, y'. Contact is lost for eta < 0; at rest y = 1. Bichri's q is (3/2)(y - 1). A force u_force is in
 * units of N, a base in units of zs, a stiffness relative. */
#ifndef MODELS_HERTZ_RIG_H
#define MODELS_HERTZ_RIG_H

#include "models/hertz_contact.h"
#include "models/lanes.h"
#include "models/model.h"

extern const struct model hertz_rig;

/* Inputs, SI parameters, the paper's parameters and prepared numbers, in the order of their tables. */
enum { RIG_FORCE, RIG_FAST_FORCE, RIG_BASE, RIG_STIFFNESS, RIG_INPUTS };
enum { RIG_MASS, RIG_CONTACT_STIFFNESS, RIG_PRELOAD, RIG_DAMPING, RIG_PARAMETERS };
enum {
    RIG_PAPER_XI,
    RIG_PAPER_SIGMA,
    RIG_PAPER_OMEGA,
    RIG_PAPER_PHI,
    RIG_PAPER_FAST_OMEGA,
    RIG_PAPER_FORCE,
    RIG_PAPER_BASE,
    RIG_PAPER_STIFFNESS,
    RIG_PAPER
};
enum { RIG_P_TWO_XI };

#define real       double
#define number     double
#define REAL(name) name
#include "models/hertz_rig_text.h"
#undef real
#undef number
#undef REAL

/* ---- what the reduced models and the rolling contact share with the rig ---- */

/* Rows of the SI parameter tables. The default rig: two steel bodies, contact resonance 230 Hz, preload about
 * the weight of the mass, 1 % damping. */
#define HERTZ_RIG_PARAMETERS(damper)                                                                         \
    {"mass_kg", "kg", 1e-9, 1e6, 6.5, "moving mass"},                                                        \
        {"stiffness_N_per_m1_5", "N/m^1.5", 1e-3, 1e18, 3.4e9, "Hertz constant k of F = k z^1.5"},           \
        {"preload_N", "N", 1e-9, 1e6, 64.0, "static normal load"},                                           \
    {                                                                                                        \
        "damping_N_s_per_m", "N s/m", 0.0, 1e6, 188.0, "viscous damping between mass and " damper            \
    }

extern const struct signal hertz_rig_states[2], hertz_rig_inputs[RIG_INPUTS], hertz_rig_outputs[5];
extern const struct parameter hertz_rig_parameters[RIG_PARAMETERS], hertz_rig_paper[RIG_PAPER];

void hertz_rig_prepare(const double *si, double *p, struct scale *scale);
const char *hertz_rig_check(const double *si);
void hertz_rig_from_paper(const double *paper, double *si, struct harmonic *drive);
/* SI parameters whose scale is 1, so that SI and model units are the same numbers. */
void hertz_rig_unit_scale(double damping_ratio, double *si);
void hertz_rig_paper_state(const double *p, const struct input *u, const double *x, double *paper);
void hertz_rig_state_from_paper(const double *p, const struct input *u, const double *paper, double *x);
/* x = 1, where the eigenfrequency of the contact is 1. */
void hertz_rig_rest(const double *p, double *x);
double hertz_rig_eigenfrequency(const double *p);

#endif
