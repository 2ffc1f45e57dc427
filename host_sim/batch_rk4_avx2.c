/* batch_rk4_avx2.c - batch_rk4.c for AVX2; see batch_kernels.h. */
#ifdef BATCH_AVX2
#define batch_rk4_plain batch_rk4_avx2
#include "host_sim/batch_rk4.c"
#endif
