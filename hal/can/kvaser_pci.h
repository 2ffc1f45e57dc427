/* kvaser_pci.h - finds Kvaser PCIcan cards on PCI bus 0 and gives their first SJA1000 (AMCC S5920 data
 * book; the layout of the card is that of Linux's driver). Three I/O ranges: the bridge, the controllers,
 * an FPGA that is not needed. */
#ifndef HAL_KVASER_PCI_H
#define HAL_KVASER_PCI_H

#include <stdbool.h>
#include "hal/device/registers.h"

enum { KVASER_PCI_OUTPUT = 0xDA }; /* OCR of its SJA1000: push-pull, TX1 inverted */

/* Opens card i (from 0) of the bus whose configuration space (ECAM) is at `config`. Places its ranges in
 * the I/O window at `io`, enables its interrupt, and gives the registers of its SJA1000. False when the
 * bus has fewer cards. */
bool kvaser_pci_open(int i, uintptr_t config, uintptr_t io, struct registers *sja1000);

#endif
