/* branch.h - a branch of periodic motions, stable or not, by shooting and continuation in arc length:
 * Newton's method on the map over one period, with its derivatives by differences. */
#ifndef TESTS_PAPERS_BRANCH_H
#define TESTS_PAPERS_BRANCH_H

#include "tests/papers/motion.h"

struct branch {
    const struct model *model;
    double paper[MODEL_PARAMETERS];
    int swept;       /* index of the frequency among the paper's parameters */
    double turn;     /* the period is turn over that parameter: 2 pi n for period n, or n where it is in Hz */
    double unit;     /* unit of that parameter in which arc length is counted */
    int ticks;       /* ticks of a period */
    int coordinate;  /* in the paper's state, its rate n_states/2 further on; -1: the model's own position */
    double from, to; /* begins at `from` towards `to`, ends beyond either */
    double other;    /* 0, or where it ends instead of at `from` */
    double step;     /* largest step of arc length */
    /* A state of the paper's near the branch at `from`, at the
     * period's start; NULL: where the motion from rest settles. */
    const double *start;
};

struct branch_point {
    double at; /* the swept parameter */
    double x[MODEL_STATES];
    double high, low, loss; /* extremes of the coordinate over a period; share of time without contact */
    double multiplier;      /* the largest magnitude */
    /* Where a multiplier is 1, to rounding of the arc length: a turning point of the swept parameter, or else
     * a crossing of branches (symmetry is lost). */
    bool fold, crossing;
};

enum { BRANCH_POINTS = 4000 };

/* The branch through the start; it ends too where it comes back on itself, if `start` is given, or where
 * Newton fails. How many points; 0 when there is none through the start. */
int branch_follow(const struct branch *b, struct branch_point *point);

/* Between points i - 1 and i the branch comes by point j again, in the same direction. By what does not
 * depend on the phase: a motion of period n may return as itself some forcing periods later. */
bool branch_returns(const struct branch *b, const struct branch_point *point, int i, int j);

/* The fold, or the crossing, nearest to a value of the swept parameter; NaN when there is none. */
double branch_fold(const struct branch_point *point, int n, double near);
double branch_crossing(const struct branch_point *point, int n, double near);

#endif
