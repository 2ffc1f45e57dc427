/* scene_name.c - see scene_name.h. */
#include "host_sim/scene/scene_name.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/afm/afm_plant.h"
#include "firmware/bus/settings.h"
#include "firmware/stage/stages.h"
#include "host_sim/cli/options.h"
#include "host_sim/cli/options_nearest.h"
#include "models/models.h"
#include "models/scenes/scenes_table.h"

enum { NAME_SHOWN = 120 };

const struct model *scene_model(int i)
{
    return i < MODELS ? model_table[i] : i == MODELS ? &afm_plant : NULL;
}

static void microscope_scene(struct scene *s)
{
    s->method = afm_plant_method.name;
    s->substeps = 1120; /* 16 samples in a period of 70 kHz */
    s->observable = AFM_PLANT_HEIGHT;
    s->over = 1.0;
}

static const struct scene_kind plants = {.stage_calls = &stages_for_plants, .seed = -1};
static const struct scene_kind microscope = {
    .method = &afm_plant_method,
    .stage_calls = &afm_plant_calls,
    .holds_stages = true,
    .seed = LEVER_SEED,
    .from_rest = true,
    .check = afm_plant_check,
    .scene = microscope_scene,
    .settings = afm_plant_settings,
    .keep = afm_plant_forget_pointers,
    .without_bus = "it is a microscope, which works in run and test, and in programs that speak with those",
    .library = "a microscope alone is opened by contactplant_afm_open, or on a bus",
};

const struct scene_kind *scene_kind(const struct model *m)
{
    return scene_is_microscope(m) ? &microscope : &plants;
}

struct stages *scene_stages(const struct scene_kind *k, struct stages *own, double *scratch)
{
    return k->holds_stages ? (struct stages *)(void *)scratch : own;
}

bool scene_is_microscope(const struct model *m)
{
    return !m->rhs;
}

void scene_subject(const struct model *m, const double *si, char *text)
{
    int which = -1;
    const struct scene_kind *k = scene_kind(m);
    bool refuses = k->check && k->check(si, &which) != NULL;
    snprintf(text, SCENE_SUBJECT, "%s%s", refuses && which >= 0 ? m->parameter[which].name : "",
             refuses && which >= 0 ? " " : "");
}

const struct method *scene_find_method(const struct model *m, const char *name)
{
    const struct method *own = scene_kind(m)->method;
    if (!own)
        return method_find(name);
    return !strcmp(name, own->name) || !strcmp(name, auto_method.name) ? own : NULL;
}

void scene_default(struct scene *s, int i)
{
    scenes_default(s, scene_model(i));
    if (scene_kind(s->model)->scene)
        scene_kind(s->model)->scene(s);
}

/* The stages of a lever's scene stand before z and behind deflection, those of a microscope before z and
 * behind displacement. */
static double stage_at(double at)
{
    if (at == 1.0 + LEVER_Z)
        return 1.0 + AFM_PLANT_Z;
    return at == 1.0 + MODEL_INPUTS + LEVER_DEFLECTION ? 1.0 + MODEL_INPUTS + AFM_PLANT_DISPLACEMENT : at;
}

/* An exchange in each millisecond: a step may be off by a part in twice the samples of that. */
void scene_around_lever(const struct scene *lever, double ticks, struct scene *s)
{
    double si[MODEL_PARAMETERS], step = lever->frame_s / lever->substeps / lever->dilation;
    struct harmonic unused[MODEL_INPUTS];
    scenes_resolve(lever, si, unused);
    scene_default(s, MODELS);
    memcpy(s->value, si, LEVER_PARAMETERS * sizeof *si);
    double samples = floor(s->frame_s / (step * ticks) + 0.5);
    s->value[AFM_PLANT_NUMBERS + STATION_TICKS] = ticks;
    s->substeps = samples < 1.0 ? 1 : samples > 4096.0 ? 4096 : (uint32_t)samples;
    memcpy(s->stage, lever->stage, sizeof s->stage);
    for (int i = 0; i < SCENE_STAGES; i++)
        s->stage[i][STAGE_AT] = stage_at(lever->stage[i][STAGE_AT]);
}

enum scene_origin scene_name_find(const char *name, struct scene *s)
{
    for (int i = 0; i < SCENE_MODELS; i++) {
        if (!strcmp(name, scene_model(i)->name)) {
            scene_default(s, i);
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
    const char *known[SCENE_MODELS + SCENES];
    for (int i = 0; i < SCENE_MODELS + SCENES; i++)
        known[i] = i < SCENE_MODELS ? scene_model(i)->name : scenes_table[i - SCENE_MODELS].name;
    snprintf(why, SCENE_REASON, "no such %s: \"%.*s\"%s", kind, NAME_SHOWN, name,
             options_advise(name, strlen(name), known, SCENE_MODELS + SCENES,
                            "contactplant list shows models and scenes"));
}

int scene_method_names(const char **name)
{
    for (int i = 0; i < METHODS; i++)
        name[i] = method_table[i]->name;
    return METHODS;
}

void scene_method_refuse(const char *method, char *why)
{
    const char *name[METHODS];
    int n = scene_method_names(name);
    snprintf(why, SCENE_REASON, "no such method: \"%.*s\"%s", NAME_SHOWN, method,
             options_advise(method, strlen(method), name, n, NULL));
}
