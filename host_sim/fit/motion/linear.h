/* linear.h - the response of a plant that is linear about its rest: what a sweep at a small level shows. */
#ifndef HOST_SIM_FIT_LINEAR_H
#define HOST_SIM_FIT_LINEAR_H

#include "host_sim/fit/motion/orbit.h"

/* The response at this frequency, as orbit.h has it. False: it is infinite. */
bool linear_response(const struct orbit_task *t, double frequency_Hz, double *re, double *im);

#endif
