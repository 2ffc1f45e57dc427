/* simulate.h - a run of contactplant simulate as it was asked for, and its files. */
#ifndef HOST_SIM_SIMULATE_H
#define HOST_SIM_SIMULATE_H

#include "firmware/plant/plant.h"
#include "host_sim/cli/options.h"
#include "host_sim/scene/scene_load.h"

#include <stdio.h>

struct simulate_report;

struct simulation {
    const struct options *o;
    struct scene scene;       /* with --set; a bare model's has defaults */
    enum scene_origin origin; /* where the scene comes from */
    const struct model *model;
    const struct method *method;
    bool paper;
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];      /* SI: omega in rad/s */
    struct noise_setting noise[MODEL_INPUTS]; /* in the units shown; ticks are steps */
    double state[MODEL_STATES];               /* at the start, model units */
    double p[MODEL_DERIVED];                  /* prepared from si */
    struct scale scale;
    bool chosen; /* method was auto, and is now what that took */
    double tol;
    char reason[256];    /* text of a refusal */
    double dilation;     /* the scene's: the plant is stepped by bus seconds, as on the bus */
    double tick_s;       /* a step, bus seconds */
    double step;         /* longest, in the units shown */
    double until, every; /* the rows' last time and distance, in the units shown */
    double *at;          /* times asked for, or NULL */
    int observable;      /* output shown beside the states, or -1 */
    size_t n_rows;
    FILE *out, *events;
    struct simulate_report *report; /* NULL without --report */
    double *scratch, *scratch_ahead;
    struct plant plant;
    struct plant ahead;        /* at a row between two ticks: begun at the last one */
    const struct plant *shown; /* the one at the row, or NULL: at the start */
};

#endif
