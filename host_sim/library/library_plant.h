/* library_plant.h - a plant alone. */
#ifndef HOST_SIM_LIBRARY_PLANT_H
#define HOST_SIM_LIBRARY_PLANT_H

#include "host_sim/library/library.h"

/* An input of this plant; else noted. */
bool library_is_input(struct contactplant *p, int input);

#endif
