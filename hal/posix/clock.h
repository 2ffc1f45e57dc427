/* clock.h - common to every hal of a POSIX host: its clock, and the watchdog that a PC does not have. */
#ifndef HAL_CLOCK_H
#define HAL_CLOCK_H

#include <stdint.h>
#include <time.h>

/* The clock that also counts the time in which the machine slept, so that frames age in a sleep.
 * CLOCK_MONOTONIC would stand. */
#ifdef CLOCK_BOOTTIME
#define CLOCK_ELAPSED CLOCK_BOOTTIME
#else
#define CLOCK_ELAPSED CLOCK_MONOTONIC
#endif

/* Nanoseconds of CLOCK_ELAPSED, or of CLOCK_MONOTONIC where the kernel does not have it. */
int64_t clock_ns(void);

/* struct hal's now_us: the same clock, wrapping at 32 bits. */
uint32_t clock_now_us(void *context);

/* struct hal's healthy where there is no watchdog to feed. */
void clock_no_watchdog(void *context);

#endif
