/* rk4.h - the step guard of rk4, rk4_float32 and rk4_unlocated. */
#ifndef FIRMWARE_RK4_H
#define FIRMWARE_RK4_H

#include "firmware/method/method.h"

/* The largest eigenfrequency * step, in rad. Above it a
 * bounce is not resolved, and each one makes or loses energy. */
#define RK4_ANGLE_MAX 0.2

#endif
