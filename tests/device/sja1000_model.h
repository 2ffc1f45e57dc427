/* sja1000_model.h - the SJA1000 after its data sheet of 4 January 2000, PeliCAN mode. */
#ifndef TESTS_SJA1000_MODEL_H
#define TESTS_SJA1000_MODEL_H

#include "hal/can/sja1000.h"
#include "tests/device/can_device.h"

enum { SJA1000_FIFO = 64, SJA1000_FRAME = 13 };

struct sja1000_model {
    uint8_t mode, status, events, enabled, timing[2], output, clock, code[4], mask[4], tec, rec;
    uint8_t tx[SJA1000_FRAME];
    uint8_t fifo[SJA1000_FIFO];
    unsigned n_fifo;    /* bytes */
    unsigned idle_left; /* times 11 recessive bits until bus-off ends */
    bool pelican, sending;
    bool stuck, promiscuous;
    uint32_t illegal;
};

extern struct sja1000_model sja1000_model;
extern struct sja1000 sja1000_driver;

#endif
