/* math.h - declarations of C99, for a cross compiler without a C library: make lib CROSS=.. compiles with
 * them. The firmware that links the library brings the functions. */
#ifndef LINKER_HOSTED_MATH_H
#define LINKER_HOSTED_MATH_H

#define NAN         __builtin_nanf("")
#define INFINITY    __builtin_inff()
#define isnan(x)    __builtin_isnan(x)
#define isfinite(x) __builtin_isfinite(x)

double sqrt(double x);
double fabs(double x);
float sqrtf(float x);
float fabsf(float x);
double floor(double x);
double ceil(double x);
double round(double x);
double fmod(double x, double y);
double fmin(double x, double y);
double fmax(double x, double y);

#endif
