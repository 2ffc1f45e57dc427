/* fit.h - the harmonic part of a signal by least squares:
 * x = mean + c cos + s sin, exact for such a signal. */
#ifndef HOST_SIM_FIT_H
#define HOST_SIM_FIT_H

#include <stdbool.h>
#include <stdint.h>

/* Sums over the samples; all zero before the first one. */
struct fit {
    uint64_t n;
    double c, s, cc, ss, cs, x, xc, xs;
};

/* A sample at this phase, turns * 2^64. */
void fit_add(struct fit *f, uint64_t turns, double x);

/* Amplitude and phase in degrees, (-180, 180], of amplitude
 * * cos(turns + phase). False where the samples do not tell. */
bool fit_solve(const struct fit *f, double *amplitude, double *phase_deg);

#endif
