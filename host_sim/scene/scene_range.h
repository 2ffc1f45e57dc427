/* scene_range.h - the numbers of a scene by name on a command line, and ranges of them, for commands that
 * run a scene often.
 *
 * A name is a key of the scene: "damping", "omega" in a scene with [paper], "force.frequency" of a drive.
 * A value has its unit, or is in the table's without one. Functions that return a status have printed one
 * line when it is not 0. */
#ifndef HOST_SIM_SCENE_RANGE_H
#define HOST_SIM_SCENE_RANGE_H

#include "host_sim/cli/options.h"
#include "host_sim/scene/range.h"
#include "host_sim/scene/scene_keys.h"

#include <stdio.h>

enum { SCENE_RANGE_POINTS = 1000000, SCENE_RANGE_NAME = 96 };

/* A number of the scene that goes from one value to another. */
struct scene_range {
    struct scene_key key;
    char column[SCENE_RANGE_NAME]; /* as in the CSV, with its unit */
    char words[SCENE_RANGE_NAME];  /* for people: "frequency of force" */
    const char *unit;              /* "" or "1" for none */
    int input;                     /* input of a drive's key, or -1 */
    struct range values;           /* n 0: there is no such range */
};

/* Names of a command's own numbers, for the line that refuses one; NULL for none. */
enum { SCENE_RANGE_ALSO = 96 };
struct scene_range_names {
    const char *name[SCENE_RANGE_ALSO];
    int n;
    const char *where; /* "contactplant .. shows them", for a name near to none; NULL: the usual one */
};

/* The number that is called name[0..n-1]: key, column and input of *r. */
int scene_range_find(const struct usage *u, const struct scene *s, const char *name, size_t n,
                     const struct scene_range_names *also, struct scene_range *r);

/* NAME=FROM:TO:N or NAME=FROM:TO:N:log, the text of --option (range.h). */
int scene_range_read(const struct usage *u, const struct scene *s, const char *option, const char *text,
                     struct scene_range *r);

/* Reads the text behind the equal sign, where key and column of *r are known. */
int scene_range_limits(const struct usage *u, const char *option, const char *text, struct scene_range *r);

/* Every --set NAME=VALUE into the scene; and one of them. */
int scene_range_settings(const struct options *o, struct scene *s);
int scene_range_setting(const struct usage *u, struct scene *s, const char *text,
                        const struct scene_range_names *also);

/* The value behind the equal sign of NAME=VALUE, for a number of another table. */
int scene_range_parameter(const struct usage *u, const struct parameter *p, const char *equal, double *value);

/* Key i of all numbers and other keys: parameters, then each input's; key and input of *r. False when
 * there are no more. */
bool scene_range_nth(const struct scene *s, int i, struct scene_range *r);

/* Puts a value into the scene. */
void scene_range_set(struct scene *s, const struct scene_range *r, double value);

/* For an axis: its words with the unit in brackets, "log10 of" before them where the range is logarithmic. */
void scene_range_label(const struct scene_range *r, char *text, size_t size);

/* Its part of a run's identity; nothing where there is no range. */
void scene_range_print(FILE *f, const struct scene_range *r);

/* A column's name: name and unit, "force.amplitude_N". */
void scene_range_spell(char *text, size_t size, const char *name, const char *unit);

#endif
