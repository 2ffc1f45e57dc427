/* test_uart.c - the drivers of both UARTs against their registers: PC16550D, and Cadence's (Xilinx UG1087).
 *
 * Each model sends what is written to it while it has room, and counts what its data sheet forbids. */
#include <stdbool.h>
#include <string.h>
#include "hal/device/uart_16550.h"
#include "hal/device/uart_cadence.h"
#include "tests/unit/test.h"

static struct {
    uint32_t line, divider, events, fifo;        /* PC16550D */
    uint32_t control, generator, divider_cycles; /* Cadence */
    bool full;
    uint32_t sent, n_sent, wrong;
} uart;

/* ---- PC16550D: with bit 7 of LCR (3) set, 0 and 1 are the divisor latch ---- */

static uint32_t read_16550(uintptr_t context, uint32_t offset)
{
    (void)context;
    uart.wrong += offset != 5; /* LSR */
    return uart.full ? 0x00 : 0x60;
}

static void send(uint32_t value)
{
    uart.wrong += uart.full || value > 0xFF;
    uart.sent = value;
    uart.n_sent++;
}

static void write_16550(uintptr_t context, uint32_t offset, uint32_t value)
{
    bool latch = (uart.line & 0x80) != 0;
    (void)context;
    if (offset == 3)
        uart.line = value;
    else if (offset == 2)
        uart.fifo = value;
    else if (offset == 1 && latch)
        uart.divider = (uart.divider & 0xFF) | value << 8;
    else if (offset == 1)
        uart.events = value;
    else if (offset == 0 && latch)
        uart.divider = (uart.divider & 0xFF00) | value;
    else if (offset == 0)
        send(value);
    else
        uart.wrong++;
}

TEST(uart_16550)
{
    static const struct registers r = {0, read_16550, write_16550};
    memset(&uart, 0, sizeof uart);
    uart.events = 0xF;
    uart_16550_open(r, 0x1234);
    check_hex("divider", uart.divider, 0x1234);
    check_hex("line: 8 bits, no parity, one stop bit, registers 0 and 1 those of data", uart.line, 0x03);
    check_hex("no interrupts", uart.events, 0);
    check_hex("FIFO on", uart.fifo & 1, 1);
    check_int("nothing sent yet", uart.n_sent, 0);
    check_true("a character is taken", uart_16550_put(r, (char)0xE9));
    check_hex("and sent", uart.sent, 0xE9);
    uart.full = true;
    check_true("without room it is not", !uart_16550_put(r, 'b'));
    check_int("sent", uart.n_sent, 1);
    check_int("accesses that the data sheet does not have", uart.wrong, 0);
}

/* ---- Cadence: Control 0x00, Baud_rate_gen 0x18, Channel_sts 0x2C, FIFO 0x30, Baud_rate_divider 0x34 ---- */

static uint32_t read_cadence(uintptr_t context, uint32_t offset)
{
    (void)context;
    uart.wrong += offset != 0x2C;
    return uart.full ? 1 << 4 : 1 << 3; /* transmit FIFO full, or empty */
}

static void write_cadence(uintptr_t context, uint32_t offset, uint32_t value)
{
    (void)context;
    if (offset == 0x00)
        uart.control = value;
    else if (offset == 0x18)
        uart.generator = value;
    else if (offset == 0x34)
        uart.divider_cycles = value + 1;
    else if (offset == 0x30)
        send(value);
    else
        uart.wrong++;
}

TEST(uart_cadence)
{
    static const struct registers r = {0, read_cadence, write_cadence};
    memset(&uart, 0, sizeof uart);
    uart_cadence_open(r, 109);
    check_int("cycles of the clock in a bit", uart.generator * uart.divider_cycles, 109 * 8);
    check_hex("the transmitter on (bit 4), the receiver off (bit 3)", uart.control, 0x18);
    check_true("a character is taken", uart_cadence_put(r, (char)0xE9));
    check_hex("and sent", uart.sent, 0xE9);
    uart.full = true;
    check_true("without room it is not", !uart_cadence_put(r, 'b'));
    check_int("sent", uart.n_sent, 1);
    check_int("accesses that the manual does not have", uart.wrong, 0);
}
