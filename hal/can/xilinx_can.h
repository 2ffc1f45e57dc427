/* xilinx_can.h - the CAN controller of Zynq-7000 and Zynq UltraScale+, polled (Xilinx UG1085, chapter "CAN
 * Controller"; UG1087 for the registers). hal/can/can.h says what errors and bus-off do.
 *
 * Transmit and receive FIFO hold 64 frames each: with a frame a millisecond at 1 Mbit/s neither fills. The
 * acceptance filter compares base identifier, format and remote bit, so that nothing else takes room. The
 * high-priority buffer is not used: it would overtake the FIFO. Order is that of the calls.
 *
 * Data byte 0 is bits 31..24 of the first data word. QEMU has it in bits 7..0 and puts the identifier word
 * on its bus as it stands: two of these controllers understand each other there, another kind would not. */
#ifndef HAL_XILINX_CAN_H
#define HAL_XILINX_CAN_H

#include "hal/can/can.h"
#include "hal/device/registers.h"

struct xilinx_can {
    struct hal hal; /* give this to the app */
    struct registers registers;
    struct can can;
    uint16_t received_stamp; /* the controller's free-running 16 bits when the last frame came */
};

/* Prescaler 1..256, segment1 1..16, segment2 1..8, jump 1..4. NULL, or what is wrong. *d must stay where
 * it is. */
const char *xilinx_can_open(struct xilinx_can *d, struct registers registers, const struct can_config *c);

#endif
