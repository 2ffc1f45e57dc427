/* plant_parts.h - what the files of the plant share with each other and nobody else. */
#ifndef FIRMWARE_PLANT_PARTS_H
#define FIRMWARE_PLANT_PARTS_H

#include "firmware/plant.h"

/* The regime that follows from state, inputs and parameters: a contact is closed where its gap is negative. */
void plant_find_regime(struct plant *pl);

#endif
