/* basin.h - a basin map of contactplant basin: what is asked, its rows, its report. */
#ifndef HOST_SIM_BASIN_H
#define HOST_SIM_BASIN_H

#include "host_sim/maps/basin/basin_clusters.h"
#include "host_sim/maps/basin/basin_starts.h"
#include "host_sim/maps/maps.h"

enum { BASIN_BLOCK = 50 /* starts in a job */, BASIN_STARTS_MAX = 1000000 };

struct basin {
    struct maps m;
    struct basin_plant plant;
    struct basin_patience patience;
    struct basin_starts starts;
};

/* A start and where it leads. */
struct basin_row {
    int start;
    double x[MODEL_STATES]; /* as the scene writes it */
    struct basin_motion motion;
    double end[MODEL_STATES]; /* motion.end as the scene writes it */
    int attractor;            /* its number, -1 for none; no column */
};

extern const struct usage basin_usage;

#endif
