/* xilinx_model.h - the CAN controller of Zynq UltraScale+ after UG1085 and UG1087. */
#ifndef TESTS_XILINX_MODEL_H
#define TESTS_XILINX_MODEL_H

#include "hal/can/xilinx_can.h"
#include "tests/device/can_device.h"

enum { XILINX_FIFO = 64 };

struct xilinx_model {
    uint32_t reset, mode, prescaler, timing, filters, mask[4], id[4], enabled, events;
    unsigned tec, rec;
    uint32_t tx[XILINX_FIFO][4], rx[XILINX_FIFO][4], part[4], taken[4];
    unsigned n_tx, n_rx, n_part; /* words of a frame being written */
    unsigned joining;            /* looks until the bus was idle for 11 bits */
    bool off;                    /* bus-off */
    bool stuck, promiscuous, filter_busy;
    bool rx_stuck; /* says that a frame waits, always */
    uint32_t illegal;
};

extern struct xilinx_model xilinx_model;
extern struct xilinx_can xilinx_driver;

#endif
