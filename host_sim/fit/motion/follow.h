/* follow.h - the periodic motions along a response curve: each point begins where the one before is.
 *
 * Between two points the frequency moves in steps so short that the motion changes by less than
 * FOLLOW_CHANGE of its size. Where no such step is left the branch ends: the plant then runs at the next
 * point until it settles, as a rig in a sweep does. Only stable motions count. */
#ifndef HOST_SIM_FIT_FOLLOW_H
#define HOST_SIM_FIT_FOLLOW_H

#include "host_sim/fit/motion/orbit.h"

#define FOLLOW_CHANGE 0.25

struct follow_point {
    bool found;     /* a stable motion with the period of the drive */
    double jump_Hz; /* the branch ended there, on the way to this point; 0: it did not */
    struct orbit orbit;
};

/* The motion of the plant *t near one of a plant that differs little. False: there is none that is stable. */
bool follow_on(struct orbit_task *t, const struct orbit *from, struct orbit *o);

/* The motions at frequency[0..n-1] (Hz), visited in the order first, first + by, ..: by is 1 or -1. Returns
 * the number of jumps. */
int follow_curve(struct orbit_task *t, const double *frequency, int n, int by, struct follow_point *at);

#endif
