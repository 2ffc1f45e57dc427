/* lan9118.h - SMSC LAN9118 Ethernet controller, polled: 100 or 10 Mbit/s full duplex, its own address and
 * broadcasts (data sheet DS 1.5, chapter 5). The MPS2 boards have its relative LAN9220, and QEMU models
 * it. */
#ifndef HAL_LAN9118_H
#define HAL_LAN9118_H

#include <stdbool.h>
#include <stdint.h>
#include "hal/ethernet/net.h"
#include "hal/device/registers.h"

struct lan9118 {
    struct ethernet ethernet; /* give this to net_open */
    struct registers registers;
    uint32_t dropped; /* frames lost for want of room */
    uint32_t damaged; /* frames that arrived with an error, or longer than ETHERNET_MAX */
};

/* Resets and starts the controller under this address. NULL, or what does not answer. *d must stay where
 * it is. */
const char *lan9118_open(struct lan9118 *d, struct registers registers, const uint8_t *mac);

#endif
