/* board_main.c - the image as it is (firmware/main.c), with one trouble a start in a turn of its frames.
 * It is linked with app_overrun wrapped, which main calls once a turn. In each start it is away for some
 * periods, which must be counted as missed.
 *
 * 1. The stack reaches into its guard and comes back.
 * 2. An assertion fails while nobody has acknowledged the first fault: that one stays.
 * 3. The fault is acknowledged, as by a reset command, then the program hangs. Where no watchdog ends it, an
 *    assertion does.
 * 4. The last run is reported on the bus, and the program ends.
 *
 * Each start prints its report of the last run on the console. An emulator's memory comes up as zeros. */
#include "firmware/app/app.h"
#include "models/check.h"
#include "hal/board/board.h"
#include "hal/board/console.h"

enum {
    AWAY_AT = 5,
    ACKNOWLEDGED_AT = 10,
    TROUBLE_AT = 20 /* turns */,
    AWAY = 5 /* periods */,
    GUARD_TOP = 31,
    STACK_LEAST = 2048 /* bytes: the self-test's tables */
};

extern uint32_t stack_bottom[];

static uint32_t start __attribute__((section(".noinit")));

uint32_t __real_app_overrun(struct app *a, uint32_t missed);
uint32_t __wrap_app_overrun(struct app *a, uint32_t missed);

static void pass(uint32_t us)
{
    uint32_t begin_us = board_now_us();
    while (board_now_us() - begin_us < us) { /* bounded by board_look */
    }
}

/* Longer than the watchdog may take, its interrupt included. */
static void hang(void)
{
    bool ended = false;
    pass((2 * BOARD_WATCHDOG_S + 1) * 1000000u);
    ASSERT(ended);
}

static void end(const struct app *a)
{
    bool told = a->state == STATE_FAULT && a->faults == FAULT_ASSERT && a->count[DIAG_LAST_RUN] != 0;
    bool counted = a->count[DIAG_FRAMES_MISSED] >= AWAY - 1;
    bool measured = board_stack_used() > STACK_LEAST && board_stack_used() < board_stack_bytes();
    console_flush();
    board_stop(!(told && counted && measured));
}

static void trouble(const struct app *a)
{
    switch (++start) {
    case 1:
        stack_bottom[GUARD_TOP] = 0;
        break;
    case 2:
        ASSERT(a->count[DIAG_LAST_RUN] != BOARD_STACK);
        break;
    case 3:
        hang();
        break;
    default:
        end(a);
    }
}

uint32_t __wrap_app_overrun(struct app *a, uint32_t missed)
{
    static uint32_t turns;
    turns++;
    if (turns == AWAY_AT)
        pass(AWAY * 1000u);
    if (turns == ACKNOWLEDGED_AT && start == 2)
        a->faults = 0;
    if (turns == TROUBLE_AT)
        trouble(a);
    return __real_app_overrun(a, missed);
}
