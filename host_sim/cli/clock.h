/* clock.h - the host's time: absolute pacing that does not drift, and the wish of the user to stop. */
#ifndef HOST_SIM_CLOCK_H
#define HOST_SIM_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

/* Time that passes, also while the machine sleeps (hal/posix/clock.h), nanoseconds and seconds. */
int64_t clock_now_ns(void);
double clock_now_s(void);

/* Sleeps until that instant; at once when it has passed, early when a signal comes. */
void clock_sleep_until_ns(int64_t ns);

/* Sleeps to a microsecond: it polls the clock for the last 100 us, so that the processor is awake and
 * warm. */
void clock_wait_until_ns(int64_t ns);

/* Sleeps this long, or less when a signal comes. */
void clock_sleep_s(double seconds);

/* From now on SIGINT, SIGTERM and SIGHUP do not kill but are seen by clock_interrupted. A SIGHUP that was
 * ignored before (nohup) stays so. */
void clock_catch_signals(void);
bool clock_interrupted(void);

#endif
