/* maps.h - scene, method, columns, identity and files, shared by the commands that run one scene many
 * times. */
#ifndef HOST_SIM_MAPS_H
#define HOST_SIM_MAPS_H

#include "firmware/plant/plant.h"
#include "host_sim/maps/rows.h"
#include "host_sim/report/figure.h"
#include "host_sim/scene/plant_of_scene.h"
#include "host_sim/scene/scene_load.h"
#include "host_sim/scene/scene_range.h"

struct maps {
    struct options o;
    struct scene scene; /* with --set */
    enum scene_origin origin;
    const char *name; /* the scene, as on the command line */
    const struct method *method;
    double tol; /* the method's tolerance */
    struct rows rows;
    FILE *copy;     /* rows that go to standard output are here, too; or NULL */
    char *identity; /* all that decides the rows, as text; the command frees it */
    size_t identity_size;
};

/* Options that sweep, stability and random share: --set --method --tol; and those of all maps: --svg
 * --report. */
extern const struct option maps_options[], maps_outputs[];

/* The scene of the command's word, with --set. 0, or the exit status after a line; so for all below that
 * return int. */
int maps_load(struct maps *m);

/* The method of --method or the scene; the tolerance of --tol, or the scene's but at most tol_most. */
int maps_load_method(struct maps *m, double tol_most);

/* The first number of the scene that the frequency (else the amplitude) of this input's drive is
 * proportional to, and by what factor. False: there is none. */
bool maps_find_drive_number(const struct scene *s, int input, bool frequency, struct scene_range *r,
                            double *factor);

/* A drive that moves something. */
bool maps_sounds(const struct harmonic *d);

/* The least damping of the masses at rest, per model time: twice the rate at which the slowest free motion
 * falls, or less. */
double maps_damping(const struct model *m, const double *p);

/* The time of --name into *value, in seconds of the real plant, or the paper's; without the option *value
 * stays. */
int maps_read_time(const struct maps *m, const char *name, double *value);

/* Checks that the scene and the files of --out, --rows, --svg, --report and --statistics are files of their
 * own. rows:
 * --out or
 * --rows, or NULL. */
int maps_check_files(const struct maps *m, const char *rows);

/* Writes the value that the command took for this option, or chose where it was not given. False where it
 * took the text or number of the command line as it is. */
typedef bool maps_say(const void *context, const char *option, FILE *f);

/* Makes the identity: kind and scene, each option that its row counts in (struct option), and the columns. */
int maps_identify(struct maps *m, const char *kind, maps_say *say, const void *context);

/* Says on stderr where the scene leaves a source paper's range; then computes all jobs: the command's
 * rows. */
int maps_compute(struct maps *m, struct jobs *j);

/* A map has these three for its rows. */
struct maps_finding {
    /* Sorts and counts; NULL for nothing. 0, or the exit status after a line. */
    int (*read)(void *context, const struct rows_table *t);
    /* The summary: what was found. */
    void (*tell)(void *context, const struct rows_table *t, FILE *f);
    /* Panels and tables. NULL, or why there are none. */
    const char *(*draw)(void *context, const struct rows_table *t, struct figure *g);
    bool is_table; /* the summary is one, and no words for the page */
};

/* Ends every map but a share of one. It reads the rows in `path` (NULL: those of maps_compute), writes the
 * picture --svg and the page --report, and tells the summary. 0, or the exit status after a line. */
int maps_conclude(const struct maps *m, const char *path, const struct maps_finding *what, void *context);

/* The axis of a range, as it is in the figure. */
void maps_put_axis(struct figure *g, const struct scene_range *r);

/* Six digits of a number with its unit: "212.34 Hz". Returns text[UNIT_TEXT]. */
const char *maps_in_words(double value, const char *unit, char *text);

#endif
