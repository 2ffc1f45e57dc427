/* loopback.h - a bus inside the process, for tests: what one port sends arrives at all others, in order.
 *
 * Like a real bus it has two bounds. A port takes `tx_limit` frames between two flushes and refuses the
 * rest (send returns 0). A receiver that does not read loses the frames that exceed its ring, the newest
 * first. recv reports HAL_DROPPED once the receiver has read the rest. No heap, no clock: time is what the
 * test says. */
#ifndef HAL_LOOPBACK_H
#define HAL_LOOPBACK_H

#include <stdint.h>
#include "hal/hal.h"

enum { LOOPBACK_PORTS = 4, LOOPBACK_RING = 512 };

struct loopback_bus;

struct loopback_port {
    struct hal hal; /* give this to an app or a client */
    struct loopback_bus *bus;
    struct frame ring[LOOPBACK_RING];
    uint32_t first, n; /* oldest waiting frame, and how many wait */
    uint32_t dropped;  /* frames lost since the last HAL_DROPPED */
    uint32_t tx_limit; /* frames taken between two flushes; set by the test, unlimited at first */
    uint32_t tx_taken;
    int fault;        /* hal_fault bits that the next recv reports once; set by the test */
    uint32_t healthy; /* calls of hal.healthy */
};

struct loopback_bus {
    uint32_t n_ports;
    uint32_t depth;  /* frames a receiver keeps, up to LOOPBACK_RING */
    uint32_t now_us; /* the clock of every port; set by the test */
    struct loopback_port port[LOOPBACK_PORTS];
};

/* Sets up a bus of 1..LOOPBACK_PORTS ports whose receivers keep 1..LOOPBACK_RING frames. Other numbers are
 * an error of the caller (assert). *bus must stay where it is.
 *
 *     loopback_init(&bus, 2, 64);
 *     app_init(&app, &config, &bus.port[0].hal);
 *     client_hal = &bus.port[1].hal; */
void loopback_init(struct loopback_bus *bus, uint32_t n_ports, uint32_t depth);

#endif
