/* clock.c - the clock of a POSIX host; see clock.h. */
#include "hal/posix/clock.h"

int64_t clock_ns(void)
{
    struct timespec t;
    if (clock_gettime(CLOCK_ELAPSED, &t) != 0)
        clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

/* Microseconds of that clock. */
static uint64_t clock_us(void)
{
    return (uint64_t)clock_ns() / 1000u;
}

uint32_t clock_now_us(void *context)
{
    (void)context;
    return (uint32_t)clock_us();
}

void clock_no_watchdog(void *context)
{
    (void)context;
}
