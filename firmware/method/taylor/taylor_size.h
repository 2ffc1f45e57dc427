/* taylor_size.h - the size of a motion, and the error that its series may leave. */
#ifndef FIRMWARE_TAYLOR_SIZE_H
#define FIRMWARE_TAYLOR_SIZE_H

#include "firmware/method/taylor/taylor.h"

/* Call it when the state was set from outside: a motion begins at x. */
void taylor_begin_motion(struct taylor *t, const struct model *m, const double *p, const struct segment *e,
                         const double *x);

/* The motion is at x now: its size, and when that has doubled what follows from it. */
void taylor_grow(struct taylor *t, double size);
ALWAYS_INLINE void taylor_measure(struct taylor *t, const double *x)
{
    double deviation = fabs(x[0] - t->rest) * t->rate_scale, rate = fabs(x[1]);
    t->most = deviation > t->most ? deviation : t->most;
    t->most_rate = rate > t->most_rate ? rate : t->most_rate;
    double size = TAYLOR_SPARE * (t->most < t->most_rate ? t->most : t->most_rate);
    if (t->size < 1.0 && size >= 2.0 * t->size)
        taylor_grow(t, size);
}

#endif
