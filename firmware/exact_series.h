/* exact_series.h - the linear system of one contact regime and its solution as a power series, for method exact.
 *
 *   x = (positions, velocities):  position' = velocity,  velocity' = a x + sum_i (b_i u_i + b_rate_i u_i') + c
 *
 * With constant coefficients and inputs that are waves (method.h) the series converges everywhere and as fast as that
 * of e^z: to 2^-56 of its largest term with EXACT_TERMS terms while |eigenvalue| * length and |omega| * length stay
 * below EXACT_REACH. No eigenvectors: an overdamped, undamped or defective regime, or a drive on a resonance, is a
 * case like the others. */
#ifndef FIRMWARE_EXACT_SERIES_H
#define FIRMWARE_EXACT_SERIES_H

#include <stdbool.h>
#include <string.h>
#include "firmware/check.h"
#include "firmware/method.h"

/* |eigenvalue| * length above this, and two switches of a contact could hide between the ends of a step. */
#define EXACT_LIMIT 2.1
/* A drive turns less than half a turn per tick: pi is inside. */
#define EXACT_REACH 3.375

enum {
    EXACT_TERMS = 31,
    EXACT_LANES = 4, /* positions, or velocities, filled up to whole pairs */
    EXACT_REGIMES = 1 << MODEL_CONTACTS
};
STATIC_ASSERT(EXACT_LANES % 2 == 0 && 2 * EXACT_LANES >= MODEL_STATES, exact_lanes);

/* Two doubles side by side: one operation where the target has such registers, two where it has not, the same bits.
 * Left to themselves compilers do not see it here, or not at this level. */
typedef double exact_pair __attribute__((vector_size(16)));

ALWAYS_INLINE exact_pair exact_load(const double *a)
{
    exact_pair v;
    memcpy(&v, a, sizeof v);
    return v;
}

ALWAYS_INLINE void exact_store(double *a, exact_pair v)
{
    memcpy(a, &v, sizeof v);
}

/* Loops over the components of a state have constant bounds: unrolled, each is a register. (clang does so unasked.) */
#if defined(__clang__)
#define EXACT_UNROLL
#else
#define EXACT_UNROLL _Pragma("GCC unroll 8")
#endif

/* Doubles only: it lies in a method's work memory. */
struct exact_regime {
    double exists; /* 0 for contacts that cannot be closed together */
    double rate;   /* largest |eigenvalue|, from above */
    double reach;  /* length over which a step is sound, EXACT_LIMIT / rate; 0: no such regime */
    double below[EXACT_LANES], above[EXACT_LANES]; /* it holds for positions between these */
    double a[MODEL_STATES][EXACT_LANES];           /* [column][row] */
    double b[MODEL_INPUTS][EXACT_LANES], b_rate[MODEL_INPUTS][EXACT_LANES], c[EXACT_LANES];
    double follows_rate[MODEL_INPUTS]; /* 0 where b_rate is */

    /* The change of the state over a whole tick is the sum of these, each times what it is the response to. The change,
     * not the state: its rounding errors, the same in every tick, are smaller by rate * h. */
    double whole[MODEL_STATES][MODEL_STATES]; /* a state of 1 at the start */
    double rest[MODEL_STATES];                /* c */
    double offset[MODEL_INPUTS][MODEL_STATES], slope[MODEL_INPUTS][MODEL_STATES]; /* u_i = 1, u_i = s */
    double omega[MODEL_INPUTS]; /* that the next two hold for */
    double cosine[MODEL_INPUTS][MODEL_STATES],
        sine[MODEL_INPUTS][MODEL_STATES]; /* u_i = cos, sin (omega s) */
};

/* gap = constant + slope * position */
struct exact_gap {
    double constant, slope;
    int position;
};

struct exact {
    double h;
    struct exact_gap gap[MODEL_CONTACTS];
    double load[EXACT_TERMS][EXACT_LANES]; /* series of what drives the velocities */
    /* Series of the state, in units of the length it was made for: positions, then velocities, from lane EXACT_LANES. */
    double term[EXACT_TERMS][2 * EXACT_LANES];
    struct exact_regime regime[]; /* 1 << n_contacts */
};

/* What method exact refuses, and its tables (exact_tables.c). */
const char *exact_refuse(const struct model *m, const double *p, double h, double tol);
void exact_prepare(const struct model *m, const double *p, double h, double tol, double *work);
/* The tables of input i at this frequency. */
void exact_tune(struct exact *w, struct exact_regime *r, const struct model *m, int i, double omega);

/* Fastest exponent or phase over a span of length `l` (either sign) of this excitation. */
double exact_reach(const struct exact_regime *r, const struct excitation *e, int n_inputs, double l);

/* The order that a series needs for this reach. */
int exact_order(double reach);

/* w->term[n]: coefficients of the state over s / l, from x at s = 0; l may be negative. */
void exact_expand(struct exact *w, const struct exact_regime *r, const struct model *m,
                  const struct excitation *e, double l, int order, const double *x);

/* By how much the state has changed at s / l = theta, from w->term. Added to the start last, it loses to rounding once. */
void exact_change(const struct exact *w, int n_states, int order, double theta, double *dx);

/* Where a contact leaves its regime, in units of the span of w->term. */
struct exact_root {
    double theta;
    bool converged;
};

/* The first such instant in [0, 1]; false when there is none. reach: of the span; end: the gap there, its rate per
 * span (exact_root.c). */
bool exact_first_root(const struct exact *w, int contact, bool closed, double reach, const struct input *end,
                      struct exact_root *root);

#endif
