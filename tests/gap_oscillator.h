/* gap_oscillator.h - the simplest piecewise linear plant, in SI with unit scale, for tests of methods; and a plant with
 * its work memory.
 *
 *   x'' + 2 zeta x' + k x + kappa [(x - g)_+ - (-x - g)_+] = u_0 + u_1 + 2 zeta u_2' + k u_2
 *
 * Contact 0 is the gap above, contact 1 the gap below. */
#ifndef TESTS_GAP_OSCILLATOR_H
#define TESTS_GAP_OSCILLATOR_H

#include "firmware/plant.h"

enum { GAP_ZETA, GAP_K, GAP_KAPPA, GAP_G, GAP_PARAMETERS };
extern const struct model gap_oscillator;

struct gap_run {
    struct plant plant;
    double work[METHOD_WORK];
    int n_events;
};

/* Starts m with these SI parameters and drives (unit amplitudes in SI; NULL for none) at state x in model units. */
void gap_start(struct gap_run *r, const struct model *m, const struct method *method, const double *si,
               const struct harmonic *drive, double tick_s, const double *x);

/* Whole ticks; a plant that fails is a failed check. Each event goes to `seen` (NULL: none wanted) and is counted. */
void gap_advance(struct gap_run *r, uint64_t ticks,
                 void (*seen)(void *context, const struct plant *pl, const struct event *e), void *context);

#endif
