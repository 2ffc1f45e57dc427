/* uart_cadence.c - the Cadence UART of Zynq devices, transmit only; see uart_cadence.h. */
#include "hal/device/uart_cadence.h"

enum { CONTROL = 0x00, BAUD_GENERATOR = 0x18, STATUS = 0x2C, FIFO = 0x30, BAUD_DIVIDER = 0x34 };
enum { CONTROL_TX_ON = 1 << 4, CONTROL_RX_OFF = 1 << 3, STATUS_TX_FULL = 1 << 4, EIGHT = 7 };

void uart_cadence_open(struct registers registers, uint32_t divider)
{
    registers.write(registers.context, BAUD_GENERATOR, divider);
    registers.write(registers.context, BAUD_DIVIDER, EIGHT);
    registers.write(registers.context, CONTROL, CONTROL_TX_ON | CONTROL_RX_OFF);
}

bool uart_cadence_put(struct registers registers, char c)
{
    if (registers.read(registers.context, STATUS) & STATUS_TX_FULL)
        return false;
    registers.write(registers.context, FIFO, (uint8_t)c);
    return true;
}
