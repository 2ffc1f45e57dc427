/* fdcan_model.h - the FDCAN controller of STM32H7 after RM0433: registers and message RAM on one side, a wire
 * on the other.
 *
 * Where its pages leave something open, the model is as hard as they allow. A change of CCCR.INIT takes some
 * looks to read back. Other modes change only while CCE stays set. The message RAM holds garbage after
 * power-on. An access outside our part of it, to a register that is not there, or to a setting while CCE is
 * clear is counted as illegal. A classic controller that meets a CAN FD frame is taken to count a receive
 * error. */
#ifndef TESTS_FDCAN_MODEL_H
#define TESTS_FDCAN_MODEL_H

#include "tests/device/stm32_fdcan.h"
#include "tests/device/can_device.h"

enum { FDCAN_MODEL_REGISTERS = 0x100 / 4, FDCAN_MODEL_WORDS = STM32_FDCAN_RAM_BYTES / 4 };

struct fdcan_model {
    uint32_t reg[FDCAN_MODEL_REGISTERS]; /* settings, as written */
    uint32_t ram[FDCAN_MODEL_WORDS];
    uint32_t ram_offset; /* where the driver's part of the RAM begins */
    bool init, cce;      /* as they read back */
    bool wanted_init;    /* as written */
    unsigned looks;      /* at CCCR until init follows */
    uint32_t mode;       /* FDOE, BRSE, ASM, CSA of CCCR */
    uint32_t stuck_fill; /* bits of RXF0S that read as one */
    uint32_t stuck_full; /* bits of TXFQS that read as one */
    uint32_t get, n_rx;  /* receive FIFO 0 */
    uint32_t put, n_tx;  /* transmit FIFO: the next to be written, and those requested before it */
    unsigned tec, rec;
    bool off, recovering; /* bus-off; INIT was cleared since */
    bool exception;       /* PSR.PXE, until it is read */
    bool absent, stuck, promiscuous;
    uint32_t illegal, reads;
};

extern struct fdcan_model fdcan_model;
extern struct stm32_fdcan fdcan_driver;
extern const struct can_device stm32_fdcan_device;

/* Powers a new controller up and opens the driver on it. */
const char *fdcan_model_open(const struct stm32_fdcan_config *c);

/* A CAN FD frame of 64 bytes on the wire. */
void fdcan_model_arrive_fd(uint32_t id);

#endif
