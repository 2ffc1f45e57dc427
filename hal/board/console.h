/* console.h - text and numbers for a board's console. It is slow and must never hold up a frame. So printed
 * text waits in a ring, and a frame hands over as much as the device takes. Text that does not fit is lost;
 * reliable reports go over the bus. */
#ifndef HAL_CONSOLE_H
#define HAL_CONSOLE_H

#include <stdint.h>
#include "hal/board/board.h"

enum { CONSOLE_RING = 512, CONSOLE_TRIES = 1000000 };

/* Put text into the ring: a string, a number in decimal, or the lowest `digits` (1..16) hexadecimal digits
 * of one. The part that finds no room is lost. Cost: a copy; the device is not touched. */
void console_text(const char *text);
void console_number(uint64_t value);
void console_hex(uint64_t value, int digits);

/* Puts in a line about the fault that ended a run, `starts` starts ago. */
void console_fault(const struct board_fault *f, uint32_t starts);

/* Hands over as many characters as the device takes without waiting. Call it once a frame. */
void console_poll(void);

/* Waits until all is handed over, at most CONSOLE_TRIES looks at the device. Call it only before the first
 * frame and at the end. */
void console_flush(void);

#endif
