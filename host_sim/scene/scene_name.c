/* scene_name.c - see scene_name.h. */
#include "host_sim/scene/scene_name.h"

#include <stdio.h>
#include <string.h>
#include "host_sim/cli/options.h"
#include "models/models.h"

enum { SHOWN = 120 };

enum scene_origin scene_name_find(const char *name, struct scene *s)
{
    for (int i = 0; i < MODELS; i++) {
        if (!strcmp(name, model_table[i]->name)) {
            scenes_default(s, model_table[i]);
            return SCENE_OF_MODEL;
        }
    }
    const struct preset *p = scenes_find(name);
    if (!p)
        return SCENE_OF_NOTHING;
    *s = p->scene;
    return SCENE_OF_PRESET;
}

void scene_name_refuse(const char *kind, const char *name, char *why)
{
    const char *known[MODELS + SCENES];
    for (int i = 0; i < MODELS + SCENES; i++)
        known[i] = i < MODELS ? model_table[i]->name : scenes_table[i - MODELS].name;
    const char *nearest = options_nearest(name, known, MODELS + SCENES);
    snprintf(why, SCENE_REASON, "no such %s: \"%.*s\"%s%s; contactplant list shows models and scenes", kind,
             SHOWN, name, nearest ? "; did you mean " : "", nearest ? nearest : "");
}
