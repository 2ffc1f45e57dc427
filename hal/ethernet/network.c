/* network.c - the addresses of this site, a section of its own (`.network`): edit them here, or write
 * other ones into an image that is built (`objcopy --update-section .network=FILE`, struct net_config byte
 * for byte).
 *
 * As they stand: QEMU's user network, whose 10.0.2.2 is the machine it runs on, with the ports of a host's
 * plant: 20000, and for its controller, a monitor and contactplant send 20001 to 20003. */
#include "hal/ethernet/network.h"

__attribute__((section(".network"))) const struct net_config network = {
    .self = {{0x52, 0x54, 0x00, 0x12, 0x34, 0x56}, {{10, 0, 2, 15}, {0x4E, 0x20}}},
    .n_peers = 3,
    .peer = {{{10, 0, 2, 2}, {0x4E, 0x21}}, {{10, 0, 2, 2}, {0x4E, 0x22}}, {{10, 0, 2, 2}, {0x4E, 0x23}}},
};
