/* scene_load.h - a scene by its name on the command line: a model, else a preset, else a file. */
#ifndef HOST_SIM_SCENE_LOAD_H
#define HOST_SIM_SCENE_LOAD_H

#include "firmware/method/method.h"
#include "host_sim/cli/options.h"
#include "host_sim/scene/scene_name.h"

/* The meaning of SCENE, for the help of commands that take one. */
#define SCENE_WORDS_HELP                                                                                     \
    "SCENE is a model, a preset or a scene file; without SCENE it is hertz_rig. contactplant list scenes\n"  \
    "prints the presets, and contactplant scene rig > my.ini writes a file to edit. docs/guide/scenes.md\n"  \
    "explains its keys. Options override them.\n"

/* The scene of this name. SCENE_OF_NOTHING, with *s as it was: why[SCENE_REASON] says what to do. A
 * model's scene is its defaults. */
enum scene_origin scene_load(const char *name, struct scene *s, char *why);
/* As scene_load, for a caller that puts another method, step or tolerance in the place of the file's, and
 * then asks the method. */
enum scene_origin scene_load_unstepped(const char *name, struct scene *s, char *why);
/* As scene_load, at temperature 0: maps need equal states to have equal futures. --set sets it again. A scene
 * with stages is refused: their states are no part of a map. */
enum scene_origin scene_load_cold(const char *name, struct scene *s, char *why);

/* Whether facts of scene_load_warn are told: of every scene; of a bare model only where it is an averaged
 * one, whose fast drive is among its own parameters. One that is not fast makes its equation stiff without
 * bound. */
bool scene_load_warns(enum scene_origin origin, const struct model *m);

/* One line on stderr for each fact of a source paper that leaves its range in this plant. */
void scene_load_warn(const char *command, const struct model *m, const double *si,
                     const struct harmonic *drive);

/* A line on stderr where --tol was given and the method has no tolerance: modal, or one that was named and
 * has its error from the step. method: as asked, auto too. */
void scene_load_tell_tolerance(const struct options *o, const struct model *m, const struct method *method);

#endif
