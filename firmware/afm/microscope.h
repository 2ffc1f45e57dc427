/* microscope.h - an AFM lever over a sample, run by the sample of a converter: forces and places in, a
 * sensor's reading out.
 *
 * A sample is `ticks` ticks of the method `modal`. The order of things in it:
 *   - the held force jumps to its new value at the beginning; two tones are added to it, tick by tick
 *   - the base z goes in a straight line to its new value, which it has at the end; then `piezo`, where there
 *     is one, makes of this command the true motion, tick by tick
 *   - the surface below x, y goes in a straight line over MICROSCOPE_PATCH ticks to the height at the place
 *     that was given last: so it comes MICROSCOPE_PATCH ticks late
 *   - the deflection is read at the end; `sensor`, where there is one, sees each tick.
 *
 * The surface moves no mass: it enters the gap alone, and excites no mode of the lever.
 *
 * A crash is a contact force above crash_N. It is one event until the force has stayed below for
 * MICROSCOPE_APART ticks. All units are SI; state belongs to the caller; equal calls give equal bits. */
#ifndef FIRMWARE_AFM_MICROSCOPE_H
#define FIRMWARE_AFM_MICROSCOPE_H

#include <stdbool.h>
#include "firmware/afm/surface.h"
#include "firmware/method/method.h"
#include "models/afm_lever.h"

enum {
    MICROSCOPE_PATCH = 64,    /* ticks from one height of the surface to the next */
    MICROSCOPE_APART = 4096,  /* ticks without a crash after which the next one is another */
    MICROSCOPE_TONES = 2,     /* two for dual-frequency tracking */
    MICROSCOPE_SCRATCH = 128, /* doubles; modal needs fewer */
    MICROSCOPE_TICKS_MAX = 4096
};

/* A stage between a command and what it moves, or between a quantity and its reading. It makes the values of
 * n ticks in a row, n > 0, what they are behind it. run NULL: ideal. */
struct microscope_stage {
    void (*run)(void *who, double *value, uint32_t n);
    void *who;
};

/* A tone: the force is force_N cos(phase). With the step 0 it is none. */
struct tone {
    double force_N;
    uint64_t phase, step;  /* now, and a tick later more: turns * 2^64 */
    double cosine, sine;   /* belong to the phase */
    double turn_c, turn_s; /* belong to the step */
};

struct crash {
    uint64_t tick;
    double peak_N, x_m, y_m;
};

struct microscope_in {
    double force_N, z_m, x_m, y_m;
};

struct microscope_config {
    const double *si;     /* [LEVER_PARAMETERS], lever and base material */
    const double *second; /* as si, with the second material; NULL: one material */
    double tick_s;
    uint32_t ticks; /* in a sample */
    double crash_N; /* 0: no force is a crash */
    struct microscope_stage piezo, sensor;
    struct microscope_in at; /* the places that are commanded where it begins */
    double z_m;              /* at.z_m behind the piezo */
};

struct microscope_out {
    double deflection_m; /* the sensor's reading */
    double z_m;          /* the true base over its place at z = 0 */
    double truth_m;      /* the true deflection */
    double surface_m;    /* the height below the tip */
    double peak_N;       /* largest contact force in the sample, 0 apart */
};

struct microscope {
    struct surface surface;
    struct tone tone[MICROSCOPE_TONES];
    uint64_t tick;
    uint32_t n_crashes;
    struct crash crash;               /* the last one, with its peak so far */
    bool failed;                      /* the motion left the finite numbers; nothing runs any more */
    double length_m, force_N, tick_s; /* units of the model */
    uint32_t ticks;
    /* the rest is the microscope's own */
    double crash_N;
    struct microscope_stage piezo, sensor;
    double p[2][MODEL_DERIVED];
    int material;
    double length;                      /* a tick in model time */
    struct input base;                  /* model units; its rate is that of z alone */
    double command_m, z_m;              /* the base now: told, and true */
    double patch_from, patch_to, below; /* height of the surface: over the present patch, and now */
    double sensed_m;
    uint64_t crash_last; /* tick of the last force above crash_N */
    double x[MODEL_STATES];
    double scratch[MICROSCOPE_SCRATCH];
};

/* At rest at c->at, that place of this surface below the tip. NULL, or the reason of a refusal. */
MUST_CHECK const char *microscope_init(struct microscope *m, const struct microscope_config *c,
                                       const struct surface *s);

/* The frequency of a tone from now on, at most a quarter of the tick rate; its phase is continuous. */
void microscope_tune(struct microscope *m, int i_tone, double frequency_Hz);

/* One sample. False, with `failed`, when the motion left the finite numbers. */
bool microscope_run(struct microscope *m, const struct microscope_in *in, struct microscope_out *out);

#endif
