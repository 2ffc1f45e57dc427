/* taylor_root.h - the first sign change of a series. */
#ifndef FIRMWARE_TAYLOR_ROOT_H
#define FIRMWARE_TAYLOR_ROOT_H

#include "firmware/method/taylor/taylor_series.h"

/* A root of a series. */
struct taylor_root {
    double at;
    bool residual; /* it did not converge within the bound on iterations */
};

/* The first instant in (0, x] where sign * series turns from negative to not negative; false when there is
 * none. A series that starts at exactly 0 is taken as having left zero: that root does not count. */
bool taylor_first_root(const double *c, double sign, double x, struct taylor_root *root);

#endif
