/* app_advance.h - plant time in a frame: fires and samples at their instants, ticks, lock-in, capture, watch and sensors. */
#ifndef FIRMWARE_APP_ADVANCE_H
#define FIRMWARE_APP_ADVANCE_H

#include <stdint.h>

struct app;

/* The plant's share of a bus frame, and frames to make up for. Returns how many plant frames plant time moved. */
uint32_t app_advance(struct app *a);

#endif
