/* basin_motion.h - where a start leads: the motion it settles on, and numbers that tell that motion from others.
 *
 * A motion has settled with period k when the state at phase 0 comes back after k forcing periods, and again after 2 k and
 * 3 k, to within `repeat` (of 1 + its size, model units). k is at most BASIN_PERIODS; what shows none in `bound` periods is
 * unsettled: chaotic, quasiperiodic, or slow. A decay that turns comes back early after a multiple of its period, so the
 * period told is the smallest divisor of k after which it came back to BASIN_DIVISOR times that. Where the largest multiplier is lambda, the state is then within
 * repeat/|1 - lambda^k| of the attractor.
 *
 * The fingerprint is the mean and the root of the mean square of each state over BASIN_FINE ticks a forcing period: it does
 * not depend on the phase at which the motion was caught, and a mirrored motion has the mirrored mean.
 *
 * A motion is that of a plant with this method, tick by tick, to the last bit (host_sim/maps/basin/basin_map.h): it settles with `steps` ticks a period, and
 * from the state in which it has, new plants at phase 0 are measured with BASIN_FINE ticks and their growth with `steps`. Rig, rolling
 * contact and tip settle in batches with rk4_unlocated, to the same bits, and with batch_taylor (host_sim/maps/basin/basin_settle.h). */
#ifndef HOST_SIM_BASIN_MOTION_H
#define HOST_SIM_BASIN_MOTION_H

#include "host_sim/maps/basin/basin_map.h"

enum {
    BASIN_PERIODS = 32,     /* longest period, forcing periods */
    BASIN_FINE = 256,       /* ticks a period, at least, when a motion is measured */
    BASIN_WANDER = 512,     /* periods over which an unsettled motion is measured */
    BASIN_GROWTH_SKIP = 64, /* periods before the growth is measured, and over which: settled or not */
    BASIN_GROWTH_SETTLED = 512,
    BASIN_GROWTH_UNSETTLED = 1024
};

#define BASIN_DIVISOR 1e3

enum basin_outcome { BASIN_SETTLED, BASIN_UNSETTLED, BASIN_GONE, BASIN_TROUBLE, BASIN_OUTCOMES };
extern const char *const basin_outcome_name[BASIN_OUTCOMES + 1]; /* NULL behind the last */

struct basin_motion {
    enum basin_outcome outcome;
    int period;  /* forcing periods; 0 unless settled */
    int periods; /* completed until it was told */
    double
        growth;  /* mean logarithmic growth of a small distance in a forcing period (Benettin et al. 1980) */
    double open; /* share of time without any contact */
    double peak; /* of the observable, at ticks */
    double mean[MODEL_STATES], rms[MODEL_STATES];
    double end
        [MODEL_STATES]; /* a state at phase 0 on the attractor; of a motion without one the last at phase 0 */
};

/* The largest component of a state of n numbers; the largest difference of two states. */
double basin_size(const double *x, int n);
double basin_distance(const double *a, const double *b, int n);

/* The state at phase 0, period after period, in search of a return. */
struct basin_repeat {
    double reference[MODEL_STATES];
    double apart[BASIN_PERIODS + 1]; /* from the reference, so many periods after it */
    int since, period;               /* since the reference was taken; 0: none seen yet */
};

void basin_repeat_start(struct basin_repeat *r, const double *x, int n);

/* The next state: its period once it has come back three times, else 0. */
int basin_repeat_see(struct basin_repeat *r, const double *x, int n, double tolerance);

/* Without an attractor. */
void basin_motion_fail(struct basin_motion *m, enum basin_status status);

/* How far motions are followed. */
struct basin_patience {
    int bound;     /* forcing periods */
    double repeat; /* see above */
};

/* The motions of n starts, x[n][MODEL_STATES], which is used up. NULL, or a reason. */
const char *basin_motion_find(const struct basin_plant *b, const struct basin_patience *s, int n,
                              double (*x)[MODEL_STATES], struct basin_motion *motion);

#endif
