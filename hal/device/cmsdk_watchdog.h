/* cmsdk_watchdog.h - the APB watchdog of Arm's Cortex-M System Design Kit (Arm DDI 0479, chapter 4), as on
 * MPS2 boards.
 *
 * It counts down from LOAD. At zero it raises its interrupt, which is the NMI there, and counts down once
 * more; if that was not answered it resets the board at the second zero. All registers are locked but for
 * the two writes of a feed. */
#ifndef HAL_CMSDK_WATCHDOG_H
#define HAL_CMSDK_WATCHDOG_H

#include "hal/device/registers.h"

/* Starts it: without a feed the interrupt comes after `counts` of its clock, the reset after twice that. */
void cmsdk_watchdog_open(struct registers r, uint32_t counts);

/* Counts from LOAD again. */
void cmsdk_watchdog_feed(struct registers r);

#endif
