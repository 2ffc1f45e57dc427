/* arithmetic.h - checks of the double arithmetic that the core needs, operation by operation.
 *
 * On a board whose FPU has no doubles each operation is a function of the compiler's. It must round to the
 * nearest even and keep subnormals, as an instruction does. */
#ifndef TESTS_ARITHMETIC_H
#define TESTS_ARITHMETIC_H

#include <stdint.h>

/* Hashes the results of + - * / sqrt, comparisons and conversions for `rounds` pairs of operands on from
 * *random: any bits, numbers that nearly cancel, subnormals, small integers. All NaN count as one. */
uint64_t arithmetic_hash(uint64_t *random, int rounds, uint64_t hash);

#endif
