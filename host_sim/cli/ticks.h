/* ticks.h - counts ticks, samples or frames in a time that was written in decimal.
 *
 * 0.3 s are 300 ticks of 1 ms, although the quotient of the two numbers is not 300. So a time counts as one
 * of whole ticks where it misses them by rounding: by 1e-9 of a tick, or by some roundings of the quotient.
 * Time and tick have one unit; the time is 0 or more. */
#ifndef HOST_SIM_TICKS_H
#define HOST_SIM_TICKS_H

#include <stdbool.h>
#include <stdint.h>

/* The time in ticks; a whole number where it is one but for rounding. */
double ticks_in(double time, double tick);

/* Whole ticks, that many and no part of one. */
bool ticks_fit(double time, double tick);

/* Ticks that begin, and ticks that end, up to this time; UINT64_MAX for more than 1e18. */
uint64_t ticks_begun(double time, double tick);
uint64_t ticks_ended(double time, double tick);

#endif
