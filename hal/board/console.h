/* console.h - text and numbers for a board's console. It is slow and must never hold up a frame. So printed
 * text waits in a ring, and a frame hands over as much as the device takes. Text that does not fit is lost;
 * reliable reports go over the bus. */
#ifndef HAL_CONSOLE_H
#define HAL_CONSOLE_H

#include <stdint.h>
#include "hal/board/board.h"

enum { CONSOLE_RING = 512, CONSOLE_TRIES = 1000000 };

void console_text(const char *text);
void console_number(uint64_t value);
void console_hex(uint64_t value, int digits);

/* One line about what ended a run, so many starts ago. */
void console_fault(const struct board_fault *f, uint32_t starts);

/* Hands over what the device takes without waiting. Once a frame. */
void console_poll(void);

/* Waits until all is handed over, at most CONSOLE_TRIES looks. Before the first frame and at the end. */
void console_flush(void);

#endif
