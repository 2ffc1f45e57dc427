/* riscv.h - the part of a board that hal/board/riscv.c calls, and the handler that start-up names. */
#ifndef HAL_RISCV_H
#define HAL_RISCV_H

/* From now on `serve` is called when an external interrupt ended the sleep between two frames: it serves the
 * devices that raise one, so that it goes down. Called once, before they may raise one. */
void riscv_serve_by(void (*serve)(void));

/* Any exception or interrupt that is taken: a fault, which restarts the board. Start-up names it. */
void riscv_trap(void);

#endif
