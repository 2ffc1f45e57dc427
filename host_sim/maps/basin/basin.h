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
    int argc; /* the command line, for the report */
    char **argv;
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

/* The attractors in the rows of `path`: a table on standard output, the picture --svg and the page --report.
 * 0, or the exit status after a line. */
int basin_report(const struct basin *b, const char *path);

/* The picture: start positions and velocities, coloured by attractor. NULL, or a reason. */
const char *basin_draw(const struct basin *b, const struct basin_clusters *c, const struct basin_row *row,
                       int n, FILE *out);

/* The classes of a picture: the most frequent attractors,
 * then all others, then motions without an attractor. */
enum { BASIN_OWN = 5, BASIN_OTHERS = 5, BASIN_NONE = 6, BASIN_CLASSES = 7 };
int basin_class_of(int attractor);
void basin_class_name(const struct basin_clusters *c, int k, char *name, size_t size);

/* "3", "chaos" or "none". */
void basin_period_text(const struct basin_motion *motion, char *text, size_t size);

/* The page. NULL, or a reason. */
const char *basin_html(const struct basin *b, const struct basin_clusters *c, const struct basin_row *row,
                       int n, const char *path);

#endif
