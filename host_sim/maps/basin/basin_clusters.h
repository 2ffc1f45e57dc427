/* basin_clusters.h - attractors from the fingerprints of motions: counts, confidence intervals, mirror
 * images.
 *
 * Two motions belong to one attractor when their periods are equal, and the means and rms of all states
 * differ by less than a tolerance. It is relative to the attractor's size, the largest rms among states of
 * the same quantity. A motion without a period is chaotic where neighbours separate, else quasiperiodic or
 * not settled yet. Its means scatter, so its tolerance is wider, and attractors that differ by less count
 * as one. */
#ifndef HOST_SIM_BASIN_CLUSTERS_H
#define HOST_SIM_BASIN_CLUSTERS_H

#include "host_sim/maps/basin/basin_motion.h"

enum basin_kind { BASIN_PERIODIC, BASIN_APERIODIC, BASIN_CHAOTIC, BASIN_KINDS };

/* A motion without a period is called chaotic above this growth per forcing period: three times what a
 * quasiperiodic one shows over BASIN_GROWTH_UNSETTLED periods. */
#define BASIN_CHAOS 0.01
enum { BASIN_ATTRACTORS = 1024 };

/* Symmetries of a model, which take an attractor to an image. */
enum basin_image { IMAGE_NONE, IMAGE_MIRROR, IMAGE_ENDS, IMAGE_BOTH, IMAGES };

struct basin_attractor {
    struct basin_motion motion; /* the first one that was seen */
    int count;
    double growth; /* mean */
    /* The attractors that are its images: mirrored (x to -x), with the shaft's ends exchanged, and both.
     * Its own number where it is symmetric, -1 where none was seen. */
    int image[IMAGES];
};

struct basin_clusters {
    const struct model *model;
    int n;
    struct basin_attractor attractor[BASIN_ATTRACTORS]; /* once finished, the most frequent first */
    int escaped, trouble;                               /* motions without an attractor */
    int total;
};

enum basin_kind basin_clusters_kind(const struct basin_motion *motion);

void basin_clusters_start(struct basin_clusters *c, const struct model *m);

/* Adds a motion: the number of its attractor for now, -1 where it has none, -2 where there would be more than
 * BASIN_ATTRACTORS. */
int basin_clusters_add(struct basin_clusters *c, const struct basin_motion *motion);

/* Sorts attractors by count and finds the images. order[old number] = new number, or NULL. */
void basin_clusters_finish(struct basin_clusters *c, int *order);

/* Wilson's interval for a share, k of n, at 95 % (Wilson 1927). */
void basin_clusters_wilson(int k, int n, double *low, double *high);

#endif
