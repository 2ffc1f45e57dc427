/* scene_keys.h - sections, keys, units and ranges of a scene file, from the model's own tables.
 *
 * One list serves to read a scene file, to print one, and to explain a mistake in it. */
#ifndef HOST_SIM_SCENE_KEYS_H
#define HOST_SIM_SCENE_KEYS_H

#include <stddef.h>
#include "models/scenes/scenes.h"

enum scene_section {
    SECTION_PLANT,
    SECTION_PAPER,
    SECTION_DRIVE, /* one for each input */
    SECTION_STAGE, /* one for each input or output that has one; `input` counts inputs from 0, outputs from
                      MODEL_INPUTS */
    SECTION_START,
    SECTION_ASK,
    SECTION_DEADLINE,
    SECTION_WATCH,
    SECTIONS
};
enum { SCENE_SUBSTEPS_MAX = 4096 };

extern const char *const scene_section_name[SECTIONS];

/* Where the stage of this signal stands in the scene, or -1. */
int scene_keys_stage(const struct scene *s, int signal);

/* A stage of this signal with its defaults; false when the scene has as many as it may. */
bool scene_keys_add_stage(struct scene *s, int signal);

/* Numbers of the stage in this slot as of a preset: a tube scanner or a stack of an AFM, or its optical lever
 * with an ADC of 16 bits; lengths. False: none has this name; name[SCENE_STAGE_PRESETS] has all. */
enum { SCENE_STAGE_PRESETS = 3 };
bool scene_keys_stage_preset(struct scene *s, int slot, const char *text, size_t n, const char **name);

enum scene_key_kind {
    KEY_NUMBER,
    KEY_COUNT,
    KEY_MODEL,
    KEY_METHOD,
    KEY_OBSERVABLE,
    KEY_WATCHED,
    KEY_PROMOTE
};

enum { SCENE_KEY_NAME = 40, SCENE_KEYS = MODEL_PARAMETERS + 2 /* at most, in one section */ };

struct scene_key {
    enum scene_key_kind kind;
    char name[SCENE_KEY_NAME]; /* mass_kg is `mass`: the unit stands behind the value */
    const char *full;          /* the table's name, also accepted */
    const char *unit;          /* "" for none */
    const char *meaning;
    double min, max;
    size_t offset; /* where the value is in struct scene: double for KEY_NUMBER, uint32_t for KEY_COUNT */
};

/* Key `index` of a section in a scene whose model and `paper` are known; false when there are no more.
 * `input` is that of a drive, and the signal of a stage. In a scene with the paper's parameters a drive has
 * noise only. */
bool scene_keys_get(const struct scene *s, enum scene_section section, int input, int index,
                    struct scene_key *k);

/* A unit as names write it: N_per_m1_5 of N/m^1.5. */
void scene_keys_spell(const char *unit, char *text, size_t size);

/* The key of a parameter or setting, whose value is at this offset. */
void scene_keys_parameter(const struct parameter *p, size_t offset, struct scene_key *k);

/* The value of a KEY_NUMBER or a KEY_COUNT. A value that is set must be in the key's range, and whole for
 * a count. */
double scene_keys_value(const struct scene *s, const struct scene_key *k);
void scene_keys_set(struct scene *s, const struct scene_key *k, double value);

#endif
