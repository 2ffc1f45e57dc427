/* tolerance_force.h - random scenes of every model and their equations of motion, written down once more, for
 * tests/tolerance/tolerance_scenes.c. Model units throughout. */
#ifndef TESTS_TOLERANCE_FORCE_H
#define TESTS_TOLERANCE_FORCE_H

#include "models/model.h"
#include "tests/fixture/extrapolation.h"

/* a r(t) cos(omega (t - start) + phase) from `start` on, r rising to 1 over `ramp`; 0 before. */
struct tolerance_drive {
    double amplitude, omega, phase, start, ramp;
};

struct tolerance_scene {
    const struct model *model;
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct scale scale;
    double eigenfrequency, tick, tol; /* per model time; model time */
    double size;                      /* size of the motion wanted, by linear theory */
    long ticks;                       /* in all, a multiple of TOLERANCE_SAMPLES */
    long change;                      /* a tick at which a drive begins; 0: none */
    bool forces;                      /* no drive is more than a force */
    struct tolerance_drive drive[MODEL_INPUTS];
    double x[MODEL_STATES]; /* at the start */
};

enum { TOLERANCE_SAMPLES = 24 };

/* The model of this scene, by its place in model_table: all in turn but levers. */
int tolerance_model(int number);

/* Scene `number` of a seed; loose: with a tolerance of 1e-4 to 1e-2, else of 1e-8 to 1e-3, and half
 * of them with forces alone at short steps, where auto may take adams. */
void tolerance_draw(struct tolerance_scene *s, int number, unsigned seed, bool loose);

/* The scene as a motion for the integrator, at its start; fine: with a hundred times smaller errors. */
void tolerance_motion(const struct tolerance_scene *s, bool fine, struct extrapolation *e);

#endif
