/* uart_16550.h - a 16550 UART, transmit only, polled (National Semiconductor PC16550D). */
#ifndef HAL_UART_16550_H
#define HAL_UART_16550_H

#include <stdbool.h>
#include "hal/device/registers.h"

/* Baud rate = clock / (divider * 16). */
void uart_16550_open(struct registers registers, uint16_t divider);

/* True when the character was taken. */
bool uart_16550_put(struct registers registers, char c);

#endif
