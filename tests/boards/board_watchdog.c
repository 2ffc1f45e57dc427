/* board_watchdog.c - a program for boards with a watchdog: it must end, in its time, what nothing else
 * ends.
 *
 * Each start has one trouble, after frames that fed the watchdog and a silence that is almost too long:
 * - The timer that ends a sleep does not interrupt any more: CLOCK.
 * - The program hangs: WATCHDOG.
 * - On a Cortex-M, where these two say where it hung, the handler of the watchdog's interrupt hangs too. The
 *   reset leaves no record.
 *
 * Then, on a Cortex-M, the program is away with interrupts off and prints how many periods it learns of.
 * Each start prints a line on the console. */
#include <stddef.h>
#include "hal/board/board.h"
#include "hal/board/console.h"
#include "tests/boards/board_clock.h"

enum { FED_FRAMES = 1000 * (2 * BOARD_WATCHDOG_S + 1) /* more than until the reset */ };
#define FRAME_S 1e-3

static const struct hal *bus;

static void feed_frames(int n)
{
    for (int i = 0; i < n; i++) {
        (void)board_wait();
        bus->healthy(bus->context);
    }
}

static void pass(uint32_t us)
{
    uint32_t begin_us = board_now_us();
    while (board_now_us() - begin_us < us) { /* bounded by board_look */
    }
}

/* Comes back if the watchdog has not ended it in its time. */
static void hang(void)
{
    pass(BOARD_WATCHDOG_S * 1250000u);
}

#ifdef __ARM_ARCH
enum {
    AWAY = 5, /* periods */
    VECTORS = 16,
    NMI = 2,
    SCB_VECTORS = 0x08 / 4 /* VTOR */
};
extern volatile uint32_t system_control[];

/* A copy of the vectors whose NMI hangs. */
static void hang_in_nmi(void)
{
    static uint32_t vectors[VECTORS] __attribute__((aligned(128)));
    for (uint32_t i = 0; i < VECTORS; i++)
        vectors[i] = ((const volatile uint32_t *)(uintptr_t)system_control[SCB_VECTORS])[i];
    vectors[NMI] = (uint32_t)(uintptr_t)hang;
    system_control[SCB_VECTORS] = (uint32_t)(uintptr_t)vectors;
    hang();
}

/* Periods that begin while interrupts are off wait as one interrupt. */
static void be_away(void)
{
    (void)board_wait();
    __asm__ volatile("cpsid i" ::: "memory");
    pass((uint32_t)(AWAY * 1e6 * FRAME_S));
    __asm__ volatile("cpsie i" ::: "memory");
    console_text("periods ");
    console_number(board_wait());
    console_text("\n");
    console_flush();
}

static void more(const struct board_fault *last)
{
    if (last->address != 0)
        hang_in_nmi();
    be_away();
}
#else
static void more(const struct board_fault *last)
{
    (void)last;
}
#endif

int main(void)
{
    struct board_fault last = {.kind = 0};
    uint32_t starts = 0;
    const char *why;
    bool ended = board_take_fault(&last, &starts);
    board_forget_fault();
    console_fault(&last, starts);
    console_flush();
    bool ready = board_pace(FRAME_S) && (bus = board_bus(&why)) != NULL && board_watch();
    if (!ready)
        return 1;
    feed_frames(FED_FRAMES);
    pass(BOARD_WATCHDOG_S * 750000u);
    feed_frames(1);
    if (!ended)
        board_clock_mute();
    else if (last.kind == BOARD_CLOCK)
        hang();
    else
        more(&last);
    (void)board_wait();
    return 0;
}
