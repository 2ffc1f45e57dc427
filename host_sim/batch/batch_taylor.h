/* batch_taylor.h - many independent trajectories of plants with one Hertzian contact under harmonic drives,
 * by power series.
 *
 * Rig, rolling contact and tip come in by one path, their hertz_form (models/model.h), as
 *
 *   eta'' = constant + p_0(t) + p_1(t) - damping eta' - stiffness eta - (hertz + p_2(t)) eta_+^{3/2}
 *
 * with tones p_i = amplitude_i cos(phase_i + omega_i t): two of the force (drives of one frequency share one,
 * a moving base or a waviness is a force here), one of the contact's stiffness. Each trajectory has its own
 * parameters, drives, state and interval from sample to sample (model time; a forcing period, usually).
 * Switches are located; the error follows a tolerance.
 *
 * batch_taylor is a method of its own, beside the plant's `taylor`: of fixed order 14, in model time, a new
 * series as soon as the last one ends. Its scalar form is a batch of one. A trajectory's bits depend on
 * nothing but its own numbers. Its place, its company, the machine's vectors and the compiler (flags of the
 * Makefile) do not matter. A series starts anew at each call.
 *
 * One array per quantity, [n] each, in memory of the caller; read and, between two calls, changed at will. A
 * trajectory that fails (status) stays where its last good interval ended and disturbs no other one. */
#ifndef HOST_SIM_BATCH_TAYLOR_H
#define HOST_SIM_BATCH_TAYLOR_H

#include <stddef.h>
#include <stdint.h>
#include "models/model.h"

enum { BATCH_TONES = 3, BATCH_STIFFNESS_TONE = 2 };

/* eta or eta' beyond this many units of the contact: the motion has escaped. */
#define BATCH_LIMIT 1e6

enum batch_status {
    BATCH_GOOD,
    BATCH_ESCAPED, /* eta or its rate left BATCH_LIMIT, or the finite numbers */
    BATCH_BUDGET   /* BATCH_PIECES series did not reach the end of an interval */
};

struct batch_tone {
    double *amplitude, *omega; /* model units */
    uint64_t *phase;           /* now, turns * 2^64 */
};

struct batch_taylor {
    int n;
    /* the equation */
    double *constant, *damping, *stiffness, *hertz;
    double *rest, *pace; /* eta and eigenfrequency at rest: what the size of the motion is counted by */
    struct batch_tone tone[BATCH_TONES];
    double *interval;
    /* where it stands */
    double *eta, *rate;
    int64_t *intervals; /* completed */
    /* since batch_taylor_set: largest deviation from rest, times pace, and largest rate where series began */
    double *most, *most_rate;
    /* counts since batch_taylor_set */
    int64_t *liftoffs;
    int64_t *residuals; /* roots that kept a residual above its bound */
    int64_t *status;    /* enum batch_status */
};

/* A trajectory as its model says it, at time 0. */
struct batch_trajectory {
    const struct model *model;
    const double *p;                     /* prepared parameters */
    struct harmonic drive[MODEL_INPUTS]; /* model units, omega per model time */
    double x[2];
    double interval; /* model time */
};

/* `intervals` intervals of every trajectory that is good. samples: NULL, or eta and eta' at the end of
 * interval j in samples[2 j n + i] and samples[(2 j + 1) n + i], NaN where trajectory i has failed. tol in
 * 1e-13..1e-2 is about the error of each series, over the smaller of `most` and `most_rate`, and at most
 * over a unit of the contact. NULL, or the reason for a refusal that changed nothing. */
enum { BATCH_PIECES = 4096 };

/* batch_taylor as it is compiled: for the instructions of the build, and with BATCH_AVX2 once more for AVX2
 * (the Makefile sets it on x86-64, whose default knows no AVX2). batch_taylor takes the widest that the
 * processor has. The bits are equal: batch_lanes.h. */
const char *batch_taylor_plain(struct batch_taylor *b, double tol, int intervals, double *samples);

#endif
