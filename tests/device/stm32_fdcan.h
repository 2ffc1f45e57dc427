/* stm32_fdcan.h - a driver of the FDCAN controller of STM32H7 (Bosch M_CAN), polled: the worked example of
 * docs/guide/fdcan.md, to be copied, and no part of the product. The unit tests compile it and run it on a
 * model of the registers. IT HAS NEVER RUN ON HARDWARE. It was written after the register layout of ST
 * RM0433, chapter "FD Controller Area Network", as public headers show it; the manual itself was not at hand.
 * The model has the knowledge of the driver and no more. hal/can/can.h says what errors and bus-off do.
 *
 * MESSAGE RAM. The two controllers share 10240 bytes. This driver takes STM32_FDCAN_RAM of them from
 * ram_offset on: one filter element, a receive FIFO of 64 and a transmit FIFO of 32 elements of eight data
 * bytes. The RAM comes up with anything in it, and is accessed in words only.
 *
 * FILTER. One element, classic (identifier and mask), of the plant's format; everything else and remote
 * frames are rejected. The receive FIFO blocks when it is full: the oldest frames are kept, the loss is
 * reported.
 *
 * ORDER. A transmit FIFO, not a queue: frames go out in the order of the calls. Mode changes and bus-off drop
 * what waits.
 *
 * CAN FD. Frames of the plant are classic, sent and received. With `data` set the controller takes part in a
 * bus on which others use CAN FD: their frames are acknowledged and passed over. Without, it must not share a
 * bus with CAN FD.
 *
 * The board gives it its kernel clock (RCC), bypasses the clock calibration unit (FDCAN_CCU CCFG.BCC) and
 * sets up the pins. */
#ifndef TESTS_STM32_FDCAN_H
#define TESTS_STM32_FDCAN_H

#include "hal/can/can.h"
#include "hal/device/registers.h"

enum {
    STM32_FDCAN_RX = 64,          /* frames that wait to be received */
    STM32_FDCAN_TX = 32,          /* and to be sent */
    STM32_FDCAN_RAM = 1544,       /* bytes of message RAM that one controller takes */
    STM32_FDCAN_RAM_BYTES = 10240 /* that there are */
};

struct stm32_fdcan_config {
    struct can_config can; /* prescaler 1..512, segment1 2..255, segment2 2..128, jump 1..128 */
    /* Data phase of CAN FD: prescaler 1..32, segment1 1..32,
     * segment2 1..16, jump 1..16; prescaler 0: a classic bus. */
    struct can_timing data;
    uint32_t ram_offset; /* bytes, a multiple of 4 */
};

struct stm32_fdcan {
    struct hal hal; /* give this to the app */
    struct registers registers, ram;
    struct can can;
    struct can_timing data;
    uint32_t ram_offset;
    /* counters, as those of struct can */
    uint32_t fd_frames;           /* CAN FD among those passed over */
    uint32_t protocol_exceptions; /* looks that found a frame of a protocol yet to come */
};

/* registers: FDCAN1 or FDCAN2; ram: the message RAM from its beginning, words both. NULL, or what is wrong.
 * *d must stay where it is. */
const char *stm32_fdcan_open(struct stm32_fdcan *d, struct registers registers, struct registers ram,
                             const struct stm32_fdcan_config *c);

#endif
