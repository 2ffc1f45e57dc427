/* rk4_beside_avx2.c - rk4_beside.c for AVX2. */
#ifdef BESIDE_AVX2
#define BESIDE_COPY
#define rk4_bind_sides_plain rk4_bind_sides_avx2
#include "host_sim/beside/rk4_beside.c"
#endif
