/* packet.h - one cannelloni packet written by hand, its frames, and the comparison of frames. */
#ifndef TESTS_PACKET_H
#define TESTS_PACKET_H

#include <stdbool.h>
#include <stdint.h>
#include "hal/hal.h"

enum { PACKET_BYTES = 30, PACKET_FRAMES = 3, PACKET_SEQUENCE = 7 };

extern const uint8_t packet_golden[PACKET_BYTES];
extern const struct frame packet_frame[PACKET_FRAMES];

bool packet_same(const struct frame *a, const struct frame *b);

#endif
