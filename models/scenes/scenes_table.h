/* scenes_table.h - the presets. */
#ifndef MODELS_SCENES_TABLE_H
#define MODELS_SCENES_TABLE_H

#include "models/scenes/scenes.h"

enum {
    SCENES = 64,
    SCENES_OWN = 7 /* the first ones are no figures of papers */
};
extern const struct preset scenes_table[SCENES];

#endif
