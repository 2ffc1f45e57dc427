/* physics.h - shared by the programs behind the charts of docs/why/failures.md. Each prints one CSV to
 * standard output. */
#ifndef TESTS_BENCH_PHYSICS_H
#define TESTS_BENCH_PHYSICS_H

#include <stddef.h>

/* The q-quantile of n numbers, 0 <= q <= 1; sorts them. */
double physics_quantile(double *x, int n, double q);

/* CPU time of this process, ns. */
double physics_now_ns(void);

#endif
