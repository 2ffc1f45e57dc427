/* ticks.c - times that were written in decimal, in whole ticks. */
#include "host_sim/cli/ticks.h"

#include <float.h>
#include <math.h>

static const double rounding = 1e-9; /* ticks */
static const double quotient_roundings = 4.0;
static const double most = 1e18; /* ticks, below 2^63 */

double ticks_in(double time, double tick)
{
    double n = time / tick, whole = round(n);
    return fabs(n - whole) <= rounding + quotient_roundings * DBL_EPSILON * n ? whole : n;
}

bool ticks_fit(double time, double tick)
{
    double n = ticks_in(time, tick);
    return !(n > floor(n));
}

static uint64_t count(double ticks)
{
    return ticks <= most ? (uint64_t)ticks : UINT64_MAX;
}

uint64_t ticks_begun(double time, double tick)
{
    return count(ceil(ticks_in(time, tick)));
}

uint64_t ticks_ended(double time, double tick)
{
    return count(floor(ticks_in(time, tick)));
}
