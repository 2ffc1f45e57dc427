/* bench_time.h - clock and statistics for the programs that measure time. */
#ifndef TESTS_BENCH_TIME_H
#define TESTS_BENCH_TIME_H

/* Processor time of this program. */
double bench_time_ns(void);

/* The median of n values, which are sorted. */
double bench_time_median(double *x, int n);

#endif
