/* board.h - what a board gives to the roof: firmware/main.c and the test programs that run on boards. One
 * implementation is linked (linker/boards.mk names its files); docs/PORTING.md says in which order to write it.
 *
 * The processor's file writes pace, wait, late, now, reset and stop; the board's own file writes put and bus; the rest
 * is hal/board.c for all. */
#ifndef HAL_BOARD_H
#define HAL_BOARD_H

#include <stdbool.h>
#include <stdint.h>
#include "hal/hal.h"

/* ---- console ---- */

/* One character to the console: true when it was taken, false when there is no room now. */
bool board_put(char c);

/* ---- bus ---- */

/* The bus, ready to use, its peers known as far as they answer within BOARD_BUS_WAIT_US. NULL: *why says what is wrong.
 * Called once, after board_pace. */
enum { BOARD_BUS_WAIT_US = 200000 };
const struct hal *board_bus(const char **why);

/* ---- time ---- */

/* Frame periods run from now on. False when the timer cannot do that. */
bool board_pace(double frame_s);

/* Sleeps until a frame period begins that was not waited for yet. Returns how many have begun since the last call: 1
 * when the caller keeps up. */
uint32_t board_wait(void);

/* Microseconds since the current period began, and since start, wrapping. */
uint32_t board_late_us(void);
uint32_t board_now_us(void);

/* The latter as struct hal's now_us. */
uint32_t board_hal_now_us(void *context);

/* ---- stack ---- */

/* True while the guard words below the stack are as start-up wrote them. */
bool board_stack_intact(void);

/* The deepest use so far and the whole, bytes. Cost: reads what was never used. */
uint32_t board_stack_used(void);
uint32_t board_stack_bytes(void);

/* Start-up: paints what is below `sp`, the guard included. */
void board_stack_paint(const uint32_t *sp);

/* ---- faults: recorded in memory that a restart keeps, told after it ---- */

enum board_fault_kind { BOARD_ASSERT = 1, BOARD_EXCEPTION, BOARD_STACK };

enum { BOARD_FILE = 40 };

struct board_fault {
    uint32_t kind;         /* enum board_fault_kind */
    char file[BOARD_FILE]; /* of a failed assertion, its last characters */
    uint32_t line;
    uint32_t address; /* of the instruction, where an exception tells it */
    uint32_t cause;   /* the processor's fault status */
};

/* Records the fault and restarts: inputs silent, plant at rest, the fault latched in STATUS until a reset command. */
void board_fail(const struct board_fault *f);

/* The same for an exception at `address`, or for a broken stack if `sp` has left it. */
void board_fail_exception(const uint32_t *sp, uint32_t address, uint32_t cause);

/* True when the last run ended so: once for each fault. */
bool board_take_fault(struct board_fault *f);

/* ---- ends ---- */

/* Restarts the processor. Does not return. */
void board_reset(void);

/* The program has nothing more to do: an emulator exits with this status, a board sleeps. Does not return. */
void board_stop(int status);

#endif
