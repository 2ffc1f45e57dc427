/* profile.h - the profile likelihood of an unknown: how chi^2 rises where it is held off its best value, and
 * all others are fitted again. Where the rise is no parabola, the interval from slopes at the minimum is not
 * to be trusted. */
#ifndef HOST_SIM_FIT_PROFILE_H
#define HOST_SIM_FIT_PROFILE_H

#include "host_sim/fit/starts.h"

enum { PROFILE_POINTS = 17, PROFILE_REACH = 3 /* in standard deviations, to both sides */, PROFILE_FAR = 10 };

struct profile {
    int unknown;
    double u[PROFILE_POINTS], rise[PROFILE_POINTS]; /* chi^2 above the least; NaN: not computed */
    bool crossed[2];                                /* the rise comes to that of 95 % below and above */
    double low, high;                               /* u, where it does */
};

/* The profile of unknown k, within its reach. False: the user stopped it, and it has fewer
 * points. */
bool profile_find(struct fit_setup *s, const struct fit_result *r, int k, struct profile *p);

/* The true standard deviation of unknown k over that from the slopes. 1: two of these off, chi^2 rises by 2
 * at least on both sides, where a parabola rises by 4. Else it is half of where chi^2 has risen by 4, on the
 * further side. Infinite: that is not within PROFILE_FAR. Cost: fits of the other unknowns, two at least. */
double profile_widening(struct fit_setup *s, const struct fit_result *r, int k);

#endif
