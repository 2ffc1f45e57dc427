/* board.h - the functions of a board for firmware/main.c and the test programs that run on boards. One
 * implementation is linked (linker/boards.mk names its files); docs/guide/porting.md says in which order to
 * write it.
 *
 * The processor's file writes pace, wait, late, now, reset and stop; the board's own file writes put and bus;
 * the rest is hal/board/board.c for all. */
#ifndef HAL_BOARD_H
#define HAL_BOARD_H

#include <stdbool.h>
#include <stdint.h>
#include "hal/hal.h"

/* ---- console ---- */

/* One character to the console: true when it was taken, false when there is no room now. */
bool board_put(char c);

/* ---- bus ---- */

/* Opens the bus and returns it ready to use. It waits at most BOARD_BUS_WAIT_US for its peers to answer.
 * NULL when it does not work: *why says what is wrong. Called once, after board_pace. */
enum { BOARD_BUS_WAIT_US = 200000 };
const struct hal *board_bus(const char **why);

/* ---- time ---- */

/* Starts frame periods of frame_s seconds. False when the timer cannot make this period, or stands still. */
bool board_pace(double frame_s);

/* Sleeps until a frame period begins that was not waited for yet. Returns how many have begun since the
 * last call: 1 when the caller keeps up. */
uint32_t board_wait(void);

/* Microseconds since the current period began, and since start, wrapping. */
uint32_t board_late_us(void);
uint32_t board_now_us(void);

/* The latter as struct hal's now_us. */
static inline uint32_t board_hal_now_us(void *context)
{
    (void)context;
    return board_now_us();
}

/* ---- the clock that paces frames, and may stop ---- */

/* A counter of BOARD_CLOCK_HZ that wraps at 32 bits and also runs while the processor sleeps. A timer that
 * ends the sleeps must run from the same oscillator. */
uint32_t board_count(void);

/* Looks in a row at an unchanged counter that prove that it stands still. They take the time of 16 counts
 * on a processor of 2 GHz with 4 cycles a look. */
#define BOARD_STILL_LOOKS (16u + 8000000000u / BOARD_CLOCK_HZ)

/* Reads the counter; every loop that waits must read it this way. If BOARD_STILL_LOOKS calls in a row find
 * it unchanged, the board restarts with fault BOARD_CLOCK. So no loop that looks at the time hangs. A
 * sleep that never ends is left to the watchdog. */
uint32_t board_look(void);

/* True when the counter moves within BOARD_STILL_LOOKS. */
bool board_clock_runs(void);

/* ---- watchdog ---- */

/* Starts the watchdog; false where there is none. Called once, before the first frame. From then on the
 * hal's `healthy` must be called every BOARD_WATCHDOG_S seconds, or the board restarts and reports
 * BOARD_WATCHDOG. The longest absence of a sound program is a frame that makes up for 100 missed ones
 * (policy skip): 20 ms for each. */
enum { BOARD_WATCHDOG_S = 2 };
bool board_watch(void);

/* Called by board_watch: from now on a restart that leaves no record counts as the watchdog's. */
void board_watched(void);

/* Around a sleep that ends when a period begins: a watchdog that ends it has found a stopped clock.
 * board_starved is the cause of a starved watchdog: BOARD_CLOCK or BOARD_WATCHDOG. */
void board_sleeps(bool asleep);
uint32_t board_starved(void);

/* ---- stack ---- */

/* True while the guard words below the stack are as start-up wrote them. */
bool board_stack_intact(void);

/* The deepest use so far and the whole, bytes. Cost: reads what was never used. */
uint32_t board_stack_used(void);
uint32_t board_stack_bytes(void);

/* Start-up: paints what is below `sp`, the guard included. */
void board_stack_paint(const uint32_t *sp);

/* ---- faults: recorded in memory that a restart keeps, reported after it ---- */

/* The numbers of HEALTH last_run. */
enum board_fault_kind { BOARD_ASSERT = 1, BOARD_EXCEPTION, BOARD_STACK, BOARD_CLOCK, BOARD_WATCHDOG };

enum { BOARD_FILE = 40 };

struct board_fault {
    uint32_t kind;         /* enum board_fault_kind */
    char file[BOARD_FILE]; /* file of a failed assertion, its last characters */
    uint32_t line;
    uint32_t address; /* the instruction, where an exception or the watchdog's interrupt tells it; else 0 */
    uint32_t cause;   /* the processor's fault status */
};

/* Records the fault and restarts; does not return. After the restart inputs are silent, the plant is at
 * rest, and the fault is latched in STATUS until a reset command. An earlier record that was not
 * acknowledged stays: the first fault is the one to look for. */
void board_fail(const struct board_fault *f);

/* board_fail for an exception at `address`, or for a broken stack if `sp` has left it. */
void board_fail_exception(const uint32_t *sp, uint32_t address, uint32_t cause);

/* True when a fault has ended a run and was not acknowledged yet. Then *f is the first such fault, and
 * *starts the number of starts since, with this one. Call it once a start, before board_watch. */
bool board_take_fault(struct board_fault *f, uint32_t *starts);

/* Call it when the fault was reported and acknowledged: the next fault will be recorded. */
void board_forget_fault(void);

/* ---- ends ---- */

/* Restarts the processor. Does not return. */
void board_reset(void);

/* There is nothing to run: sleeps. Does not return. */
void board_stand(void);

/* Ends a program that has nothing more to do: an emulator exits with this status, a board sleeps. Does not
 * return. */
void board_stop(int status);

#endif
