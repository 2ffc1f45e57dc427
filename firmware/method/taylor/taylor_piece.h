/* taylor_piece.h - one expansion of method taylor: its kind, its reach, its end and the state inside it.
 *
 * A piece is a series in time, for flight, for contact that is deep enough and for a plant without contact.
 * Or it is a series in s with eta = y^2, dt = 2 y ds, for contact about to be lost or just made. It holds
 * over any number of steps while the inputs run on. */
#ifndef FIRMWARE_TAYLOR_PIECE_H
#define FIRMWARE_TAYLOR_PIECE_H

#include <math.h>
#include <stdint.h>
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

/* Call it when the state was set from outside: a motion begins at x. */
void taylor_begin_motion(struct taylor *t, const struct model *m, const double *p, const struct segment *e,
                         const double *x);

/* The motion is at x now: its size, and when that has doubled what follows from it. */
void taylor_grow(struct taylor *t, double size);
ALWAYS_INLINE void taylor_measure(struct taylor *t, const double *x)
{
    double deviation = fabs(x[0] - t->rest) * t->rate_scale, rate = fabs(x[1]);
    t->most = deviation > t->most ? deviation : t->most;
    t->most_rate = rate > t->most_rate ? rate : t->most_rate;
    double size = TAYLOR_SPARE * (t->most < t->most_rate ? t->most : t->most_rate);
    if (t->size < 1.0 && size >= 2.0 * t->size)
        taylor_grow(t, size);
}

/* Begins a piece from (eta, rate) and the regime `closed` under a load, `left` before the segment's end.
 * `short_lived`: it will not be read beyond that. False when the motion escaped or a number is not finite. */
bool taylor_begin(struct taylor *t, const struct taylor_load *load, double left, bool short_lived);

/* Instead of a piece: the whole segment by one series of order 8, 10 or 12, for a Hertzian contact. `brief`
 * then says whether that was worth it. False when no such series holds that far or a contact switches; the
 * motion is unchanged. */
bool taylor_short(struct taylor *t, const struct segment *e);
/* Likewise for a polynomial force, by order 6, 8, 11 or 14. At most one input may multiply powers of x. */
bool taylor_short_cubic(struct taylor *t, const struct segment *e);

/* After this piece, is one short series per step sufficient and cheaper? */
bool taylor_is_brief(const struct taylor *t, const struct segment *e);

/* eta and rate at `now`, now <= end. */
void taylor_read(struct taylor *t);

/* eta, rate and root at the end; the regime turns when that is an event. The piece is over. */
void taylor_finish(struct taylor *t);

#endif
