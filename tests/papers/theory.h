/* theory.h - closed forms of the papers, with the errata of docs/reference/models.md: the averaged equation
 *
 *   z'' + damping z' + w2 z + quadratic z^2 + cubic z^3 + constant = drive cos omega t
 *
 * in the paper's coordinate, its amplitude at the drive's frequency to second order (multiple scales), and
 * Nayak's harmonic balance, heuristics and random theory. */
#ifndef TESTS_PAPERS_THEORY_H
#define TESTS_PAPERS_THEORY_H

#include <stdbool.h>
#include "models/model.h"

struct slow {
    double damping, w2, quadratic, cubic, constant;
};

/* Slow theory of an averaged model with these paper parameters, coordinate q = scale (x - 1). */
struct slow theory_slow(const struct model *averaged, const double *paper, double scale);

/* Real roots of c[0] + c[1] x + c[2] x^2 + c[3] x^3, ascending; how many (0..3). */
int theory_roots(const double *c, double *root);

/* Amplitudes at omega, ascending: one, or three of which
 * the middle one is unstable. Bichri et al. eqs 18, 24, 35. */
int theory_rig(const struct slow *s, double drive, double omega, double *amplitude);

/* Kirrou & Belhaq: w1, rho_n, rho_l of eq 18 and the amplitudes at the detuning of eq 21. */
struct tip_theory {
    double w1, rho_n, rho_l, damping;
};
struct tip_theory theory_tip(const struct slow *s);
int theory_tip_amplitude(const struct tip_theory *t, double drive, double detuning, double *amplitude);
/* Detuning at which the amplitude is `a`, on the side `sign` (1 above, -1 below) of the backbone: eq 21
 * solved for it. And where that side turns, if it does: amplitudes between which the motion is unstable,
 * ascending. */
double theory_tip_side(const struct tip_theory *t, double drive, double a, double sign);
bool theory_tip_turns(const struct tip_theory *t, double drive, double turn[2]);
/* Detuning and amplitude of the peak, f/(c w1); and the jumps: detunings between which there are three
 * amplitudes, low[0] < low[1]. False where there are none. */
double theory_tip_peak(const struct tip_theory *t, double drive, double *amplitude);
int theory_tip_jumps(const struct tip_theory *t, double drive, double jump[2]);

/* Slow frequency of the true, single-sided rig under a fast relative motion of amplitude `a` (in q; force:
 * a/W^2, base: a). It is the stiffness of the mean force <(1 + (2/3)(x + a cos))_+^{3/2}> where that
 * equals 1; *shift is x there. */
double theory_mean_force(double a, double *shift);

#endif
