/* scenes.h - a plant and its task as data: model, parameters, drives, start, question and deadline.
 *
 * A scene is given in SI or, with `paper`, in the parameters of the model's source paper. Most papers are
 * dimensionless (scenes_dimensionless). Then times, drives and states of the scene are the paper's, too.
 * frame_s and cost_s are always seconds of bus time.
 *
 *     const struct preset *rig = scenes_find("rig");
 *     scenes_resolve(&rig->scene, si, drive);
 *     scenes_begin(&rig->scene, si, drive, x);
 *
 * The functions expect a scene whose numbers are in range: plant_check and the readers in host_sim/scene see
 * to it. The presets are constant data; an image that names none of them leaves them out. */
#ifndef MODELS_SCENES_H
#define MODELS_SCENES_H

#include <stdint.h>
#include "models/model.h"

/* One input over the whole scene; the unit of amplitude and noise is the input's. */
struct scene_drive {
    double amplitude, frequency_Hz, phase_rad; /* amplitude cos(2 pi frequency t + phase); 0 with `paper` */
    double noise;                              /* standard deviation, 0 for none */
    double noise_hold;                         /* time from one value to the next; 0: one step */
    uint32_t noise_seed;
};

/* As a limit of struct scene_watch, with its sign: there is no limit on this side. */
#define SCENE_UNBOUNDED 1e300

/* The first condition that would void the choice of this model; a monitor watches it while the plant runs. */
struct scene_watch {
    bool on;             /* something is watched */
    int observable;      /* number, see model_observable */
    double above, below; /* it trips above the one or below the other, in units of scenes_watch_unit */
    const struct model *promote; /* the full model to which the plant may climb then; or NULL */
};

/* Actuators and sensors, in the order of their settings (firmware/bus/settings.h); all 0: off. */
enum { SCENE_STAGES = 4, SCENE_STAGE_NUMBERS = 15 };

struct scene {
    const struct model *model;
    const char *method;             /* by name: methods stand above models */
    bool paper;                     /* value[] is in the order of model->paper, else of model->parameter */
    bool started;                   /* begins at start[], else at rest */
    double value[MODEL_PARAMETERS]; /* [n_paper] or [n_parameters] */
    struct scene_drive drive[MODEL_INPUTS];
    double start[MODEL_STATES]; /* SI, or the paper's symbols with `paper` */
    /* the question */
    int observable;   /* index into model->output_signal */
    double over;      /* duration, of the real plant */
    double tolerance; /* the method's tolerance */
    /* the deadline */
    double frame_s;    /* bus seconds from one exchange to the next */
    uint32_t substeps; /* steps in a frame, at least 1 */
    double dilation;   /* bus seconds per second of the real plant */
    double cost_s;     /* budget for one step, 0: none given */
    struct scene_watch watch;
    double stage[SCENE_STAGES][SCENE_STAGE_NUMBERS];
};

struct preset {
    const char *name, *title;
    struct scene scene;
};

/* The preset of this name, or NULL. */
const struct preset *scenes_find(const char *name);

/* A scene of a model's defaults: at rest, penetration asked, a frame of 1 ms in 64 steps. */
void scenes_default(struct scene *s, const struct model *m);

/* True when the paper's parameters have no unit of mass, length or time; the scene then has none either. */
bool scenes_dimensionless(const struct scene *s);

/* SI parameters, and the harmonic drive of each input (SI, real plant time). */
void scenes_resolve(const struct scene *s, double *si, struct harmonic *drive);

/* A state as the scene writes it: its name, and the states in SI or in the paper's symbols with `paper`; and
 * back. p and scale are prepared from the scene; u: the inputs at that instant, model units. */
const char *scenes_state_name(const struct scene *s, int i);
void scenes_show_state(const struct scene *s, const double *p, const struct scale *scale,
                       const struct input *u, const double *x, double *shown);
void scenes_take_state(const struct scene *s, const double *p, const struct scale *scale,
                       const struct input *u, const double *shown, double *x);

/* The inputs of a model's drives at time 0, model units. */
void scenes_inputs(const struct model *m, const struct scale *scale, const struct harmonic *drive,
                   struct input *u);

/* The initial state in model units, for these parameters and drives. */
void scenes_begin(const struct scene *s, const double *si, const struct harmonic *drive, double *x);

/* SI value of 1 in the limits of the scene's watch: 1, but 1/(2 pi) for the angular frequencies of a
 * dimensionless scene. */
double scenes_watch_unit(const struct scene *s);

/* The watched number of the real plant at the start, in the units of the limits. */
double scenes_watched(const struct scene *s, const double *si, const struct harmonic *drive);

/* Steps from one value of an input's noise to the next, at least 1. A step takes `step` of real plant
 * time. */
double scenes_noise_steps(const struct scene_drive *d, double step);

#endif
