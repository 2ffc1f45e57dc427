/* choose_climb.h - a method on a model: its cost, and the coarsest step that keeps the tolerance. */
#ifndef HOST_SIM_CHOOSE_CLIMB_H
#define HOST_SIM_CHOOSE_CLIMB_H

#include "host_sim/choose/choose.h"
#include "host_sim/choose/choose_steps.h"

/* The rank of an attempt: time on the machine, instructions where that is not known. */
double choose_rank(const struct choose_certificate *c, const struct choose_attempt *t, int method);

/* The highest frequency of the sweep, of the real plant; 0 without one. */
double choose_swept_Hz(const struct choose_certificate *c);

/* Fills the costs of an attempt from its scene. */
void choose_price(const struct search *o, struct choose_attempt *t, int method);

/* The coarsest step of a method that meets the tolerance, unless it ranks above `most`. */
void choose_climb(struct search *o, struct choose_verdict *v, int method, double most);

/* Instructions of the steps of one frame on a machine, and bus seconds; 0: not known. */
double choose_frame_cost(const struct choose_attempt *t, int machine);
double choose_time_s(const struct choose_attempt *t, int method, int machine);

#endif
