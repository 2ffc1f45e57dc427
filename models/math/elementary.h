/* elementary.h - sine, cosine, exp, log, cube root and arc tangent from + - * / sqrt alone: the same bits
 * everywhere.
 *
 * They are used at set-up, at commands, at contact switches and when a phasor is synchronised again, never in
 * each stage. A call costs 30 to 60 floating point operations. Errors are against the exact result;
 * tests/unit/models/test_elementary.c checks them. An argument outside the stated domain gives a finite value
 * as stated. */
#ifndef MODELS_ELEMENTARY_H
#define MODELS_ELEMENTARY_H

#include <stdint.h>

#define ELEMENTARY_PI 3.14159265358979323846

/* Cosine and sine of a phase in turns * 2^64: exact argument reduction. Absolute error <= 3e-16. About 30
 * flops. */
void cos_sin_turns(uint64_t turns, double *cosine, double *sine);

/* Cosine and sine of an angle in radians, |angle| <= 1e5. Absolute error <= 3e-16.
 * Beyond, and for a NaN: those of 0. */
void cos_sin(double radians, double *cosine, double *sine);

/* Turns * 2^64 of an angle in turns, any finite value: the fraction of `turns`, cut to 2^-64 of a turn.
 * 0 when not finite. */
uint64_t turns_of(double turns);

/* Signed turns in [-0.5, 0.5) of a phase in turns * 2^64, rounded to 53 bits. */
double turns_to_double(uint64_t turns);

/* Angle of the point (x, y), radians in (-pi, pi]; 0 at the origin and where an argument is not finite.
 * Absolute error <= 4e-16. */
double arc_tangent(double y, double x);

/* e^x for |x| <= 700, relative error <= 4e-16; beyond: 0 or the largest finite double. NaN: 0. */
double exponential(double x);

/* Natural logarithm of a normal x > 0, error <= 4e-16, relative or absolute, whichever is larger. For a
 * subnormal, zero, negative x or a NaN: -DBL_MAX; for infinity: 1024 ln 2. */
double logarithm(double x);

/* Cube root of any normal number, relative error <= 3e-16; 0 for any other. */
double cube_root(double x);

#endif
