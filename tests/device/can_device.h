/* can_device.h - CAN controllers as their data sheets describe them, behind the drivers under test:
 * registers on one side, a wire on the other. Written from the data sheets alone; nothing here calls a
 * driver but open.
 *
 * A model counts as `illegal` each access that its data sheet forbids. Such are a register that only
 * configuration may change, a filter while it is in use, reserved bits, and a transmit buffer that is not
 * free. */
#ifndef TESTS_CAN_DEVICE_H
#define TESTS_CAN_DEVICE_H

#include <stdbool.h>
#include <stdint.h>
#include "hal/can/can.h"

/* A frame on the wire; dlc 9..15 have eight bytes. */
struct wire_frame {
    uint32_t id;
    bool extended, remote;
    uint8_t dlc;
    uint8_t data[8];
};

struct can_device {
    const char *name;
    struct hal *hal;
    struct can *can;
    uint32_t tx_depth; /* frames that wait to be sent at most, driver and controller together */
    uint32_t rx_depth; /* frames of eight bytes and 11 bits that the controller keeps */
    uint32_t *illegal;
    bool *stuck;       /* does not change its mode any more */
    bool *promiscuous; /* its filter lets everything through */
    const char *(*open)(
        const struct can_config *c); /* powers a new controller up and opens the driver on it */
    void (*arrive)(const struct wire_frame *f);
    bool (*leave)(struct wire_frame *f); /* the wire takes the next frame; false: none waits */
    void (*errors)(unsigned transmit, unsigned receive); /* its error counters now; 256 is bus-off */
    void (*idle)(void);                                  /* 128 times 11 recessive bits pass */
    void (*upset)(void);                                 /* falls back into configuration by itself */
};

extern const struct can_device xilinx_device, sja1000_device;
extern uint32_t can_device_us; /* the drivers' clock; set by the test */
uint32_t can_device_now(void *context);

/* An open must have said nothing. */
void can_device_check(const char *name, const char *why);

enum { CAN_DEVICE_BASE = 0x240, CAN_DEVICE_RESTART_US = 100000 };

/* That base, 1 Mbit/s from 16 MHz, that restart. */
extern const struct can_config can_device_config;

#endif
