/* plant_scene.h - a plant in the initial state of a scene, its drives sounding as soon as time runs. */
#ifndef FIRMWARE_PLANT_SCENE_H
#define FIRMWARE_PLANT_SCENE_H

#include "firmware/plant/plant.h"
#include "firmware/observe/watch.h"
#include "models/scenes/scenes.h"

/* After plant_init (or app_init) with the scene's model, `si` and a rate of at least DRIVE_TICKS_MIN ticks per period of each drive; si and
 * drive are what scenes_resolve gave. Noise is rounded to whole ticks of hold, at most NOISE_HOLD_MAX. */
void plant_scene_begin(struct plant *pl, const struct scene *s, const double *si,
                       const struct harmonic *drive);

/* The limits of the scene's watch on a bus of this dilation; false when it watches nothing. */
bool plant_scene_watch(const struct scene *s, double dilation, struct watch_limits *l);

#endif
