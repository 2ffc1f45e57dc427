/* branch.h - a branch of periodic motions of the drive's period, stable or not, by shooting and continuation in arc
 * length: Newton's method on the map over one period, with its derivatives by differences. */
#ifndef TESTS_PAPERS_BRANCH_H
#define TESTS_PAPERS_BRANCH_H

#include "tests/papers/motion.h"

struct branch {
    const struct model *model;
    double paper[MODEL_PARAMETERS];
    int swept;      /* index of the frequency among the paper's parameters */
    double turn;    /* the period is turn over that parameter: 2 pi, or 1 for one in Hz */
    double unit;    /* of that parameter: what arc length is counted in */
    int ticks;      /* of a period */
    int coordinate; /* of the paper's state, its rate n_states/2 further on; -1: the model's own position */
    double from, to, end; /* begins at `from` towards `to`, ends outside [from, end] or [end, from] */
    double step;          /* largest step of arc length */
};

struct branch_point {
    double at; /* the swept parameter */
    double x[MODEL_STATES];
    double high, low, loss; /* of the coordinate over a period; share of time without contact */
    double multiplier;      /* the largest magnitude */
    /* Where a multiplier is 1, to rounding of the arc length: a turning point of the swept parameter, or else a crossing
     * of branches (symmetry is lost). */
    bool fold, crossing;
};

enum { BRANCH_POINTS = 4000 };

/* The branch on which the motion from rest settles at `from`. How many points; 0 when it did not settle. */
int branch_follow(const struct branch *b, struct branch_point *point);

/* The fold, or the crossing, nearest to a value of the swept parameter; NaN when there is none. */
double branch_fold(const struct branch_point *point, int n, double near);
double branch_crossing(const struct branch_point *point, int n, double near);

#endif
