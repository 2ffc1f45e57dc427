/* board_can.h - a board whose bus is CAN: its controllers, of which board_bus takes the first. A test puts
 * its own side on the second, on the same wires. */
#ifndef HAL_BOARD_CAN_H
#define HAL_BOARD_CAN_H

#include <stdint.h>
#include "hal/can/can.h"

enum { BOARD_CANS = 2, BOARD_CAN_BASE = 0x200, BOARD_CAN_RESTART_US = 100000 };

/* Controller i, opened for the identifiers from BOARD_CAN_BASE at 1 Mbit/s. NULL: *why says what is wrong. */
const struct hal *board_can(int i, const char **why);

/* The counters of controller i. */
const struct can *board_can_counts(int i);

#endif
