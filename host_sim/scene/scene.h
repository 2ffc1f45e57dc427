/* scene.h - one place that makes a plant on a bus from a scene and options: parameters, settings, rate, identity. */
#ifndef HOST_SIM_SCENE_H
#define HOST_SIM_SCENE_H

#include "firmware/app/app.h"
#include "host_sim/cli/options.h"
#include "host_sim/scene/scene_load.h"

/* --set --setting --method --rate --substeps --dilation --base-id --extended; the scene is the word [SCENE]. */
extern const struct option scene_options[];

struct scene_app {
    struct scene scene;       /* as it was given; options stand above it */
    enum scene_origin origin; /* of the scene: a bare model has no drives, start or question */
    struct app_config config; /* points into this struct */
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS]; /* of the real plant */
    double setting[SETTINGS];
    struct watch_limits watch;
    bool promote; /* the scene's watch makes the plant climb, else it reports only */
    double *work;
    float *capture;
    struct app app;
};

/* The scene of this name, see scene_load.h (NULL: that of the first model). A model runs at 1000 frames of 64 substeps of rk4 a
 * second. False: why[SCENE_REASON] says what to do. scene_free in any case. */
bool scene_init(struct scene_app *s, const char *name, char *why);

/* Sets a model parameter or an app setting, checked against its table. False: why[SCENE_REASON] says what is wrong. */
bool scene_set(struct scene_app *s, const char *name, double value, char *why);

/* After changes of config, si or setting: the app, ready to run on this hal (NULL: none, for identity and scaling
 * only), in the scene's initial state, with its drives sounding as soon as plant time runs. False: why says what is wrong. */
bool scene_start(struct scene_app *s, const struct hal *hal, char *why);

/* scene_init and everything the options say; the scene is word `i_word`, or --model, or that of the first model.
 * False after a line on stderr. */
bool scene_from_options(struct scene_app *s, const struct options *o, int i_word);

/* A parameter or setting by name, as its wire index; -1 and why when there is none, naming the nearest. */
int scene_find(const struct model *m, const char *name, char *why);

/* The table entry of a wire index, or NULL. */
const struct parameter *scene_parameter(const struct model *m, int index);

/* True for a value inside its range; else why says what is wrong. */
bool scene_accepts(const struct model *m, int index, double value, char *why);

/* Contact eigenfrequency as the bus sees it, of a scene that was started. */
double scene_resonance_Hz(const struct scene_app *s);

/* The method at work in a scene that was started: what auto has taken, or the one it was given. */
const struct method *scene_method(const struct scene_app *s);

/* Lines on stderr where the scene leaves a source paper's range; none for a bare model. */
void scene_warn(const struct scene_app *s, const struct usage *u);

void scene_free(struct scene_app *s);

#endif
