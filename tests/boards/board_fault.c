/* board_fault.c - a program for boards that breaks in one way a start, and reports the record of it after
 * each restart.
 *
 * The ways are a failed assertion, an exception, a stack guard overwritten, a stack that ran out of
 * memory, and a stopped clock. Each start also checks that start-up has set up the program's memory. The
 * last start checks that the periods reported are those that passed. */
#include <string.h>
#include "models/check.h"
#include "hal/board/board.h"
#include "hal/board/console.h"
#include "tests/boards/board_clock.h"

enum { BLOCK = 4, GUARD_FOUND = 1, FRAMES = 10, FRAME_US = 1000, BYTES = 64, SHIFT = 5 };

/* From data and bss, whatever the last start left there. */
static volatile uint32_t with_value = 0x0DA7A123, zero;

static void look_at_memory(void)
{
    if (with_value != 0x0DA7A123 || zero != 0)
        console_text("memory is not as start-up should leave it\n");
    with_value = zero = 0xFFFFFFFF;
}

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

/* linker/memory.c: whole words and the rest, and moves onto themselves. */
static void look_at_memory_functions(void)
{
    static uint8_t from[BYTES + SHIFT], to[BYTES + SHIFT];
    int wrong = 0;
    for (uint32_t i = 0; i < BYTES; i++)
        from[i] = (uint8_t)(i + 1);
    for (uint32_t n = 0; n < BYTES; n++) {
        memset(to, 0xA5, sizeof to);
        memcpy(to + n % SHIFT, from, n);
        wrong += memcmp(to + n % SHIFT, from, n) != 0 || to[n + n % SHIFT] != 0xA5;
        memmove(to + n % SHIFT + 1, to + n % SHIFT, n);
        wrong += memcmp(to + n % SHIFT + 1, from, n) != 0;
        memmove(to + n % SHIFT, to + n % SHIFT + 1, n);
        wrong += memcmp(to + n % SHIFT, from, n) != 0;
    }
    wrong += memcmp(from, from + 1, SHIFT) >= 0 || memcmp(from + 1, from, SHIFT) <= 0;
    if (wrong)
        console_text("memory.c copies wrongly\n");
}

static void pass_until(uint32_t begin_us, uint32_t us)
{
    while (board_now_us() - begin_us < us) { /* bounded by board_look */
    }
}

/* Turns of a period and a half: none is told too early, none is lost; and inside a period, how late it is. */
static void count_periods(void)
{
    (void)board_wait();
    uint32_t begin_us = board_now_us(), told = 0;
    for (uint32_t i = 1; i <= FRAMES; i++) {
        pass_until(begin_us, i * (FRAME_US + FRAME_US / 2));
        told += board_wait();
    }
    pass_until(begin_us, FRAMES * (FRAME_US + FRAME_US / 2) + FRAME_US / 4);
    uint32_t passed_us =
        board_now_us() - begin_us - board_late_us(); /* whole periods, less the start of the first */
    if (told * FRAME_US - passed_us + 2 > FRAME_US / 2)
        console_text("periods told are not those that passed\n");
}

/* Returns only where nothing stops the clock, or nobody misses it. */
static void stop_clock(void)
{
    bool paced = board_pace(1e-3);
    if (!paced)
        return;
    count_periods();
    console_flush();
    if (board_clock_stop())
        for (int i = 0; i < FRAMES;
             i++) /* an emulator that stood still may owe a period from before the stop */
            (void)board_wait();
    else
        console_text("nothing stops this clock\n");
    console_flush();
}

/* After the restart: what keeps the frames from beginning. */
static void look_at_stopped_clock(void)
{
    if (board_clock_stop() && board_clock_runs())
        console_text("a clock that stands is not seen\n");
    console_flush();
}

int main(void)
{
    struct board_fault last = {.kind = 0};
    uint32_t starts = 0;
    look_at_memory();
    look_at_memory_functions();
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
    if (last.kind == BOARD_CLOCK)
        look_at_stopped_clock();
    return last.kind != BOARD_STACK && last.kind != BOARD_CLOCK;
}
