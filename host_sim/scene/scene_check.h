/* scene_check.h - whether what a scene asks goes together, once every number is inside its own range. */
#ifndef HOST_SIM_SCENE_CHECK_H
#define HOST_SIM_SCENE_CHECK_H

#include "models/scenes/scenes.h"

enum { SCENE_CHECK_REASON = 256 };

/* NULL, or the member of *s at the root of the contradiction; why[SCENE_CHECK_REASON] says what to do. The
 * method's own step guard has the last word. */
const void *scene_check(const struct scene *s, char *why);

/* As scene_check without the step guard, for a caller that takes another method, step or tolerance. */
const void *scene_check_unstepped(const struct scene *s, char *why);

/* Seconds of the real plant in one step. */
double scene_check_step(const struct scene *s);

#endif
