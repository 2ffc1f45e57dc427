/* sweep.h - response curves: a parameter up and down in steps, the motion carried from point to point.
 *
 * A chain is up and down again at one value of the family's parameter, and one job of jobs.h; each point is a
 * piece of it. The first point begins in the scene's start, each other one where the one before ended, at the
 * same phase of the drives, so that hysteresis is seen; and from what the row of that one says, so that a
 * resumed chain has the same bits. A point is rounds of settling, in which the damping leaves 1e-4 or for
 * `settle` periods, and of `measure` periods in two halves. It is told once `settled` is small or the rounds
 * are used up; what is told is of the second half. `settled` is what is still to come, over the largest
 * amplitude: after one round the change from the first half by the part of it that the damping leaves, then
 * the larger of the change from half to half and from round to round. Periods are those of the reference, the
 * slowest drive that sounds.
 *
 * Each round begins with a nudge: a symmetric motion that has become unstable is left by it, as a real plant
 * leaves it.
 *
 * A harmonic n/m of the observable is |z| cos((n/m) theta + arg z) with theta the phase of the reference: the
 * lock-in of firmware/observe/lockin.h, exact for a motion that fits into a half twice or oftener, a whole number of
 * times.
 *
 * Between two settled points whose amplitudes differ the parameter is bisected from the last point's
 * state, on and on to the second one, until neighbours meet (steep, but no jump) or a bracket is narrow;
 * then SWEEP_CONFIRM further bisections must not make them meet, and the last, shortest step must lead
 * across. Rows jump_from and jump_to are the two sides of the bracket, which differ by more than
 * SWEEP_JUMP; rows jump_unsettled those of one in which motion does not settle. */
#ifndef HOST_SIM_SWEEP_H
#define HOST_SIM_SWEEP_H

#include "firmware/plant/plant.h"
#include "host_sim/maps/maps.h"
#include "host_sim/maps/sweep/sweep_meter.h"

/* Amplitudes that differ by more than this part of the larger one may be a jump. */
#define SWEEP_JUMP 0.05

enum { SWEEP_CONFIRM = 4 };

struct sweep_harmonic {
    uint32_t n, m; /* n/m times the reference */
};

/* Where a point ended; SI, or the paper's numbers. */
struct sweep_state {
    double x[MODEL_STATES];
    uint64_t phase[MODEL_INPUTS];
};

/* What a row is of. */
enum sweep_kind { SWEEP_POINT, SWEEP_UNSETTLED, SWEEP_ESCAPED, SWEEP_FROM, SWEEP_TO, SWEEP_LOST };

struct sweep_result {
    enum sweep_kind kind; /* of the row; it, down and family belong to the row alone */
    int down;             /* 1 on the way down */
    double family;
    double value;                   /* of the swept parameter */
    bool escaped;                   /* left the finite numbers: nothing below means anything */
    bool beats;                     /* a second drive sounds: there is no period for it to settle on */
    struct sweep_measured measured; /* in the second half */
    double change;                  /* of the harmonics from half to half, over the largest amplitude */
    double settled;                 /* what is left of it to come */
    double unlocated;               /* contact switches that were run through */
    struct sweep_state end;
};

/* Points of a chain, one after the other, that did not settle, between the settled ones before and after. */
struct sweep_gap {
    int n;
    bool begun; /* there has been a point */
    double low, high;
};

struct sweep {
    struct maps m;
    struct scene_range range, family; /* what is swept; what makes a chain each */
    int settle, measure;              /* periods; settle -1: by the damping */
    struct sweep_harmonic harmonic[SWEEP_HARMONICS];
    int n_harmonics;
    uint32_t common; /* multiple of every m */
    double bracket;  /* of a jump, over its parameter */
    int reference;   /* input */
    /* a file that is gone on with has `done` points of job `resumed`, the last of them: */
    int resumed, done;
    struct sweep_result last;
    struct sweep_gap gap;
    struct plant plant; /* at work on a point */
    double *work;       /* of the method */
};

/* The command line into *s. 0, or the exit status after a line. */
int sweep_read(struct sweep *s);

/* The slowest drive that sounds, or -1. */
int sweep_reference(const struct scene *s);

/* Why the plant cannot be at this point of the scene, or NULL. */
const char *sweep_check(struct sweep *s, const struct scene *scene);

/* One point, measured `times` as long as asked. begin: NULL for the scene's start. NULL, or why the plant
 * cannot be. */
const char *sweep_point(struct sweep *s, const struct scene *scene, double value,
                        const struct sweep_state *begin, int times, struct sweep_result *r);

/* The change of the harmonics from a to b, over the largest of b. */
double sweep_change(const struct sweep *s, const struct sweep_measured *a, const struct sweep_measured *b);

/* The largest amplitude that was measured, at least what roundings make of an output that stays where it is. */
double sweep_largest(const struct sweep *s, const struct sweep_measured *y);

/* Chain `job`, its last row, and how much of its rows stays, as jobs.h asks for; context is the struct sweep. */
bool sweep_chain(void *context, int job, FILE *rows);
bool sweep_chain_ends(void *context, int job, const char *row);
size_t sweep_resume(void *context, int job, const char *rows);

/* The picture --svg of a file of rows. 0, or the exit status after a line. */
int sweep_chart(const struct sweep *s);

#endif
