/* batch_taylor_avx2.h - batch_taylor_plain for AVX2, with equal bits; there with BATCH_AVX2 only. */
#ifndef HOST_SIM_BATCH_TAYLOR_AVX2_H
#define HOST_SIM_BATCH_TAYLOR_AVX2_H

#include "host_sim/batch/batch_taylor.h"

const char *batch_taylor_avx2(struct batch_taylor *b, double tol, int intervals, double *samples);

#endif
