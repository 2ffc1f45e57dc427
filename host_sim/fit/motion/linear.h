/* linear.h - the response of a plant that is linear about its rest: what a sweep at a small level shows. */
#ifndef HOST_SIM_FIT_LINEAR_H
#define HOST_SIM_FIT_LINEAR_H

#include "host_sim/fit/motion/orbit.h"

/* The response at this frequency, as orbit.h has it. False: it is infinite. */
bool linear_response(const struct orbit_task *t, double frequency_Hz, double *re, double *im);

/* Frequency and decay of the free motion of a plant with one degree of freedom: e^(-decay t) cos(2 pi
 * frequency t). False: it has more, or does not swing. */
bool linear_ring(const struct orbit_task *t, double *frequency_Hz, double *decay_per_s);

#endif
