/* random.h - statistics of a scene under noise: many realisations, each with seeds of its own, beside closed forms.
 *
 * Realisation i has i added to every noise_seed of the scene. After `settle` it is looked at for `over`, at each step: shares of time
 * in the bins of a range, up-crossings of the bins' edges (a top or bottom between two steps counts too, by the parabola
 * through three samples), time out of contact and touchdowns from located switches. Standard errors come from the scatter of
 * realisations, which are independent. Realisations are jobs of jobs.h, a row each. */
#ifndef HOST_SIM_RANDOM_H
#define HOST_SIM_RANDOM_H

#include "host_sim/maps/maps.h"

enum { RANDOM_BINS = 150, RANDOM_SEEDS = 1000000 };

/* A row is an array of doubles. From RANDOM_BELOW on it has shares of time: below the range, in n_bins bins, and above the
 * range. Behind them it has the up-crossings per time of n_bins + 1 edges. */
enum {
    RANDOM_SEED,    /* realisation, from 0 */
    RANDOM_FINITE,  /* 1; 0: it escaped, and the rest are zeros */
    RANDOM_MEAN,    /* of the observable */
    RANDOM_SQUARE,  /* mean square about the middle of the range */
    RANDOM_OPEN,    /* share of time with every contact open */
    RANDOM_TOUCHES, /* touchdowns per time */
    RANDOM_BELOW,   /* share of time below the range */
    RANDOM_BIN      /* the first bin */
};

struct random_runs {
    struct maps m;
    double over, settle; /* of the real plant, or of the paper */
    int n, n_bins;
    double low, high; /* of the observable */
    double *work;     /* of the method */
};

static inline int random_columns(const struct random_runs *r)
{
    return RANDOM_BIN + 2 * r->n_bins + 2;
}

static inline double random_edge(const struct random_runs *r, int i)
{
    return r->low + (r->high - r->low) * i / r->n_bins;
}

/* The command line into *r. 0, or the exit status after a line. */
int random_read(struct random_runs *r);

/* Realisation i over this time: its row, row[random_columns]. NULL, or why the plant cannot be. */
const char *random_realise(const struct random_runs *r, int i, double over, double *row);

/* What the rows in --out say together, as CSV on standard output, and the picture --svg. 0, or the exit status after a line. */
int random_report(const struct random_runs *r);

#endif
