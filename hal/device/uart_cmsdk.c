/* uart_cmsdk.c - the UART of Arm's MPS2 boards, transmit only; see uart_cmsdk.h. */
#include "hal/device/uart_cmsdk.h"

/* Word offsets. */
enum { DATA = 0, STATE = 1, CONTROL = 2, DIVIDER = 4 };
enum { STATE_TX_FULL = 1 << 0, CONTROL_TX_ENABLE = 1 << 0 };

void uart_cmsdk_open(volatile uint32_t *registers, uint32_t divider)
{
    registers[DIVIDER] = divider;
    registers[CONTROL] = CONTROL_TX_ENABLE;
}

bool uart_cmsdk_put(volatile uint32_t *registers, char c)
{
    if (registers[STATE] & STATE_TX_FULL)
        return false;
    registers[DATA] = (uint8_t)c;
    return true;
}
