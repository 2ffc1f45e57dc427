/* uart_16550.c - a 16550 UART, transmit only; see uart_16550.h. */
#include "hal/device/uart_16550.h"

/* With LINE_DIVIDER set, the first two registers are the divider's low and high byte. */
enum { DATA = 0, EVENTS_ENABLED = 1, FIFO = 2, LINE = 3, STATUS = 5 };
enum { FIFO_ON = 1, LINE_8_BITS = 3, LINE_DIVIDER = 0x80, STATUS_TX_EMPTY = 0x20 };

void uart_16550_open(struct registers registers, uint16_t divider)
{
    registers.write(registers.context, EVENTS_ENABLED, 0);
    registers.write(registers.context, LINE, LINE_DIVIDER | LINE_8_BITS);
    registers.write(registers.context, DATA, divider & 0xFF);
    registers.write(registers.context, EVENTS_ENABLED, (uint32_t)divider >> 8);
    registers.write(registers.context, LINE, LINE_8_BITS);
    registers.write(registers.context, FIFO, FIFO_ON);
}

bool uart_16550_put(struct registers registers, char c)
{
    if (!(registers.read(registers.context, STATUS) & STATUS_TX_EMPTY))
        return false;
    registers.write(registers.context, DATA, (uint8_t)c);
    return true;
}
