/* extrapolation.h - an integrator for tests that shares nothing with the methods: the modified midpoint rule, extrapolated
 * (Gragg, Bulirsch, Stoer) in 80-bit numbers, its step chosen by its own error estimate, contact switches located. */
#ifndef TESTS_EXTRAPOLATION_H
#define TESTS_EXTRAPOLATION_H

enum { EXTRAPOLATION_STATES = 6, EXTRAPOLATION_GAPS = 4 };

/* A motion: positions in the first half of x, their rates in the second. */
struct extrapolation {
    const void *context; /* of the two functions */
    int n, n_gaps;
    /* Rates of the state at time t; bit i of regime: contact i is closed. Beyond its switch a contact's force goes on smoothly. */
    void (*rhs)(const void *context, unsigned regime, long double t, const long double *x,
                long double *x_dot);
    /* Each gap and its rate: negative while in contact. */
    void (*gap)(const void *context, long double t, const long double *x, long double *gap,
                long double *rate);
    long double step_max; /* short beside every period of motion and drives */
    long double error;    /* of a step, relative to the largest deviation so far */
    long double rest[EXTRAPOLATION_STATES];
    long double least[2]; /* deviations of positions and rates that errors are at least relative to */
    /* the motion */
    long double t, step, x[EXTRAPOLATION_STATES];
    long double most[2]; /* largest deviation of positions and rates so far */
    unsigned regime;
    long switches, failures; /* failures: steps that did not reach the error */
};

/* The regime from the gaps, after x, t and rest were set. */
void extrapolation_start(struct extrapolation *e);

/* On to time `end`; inputs have no corner in between. */
void extrapolation_run(struct extrapolation *e, long double end);

#endif
