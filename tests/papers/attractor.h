/* attractor.h - the shaft of the paper settled on its attractors, and its linear theory. Lengths in m, frequencies in Hz. */
#ifndef TESTS_PAPERS_ATTRACTOR_H
#define TESTS_PAPERS_ATTRACTOR_H

#include "models/shaft_parts.h"
#include "tests/papers/motion.h"

#define SHAFT_SOFT 2.626e4
#define SHAFT_MID  1.4e6
#define SHAFT_HARD 3.502e7

struct attractor {
    int period;                 /* in forcing periods; 0: none of at most ATTRACTOR_PERIODS fits */
    double high[3], low[3];     /* of x1, x2, x3 */
    double loss;                /* share of time with every contact open */
    double switches;            /* contact switches in a forcing period */
    double state[MODEL_STATES]; /* the paper's, at a whole number of periods */
};
enum { ATTRACTOR_PERIODS = 16, ATTRACTOR_LOOK = 40 };

/* The paper's Table 1 with these gap springs, 25 N on the middle at `hz`. */
void attractor_paper(double gap_stiffness, double hz, double *paper);

/* From a state (NULL: rest), `seconds` later. False when it could not be run. m: the motion, at its end. */
bool attractor_settle(struct motion *m, const struct model *model, const double *paper, const double *state,
                      double seconds, struct attractor *a);

/* A start as the paper's: positions within `span`, rates within 0.5 m/s. */
void attractor_start(uint64_t *seed, double span, double *state);

/* Amplitudes of x1, x2, x3 of the open shaft; eigenfrequencies with `share` of the gap springs closed. */
void attractor_linear(const double *paper, double amplitude[3]);
void attractor_frequencies(const double *paper, double share, double hz[3]);

/* Ticks of a forcing period that the exact method accepts. */
int attractor_ticks(const double *paper);

#endif
