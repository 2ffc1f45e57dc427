/* arithmetic.h - what the core asks of double arithmetic, operation by operation: on a board without an FPU for it every
 * one is a function of the compiler's, which must round to the nearest even and keep subnormals as an instruction does. */
#ifndef TESTS_ARITHMETIC_H
#define TESTS_ARITHMETIC_H

#include <stdint.h>

/* Hashes the results of + - * / sqrt, comparisons and conversions for `rounds` pairs of operands on from *random: any
 * bits, numbers that nearly cancel, subnormals, small integers. All NaN count as one. */
uint64_t arithmetic_hash(uint64_t *random, int rounds, uint64_t hash);

#endif
