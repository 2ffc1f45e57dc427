/* plant_of_scene.h - a scene's numbers, and a plant from it, for all that run one without a bus. */
#ifndef HOST_SIM_PLANT_OF_SCENE_H
#define HOST_SIM_PLANT_OF_SCENE_H

#include "firmware/plant/plant.h"
#include "models/scenes/scenes.h"

/* A scene's parameters and drives in SI, and what its model makes of them. */
struct scene_point {
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct harmonic drive[MODEL_INPUTS]; /* SI */
    struct scale scale;
};
void point_of_scene(const struct scene *s, struct scene_point *q);

/* Gives plant_init what the scene says: its method, tolerance and dilation, and a tick of its step on the
 * bus. The caller changes what it knows better. si: as of scenes_resolve. scratch: as the method needs.
 */
struct plant_config plant_config_of_scene(const struct scene *s, const double *si, double *scratch);

/* Likewise with ticks of real time, without dilation. tick_s 0: the scene's step (scene_check_step). */
struct plant_config plant_config_of_real_scene(const struct scene *s, const double *si, double tick_s,
                                               double *scratch);

/* A plant in the scene's start, its drives sounding. NULL, or why there is none. */
MUST_CHECK const char *plant_of_scene(struct plant *pl, const struct plant_config *c, const struct scene *s,
                                      const struct harmonic *drive);

#endif
