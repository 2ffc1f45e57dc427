/* batch_rk4_avx2.c - batch_rk4_steps.c for AVX2; see batch_rk4.h. */
#ifdef BATCH_AVX2
#define batch_rk4_plain batch_rk4_avx2
#include "host_sim/batch/batch_rk4_steps.c"
#endif
