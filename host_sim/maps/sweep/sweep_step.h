/* sweep_step.h - one step of a chain: from a motion at one value of the swept number to the motion at the
 * next one, with the jumps in between. It writes nothing: sweep_chain.c makes rows of the outcome. */
#ifndef HOST_SIM_SWEEP_STEP_H
#define HOST_SIM_SWEEP_STEP_H

#include "host_sim/maps/sweep/sweep.h"

enum { STEP_JUMPS = 24 };

/* How long to wait for a point: LITTLE after one that did not settle, SOME after one that did, ALL in a
 * bisection. */
enum patience { LITTLE, SOME, ALL };

/* A jump, or (lost) a range with one whose place is unknown. `brink` is the last motion before it, which may
 * be nearer than `from`. */
struct step_jump {
    bool lost;
    struct sweep_result brink, from, to;
};

struct step {
    struct sweep *s;
    const struct scene *scene; /* the swept number is set by each point */
    const char *why;           /* the plant refuses */
    struct step_jump jump[STEP_JUMPS];
    int n; /* jumps */
};

/* Settled enough to compare with others. */
bool sweep_steady(const struct sweep_result *r);

/* Do these two differ by so little that they are one motion? */
bool sweep_alike(const struct sweep *s, const struct sweep_result *a, const struct sweep_result *b);

/* A point: rounds until it changes neither from half to half nor from round to round. begin: NULL for the
 * scene's start. False: the plant refuses, step->why. */
bool sweep_settle(struct step *step, enum patience p, double value, const struct sweep_state *begin,
                  struct sweep_result *r);

/* From *last to `value`. The jumps on the way are in step->jump. False: as sweep_settle. */
bool sweep_step(struct step *step, const struct sweep_result *last, double value, struct sweep_result *now);

#endif
