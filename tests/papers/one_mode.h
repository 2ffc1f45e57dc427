/* one_mode.h - the shaft with one mode kept (shaft_bearing_mode), which stands for it in the charts of
 * docs/papers/shaft.md: integrated, and averaged. */
#ifndef TESTS_PAPERS_ONE_MODE_H
#define TESTS_PAPERS_ONE_MODE_H

#include "tests/papers/attractor.h"

/* attractor_open of the model that keeps `mode` (1
 * translation, 2 rotation, 3 bending) of these parameters. */
bool one_mode_open(struct attractor_shaft *s, const double *paper, int mode);

/* The start of attractor_start as the model of one mode has it: x1 and its rate. */
void one_mode_start(uint64_t *seed, double span, double *state);

/* ---- averaged: harmonic balance of one harmonic, q = a cos(w t + phase) ----
 *   ((K + sum_i phi_i^2 kg_i N(phi_i a, g_i)) - M w^2)^2 + (C w)^2 = (F/a)^2, SI units. */
struct one_mode {
    double mass, stiffness, damping, force;
    double shape[3], contact[3], gap[3]; /* contact and gap of the middle: 0 */
};
struct one_mode one_mode_of(const double *paper, int mode);

/* N(a, g): the part of a gap spring's stiffness that a motion
 * of amplitude a feels, 0 within the gap, 1 for a without end. */
double one_mode_share(double amplitude, double gap);

/* The amplitude of q that just reaches a gap. */
double one_mode_reach(const struct one_mode *m);

/* The forcing frequencies, Hz, falling, at which the averaged
 * motion has this amplitude of q: how many, at most 2. */
int one_mode_balance(const struct one_mode *m, double amplitude, double hz[2]);

/* The amplitudes of q at a forcing frequency, rising: how many, at most 3. */
int one_mode_amplitudes(const struct one_mode *m, double hz, double amplitude[3]);

/* The largest amplitude of q, and its frequency: where the balance has one frequency only. */
double one_mode_peak(const struct one_mode *m, double *hz);

#endif
