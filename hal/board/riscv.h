/* riscv.h - the functions that hal/board/riscv.c needs from a board. */
#ifndef HAL_RISCV_H
#define HAL_RISCV_H

/* An external interrupt ended the sleep between two frames: serve the devices that raise one, so that it
 * goes down. */
void riscv_serve(void);

#endif
