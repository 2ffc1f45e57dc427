/* uart_cmsdk.h - the CMSDK UART of Arm's MPS2 boards, transmit only, polled (Arm DDI 0479, section 4.3). */
#ifndef HAL_UART_CMSDK_H
#define HAL_UART_CMSDK_H

#include <stdbool.h>
#include <stdint.h>

/* The registers are at a word address of the linker script; the divider is clock / baud, 16 at least. */
void uart_cmsdk_open(volatile uint32_t *registers, uint32_t divider);

/* True when the character was taken. */
bool uart_cmsdk_put(volatile uint32_t *registers, char c);

#endif
