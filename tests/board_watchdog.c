/* board_watchdog.c - a program for Cortex-M boards with a watchdog, which must end what nothing else ends, one trouble a start:
 *   the timer that ends a sleep does not interrupt any more: the watchdog's interrupt tells CLOCK, and where
 *   after frames that fed it the program hangs: its interrupt tells WATCHDOG, and where
 *   the same, and the interrupt's handler hangs too: the reset leaves no record but that
 * Then: how many periods a program learns of that slept with interrupts off. A line each on the console. */
#include <string.h>
#include "hal/board.h"
#include "hal/console.h"

enum {
    FED_FRAMES = 1000 * (2 * BOARD_WATCHDOG_S + 1), /* more than until the reset */
    ASLEEP = 5,
    VECTORS = 16,
    NMI = 2,
    SCB_VECTORS = 0x08 / 4, /* VTOR */
    SYSTICK_CONTROL = 0,
    SYSTICK_INTERRUPT = 2
};
#define FRAME_S 1e-3

extern volatile uint32_t systick[], system_control[];

static const struct hal *bus;

static void feed_frames(int n)
{
    for (int i = 0; i < n; i++) {
        (void)board_wait();
        bus->healthy(bus->context);
    }
}

static void hang(void)
{
    for (volatile bool on = true; on;) {
    }
}

/* A copy of the vectors whose NMI hangs; they begin at address 0. */
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
static void oversleep(void)
{
    (void)board_wait();
    uint32_t begin_us = board_now_us();
    __asm__ volatile("cpsid i" ::: "memory");
    while (board_now_us() - begin_us < (uint32_t)(ASLEEP * 1e6 * FRAME_S)) { /* bounded by board_look */
    }
    __asm__ volatile("cpsie i" ::: "memory");
    console_text("periods ");
    console_number(board_wait());
    console_text("\n");
    console_flush();
}

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
    if (!ended)
        systick[SYSTICK_CONTROL] &= ~(uint32_t)SYSTICK_INTERRUPT;
    else if (last.kind == BOARD_CLOCK)
        hang();
    else if (last.address != 0)
        hang_in_nmi();
    else
        oversleep();
    (void)board_wait();
    return 0;
}
