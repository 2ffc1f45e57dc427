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

/* Units, parameters, drives, initial state and times from r->o, for r->model. 0, or the exit status after
 * a line. */
int simulate_read(struct simulation *r);

/* The harmonic inputs at a time, model units. */
void simulate_inputs(const struct simulation *r, double t, struct input *u);

/* A line about `text` on stderr; the exit status. */
int simulate_misuse(const struct simulation *r, const char *text, const char *reason);

/* The report --report: opened before the run; a row with its columns, states and then the observable; an
 * event; written at the end. Without --report nothing is done. 0, or the exit status after a line. */
int simulate_report_begin(struct simulation *r, int argc, char **argv);
void simulate_report_row(struct simulation *r, double t, const double *value);
void simulate_report_event(struct simulation *r, double t, const struct event *e);
int simulate_report_end(struct simulation *r, int status);

#endif
