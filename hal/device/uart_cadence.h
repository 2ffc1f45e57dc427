/* uart_cadence.h - the Cadence UART of Zynq devices, transmit only, polled (Xilinx UG1085, UG1087). The
 * boot loader has set its clock and pins. */
#ifndef HAL_UART_CADENCE_H
#define HAL_UART_CADENCE_H

#include <stdbool.h>
#include "hal/device/registers.h"

/* Baud rate = clock / (divider * 8). */
void uart_cadence_open(struct registers registers, uint32_t divider);

/* True when the character was taken. */
bool uart_cadence_put(struct registers registers, char c);

#endif
