/* basin_repeat.c - see basin_repeat.h. */
#include "host_sim/maps/basin/basin_repeat.h"

#include <math.h>
#include <string.h>

enum { RETURNS = 3 };

double basin_size(const double *x, int n)
{
    double size = 0.0;
    for (int i = 0; i < n; i++)
        size = fmax(size, fabs(x[i]));
    return size;
}

double basin_distance(const double *a, const double *b, int n)
{
    double d = 0.0;
    for (int i = 0; i < n; i++)
        d = fmax(d, fabs(a[i] - b[i]));
    return d;
}

void basin_repeat_start(struct basin_repeat *r, const double *x, int n)
{
    memcpy(r->reference, x, (size_t)n * sizeof *x);
    r->since = r->period = 0;
}

/* The smallest divisor of the period after which the motion was nearly back, too. */
static int shortest(const struct basin_repeat *r, double near)
{
    for (int k = 1; k < r->period; k++)
        if (r->period % k == 0 && r->apart[k] <= BASIN_DIVISOR * near)
            return k;
    return r->period;
}

int basin_repeat_see(struct basin_repeat *r, const double *x, int n, double tolerance)
{
    double near = tolerance * (1.0 + basin_size(x, n)), apart = basin_distance(r->reference, x, n);
    r->since++;
    if (r->since <= BASIN_PERIODS)
        r->apart[r->since] = apart;
    if (r->period == 0 && apart <= near)
        r->period = r->since;
    if (r->period > 0 && apart <= near && r->since == RETURNS * r->period)
        return shortest(r, near);
    bool missed = r->period > 0 ? r->since % r->period == 0 && !(apart <= near) : r->since == BASIN_PERIODS;
    if (missed)
        basin_repeat_start(r, x, n);
    return 0;
}

void basin_motion_fail(struct basin_motion *m, enum basin_status status)
{
    m->outcome = status == BASIN_ESCAPED ? BASIN_GONE : BASIN_TROUBLE;
    m->period = 0;
}
