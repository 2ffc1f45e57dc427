/* basin.h - a basin map of contactplant basin: what is asked, its rows, its report. */
#ifndef HOST_SIM_BASIN_H
#define HOST_SIM_BASIN_H

#include "host_sim/maps/basin/basin_clusters.h"
#include "host_sim/maps/basin/basin_starts.h"
#include "host_sim/cli/options.h"
#include "host_sim/scene/scene_load.h"

#include <stdio.h>

enum { BASIN_BLOCK = 50 /* starts in a job */, BASIN_STARTS_MAX = 1000000, BASIN_COLUMNS = 2048 };

struct basin {
    const struct options *o;
    struct scene scene;
    enum scene_origin origin;
    const char *name; /* of the scene */
    struct basin_plant plant;
    struct basin_patience patience;
    struct basin_starts starts;
    char *identity;
    char columns[BASIN_COLUMNS]; /* of a row */
};

/* The scene and what the options ask of it. 0, or the exit status after a line (basin_read.c). */
int basin_read(struct basin *b, const struct options *o);
void basin_free(struct basin *b);

/* SI value of a model unit of state i, and its unit: 1 where the scene's numbers have none. */
double basin_unit(const struct basin *b, int i, const char **unit);

/* SI value of a model unit of the peak; the columns' names; and one row, SI, of a start x in SI (basin_rows.c). */
double basin_rows_peak_unit(const struct basin *b);
void basin_rows_name(struct basin *b);
void basin_rows_write(const struct basin *b, int start, const double *x, const struct basin_motion *m,
                      FILE *f);

/* A row: its run, its start's number, the start and the motion. False when it is none of these columns. */
bool basin_rows_read(const struct basin *b, const char *line, unsigned *run, int *start, double *x,
                     struct basin_motion *m);

/* Attractors of the rows of `path` as a table on stdout, and as a picture in `svg` (or NULL). The exit status. */
int basin_report(const struct basin *b, const char *path, const char *svg);

/* The picture: start positions against velocities, coloured by attractor (basin_draw.c). NULL, or a reason. */
struct basin_point {
    double x[MODEL_STATES]; /* SI */
    int attractor;          /* -1: none */
};
const char *basin_draw(const struct basin *b, const struct basin_clusters *c, const struct basin_point *point,
                       int n, FILE *out);

#endif
