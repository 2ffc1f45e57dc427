/* lever_board.c - a program for boards: ticks of the AFM lever at its true frequency, for lever_cycles.py. */
#include "hal/board/board.h"
#include "tests/bench/rate/rate_cases.h"

enum { LEVER = 3, RK4_24_STEPS = 2, TICKS = 96 };

static struct rate_run run;

int main(void)
{
    struct rate_setting s = rate_setting(&rate_case[LEVER], RK4_24_STEPS);
    if (!board_pace(0.5) || rate_start(&run, &rate_case[LEVER], &s, false))
        return 1;
    return rate_advance(&run, &rate_case[LEVER], TICKS) ? 0 : 1;
}
