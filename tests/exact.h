/* exact.h - phases and waves in extended precision, and a generator of test numbers, for tests. */
#ifndef TESTS_EXACT_H
#define TESTS_EXACT_H

#include <stdint.h>
#include "firmware/method.h"

#define EXACT_TURN 6.283185307179586476925286766559005768L

/* Radians of a phase in turns * 2^64. */
long double exact_angle(uint64_t turns);

/* n times a frequency in (0, 0.5) turns, in turns * 2^64, by 128-bit arithmetic on the double's own digits. */
uint64_t exact_phase(double turns_per_tick, uint64_t n);

/* The wave's formula (firmware/method.h) at model time s, and its derivative by a central difference. */
long double exact_wave(const struct wave *w, long double s);
long double exact_wave_rate(const struct wave *w, long double s);

/* *max becomes at least |error|; a NaN stays. */
void exact_worst(double *max, long double error);

/* The next number in [0, 1) of a deterministic sequence. */
double exact_uniform(uint64_t *seed);

#endif
