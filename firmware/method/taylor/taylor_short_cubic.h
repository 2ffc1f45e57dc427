/* taylor_short_cubic.h - one tick of a cubic force by a series of low order, read once at its end. */
#ifndef FIRMWARE_TAYLOR_SHORT_CUBIC_H
#define FIRMWARE_TAYLOR_SHORT_CUBIC_H

#include "firmware/method/taylor/taylor.h"

/* As taylor_short, for a polynomial force, by order 6, 8, 11 or 14. At most one input may multiply powers of
 * x. */
bool taylor_short_cubic(struct taylor *t, const struct segment *e);

#endif
