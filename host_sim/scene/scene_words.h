/* scene_words.h - numbers by name, as command lines and test files write them: `mass=5 kg`, `amplitude=3 N`.
 *
 * A number whose name has its unit in it (mass_kg), and a field of a drive, is SI where no unit stands behind
 * it. All give one line into why[SCENE_REASON] where they refuse, and leave why alone where they do not. */
#ifndef HOST_SIM_SCENE_WORDS_H
#define HOST_SIM_SCENE_WORDS_H

#include "host_sim/scene/scene_keys.h"
#include "host_sim/scene/scene_name.h"
#include "host_sim/scene/scene_text.h"

enum { SCENE_WORDS_KEYS = 16 }; /* names that may stand beside parameters and settings */

/* Takes NAME=VALUE, with a unit behind a blank or not, off *rest: up to the next NAME=. False at the end, and
 * where it refuses. */
bool scene_words_next(struct word *rest, struct word *name, struct word *value, char *why);

/* A value with its unit inside [min, max]; `name` is for messages. */
bool scene_words_number(const char *name, struct word w, const char *unit, double min, double max,
                        double *value, char *why);

/* The wire index of a parameter or setting, mass_kg or mass, and its key; -1: there is none. */
int scene_words_find(const struct model *m, struct word name, struct scene_key *k);

/* Into why: there is no parameter or setting of this name, nor one of these keys; and the nearest name.
 * Always false. */
bool scene_words_no_name(const struct model *m, struct word name, const char *const *key, int n_keys,
                         char *why);

/* A parameter or setting and its value, checked against its table: the wire index, or -1. */
int scene_words_read(const struct model *m, struct word name, struct word value, double *x, char *why);

/* A field of a drive of this input: its place in x[DRIVE_FIELDS], or -1. */
int scene_words_field(const struct model *m, int input, struct word name, struct word value, double *x,
                      char *why);

#endif
