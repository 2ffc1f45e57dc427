/* afm_lever.h - an AFM lever of one to four beam modes, with heat, over a sample that attracts and repels.
 *
 * Sources: Butt & Jaschke 1995, Rabe et al. 1996 (beam, tip at the free end), Derjaguin, Muller & Toporov
 * 1975 (contact), Garcia 2010 (forces). Up is positive. Mode n has the deflection q_n of the tip, all modes
 * the same modal mass m:
 *
 *   q_n'' + (w_n/Q) q_n' + w_n^2 q_n = (F_ts + F_force + F_force_2)/m - G_n z'' + heat
 *   w_n = 2 pi f0 (beta_n/beta_1)^2,  m = k_1/w_1^2,  k_n = k beta_n^4/12
 *
 * z is the base. The modes left out are a massless spring between the last mode and the tip,
 * 1/k_res = (1 - sum_n 12/beta_n^4)/k. One mode alone is the point mass of textbooks: k_1 = k and no such
 * spring. With the gap d = height + z + sum q_n + F_ts/k_res between tip and sample:
 *
 *   d > a0:   F_ts = -H R/(6 d^2)
 *   d <= a0:  F_ts = -H R/(6 a0^2) + (4/3) E (1 + u_stiffness) sqrt(R) (a0 - d)^{3/2}
 *                    - eta sqrt(R (a0 - d)) d'
 *
 * H is hamaker_J on the way in and hamaker_out_J on the way out. The tip changes to the way out where it
 * turns back inside a0, and to the way in beyond release_m.
 *
 * Units: length range_m/30, time 1/w_1, mass m. Coordinates: y_n = q_n + G_n z and its rate, so that no
 * acceleration of the base is needed. State: y_1..y_4, branch (0 in, 1 out), y_1'..y_4', 0. */
#ifndef MODELS_AFM_LEVER_H
#define MODELS_AFM_LEVER_H

#include "models/model.h"

extern const struct model afm_lever;

/* Inputs, SI parameters and states, in the order of their tables. */
#define BOLTZMANN_J_PER_K 1.380649e-23

enum { LEVER_FORCE, LEVER_FORCE_2, LEVER_Z, LEVER_STIFFNESS, LEVER_INPUTS };
enum {
    LEVER_F0,
    LEVER_K,
    LEVER_Q,
    LEVER_TEMPERATURE,
    LEVER_MODES,
    LEVER_RADIUS,
    LEVER_HAMAKER,
    LEVER_HAMAKER_OUT,
    LEVER_A0,
    LEVER_RELEASE,
    LEVER_MODULUS,
    LEVER_VISCOSITY,
    LEVER_HEIGHT,
    LEVER_INDENTATION_MAX,
    LEVER_RANGE,
    LEVER_PERMANENT,
    LEVER_SEED,
    LEVER_PARAMETERS
};
/* The rows of their table: a microscope has them, too. The defaults are the lever of the preset `tapping`
 * over a polymer, without heat. */
/* clang-format off */
#define LEVER_ROWS \
    {"f0_Hz", "Hz", 10.0, 1e8, 70e3, "first eigenfrequency of the free lever"}, \
    {"stiffness_N_per_m", "N/m", 1e-4, 1e4, 2.0, "static stiffness of the lever at the tip"}, \
    {"quality", "1", 1.0, 1e6, 400.0, "quality factor of each mode"}, \
    {"temperature_K", "K", 0.0, 3000.0, 0.0, "temperature of the lever; 0: no thermal motion"}, \
    {"modes", "1", 1.0, MODEL_MODES, 1.0, "beam modes; 1: a point mass on a spring"}, \
    {"radius_m", "m", 1e-10, 1e-4, 10e-9, "radius of the tip"}, \
    {"hamaker_J", "J", 0.0, 1e-17, 6.4e-20, "Hamaker constant, on the way in"}, \
    {"hamaker_out_J", "J", 0.0, 1e-17, 6.4e-20, "Hamaker constant on the way out, at least hamaker_J"}, \
    {"a0_m", "m", 1e-11, 1e-8, 0.165e-9, "gap at which contact begins"}, \
    {"release_m", "m", 1e-10, 1e-3, 10e-9, "gap beyond which the way in begins anew"}, \
    {"modulus_Pa", "Pa", 1.0, 1e13, 1e9, "reduced modulus E of tip and sample"}, \
    {"viscosity_Pa_s", "Pa s", 0.0, 1e6, 0.0, "viscosity eta of the sample (Kelvin-Voigt)"}, \
    {"height_m", "m", -1e-3, 1e-2, 100e-9, "undeflected tip over the sample at z = 0"}, \
    {"indentation_max_m", "m", 1e-12, 1e-3, 5e-9, "largest indentation for which the step must do"}, \
    {"range_m", "m", 1e-9, 1e-2, 1e-6, "lengths up to this fit into the bus's 24 bits"}, \
    {"permanent_contact", "1", 0.0, 1.0, 0.0, "1: contact resonance, a corrected kick a tick; 0: tapping"}, \
    {"heat_seed", "1", 0.0, 4294967295.0, 0.0, "sequence of the thermal force"}
/* clang-format on */
enum { LEVER_DERIVED = 32 /* numbers that `prepare` makes, at most */ };
enum { LEVER_BRANCH = MODEL_MODES, LEVER_RATE, LEVER_STATES = 2 * LEVER_RATE };

/* Outputs beyond the four of every model. */
enum { LEVER_IN_CONTACT = 4, LEVER_GAP, LEVER_DEFLECTION, LEVER_POSITION, LEVER_BASE, LEVER_OUTPUTS };

/* The output `deflection` alone; z is that input, the others are silent. */
double afm_lever_deflection(const double *p, const struct input *z, const double *x);

/* Numbers of the clamped-free beam, for mode n = 0..3. */
struct beam_mode {
    double beta;   /* root of cos x cosh x = -1 */
    double sensor; /* slope at the tip per deflection, over that of the static beam under a force there */
    double base;   /* participation of the base's acceleration */
};
extern const struct beam_mode beam_modes[MODEL_MODES];

#endif
