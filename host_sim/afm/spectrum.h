/* spectrum.h - power densities by Welch's method, and the resonance of an oscillator fitted to one. */
#ifndef HOST_SIM_SPECTRUM_H
#define HOST_SIM_SPECTRUM_H

#include <stdbool.h>
#include <stddef.h>

/* Welch 1967: means over segments of `length` samples (a power of 2) that overlap by half, each with a Hann
 * window and without its mean. */
struct spectrum {
    size_t length, filled; /* samples of a segment, and those that wait */
    double sample_s;
    double *waiting; /* [length] */
    double *density; /* [length/2 + 1], one-sided, unit^2/Hz: a sum until spectrum_finish */
    double *re, *im; /* [length] */
    size_t segments;
};

bool spectrum_init(struct spectrum *s, size_t length, double sample_s);
void spectrum_add(struct spectrum *s, double value);
void spectrum_finish(struct spectrum *s);
void spectrum_free(struct spectrum *s);

/* Frequency of bin i. */
double spectrum_frequency(const struct spectrum *s, size_t i);

/* S(f) = low f0^4/((f0^2 - f^2)^2 + (f0 f/Q)^2) + white: an oscillator and the noise of its sensor. */
struct resonance {
    double f0_Hz, quality, low, white;
};
double resonance_density(const struct resonance *r, double f_Hz);

/* The resonance around the largest value between two frequencies, with the largest likelihood for means of
 * periodograms (Whittle 1953): Fisher's scoring, white >= 0. False where there is none. */
bool spectrum_fit(const struct spectrum *s, double from_Hz, double to_Hz, struct resonance *r);

#endif
