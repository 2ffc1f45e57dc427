/* choose_out.h - runs the scene of choose --out as a user does, and compares it with the run that was
 * certified. */
#ifndef TESTS_CHOOSE_OUT_H
#define TESTS_CHOOSE_OUT_H

#include "host_sim/choose/choose.h"

/* Frames of `contactplant simulate` of that file whose observable has other bits than the certified run's;
 * -1: it is not there. (A velocity on a dilated bus is one in another unit: there, frames that differ by
 * more than rounding.) */
int choose_out_differs(const struct choose_certificate *c);

#endif
