/* scene_app.h - the app of a scene: its configuration, and its numbers by name. It reads no file, takes no
 * heap and prints nothing: the library uses it, too. */
#ifndef HOST_SIM_SCENE_APP_H
#define HOST_SIM_SCENE_APP_H

#include "firmware/afm/station.h"
#include "firmware/app/app.h"
#include "firmware/stage/stages.h"
#include "host_sim/scene/scene_name.h"

struct scene_app {
    struct scene scene;       /* as it was given; options stand above it */
    enum scene_origin origin; /* where the scene comes from: a bare model has no drives, start or question */
    struct app_config config; /* points into this struct */
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS]; /* in real time, not bus time */
    double setting[SETTINGS];
    struct watch_limits watch;
    bool promote; /* the scene's watch makes the plant climb, else it reports only */
    double *scratch;
    float *capture;
    struct stages *stages;
    struct app app;
};

/* Fills in what s->scene and s->origin say: configuration, parameters, drives, settings; neither scratch
 * nor capture memory. */
void scene_app_configure(struct scene_app *s);

/* The settings of this model at this frame rate, as they are when nobody sets any. */
void scene_app_default_settings(struct scene_app *s);

/* The app, ready to run on this hal, in the scene's initial state. config.scratch and capture are the
 * caller's. False: why[SCENE_REASON] says what is wrong. */
bool scene_app_start(struct scene_app *s, const struct hal *hal, char *why);

/* A sensor alone must read less than the set point of peak force: its largest force in three cycles off the
 * surface. False: why[SCENE_REASON] says what to give. The second form is that of a plant that was started,
 * of any model. */
bool scene_sensor_is_quiet(const struct station *s, const struct stage *sensor, char *why);
bool scene_app_is_quiet(const struct app *a, char *why);

/* Sets a model parameter or an app setting by its wire index, to a value that was checked. */
void scene_set(struct scene_app *s, int index, double value);

/* The scene's stages in the settings of a plant, which are 0 elsewhere. False: it has none. */
bool scene_stage_settings(const struct scene *s, double setting[SETTINGS]);

/* For commands that run a plant without stages: NULL, or the line that refuses this scene. */
const char *scene_refuses_stages(const struct scene *s);

const struct parameter *scene_parameter(const struct model *m, int index);

/* True for a value inside its range; else why says what is wrong. */
bool scene_accepts(const struct model *m, int index, double value, char *why);

/* Contact eigenfrequency as the bus sees it, of a scene that was started. */
double scene_resonance_Hz(const struct scene_app *s);

/* The method at work in a scene that was started: what auto has taken, or the one it was given. */
const struct method *scene_method(const struct scene_app *s);

#endif
