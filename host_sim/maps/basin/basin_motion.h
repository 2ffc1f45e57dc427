/* basin_motion.h - where a start leads: the motion on which it settles, and numbers that tell motions
 * apart.
 *
 * A motion has settled with period k when the state at phase 0 comes back after k forcing periods, and
 * again after 2 k and 3 k, to within `repeat` times 1 + its size, in model units. k is at most
 * BASIN_PERIODS. A motion that shows no period in `bound` periods is unsettled: chaotic, quasiperiodic, or
 * slow. A decay that turns comes back early, after a multiple of its period. The period is therefore the
 * smallest divisor of k after which it came back to BASIN_DIVISOR times that distance. With a largest
 * multiplier lambda, the state is then within repeat/|1 - lambda^k| of the attractor.
 *
 * The fingerprint is the mean and the root of the mean square of each state over BASIN_FINE ticks a
 * forcing period. It does not depend on the phase, and a mirrored motion has the mirrored mean.
 *
 * A motion has the bits of a plant with this method, tick by tick (host_sim/maps/basin/basin_map.h). It
 * settles with `steps` ticks a period. New plants at phase 0 then begin where it has settled: they are
 * measured with BASIN_FINE ticks, and their growth with `steps`. With batch_taylor motions settle in batches
 * (host_sim/maps/basin/basin_settle.h). */
#ifndef HOST_SIM_BASIN_MOTION_H
#define HOST_SIM_BASIN_MOTION_H

#include "host_sim/maps/basin/basin_map.h"

enum {
    BASIN_PERIODS = 32,     /* the longest period, in forcing periods */
    BASIN_FINE = 256,       /* least ticks a period when a motion is measured */
    BASIN_WANDER = 512,     /* periods of an unsettled motion that are measured */
    BASIN_GROWTH_SKIP = 64, /* periods before growth is measured; then periods of each */
    BASIN_GROWTH_SETTLED = 512,
    BASIN_GROWTH_UNSETTLED = 1024
};

#define BASIN_DIVISOR 1e3

enum basin_outcome { BASIN_SETTLED, BASIN_UNSETTLED, BASIN_GONE, BASIN_TROUBLE, BASIN_OUTCOMES };
extern const char *const basin_outcome_name[BASIN_OUTCOMES + 1]; /* NULL behind the last */

struct basin_motion {
    enum basin_outcome outcome;
    int period;    /* forcing periods; 0 unless settled */
    int periods;   /* that were run until it settled */
    double growth; /* mean logarithm of a small distance's growth per forcing period (Benettin et al. 1980) */
    double open;   /* share of time without any contact */
    double peak;   /* the observable's peak, at ticks */
    double mean[MODEL_STATES], rms[MODEL_STATES];
    double end[MODEL_STATES]; /* at phase 0, on the attractor; without one the last state at phase 0 */
};

/* Looks for a return of the state at phase 0, period after period. */
struct basin_repeat {
    double reference[MODEL_STATES];
    double apart[BASIN_PERIODS + 1]; /* distance from the reference, so many periods after it */
    int since, period;               /* periods since the reference; 0: no return was seen */
};

/* How far motions are followed. */
struct basin_patience {
    int bound;     /* forcing periods */
    double repeat; /* see above */
};

/* Finds the motions of n starts x[n][MODEL_STATES], which it overwrites. NULL, or a reason. */
const char *basin_motion_find(const struct basin_plant *b, const struct basin_patience *s, int n,
                              double (*x)[MODEL_STATES], struct basin_motion *motion);

#endif
