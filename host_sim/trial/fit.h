/* fit.h - the harmonic part of a signal by weighted least squares:
 * x = mean + c cos + s sin, exact for such a signal.
 *
 * `contactplant test` measures by it at the frequency that its file names, over any window. A tone that is d
 * > 1 periods per window away leaks by at most 1/(pi d (d^2 - 1)) of its amplitude. LOCKIN on the bus is
 * firmware/observe/lockin_fit.h, which follows a drive and knows the other drives; a microscope's lock-ins
 * are firmware/afm/demodulator.h. */
#ifndef HOST_SIM_FIT_H
#define HOST_SIM_FIT_H

#include <stdbool.h>
#include <stdint.h>

/* Sums over the samples; all zero before the first one. */
struct fit {
    uint64_t n;
    double w, c, s, cc, ss, cs, x, xc, xs;
};

/* A sample at this phase, turns * 2^64, and at this place in the window, 0 to 1: there it has the weight of a
 * Hann window. */
void fit_add(struct fit *f, double place, uint64_t turns, double x);

/* Amplitude and phase in degrees, (-180, 180], of amplitude
 * * cos(turns + phase). False where the samples do not tell: they hold less than one period. */
bool fit_solve(const struct fit *f, double *amplitude, double *phase_deg);

#endif
