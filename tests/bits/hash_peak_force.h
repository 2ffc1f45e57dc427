/* hash_peak_force.h - peak force tapping on a hot lever with a noisy sensor: the same bits on every compiler
 * and target, as tests/bits/hash_run.h for plants. */
#ifndef TESTS_HASH_PEAK_FORCE_H
#define TESTS_HASH_PEAK_FORCE_H

#include <stdint.h>

/* Calls `block` after each of so many cycles with the hash of all results so far and of the microscope. NULL,
 * or why it stopped. */
const char *hash_peak_force(int cycles, void (*block)(uint32_t hash));

#endif
