/* response.h - frequency responses of the shaft's paper: linear
 * theory, attractors from random starts, periodic branches. */
#ifndef TESTS_PAPERS_RESPONSE_H
#define TESTS_PAPERS_RESPONSE_H

#include "tests/papers/attractor.h"
#include "tests/papers/branch.h"

/* A band of forcing frequencies. Rows are largest values in mm of the first n_coordinates of x1, x2, x3, in
 * the figures "FIGURE x1" and so on. */
struct response {
    const char *figure;
    double paper[MODEL_PARAMETERS];
    double from, to;      /* Hz */
    int points;           /* and one more: where attractors are looked for */
    int starts;           /* at each, the first from rest */
    double span, seconds; /* range of the starts' positions; time that a motion may take to settle */
    int n_coordinates;
};

/* The linear shaft, gaps open: curve NAME. */
void response_theory(const struct response *r, const char *name);

/* The averaged motion of the mode that `paper` keeps (one_mode.h), all amplitudes there are: curve NAME. */
void response_balance(const struct response *r, const char *name);

/* Draws attractors, of the shaft or of the mode that `paper` keeps. The curves are "NAME period 1" to
 * "NAME period 3", "NAME period 4" (4 to 32) and "NAME aperiodic", with the period in the fifth column. An
 * attractor within 2 % (10 % without a period) of another one at its frequency is not drawn again. found:
 * NULL, or called for each that is drawn. */
typedef void response_found(void *context, double hz, const struct attractor *a);
void response_attractors(const struct response *r, const struct model *model, const char *name,
                         response_found *found, void *context);

/* A branch in x1, in Hz, thinned out: curves NAME and "NAME unstable"; folds and crossings as numbers. */
void response_branch(const char *figure, const char *name, const struct branch_point *point, int n);

#endif
