/* maps_run.h - a command over a scene, in files of its own, and its rows. */
#ifndef TESTS_MAPS_RUN_H
#define TESTS_MAPS_RUN_H

#include "host_sim/maps.h"

/* `command` NAME SCENE --out=FILE and the arguments, separated by blanks, with this text as the scene. The exit status; the
 * rows, with `columns` columns behind run and job, are in *t (cell to be freed). */
int maps_run(int (*command)(int argc, char **argv), const char *scene, const char *arguments, int columns,
             struct maps_table *t);

#endif
