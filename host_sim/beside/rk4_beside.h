/* rk4_beside.h - rk4 for several plants of one model side by side; see beside.h. */
#ifndef HOST_SIM_RK4_BESIDE_H
#define HOST_SIM_RK4_BESIDE_H

#include "firmware/method/method.h"

/* The function for plants of which no input but these sounds: of AVX2 where the processor has it. NULL: none
 * for this model, or no vectors of doubles. */
run_beside_function *rk4_bind_beside(const struct model *m, unsigned active);

/* By vectors that every processor of its kind has. */
run_beside_function *rk4_bind_beside_plain(const struct model *m, unsigned active);

#endif
