/* attractor.h - the shaft of the paper settled on its attractors,
 * and its linear theory. Lengths in m, frequencies in Hz. */
#ifndef TESTS_PAPERS_ATTRACTOR_H
#define TESTS_PAPERS_ATTRACTOR_H

#include <stdint.h>
#include "host_sim/maps/basin/basin_motion.h"
#include "models/shaft_views.h"
#include "tests/papers/stroboscope.h"

#define SHAFT_SOFT 2.626e4
#define SHAFT_MID  1.4e6
#define SHAFT_HARD 3.502e7

/* A driven shaft and its stroboscopic map, with the ticks
 * that the exact method accepts and with finer ones. */
struct attractor_shaft {
    struct basin_plant plant;
    struct stroboscope map, fine;
    double hz;
};

struct attractor {
    int period; /* in forcing periods; 0: none of at most BASIN_PERIODS was seen */
    /* Extremes of the paper's x1, x2, x3 and their rates. The model of one mode gives them as the mode
     * moves them. */
    double high[MODEL_STATES], low[MODEL_STATES];
    double loss;                /* share of time with every contact open */
    double switches;            /* contact switches in a forcing period */
    double state[MODEL_STATES]; /* the paper's of the model, at a whole number of periods */
};
enum { ATTRACTOR_LOOK = 60 /* periods over which a motion without a period is measured */ };

/* The paper's Table 1 with these gap springs, 25 N on the middle at `hz`. */
void attractor_paper(double gap_stiffness, double hz, double *paper);

/* shaft_bearing or its model of one mode. False: no memory, or parameters that the exact method refuses. */
bool attractor_open(struct attractor_shaft *s, const struct model *model, const double *paper);
void attractor_close(struct attractor_shaft *s);

/* From a state (NULL: rest) until it has come back (basin_motion.h),
 * for at most `seconds`. False when it could not be run. */
bool attractor_settle(const struct attractor_shaft *s, const double *state, double seconds,
                      struct attractor *a);

/* Mean rate at which a nearby start leaves, per second, over `periods` from a state at phase 0 (NULL: rest):
 * the largest Lyapunov exponent. The force of a contact is continuous, so a switch adds no jump. `unison`: of
 * the motion with x1 = x3, kept so against rounding, towards every state. NaN: it could not be run. */
double attractor_exponent(const struct attractor_shaft *s, const double *state, bool unison, int periods);

/* The exponent's mean over windows of `seconds`, after as long a wait. It counts those of `starts` whose
 * motion has a contact switch a period and is aperiodic before the window and after it; *counted says how
 * many. NaN: none, or they could not be run. */
double attractor_mean_exponent(const struct attractor_shaft *s, double span, double seconds, int starts,
                               int *counted);

/* A start as the paper's: positions within `span`, rates within 0.5 m/s. */
void attractor_start(uint64_t *seed, double span, double *state);

/* Amplitudes of x1, x2, x3 of the open shaft; eigenfrequencies with `share` of the gap springs closed. */
void attractor_linear(const double *paper, double amplitude[3]);
void attractor_frequencies(const double *paper, double share, double hz[3]);

/* The eigenfrequencies, and each mode's shape x1..x3 with 1 as its largest component. */
void attractor_modes(const double *paper, double share, double hz[3], double shape[3][3]);

/* Ticks of a forcing period that the exact method accepts. */
int attractor_ticks(const double *paper);

#endif
