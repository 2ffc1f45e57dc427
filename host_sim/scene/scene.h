/* scene.h - one place that makes a plant on a bus from a scene and options: parameters, settings, rate,
 * identity. */
#ifndef HOST_SIM_SCENE_H
#define HOST_SIM_SCENE_H

#include "host_sim/cli/options.h"
#include "host_sim/scene/scene_app.h"
#include "host_sim/scene/scene_load.h"

/* --set --setting --method --rate --substeps --dilation --base-id --extended; the scene is the word
 * [SCENE]. */
extern const struct option scene_options[];

/* The scene of this name, see scene_load.h (NULL: that of the first model). A model runs at 1000 frames of
 * 64 substeps of rk4 a second. False: why[SCENE_REASON] says what to do. scene_free in any case. */
bool scene_init(struct scene_app *s, const char *name, char *why);

/* After changes of config, si or setting: sets up the app, ready to run on this hal (NULL: none, for
 * identity and scaling only). The plant is in the scene's initial state; its drives sound as soon as plant
 * time runs. False: `why` says what is wrong. */
bool scene_start(struct scene_app *s, const struct hal *hal, char *why);

/* scene_init and everything the options say; the scene is word `i_word`, or --model, or that of the first
 * model. False after a line on stderr. */
bool scene_from_options(struct scene_app *s, const struct options *o, int i_word);

/* scene_from_options and scene_start. 0, or the exit status after a line on stderr; scene_free in any case.
 */
int scene_open(struct scene_app *s, const struct options *o, int i_word, const struct hal *hal);

/* scene_init of this name, and everything the options say. False: why[SCENE_REASON] says what to do. */
bool scene_from_name(struct scene_app *s, const struct options *o, const char *name, char *why);

/* --base-id and --extended into the configuration. False: why[SCENE_REASON]. */
bool scene_take_identifiers(struct scene_app *s, const struct options *o, char *why);

/* Lines on stderr where the scene leaves a source paper's range; none for a bare model. */
void scene_warn(const struct scene_app *s, const struct usage *u);

void scene_free(struct scene_app *s);

#endif
