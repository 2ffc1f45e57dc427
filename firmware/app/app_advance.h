/* app_advance.h - plant time in a frame: fires and samples at their instants, ticks, lock-in, capture,
 * watch and sensors. */
#ifndef FIRMWARE_APP_ADVANCE_H
#define FIRMWARE_APP_ADVANCE_H

#include <stdint.h>
#include "firmware/plant/plant_beside.h"

struct app;

/* Advances plant time by one frame, and by the a->skip frames that overrun policy `skip` makes up for.
 * Returns how many plant frames it began: 0 unless the plant is RUNNING or stepping. A state that leaves
 * the finite numbers latches FAULT_NOT_FINITE and ends the frame. A bound on switches or on the method's
 * work in a tick that was reached latches FAULT_BUDGET. */
uint32_t app_advance(struct app *a);

/* app_advance for n apps, at most SIDES, to the same bits; advanced[n] is what it would return. Their plants
 * go side by side where they may. */
void app_advance_beside(struct app *const *a, uint32_t n, plant_bind_sides *bind, uint32_t *advanced);

#endif
