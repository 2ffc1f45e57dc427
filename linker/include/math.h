/* math.h - for targets without a C library: what the core uses of it. With -fno-math-errno both are one instruction
 * where there is an FPU for double. */
#ifndef LINKER_MATH_H
#define LINKER_MATH_H

#define sqrt(x) __builtin_sqrt(x)
#define fabs(x) __builtin_fabs(x)
#define NAN     __builtin_nanf("")

#endif
