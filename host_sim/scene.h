/* scene.h - one place that makes a plant from options: model, parameters, settings, rate, identity on the bus. */
#ifndef HOST_SIM_SCENE_H
#define HOST_SIM_SCENE_H

#include "firmware/app.h"
#include "host_sim/options.h"

enum { SCENE_REASON = 256 };

/* --set --setting --method --rate --substeps --dilation --base-id --extended; the model is the word [MODEL]. */
extern const struct option scene_options[];

struct scene {
    struct app_config config; /* points into this struct */
    double si[MODEL_PARAMETERS];
    double setting[SETTINGS];
    double *work;
    float *capture;
    struct app app;
};

/* The default scene of a model (NULL: the first one) at 1000 frames of 64 substeps a second. False: no such model,
 * no memory; why[SCENE_REASON] says what to do. scene_free in any case. */
bool scene_init(struct scene *s, const char *model, char *why);

/* Sets a model parameter or an app setting, checked against its table. False: why[SCENE_REASON] says what is wrong. */
bool scene_set(struct scene *s, const char *name, double value, char *why);

/* After changes of config, si or setting: the app, ready to run on this hal (NULL: none, for identity and scaling
 * only). False: why says what is wrong. */
bool scene_start(struct scene *s, const struct hal *hal, char *why);

/* scene_init and everything the options say; the model is word `i_word`, or --model, or the first one.
 * False after a line on stderr. */
bool scene_from_options(struct scene *s, const struct options *o, int i_word);

/* A parameter or setting by name, as its wire index; -1 and why when there is none, naming the nearest. */
int scene_find(const struct model *m, const char *name, char *why);

/* The table entry of a wire index, or NULL. */
const struct parameter *scene_parameter(const struct model *m, int index);

/* True for a value inside its range; else why says what is wrong. */
bool scene_accepts(const struct model *m, int index, double value, char *why);

/* Contact eigenfrequency as the bus sees it, of a scene that was started. */
double scene_resonance_Hz(const struct scene *s);

/* The method at work in a scene that was started: what auto has taken, or the one it was given. */
const struct method *scene_method(const struct scene *s);

void scene_free(struct scene *s);

#endif
