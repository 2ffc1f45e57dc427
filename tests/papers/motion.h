/* motion.h - a model in its paper's parameters, state and time, run and watched: stepped sweeps for the
 * charts of docs/papers/figures.md. Method: `exact` for a piecewise-linear model, `taylor` for any other. */
#ifndef TESTS_PAPERS_MOTION_H
#define TESTS_PAPERS_MOTION_H

#include <stdbool.h>
#include "firmware/plant/plant.h"

#define MOTION_TWO_PI 6.283185307179586477

struct motion {
    struct plant pl;
    double scratch[METHOD_SCRATCH];
};

/* Measurements of one coordinate of the paper's state. */
struct seen {
    double high, low, amplitude; /* amplitude: of the component at one frequency, by a Hann window */
    double loss;                 /* share of the time with every contact open */
    bool good;                   /* false: the motion escaped; the rest is NaN */
};

/* A plant with these paper parameters, `tick` in the paper's time, at the paper's `state` (NULL: at rest),
 * its drives on. NULL, or why not. */
const char *motion_start(struct motion *m, const struct model *model, const double *paper, double tick,
                         double tol, const double *state);

/* Other amplitudes or frequencies of the drives from now on, phases continuous. */
void motion_tune(struct motion *m, const double *paper);

/* `time` from now; false when the motion escaped. */
bool motion_settle(struct motion *m, double time);
struct seen motion_watch(struct motion *m, int coordinate, double omega, double time);

/* The paper's state now. */
void motion_state(const struct motion *m, double *state);

/* ---- stepped sweeps ---- */

struct sweep {
    const struct model *model;
    double paper[MODEL_PARAMETERS];
    int swept;         /* index of the paper parameter that is stepped */
    int omega;         /* index of that whose component is measured */
    double from, to;   /* range of the swept parameter; the way back is a sweep of its own */
    int steps;         /* points are steps + 1 */
    double tick, tol;  /* step and tolerance of the integration */
    double wait, look; /* time to settle and to measure at each point */
    int coordinate;
};

/* One point after the other, each from where the last one ended, the first from rest and any after an escape
 * too. seen[steps + 1]. */
void sweep_run(const struct sweep *s, struct seen *seen);

/* Swept value of point i. */
double sweep_at(const struct sweep *s, int i);

/* The jump: the largest change of amplitude from one point to the next, up (sign 1) or down (-1), if it is at
 * least `least`; i of the point before it, or -1. */
int sweep_jump(const struct sweep *s, const struct seen *seen, int sign, double least);

#endif
