/* scene_name.h - a scene by the name of a model or a preset. It reads no file and prints nothing: the
 * library uses it, too. */
#ifndef HOST_SIM_SCENE_NAME_H
#define HOST_SIM_SCENE_NAME_H

#include "firmware/method/method.h"
#include "host_sim/scene/scene_file.h"
#include "models/models.h"

enum scene_origin { SCENE_OF_NOTHING, SCENE_OF_MODEL, SCENE_OF_PRESET, SCENE_OF_FILE };

enum { SCENE_REASON = SCENE_FILE_REASON };

/* The models of scenes: those of model_table, and the microscope (firmware/afm/afm_plant.h), which is a plant
 * on a bus and nothing else. NULL: there are no more. */
enum { SCENE_MODELS = MODELS + 1 };
const struct model *scene_model(int i);

/* A plant of this model has these beside its equations. */
struct scene_kind {
    const struct method *method; /* the one that runs it; NULL: any that takes it */
    const struct plant_stage_calls *stage_calls;
    bool holds_stages; /* its scratch memory is that of its stages, too */
    int seed;          /* the parameter that another seed of a run changes; -1: none */
    bool from_rest;    /* a scene has no other start */
    /* Names the parameter that it refuses; NULL: the tables do. */
    const char *(*check)(const double *si, int *which);
    void (*scene)(struct scene *s); /* defaults of its scenes and settings; NULL: none of its own */
    void (*settings)(double *setting);
    void (*keep)(double *scratch);     /* before its scratch memory is kept as bytes; NULL: nothing to do */
    const char *without_bus, *library; /* NULL, or why it does not run alone: for a command, for a program */
};
const struct scene_kind *scene_kind(const struct model *m);

/* The memory of its stages: `own`, or a part of its scratch memory. */
struct stages *scene_stages(const struct scene_kind *k, struct stages *own, double *scratch);

/* True for the microscope. */
bool scene_is_microscope(const struct model *m);

/* The name of the parameter that a microscope refuses, with a blank behind it into text[SCENE_SUBJECT]: its
 * reasons need one. "" where it refuses none, and for any other model. */
enum { SCENE_SUBJECT = 40 };
void scene_subject(const struct model *m, const double *si, char *text);

/* The method of this name that runs this model: a microscope has one of its own. NULL: there is none. */
const struct method *scene_find_method(const struct model *m, const char *name);

/* A scene of the defaults of model i. A microscope samples its lever 16 times a period. */
void scene_default(struct scene *s, int i);

/* The microscope around the lever of this scene, with so many of the lever's steps in a sample. */
void scene_around_lever(const struct scene *lever, double ticks, struct scene *s);

/* The scene of this name: a model's defaults, or a preset. SCENE_OF_NOTHING, with *s as it was, when there
 * is none. */
enum scene_origin scene_name_find(const char *name, struct scene *s);

/* Into why[SCENE_REASON]: there is no such `kind` ("model or preset"), and the nearest name. */
void scene_name_refuse(const char *kind, const char *name, char *why);

/* Refuses a method in this way. And the names of all: name has room for METHODS; returns how many. */
void scene_method_refuse(const char *method, char *why);
int scene_method_names(const char **name);

#endif
