/* sweep.h - response curves: a parameter goes up and down in steps, and the motion is carried from point
 * to point.
 *
 * A chain goes up and down at one value of the family's parameter. It is one job of jobs.h, and each point
 * is a piece of it. The first point begins in the scene's start. Each other point begins where the one
 * before ended, at the same phase of the drives, so that hysteresis is seen. It begins from the numbers in
 * the row of that point, so that a resumed chain has the same bits.
 *
 * A point is rounds of settling and measuring. Settling takes `settle` periods, or until the damping
 * leaves 1e-4. Measuring takes `measure` periods in two halves, and the row has the second half. Rounds
 * end when `settled` is small, or after a largest number. `settled` is the change that is still to come,
 * over the largest amplitude. After one round it is the change from half to half over the part of it that
 * the damping takes away. Later it is the larger of the changes from half to half and from round to round.
 * Periods are those of the reference, the slowest drive that sounds.
 *
 * Each round begins with a nudge, so that the plant leaves a symmetric motion that has become unstable.
 *
 * A harmonic n/m of the observable is |z| cos((n/m) theta + arg z), theta the phase of the reference, from
 * the lock-in of firmware/observe/lockin.h. It is exact for a motion that fits into a half a whole number
 * of times, at least twice.
 *
 * Between two settled points that differ, the parameter goes from the first point's state to the second
 * point, in steps halved until neighbours meet. It ends at the second point (steep, but no jump) or when a
 * step is narrow. Then SWEEP_CONFIRM further bisections must not make its sides meet, and the last, shortest
 * step must lead across, to a motion that differs by more than SWEEP_JUMP. Rows jump_from and jump_to are
 * the sides of the bracket, before the further bisections. Rows jump_unsettled are the sides of a range in
 * which motion does not settle; the search continues behind it. */
#ifndef HOST_SIM_SWEEP_H
#define HOST_SIM_SWEEP_H

#include "firmware/plant/plant.h"
#include "host_sim/maps/maps.h"
#include "host_sim/maps/sweep/sweep_meter.h"

/* Harmonics that differ by more than this share of the larger one may be a jump. */
#define SWEEP_JUMP 0.05

enum { SWEEP_CONFIRM = 4, SWEEP_LABEL = 192 /* bytes of a text in picture and report */ };

struct sweep_harmonic {
    uint32_t n, m; /* n/m times the frequency of the reference */
};

/* The state in which a point ended. */
struct sweep_state {
    double x[MODEL_STATES];     /* SI; a dimensionless scene's model has a scale of 1 */
    double shown[MODEL_STATES]; /* as the scene writes it: the numbers of the row */
    uint64_t phase[MODEL_INPUTS];
};

/* The kinds of rows. */
enum sweep_kind {
    SWEEP_POINT,
    SWEEP_UNSETTLED,
    SWEEP_ESCAPED,
    SWEEP_FROM,
    SWEEP_TO,
    SWEEP_LOST,
    SWEEP_CHANCE
};

struct sweep_result {
    enum sweep_kind kind; /* kind, down and family are set in rows only */
    int down;             /* 1 on the way down */
    double family;
    double value; /* the swept parameter's value */
    bool escaped; /* left the finite numbers: no number below has a meaning */
    bool beats;   /* a drive of another frequency sounds: the motion need not have a period */
    struct sweep_measured measured; /* over the second half */
    double change;                  /* change of harmonics from half to half, over the largest amplitude */
    double settled;                 /* the change that is still to come, in the same unit */
    double unlocated;               /* contact switches that were not located */
    double motions;                 /* that the sweep could be on by chance; 1: this one alone */
    struct sweep_state end;
};

/* Neighbouring points of a chain that did not settle, or that another motion could have had, between others
 * before and after. */
struct sweep_gap {
    int n;
    bool begun; /* a point was seen */
    double low, high;
};

struct sweep {
    struct maps m;
    struct scene_range range, family; /* the swept number; the number with a chain for each value */
    int settle, measure;              /* periods; settle -1: as the damping asks */
    struct sweep_harmonic harmonic[SWEEP_HARMONICS];
    int n_harmonics;
    uint32_t common; /* multiple of every m */
    double bracket;  /* width of a jump's bracket over its place */
    int reference;   /* input */
    /* When resuming, the file already holds `done` points of job `resumed`, the last of them is: */
    int resumed, done;
    struct sweep_result last;
    struct sweep_gap gap, others;
    double seen;        /* the largest amplitude of the chain so far */
    struct plant plant; /* the plant at the point under way */
    double *scratch;    /* the method's scratch memory */
};

extern const struct usage sweep_usage;

#endif
