/* plant_scene.h - a plant in the initial state of a scene, its drives sounding as soon as time runs. */
#ifndef FIRMWARE_PLANT_SCENE_H
#define FIRMWARE_PLANT_SCENE_H

#include "firmware/plant/plant.h"
#include "firmware/observe/watch.h"
#include "models/scenes/scenes.h"

/* Puts a plant into the scene's initial state, starts its drives without a ramp, and its noise within one
 * tick. Call it once after plant_init (or app_init) with the scene's model and `si`; si and drive are the
 * results of scenes_resolve. The tick rate must give each drive DRIVE_TICKS_MIN ticks a period. The hold
 * of noise is rounded to whole ticks, at most NOISE_HOLD_MAX. */
void plant_scene_begin(struct plant *pl, const struct scene *s, const double *si,
                       const struct harmonic *drive);

/* Gives the limits of the scene's watch, SI in bus seconds at this dilation; false, and *l untouched, when
 * the scene watches nothing. */
bool plant_scene_watch(const struct scene *s, double dilation, struct watch_limits *l);

#endif
