/* cortex_m_end.c - how the program of a Cortex-M ends: restart, sleep for good, the end of a test program
 * (Armv7-M ARM, part B). */
#include "hal/board/board.h"

/* From the linker script. */
extern volatile uint32_t system_control[];

enum { SCB_RESET = 0x0C / 4 /* AIRCR */, RESET_REQUEST = 0x05FA0004 };

void board_reset(void)
{
    __asm__ volatile("dsb" ::: "memory");
    system_control[SCB_RESET] = RESET_REQUEST;
    board_stand();
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
    __asm__ volatile("bkpt 0xab" ::"r"(operation), "r"(parameter) : "memory");
    board_stand();
}
