/* mathieu.h - the linear oscillator with modulated stiffness, and what one period of the modulation does to it:
 *
 *   x'' + damping x' + (k0 + k1 cos(omega t)) x = 0,   (x, x') -> map (x, x') after 2 pi/omega.
 *
 * The eigenvalues of the map are the Floquet multipliers: beyond 1 in magnitude the rest position is unstable. A method
 * with its step is a map as well, with multipliers of its own. det(map) = exp(-damping 2 pi/omega) exactly. */
#ifndef TESTS_MATHIEU_H
#define TESTS_MATHIEU_H

#include <complex.h>
#include "firmware/method.h"
#include "tests/bench/classical.h"

struct mathieu {
    double damping, k0, k1, omega;
};

/* The map by a method of ours, the whole plant with its drive; n ticks a period. */
void mathieu_map(const struct mathieu *m, const struct method *method, double tol, int n, double map[2][2]);

/* The same by a classical method. */
void mathieu_classical(const struct mathieu *m, classical_step *step, int n, double map[2][2]);

/* Both multipliers, the one of larger magnitude first; of a pair, that with imaginary part > 0. */
void mathieu_multipliers(double map[2][2], double complex mu[2]);

#endif
