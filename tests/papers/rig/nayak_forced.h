/* nayak_forced.h - figures 6, 7 and 12 of Nayak 1972: responses to harmonic waviness. */
#ifndef TESTS_PAPERS_NAYAK_FORCED_H
#define TESTS_PAPERS_NAYAK_FORCED_H

#include "tests/papers/branch.h"

/* The branch of the model's motions of period 1 over the frequency. */
struct branch nayak_branch(double zeta, double xi0, double from, double to);

/* A stepped sweep of the model; from, to, tick, wait and look are left to set. */
struct sweep nayak_sweep(int swept, double zeta, int steps);

void nayak_draw_forced(void);

/* Numbers of the text without a chart (nayak_numbers.c). */
void nayak_tell_numbers(void);

#endif
