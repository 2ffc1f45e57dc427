/* clock.h - what every hal of a POSIX host shares: its clock, and the watchdog that a PC does not have. */
#ifndef HAL_CLOCK_H
#define HAL_CLOCK_H

#include <stdint.h>

/* Microseconds of the monotonic clock since an arbitrary start. */
uint64_t clock_us(void);

/* struct hal's now_us: the same clock, wrapping at 32 bits. */
uint32_t clock_now_us(void *context);

/* struct hal's healthy where there is no watchdog to feed. */
void clock_no_watchdog(void *context);

#endif
