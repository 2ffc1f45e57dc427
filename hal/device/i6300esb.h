/* i6300esb.h - the watchdog of Intel's 6300ESB, a PCI function (Intel 300641, chapter 16), as a card of
 * QEMU's machines.
 *
 * It counts down twice and then resets the machine; the interrupt between the two is left off. */
#ifndef HAL_I6300ESB_H
#define HAL_I6300ESB_H

#include <stdbool.h>
#include <stdint.h>

/* Finds it on the PCI bus whose configuration space (ECAM) is at `config`, places its registers at
 * `memory` and starts it: a reset after `milliseconds` without a feed. False when there is none. */
bool i6300esb_open(uintptr_t config, uintptr_t memory, uint32_t milliseconds);

/* Counts from the beginning. */
void i6300esb_feed(uintptr_t memory);

#endif
