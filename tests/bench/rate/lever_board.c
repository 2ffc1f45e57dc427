/* lever_board.c - a program for boards: ticks of the AFM lever at its true frequency, 24 in a period, by rk4,
 * then by adams, then by rk4_float32, for lever_cycles.py. */
#include "hal/board/board.h"
#include "tests/bench/rate/rate_cases.h"

enum { LEVER = 3, STEPS = 24, TICKS = 96 };

static struct rate_run run;

int main(void)
{
    const struct rate_setting by[] = {{&rk4, STEPS, 0}, {&adams, STEPS, 0}, {&rk4_float32, STEPS, 0}};
    bool good = board_pace(0.5);
    for (int i = 0; i < 3 && good; i++)
        good = !rate_start(&run, &rate_case[LEVER], &by[i], false) &&
               rate_advance(&run, &rate_case[LEVER], TICKS);
    return good ? 0 : 1;
}
