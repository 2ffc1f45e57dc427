/* maps.h - what commands share that run one scene many times: the scene with its options, their files, and the rows back. */
#ifndef HOST_SIM_MAPS_H
#define HOST_SIM_MAPS_H

#include "firmware/plant/plant.h"
#include "host_sim/cli/chart.h"
#include "host_sim/cli/options.h"
#include "host_sim/scene/scene_load.h"

struct maps_scene {
    struct scene scene; /* with what --set says */
    enum scene_origin origin;
    const struct method *method; /* of --method or the scene */
    double tol;                  /* of --tol or the scene */
};

/* The scene of the command's word, --set, --method and --tol. 0, or the exit status after a line. */
int maps_load(const struct options *o, struct maps_scene *m);

/* A plant whose energy balance and peak force nobody looks at does without them from here on, until a state is set or a drive
 * started: they are a tenth to a third of its work. All else has the same bits. */
void maps_drop_books(struct plant *pl);

/* The least damping of the masses at rest, per model time: twice the rate at which its slowest free motion
 * falls, or less. */
double maps_damping(const struct model *m, const double *p);

/* The time of --name into *value, which stays where it is not given: in seconds of the real plant, or the paper's. */
int maps_read_time(const struct options *o, const char *name, const struct scene *s, double *value);

/* That --out, --svg, --shard and the scene's file go together. 0, or the exit status after a line. */
int maps_check_files(const struct options *o, enum scene_origin origin);

/* Lines on stderr where the scene leaves a source paper's range. */
void maps_warn(const struct options *o, const struct maps_scene *m);

/* The picture into the file --svg. 0, or the exit status after a line. */
int maps_finish_chart(const struct options *o, struct chart *c);

/* The rows of a CSV of jobs.h with `columns` columns behind run and job, header left out: text is NaN. */
struct maps_table {
    int n, columns;
    double *cell; /* [n][columns], to be freed */
};

/* False: errno says why not. */
bool maps_read(struct maps_table *t, int columns, const char *path);

#endif
