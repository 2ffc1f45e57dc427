/* scene_name.h - a scene by the name of a model or a preset. It reads no file and prints nothing: the
 * library uses it, too. */
#ifndef HOST_SIM_SCENE_NAME_H
#define HOST_SIM_SCENE_NAME_H

#include "host_sim/scene/scene_file.h"

enum scene_origin { SCENE_OF_NOTHING, SCENE_OF_MODEL, SCENE_OF_PRESET, SCENE_OF_FILE };

enum { SCENE_REASON = SCENE_FILE_REASON };

/* The scene of this name: a model's defaults, or a preset. SCENE_OF_NOTHING, with *s as it was, when there
 * is none. */
enum scene_origin scene_name_find(const char *name, struct scene *s);

/* Into why[SCENE_REASON]: there is no such `kind` ("model or preset"), and the nearest name. */
void scene_name_refuse(const char *kind, const char *name, char *why);

#endif
