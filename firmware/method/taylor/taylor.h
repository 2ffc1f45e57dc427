/* taylor.h - the scratch memory of method taylor. */
#ifndef FIRMWARE_TAYLOR_H
#define FIRMWARE_TAYLOR_H

#include <math.h>
#include <stdint.h>
#include "firmware/method/taylor/taylor_load.h"
#include "firmware/method/taylor/taylor_series.h"

/* A motion of size 1/TAYLOR_SPARE allows the whole tolerance to a short series, a fourth of that size to a
 * long one. */
#define TAYLOR_SPARE 2.0

enum taylor_kind { TAYLOR_NONE, TAYLOR_TIME, TAYLOR_REGULAR };

/* Expansions since prepare, from which the cost of a run can be told. */
struct taylor_tally {
    uint64_t time, regular; /* pieces begun */
    uint64_t brief;         /* steps served by one short series */
    uint64_t further;       /* orders of these beyond the first ones tried */
};

/* Scratch memory of the method. */
struct taylor {
    /* set by prepare */
    double tol, log2_tol;                     /* asked: relative to the motion */
    double rest;                              /* x[0] at rest */
    double rate_scale;                        /* x[0] to the size of x[1]: the eigenfrequency */
    double side, origin, shift[MODEL_INPUTS]; /* eta = side x[0] + origin + sum shift_i u_i */
    unsigned shifting;                        /* bit i: shift_i is not 0 */
    bool contact;                             /* hertz_form; otherwise polynomial_form */
    bool escapes; /* the contact attracts, or there is none: a run-away motion is an escape */
    struct taylor_lanes lanes;
    /* the motion's own size (taylor_size.c) */
    double most,
        most_rate; /* largest deviation from rest and rate since somebody set the state, where series began */
    double size;   /* a power of two, at most 1: TAYLOR_SPARE times the smaller of both */
    double allowed_short;         /* error that a short series may leave: tol times size */
    double allowed, log2_allowed; /* and a long one */
    double shallow;               /* below this eta, and slow, the contact force is below what is allowed */
    /* where the next piece begins, and what the last one ended with */
    double eta, rate;
    double root; /* sqrt(eta) where a piece in s ended; -1 elsewhere */
    double x[2]; /* as handed out last: another x means that the state was set from outside */
    bool closed; /* regime */
    bool brief;  /* a short series a tick (taylor_short) costs less than pieces */
    /* the piece */
    bool event;    /* the contact switches at the end */
    bool residual; /* the root at the end did not converge */
    enum taylor_kind kind;
    double now, end; /* model time from its start: read up to, valid up to */
    double s_end;
    double s, s_time, y, w, w_slope; /* TAYLOR_REGULAR: where it was read last */
    struct taylor_tally count;
    double a[TAYLOR_TERMS], b[TAYLOR_TERMS], c[TAYLOR_TERMS]; /* eta(t); or y(s), w(s), t(s) */
};

#endif
