/* survival.h - how long the shaft goes on impacting where a quiet motion exists too.
 *
 * Chaos that ends at random times has no edge in frequency of its own. The edge depends on the wait, and
 * on the share of starts, that one asks for. */
#ifndef TESTS_PAPERS_SURVIVAL_H
#define TESTS_PAPERS_SURVIVAL_H

#include "tests/papers/attractor.h"

#define SURVIVAL_CALM 0.5 /* s: without contact for so long a motion is quiet, and stays so */

/* Share of `starts` random starts (attractor_start, within gap
 * 1) with a contact after `seconds`; NaN: it could not be run. */
double survival_share(const double *paper, double seconds, int starts);

/* The share of starts that survive in the model that keeps `mode` (one_mode.h). */
double survival_share_mode(const double *paper, int mode, double seconds, int starts);

/* The frequency, Hz, between `inside` and `outside` where that share falls to `level`, by bisection to 0.25
 * Hz; NaN: not below it at `outside`, or not above it at `inside`. Fewer starts are taken where the share is
 * three standard errors from the level. */
struct survival {
    double paper[MODEL_PARAMETERS];
    double seconds, level;
    int starts;
};
double survival_edge(const struct survival *s, double inside, double outside);

/* The frequency where the linear motion of the bearing that moves most just reaches its gap: nearer to
 * `inside` there is no quiet motion at all. */
double survival_quiet(const double *paper, double inside, double outside);

#endif
