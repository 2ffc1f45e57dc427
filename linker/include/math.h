/* math.h - for targets without a C library: what the core uses of it. With -fno-math-errno each is one instruction
 * where there is an FPU of that precision. */
#ifndef LINKER_MATH_H
#define LINKER_MATH_H

#define sqrt(x)  __builtin_sqrt(x)
#define fabs(x)  __builtin_fabs(x)
#define sqrtf(x) __builtin_sqrtf(x)
#define fabsf(x) __builtin_fabsf(x)
#define NAN      __builtin_nanf("")

#endif
