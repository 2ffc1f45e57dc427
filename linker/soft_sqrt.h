/* soft_sqrt.h - square root in double for processors whose FPU is single precision, the same bits as an
 * instruction. */
#ifndef LINKER_SOFT_SQRT_H
#define LINKER_SOFT_SQRT_H

/* Correctly rounded (IEEE 754, to nearest even), subnormals included; -0 is -0, NaN and what is below zero
 * give NaN. Calls nothing. */
double soft_sqrt(double x);

#endif
