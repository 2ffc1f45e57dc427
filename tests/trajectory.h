/* trajectory.h - the stored reference trajectories, and a plant run along one of them by any method, for tests. */
#ifndef TESTS_TRAJECTORY_H
#define TESTS_TRAJECTORY_H

#include "firmware/plant.h"

enum { TRAJECTORY_SAMPLES = 16, TRAJECTORY_EVENTS = 64 };

/* One case of tests/data/rig_trajectories.txt or model_trajectories.txt, in its paper's symbols and time. */
struct trajectory {
    char name[64];
    const struct model *model;
    double paper[MODEL_PARAMETERS], growth, start[MODEL_STATES];
    double t[TRAJECTORY_SAMPLES], state[TRAJECTORY_SAMPLES][MODEL_STATES];
    double event_t[MODEL_CONTACTS][TRAJECTORY_EVENTS], event_rate[MODEL_CONTACTS][TRAJECTORY_EVENTS];
    int event_touch[MODEL_CONTACTS][TRAJECTORY_EVENTS], n_events[MODEL_CONTACTS];
    int n_samples, n_events_total; /* -1: not countable */
};

/* Worst errors of a run along a case: state over its column's maximum, times and speeds in model units. */
struct trajectory_errors {
    double state, time, speed;
    int kinds, n_events, residual, budget;
};

/* Calls `check` for each case of the file; how many there were. */
int trajectory_each(const char *path, void (*check)(const struct trajectory *));

/* A plant by this method with paper parameters, tick h in the paper's time, its drives on, at `state`. */
void trajectory_start(struct plant *pl, const struct model *m, const struct method *method, double tol,
                      double *work, const double *paper, double h, const double *state);

/* Along a case with about `steps` ticks per contact period. */
struct trajectory_errors trajectory_run(const struct trajectory *r, const struct method *method, double tol,
                                        double *work, double steps);

#endif
