/* choose_theory.h - tests of a reduced model that run nothing: linear theory, force laws, Floquet
 * multipliers. */
#ifndef HOST_SIM_CHOOSE_THEORY_H
#define HOST_SIM_CHOOSE_THEORY_H

#include "host_sim/choose/choose.h"

/* Largest difference of two force laws over compressions of rest +- amplitude, over the range of the
 * first. */
double choose_mismatch(const struct scene *full, const struct scene *candidate, double amplitude);

#endif
