/* rk4_beside.h - rk4 and the ledger for several plants of one model side by side; see beside.h. */
#ifndef HOST_SIM_RK4_BESIDE_H
#define HOST_SIM_RK4_BESIDE_H

#include "firmware/plant/plant_beside.h"

/* The function for plants of which no input but these sounds: of AVX2 where the processor has it. NULL: none
 * for this model, or no vectors of doubles. */
plant_sides_function *rk4_bind_sides(const struct model *m, unsigned active);

/* By vectors that every processor of its kind has. */
plant_sides_function *rk4_bind_sides_plain(const struct model *m, unsigned active);

#endif
