/* rate_board.c - a program for boards: instructions per period of each case and setting of rate_cases.h.
 *
 * It prints lines of "CASE METHOD STEPS TOLERANCE INSTRUCTIONS". It is for an emulator whose clock takes
 * 1.024 us an instruction (QEMU's -icount shift=10). */
#include "hal/board/board.h"
#include "hal/board/console.h"
#include "tests/bench/rate/rate_cases.h"

#define INSTRUCTION_US 1.024
#define PERIOD_S       0.5 /* period of the timer */

enum { SETTLE = 2, COUNTED = 4 /* periods */ };

static struct rate_run run;

static void number(uint64_t value)
{
    console_text(" ");
    console_number(value);
}

static void measure(const struct rate_case *c, const struct rate_setting *s)
{
    uint32_t steps = (uint32_t)s->steps;
    if (rate_start(&run, c, s, false) || !rate_advance(&run, c, SETTLE * steps))
        return;
    uint32_t begin_us = board_now_us();
    if (!rate_advance(&run, c, COUNTED * steps))
        return;
    double us = board_now_us() - begin_us;
    console_text(c->name);
    console_text(" ");
    console_text(s->method->name);
    number(steps);
    number((uint64_t)s->tolerance);
    number((uint64_t)(us / (INSTRUCTION_US * COUNTED) + 0.5));
    console_text("\n");
    console_flush();
}

int main(void)
{
    if (!board_pace(PERIOD_S))
        return 1;
    for (int i = 0; i < RATE_CASES; i++) {
        for (int k = 0; k < RATE_SETTINGS; k++) {
            struct rate_setting s = rate_setting(&rate_case[i], k);
            measure(&rate_case[i], &s);
        }
    }
    return 0;
}
