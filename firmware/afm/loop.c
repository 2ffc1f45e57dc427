/* loop.c - see loop.h. */
#include "firmware/afm/loop.h"

double loop_run(struct loop *l, double e, double dt)
{
    double sum = l->sum + l->ki * e * dt, u = l->kp * e + sum;
    l->limited = u < l->min || u > l->max;
    if (!l->limited)
        l->sum = sum;
    return u < l->min ? l->min : u > l->max ? l->max : u;
}
