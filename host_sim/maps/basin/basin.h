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
    double x[MODEL_STATES]; /* SI */
    struct basin_motion motion;
    int attractor; /* its number, -1 for none; no column */
};

/* The command line into *b: scene, method, starts, columns, identity. 0, or the exit status after a line. */
int basin_read(struct basin *b);

/* Makes the table of columns of this scene and plant. */
void basin_describe_rows(struct basin *b);

/* SI value of a model unit of state i, and its unit; 1 where the scene's numbers have none.
 * basin_peak_unit does so for the peak. */
double basin_unit(const struct basin *b, int i, const char **unit);
double basin_peak_unit(const struct basin *b);

/* The attractors in the rows of `path`: a table on standard output, and the picture --svg. 0, or the exit
 * status after a line. */
int basin_report(const struct basin *b, const char *path);

/* The picture: start positions and velocities, coloured by attractor. NULL, or a reason. */
const char *basin_draw(const struct basin *b, const struct basin_clusters *c, const struct basin_row *row,
                       int n, FILE *out);

#endif
