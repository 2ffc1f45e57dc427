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

/* The command line into *b: scene, method, starts, columns, identity. 0, or the exit status after a line. */
int basin_read(struct basin *b);

/* Makes the table of columns of this scene and plant. */
void basin_describe_rows(struct basin *b);

/* The unit of state i as the scene writes it; "" where the scene's numbers have none. */
const char *basin_unit(const struct basin *b, int i);

/* SI value of a model unit of the observable. */
double basin_peak_unit(const struct basin *b);

/* A state as the scene writes it, at phase 0 of the drives, in model units; and back. */
void basin_show(const struct basin *b, const double *x, double *shown);
void basin_take(const struct basin *b, const double *shown, double *x);

/* The attractors in the rows of `path` (NULL: of this run): a table, --svg and --report. 0, or the exit
 * status after a line. */
int basin_report(const struct basin *b, const char *path);

/* "3", "chaos" or "none". */
void basin_period_text(const struct basin_motion *motion, char *text, size_t size);

/* Start positions and velocities, coloured by attractor, and the attractors as a table. NULL, or a reason. */
const char *basin_draw(const struct basin *b, const struct basin_clusters *c, const struct basin_row *row,
                       int n, struct figure *g);

#endif
