/* adams_wave.h - the inputs' share in a tick of `adams`. */
#ifndef FIRMWARE_ADAMS_WAVE_H
#define FIRMWARE_ADAMS_WAVE_H

#include "firmware/method/adams/adams.h"

/* By a force that begins at `value` and has a slope. */
ALWAYS_INLINE adams_pair adams_push_steady(double h, double value, double slope)
{
    return (adams_pair){0.5 * h * h * (value + h * slope * (1.0 / 3.0)), h * (value + 0.5 * h * slope)};
}

/* The series of the functions below, once for all. */
void adams_prepare_series(struct adams *s);

struct complex {
    double re, im;
};

/* exp(i z), and M_k, the integrals of t^k exp(i z t) over 0 <= t <= 1, for |z| up to pi. */
void adams_moments(const struct adams *s, double z, struct complex *e, struct complex m[3]);

/* The active inputs, their waves and their push in a tick. A wave that only turns on keeps its response. */
void adams_take_waves(struct adams *s, const struct segment *e);

/* Their push in a span of any length that begins with the segment. */
void adams_push_for(const struct adams *s, double length, struct adams_push *push);

#endif
