/* basin_clusters.h - attractors from the fingerprints of motions: counts, intervals of confidence, mirror images.
 *
 * Two motions are of one attractor when their periods are equal and means and rms of all states differ by less than a
 * tolerance, relative to the attractor's own size: the largest rms among the states of the same kind (lengths, velocities).
 * What shows no period is quasiperiodic (or not settled yet) or, where neighbours part, chaotic. Its means over a while
 * scatter, so the tolerance is wider, and attractors that differ by less are told as one. */
#ifndef HOST_SIM_BASIN_CLUSTERS_H
#define HOST_SIM_BASIN_CLUSTERS_H

#include "host_sim/maps/basin/basin_motion.h"

enum basin_kind { BASIN_PERIODIC, BASIN_APERIODIC, BASIN_CHAOTIC, BASIN_KINDS };

/* Growth a forcing period from which on a motion without a period is called chaotic: three times what a quasiperiodic one
 * shows over BASIN_GROWTH_UNSETTLED periods. */
#define BASIN_CHAOS 0.01
enum { BASIN_ATTRACTORS = 1024 };

/* Where a Z2 symmetry of a model takes an attractor. */
enum basin_image { IMAGE_NONE, IMAGE_MIRROR, IMAGE_ENDS, IMAGE_BOTH, IMAGES };

struct basin_attractor {
    struct basin_motion motion; /* the first one that was seen */
    int count;
    double growth; /* mean */
    /* Which attractor is the mirror image (x to -x), that with the shaft's ends exchanged, and both: itself where it is
     * symmetric, -1 where none was seen. */
    int image[IMAGES];
};

struct basin_clusters {
    const struct model *model;
    int n;
    struct basin_attractor attractor[BASIN_ATTRACTORS]; /* finished: by count, the most frequent first */
    int escaped, trouble;                               /* motions without an attractor */
    int total;
};

enum basin_kind basin_clusters_kind(const struct basin_motion *motion);

void basin_clusters_start(struct basin_clusters *c, const struct model *m);

/* One motion more: the number of its attractor for now, -1 where it has none, -2 where there would be more than
 * BASIN_ATTRACTORS. */
int basin_clusters_add(struct basin_clusters *c, const struct basin_motion *motion);

/* Sorts, and finds the images. order[old number] = new number, [c->n]; NULL: not asked. */
void basin_clusters_finish(struct basin_clusters *c, int *order);

/* Wilson's interval for a share, k of n, at 95 % (Wilson 1927). */
void basin_clusters_wilson(int k, int n, double *low, double *high);

#endif
