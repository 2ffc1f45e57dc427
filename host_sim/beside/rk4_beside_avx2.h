/* rk4_beside_avx2.h - rk4_beside.h for AVX2, with equal bits; there with BESIDE_AVX2 only. */
#ifndef HOST_SIM_RK4_BESIDE_AVX2_H
#define HOST_SIM_RK4_BESIDE_AVX2_H

#include "firmware/plant/plant_beside.h"

plant_sides_function *rk4_bind_sides_avx2(const struct model *m, unsigned active);

#endif
