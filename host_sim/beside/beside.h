/* beside.h - plants of one model by one method side by side, in the lanes of vectors.
 *
 * The ticks of a plant are a chain of operations that wait for each other. Those of several plants are
 * independent. SIDES of them go through the same instructions, to the bits of rk4 and of the ledger. It is
 * there for x86-64, by AVX2 where the processor has it, and for the models of INSTANCES_BESIDE. */
#ifndef HOST_SIM_PLANTS_BESIDE_H
#define HOST_SIM_PLANTS_BESIDE_H

#include "firmware/plant/plant_beside.h"

plant_bind_sides beside_bind;

#endif
