/* cortex_r_base.c - the functions of a Cortex-R5 that need no other ones: its counter, restart, sleep for
 * good, the end of a test program (Arm DDI 0460, DDI 0406). */
#include "hal/board/board.h"

void reset(void);

uint32_t board_count(void)
{
    uint32_t n;
    __asm__ volatile("mrc p15, 0, %0, c9, c13, 0" : "=r"(n));
    return n;
}

/* Start-up runs again; drivers reset their devices. Resetting the core itself takes another processor. */
void board_reset(void)
{
    __asm__ volatile("dsb" ::: "memory");
    reset();
    for (;;) { /* not reached */
    }
}

void board_stand(void)
{
    for (;;)
        __asm__ volatile("wfi");
}

/* Semihosting, SYS_EXIT_EXTENDED: without a debugger or emulator it is a fault, so only test programs
 * stop. */
void board_stop(int status)
{
    const uint32_t block[2] = {0x20026, (uint32_t)status}; /* ADP_Stopped_ApplicationExit */
    register uint32_t operation __asm__("r0") = 0x20;
    register const uint32_t *parameter __asm__("r1") = block;
    __asm__ volatile("svc 0x123456" ::"r"(operation), "r"(parameter) : "memory");
    board_stand();
}
