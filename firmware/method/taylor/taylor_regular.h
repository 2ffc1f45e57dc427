/* taylor_regular.h - the contact as a series in regularised variables. */
#ifndef FIRMWARE_TAYLOR_REGULAR_H
#define FIRMWARE_TAYLOR_REGULAR_H

#include "firmware/method/taylor/taylor_load.h"
#include "firmware/method/taylor/taylor_series.h"

/* Contact in regularised variables: eta = y^2, dt = 2 y ds, w = eta'. Series in s of y, w and the time, from
 * (y0, w0) at time 0, y0 >= 0. They converge through touchdown and lift-off, where y = 0. */
void taylor_regular(const struct taylor_load *load, double y0, double w0, double *y, double *w, double *t);

#endif
