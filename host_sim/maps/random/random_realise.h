/* random_realise.h - one realisation of a scene under noise: runs a plant and fills its row. */
#ifndef HOST_SIM_RANDOM_REALISE_H
#define HOST_SIM_RANDOM_REALISE_H

#include "host_sim/maps/random/random.h"

/* Computes realisation i over this time: row[random_columns]. NULL, or why the plant refuses. */
const char *random_realise(const struct random_runs *r, int i, double over, double *row);

#endif
