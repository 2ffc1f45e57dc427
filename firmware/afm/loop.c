/* loop.c - see loop.h. */
#include "firmware/afm/loop.h"

#include <math.h>
#include "models/math/elementary.h"

double loop_run(struct loop *l, double e, double dt)
{
    double sum = l->sum + l->ki * e * dt, u = l->kp * e + sum;
    l->limited = u < l->min || u > l->max;
    if (!l->limited)
        l->sum = sum;
    return u < l->min ? l->min : u > l->max ? l->max : u;
}

/* With Om = f1 A1/(f2 A2) and D = p2 - p1: cot p1 = (1/Om - cos D)/sin D, cot p2 = (cos D - Om)/sin D, and
 * for each drive f0^2 = f^2 - f (f0/Q) cot p. */
bool loop_find_resonance(const double f_Hz[2], const double amplitude[2], const double phase[2],
                         double *f0_Hz, double *quality)
{
    double c, s, ratio = f_Hz[0] * amplitude[0] / (f_Hz[1] * amplitude[1]);
    cos_sin(phase[1] - phase[0], &c, &s);
    double first = (1.0 / ratio - c) / s, second = (c - ratio) / s;
    double width = (f_Hz[1] * f_Hz[1] - f_Hz[0] * f_Hz[0]) / (f_Hz[1] * second - f_Hz[0] * first);
    double square = f_Hz[0] * (f_Hz[0] - width * first);
    if (!(square > 0.0 && width > 0.0))
        return false;
    *f0_Hz = sqrt(square);
    *quality = *f0_Hz / width;
    return true;
}
