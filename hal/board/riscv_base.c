/* riscv_base.c - the functions of a RISC-V hart that need no other ones: its counter, restart, sleep for
 * good, the end of a test program. */
#include "hal/board/board.h"

/* From the linker script. */
extern volatile uint64_t machine_timer[];
extern volatile uint32_t test_device[];

enum { TEST_PASS = 0x5555, TEST_FAIL = 0x3333, TEST_RESET = 0x7777, TEST_STATUS_SHIFT = 16 };

uint32_t board_count(void)
{
    return (uint32_t)machine_timer[0];
}

void board_reset(void)
{
    test_device[0] = TEST_RESET;
    board_stand();
}

void board_stand(void)
{
    for (;;)
        __asm__ volatile("wfi");
}

void board_stop(int status)
{
    test_device[0] = status == 0 ? TEST_PASS : TEST_FAIL | (uint32_t)status << TEST_STATUS_SHIFT;
    board_stand();
}
