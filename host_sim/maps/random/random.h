/* random.h - statistics of a scene under noise: many realisations, each with seeds of its own, beside
 * closed forms.
 *
 * Realisation i adds i to every noise_seed of the scene. It settles, and is then measured at each step for
 * the time `over`. Measured are shares of time in the bins of a range, up-crossings of the bins' edges,
 * time out of contact, and touchdowns from located switches. A top or bottom between two steps counts as a
 * crossing too, by the parabola through three samples. Realisations are independent, so standard errors
 * come from their scatter. Each is a job of jobs.h, with one row. */
#ifndef HOST_SIM_RANDOM_H
#define HOST_SIM_RANDOM_H

#include "host_sim/maps/maps.h"

enum { RANDOM_BINS = 150, RANDOM_SEEDS = 1000000 };

/* A row is an array of doubles. From RANDOM_BELOW on it has shares of time: below the range, in n_bins
 * bins, and above the range. Behind them it has the up-crossings per time of n_bins + 1 edges. */
enum {
    RANDOM_SEED,    /* realisation, from 0 */
    RANDOM_FINITE,  /* 1, or 0: the motion escaped, and all that follows is 0 */
    RANDOM_MEAN,    /* mean of the observable */
    RANDOM_SQUARE,  /* mean square about the middle of the range */
    RANDOM_OPEN,    /* share of time with every contact open */
    RANDOM_TOUCHES, /* touchdowns per time */
    RANDOM_BELOW,   /* share of time below the range */
    RANDOM_BIN      /* the first bin */
};

struct random_runs {
    struct maps m;
    double over, settle; /* in seconds of the real plant, or the paper's time */
    int n, n_bins;
    double low, high; /* range of the observable */
    double *scratch;  /* the method's scratch memory */
};

static inline int random_columns(const struct random_runs *r)
{
    return RANDOM_BIN + 2 * r->n_bins + 2;
}

static inline double random_edge(const struct random_runs *r, int i)
{
    return r->low + (r->high - r->low) * i / r->n_bins;
}

extern const struct usage random_usage;

#endif
