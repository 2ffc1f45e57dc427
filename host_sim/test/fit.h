/* fit.h - the harmonic part of a signal at a frequency, beside the tones of drives, by weighted least
 * squares: x = mean + c cos + s sin + the tones, exact for such a signal.
 *
 * `contactplant test` measures by it at the frequency that its file names, over any window, from samples that
 * may have gaps. The equations are those of LOCKIN (firmware/observe/lockin_fit.h), whose tones are the
 * drives'. Any other tone that is d > 1 periods per window away leaks by at most 1/(pi d (d^2 - 1)) of its
 * amplitude. A microscope's lock-ins are firmware/afm/demodulator.h. */
#ifndef HOST_SIM_FIT_H
#define HOST_SIM_FIT_H

#include <stdint.h>
#include "firmware/observe/lockin_fit.h"

/* A drive at a sample. */
struct fit_drive {
    double cosine, sine; /* its phasor */
    double rate;         /* turns a tick; 0: it does not sound */
};

/* Sums over the samples; all zero before the first one. */
struct fit {
    uint64_t n;
    struct lockin_normal sums; /* the drives' tones, then that of the fit */
    struct {
        double least, most;
    } rate[MODEL_INPUTS]; /* while a drive sounds; 0: it never did */
};

/* A sample at this phase, turns * 2^64, and at this place in the window, 0 to 1: there it has the weight of a
 * Hann window. drive: [MODEL_INPUTS], or NULL where nothing is known of them. */
void fit_add(struct fit *f, double place, uint64_t turns, double x, const struct fit_drive *drive);

/* Amplitude and phase in degrees, (-180, 180], of amplitude * cos(turns + phase), from samples of a wave of
 * `rate` turns a tick over so many ticks. A drive of this frequency, or else the nearest one within a period
 * a window, is this wave. Other than LOCKIN_TOLD where the samples do not tell: they hold less than one
 * period, or another drive's tone is too near. */
enum lockin_verdict fit_solve(const struct fit *f, double rate, double ticks, double *amplitude,
                              double *phase_deg);

#endif
