/* board_zcu102.c - Xilinx ZCU102 from its Cortex-R5F: console on UART0, bus on CAN0. The linker script has
 * the addresses; the boot loader has set clocks and pins. */
#include <stddef.h>
#include "hal/board/board.h"
#include "hal/board/board_can.h"
#include "hal/device/uart_cadence.h"
#include "hal/can/xilinx_can.h"

enum { UART_DIVIDER = 108 }; /* 115200 baud from 100 MHz */

extern uint32_t uart0[], can0[], can1[];

static struct xilinx_can controller[BOARD_CANS];

bool board_put(char c)
{
    static bool open;
    struct registers r = registers_words((uintptr_t)uart0);
    if (!open)
        uart_cadence_open(r, UART_DIVIDER);
    open = true;
    return uart_cadence_put(r, c);
}

const struct hal *board_can(int i, const char **why)
{
    const struct can_config c = {.timing = {10, 7, 2, 1}, /* 10 quanta of 100 ns, sampled after 8 */
                                 .base_id = BOARD_CAN_BASE,
                                 .restart_us = BOARD_CAN_RESTART_US,
                                 .now_us = board_hal_now_us};
    *why = xilinx_can_open(&controller[i], registers_words((uintptr_t)(i == 0 ? can0 : can1)), &c);
    return *why ? NULL : &controller[i].hal;
}

const struct can *board_can_counts(int i)
{
    return &controller[i].can;
}

const struct hal *board_bus(const char **why)
{
    return board_can(0, why);
}

/* The chip's watchdogs (SWDT of the low-power domain for this core) are not in QEMU's model of it: none is
 * driven. */
bool board_watch(void)
{
    return false;
}
