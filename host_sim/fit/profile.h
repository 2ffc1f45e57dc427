/* profile.h - the profile likelihood of an unknown: how chi^2 rises where it is held off its best value, and
 * all others are fitted again. Where the rise is no parabola, the interval from slopes at the minimum is not
 * to be trusted. */
#ifndef HOST_SIM_FIT_PROFILE_H
#define HOST_SIM_FIT_PROFILE_H

#include "host_sim/fit/starts.h"

enum { PROFILE_POINTS = 17, PROFILE_REACH = 3 }; /* the reach in standard deviations, to both sides */

struct profile {
    int unknown;
    double u[PROFILE_POINTS], rise[PROFILE_POINTS]; /* chi^2 above the least; NaN: not computed */
    bool crossed[2];                                /* the rise comes to that of 95 % below and above */
    double low, high;                               /* u, where it does */
};

/* The profile of unknown k, within its reach. False: the user stopped it, and it has fewer
 * points. */
bool profile_find(struct fit_setup *s, const struct fit_result *r, int k, struct profile *p);

#endif
