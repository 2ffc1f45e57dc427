/* math.h - for targets without a C library: what the core uses of it. With -fno-math-errno each is one
 * instruction where there is an FPU of that precision; an Arm processor without one for double takes
 * linker/soft_sqrt.c. */
#ifndef LINKER_MATH_H
#define LINKER_MATH_H

#if defined __arm__ && !(defined __ARM_FP && (__ARM_FP & 8))
#include "linker/soft_sqrt.h"
#define sqrt(x) soft_sqrt(x)
#else
#define sqrt(x) __builtin_sqrt(x)
#endif
#define fabs(x)  __builtin_fabs(x)
#define sqrtf(x) __builtin_sqrtf(x)
#define fabsf(x) __builtin_fabsf(x)
#define NAN      __builtin_nanf("")

#endif
