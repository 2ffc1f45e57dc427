/* board_fault.c - a program for boards that breaks in each way a program can, one a start, and tells after each restart
 * what the record says: a failed assertion, an exception, a stack guard overwritten, a stack that ran out of memory,
 * the clock stopped. */
#include "firmware/check.h"
#include "hal/board.h"
#include "hal/console.h"
#include "tests/board_clock.h"

enum { BLOCK = 4, GUARD_FOUND = 1, FRAMES = 10 };

/* Deeper, in steps smaller than the guard, until it is overwritten; with `on`, until there is no memory. */
static __attribute__((noinline)) uint32_t dig(bool on)
{
    volatile uint32_t block[BLOCK];
    for (int i = 0; i < BLOCK; i++)
        block[i] = (uint32_t)i;
    uint32_t below = on || board_stack_intact() ? dig(on) : 0;
    return below + block[BLOCK - 1];
}

static void overwrite_guard(void)
{
    (void)dig(false);
    board_fail(&(struct board_fault){.kind = BOARD_STACK, .line = GUARD_FOUND});
}

/* Returns only where nothing stops the clock, or nobody misses it. */
static void stop_clock(void)
{
    bool paced = board_pace(1e-3);
    for (int i = 0; i < FRAMES; i++)
        (void)board_wait();
    if (!paced)
        return;
    if (board_clock_stop())
        for (int i = 0; i < FRAMES;
             i++) /* an emulator that stood still may owe a period from before the stop */
            (void)board_wait();
    else
        console_text("nothing stops this clock\n");
    console_flush();
}

int main(void)
{
    struct board_fault last = {.kind = 0};
    uint32_t starts = 0;
    bool ended = board_take_fault(&last, &starts);
    board_forget_fault();
    console_fault(&last, starts);
    console_flush();
    if (!ended)
        ASSERT(board_stack_bytes() == 0);
    if (last.kind == BOARD_ASSERT)
        __builtin_trap();
    if (last.kind == BOARD_EXCEPTION)
        overwrite_guard();
    if (last.kind == BOARD_STACK && last.line == GUARD_FOUND)
        (void)dig(true);
    if (last.kind == BOARD_STACK)
        stop_clock();
    return last.kind != BOARD_STACK && last.kind != BOARD_CLOCK;
}
