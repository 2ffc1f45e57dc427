/* scene_print.h - a scene as the text file that scene_file_parse reads back to the last bit, each key with
 * its meaning. */
#ifndef HOST_SIM_SCENE_PRINT_H
#define HOST_SIM_SCENE_PRINT_H

#include <stdio.h>
#include "models/scenes/scenes.h"

void scene_print(FILE *out, const char *title, const struct scene *s);

#endif
