/* batch_kernels.h - the methods of batch.h as they are compiled: for what the compiler was told of the machine, and with
 * BATCH_AVX2 (the Makefile, on x86-64, whose default knows no AVX2) once more for AVX2. batch.c chooses at each call. The bits
 * are the same: batch_lanes.h. */
#ifndef HOST_SIM_BATCH_KERNELS_H
#define HOST_SIM_BATCH_KERNELS_H

#include "host_sim/batch.h"

const char *batch_rk4_plain(struct batch *b, int steps, int intervals, double *samples);
const char *batch_taylor_plain(struct batch *b, double tol, int intervals, double *samples);
const char *batch_rk4_avx2(struct batch *b, int steps, int intervals, double *samples);
const char *batch_taylor_avx2(struct batch *b, double tol, int intervals, double *samples);

#endif
