/* board_cost.c - a program for boards: the instructions that each piece of tests/work_pieces.h takes, in lines of
 * "NAME instructions", a tenth at the end. For an emulator whose clock counts instructions: 1.024 us each (QEMU: -icount
 * shift=10), which makes the counts exact but for the timer's interrupt, twice a second. */
#include "hal/board.h"
#include "hal/console.h"
#include "tests/work_pieces.h"

#define INSTRUCTION_US 1.024
#define PERIOD_S       0.5 /* of the timer: long, within every board's range */

static void nothing(void)
{
}

/* Microseconds of WORK_CALLS calls. */
static uint32_t calls_us(void (*volatile once)(void))
{
    uint32_t begin_us = board_now_us();
    for (int i = 0; i < WORK_CALLS; i++)
        once();
    return board_now_us() - begin_us;
}

int main(void)
{
    if (!board_pace(PERIOD_S))
        return 1;
    uint32_t loop_us = calls_us(nothing);
    for (int i = 0; i < WORK_PIECES && !work_fault; i++) {
        work_setup(i);
        double us = calls_us(work_piece[i].once) - loop_us;
        work_check(i);
        uint64_t tenths = (uint64_t)(10.0 * us / (INSTRUCTION_US * WORK_CALLS) + 0.5);
        console_text(work_piece[i].name);
        console_text(" ");
        console_number(tenths / 10);
        console_text(".");
        console_number(tenths % 10);
        console_text("\n");
        console_flush();
    }
    if (work_fault) {
        console_text("not what it should be: ");
        console_text(work_fault);
        console_text("\n");
        console_flush();
    }
    return work_fault != 0;
}
