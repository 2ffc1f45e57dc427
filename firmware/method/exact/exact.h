/* exact.h - the linear system of one contact regime, and the scratch memory of method exact.
 *
 *   x = (positions, velocities),  position' = velocity, velocity' = a x + sum_i (b_i u_i + b_rate_i u_i') + c
 *
 * With constant coefficients and inputs that are waves (method.h) the series converges everywhere, as fast as
 * that of e^z. There are no eigenvectors: a regime that is overdamped, undamped or defective, and a drive on
 * a resonance, need no case of their own. The solution is linear in the start, in c and in the inputs. So its
 * series over a tick is a sum of curves that are tabulated at the start. exact_follow adds them up, and
 * expands only what they do not cover. */
#ifndef FIRMWARE_EXACT_H
#define FIRMWARE_EXACT_H

#include <stdbool.h>
#include <string.h>
#include "firmware/method/method.h"
#include "models/check.h"

/* Above this |eigenvalue| * length two switches of a contact could hide between the ends of a step. */
#define EXACT_LIMIT 2.1
/* Without contacts a tick may be this many times as long. Its tables are put together from pieces. */
#define EXACT_PIECES 32
/* A drive makes less than half a turn per tick: pi is inside. */
#define EXACT_REACH 3.375

enum {
    EXACT_HALF = MODEL_LINEAR_STATES / 2,
    EXACT_TERMS = 32, /* terms of a series: good to 2^-56 of its largest up to EXACT_REACH */
    /* Terms of a curve beyond its position and velocity at the start. It is economised, not cut off
     * (exact_tables.c): good to 2^-53 over a tick up to EXACT_REACH. A multiple of 4. */
    EXACT_CURVE = 16,
    EXACT_LANES = 4, /* positions, or velocities, filled up to a quad */
    EXACT_LATE = 4,  /* the last states of six, from the pair of the first velocity on */
    /* The change of n states over a tick, and behind it that of the last ones over half a tick. */
    EXACT_ROW = MODEL_LINEAR_STATES + EXACT_LATE,
    EXACT_REGIMES = 1 << MODEL_CONTACTS,
    EXACT_SYSTEMS =
        4 /* different ones that there are tables for; sides of a gap and equal springs share theirs */
};
STATIC_ASSERT(EXACT_LANES >= EXACT_HALF, exact_lanes);

/* Two doubles side by side: one operation where the target has such registers, two where it has not, with the
 * same bits. Compilers do not find this by themselves here, or not at this level. */
typedef double exact_pair __attribute__((vector_size(16)));

#if defined(__SSE2__)
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
#else /* one by one: as a block it would pass through integer registers */
ALWAYS_INLINE exact_pair exact_load(const double *a)
{
    return (exact_pair){a[0], a[1]};
}

ALWAYS_INLINE void exact_store(double *a, exact_pair v)
{
    a[0] = v[0];
    a[1] = v[1];
}
#endif

/* Loops over the components of a state have constant bounds; unrolled, each component is a register. clang
 * does so by itself. */
#if defined(__clang__)
#define EXACT_UNROLL
#else
#define EXACT_UNROLL _Pragma("GCC unroll 8")
#endif

/* The structs down to struct exact lie in scratch memory. Their arrays of doubles begin at multiples of a
 * pair: pairs that cross a cache line are slow. */
struct exact_equation {
    double rate;                                /* largest |eigenvalue|, from above */
    double a[MODEL_LINEAR_STATES][EXACT_LANES]; /* [column][row] */
    double b[MODEL_INPUTS][EXACT_LANES], b_rate[MODEL_INPUTS][EXACT_LANES];
    bool follows_rate[MODEL_INPUTS]; /* b_rate is not 0 */
};

/* The cause of a curve, s in ticks from its start. */
enum exact_column {
    CURVE_STATE,                                        /* a state of 1 at the start, from rest otherwise */
    CURVE_CONSTANT = CURVE_STATE + MODEL_LINEAR_STATES, /* velocity' = 1 */
    CURVE_SLOPE = CURVE_CONSTANT + EXACT_HALF,          /* velocity' = s */
    CURVE_COSINE = CURVE_SLOPE + EXACT_HALF,            /* u_i = cos (omega s) */
    CURVE_SINE = CURVE_COSINE + MODEL_INPUTS,
    EXACT_COLUMNS = CURVE_SINE + MODEL_INPUTS
};

/* The change of the state by an input u = cos(omega s), sin(omega s), 1 and s. */
struct exact_response {
    double omega; /* that cosine and sine hold for, here and in curve */
    double pad;
    double cosine[EXACT_ROW], sine[EXACT_ROW], offset[EXACT_ROW], slope[EXACT_ROW];
};

/* Regimes that differ in c alone share a system. */
struct exact_system {
    struct exact_equation equation;
    /* The change of the state over a whole tick is the sum of these, each times its cause. It is the change
     * and not the state, because its rounding errors, which are equal in every tick, are then smaller, by the
     * factor rate h. */
    double whole[MODEL_LINEAR_STATES][EXACT_ROW]; /* a state of 1 at the start */
    struct exact_response input[MODEL_INPUTS];
    /* Positions inside a tick: coefficients of s^2, s^3, ... */
    double curve[EXACT_COLUMNS][EXACT_HALF][EXACT_CURVE];
};

struct exact_regime {
    int system;   /* number in struct exact */
    double reach; /* length over which a step is sound, EXACT_LIMIT / rate; 0: no such regime */
    double tick;  /* length that there are tables for; -1: none */
    double unit;  /* time unit of a path: the tick, or a shorter `reach`; then there are no curves */
    double below[EXACT_LANES], above[EXACT_LANES];              /* it holds for positions between these */
    int contact_below[EXACT_LANES], contact_above[EXACT_LANES]; /* which switches there */
    double ends_below[2], ends_above[2]; /* first and last position; empty if others have walls */
    double c[EXACT_LANES];
    double rest[EXACT_ROW]; /* the change by c */
};

/* gap = constant + slope * position */
struct exact_gap {
    double constant, slope;
    int position;
};

/* Powers at velocities v: loss sum damping_k v_k^2, work of input i u_i sum work_ik v_k. Their rows stand as
 * the last states do, with 0 for a position. Contact i has the force stiffness_i times its compression. */
struct exact_powers {
    double damping[EXACT_LATE], work[MODEL_INPUTS][EXACT_LATE];
    double stiffness[MODEL_CONTACTS];
    bool known; /* false: the ledger books by its own rule */
};

enum { EXACT_BOOKS = TICK_LANES > 1 ? BLOCK_TICKS : 1, EXACT_SWITCHES = TICK_LANES > 1 ? RUN_SWITCHES : 1 };

struct exact {
    double h, pad;
    double end[EXACT_ROW]; /* state after a tick that may have switched, and in its middle, for step_near */
    struct exact_powers powers;
    struct method_books books[EXACT_BOOKS];
    double at_switch[EXACT_SWITCHES][MODEL_LINEAR_STATES]; /* states at the switches of a run, */
    struct method_books before[EXACT_SWITCHES];            /* and the books of their ticks before them */
    struct exact_gap gap[MODEL_CONTACTS];
    struct exact_regime regime[EXACT_REGIMES];
    struct exact_system system[]; /* as many as the model may have, at most EXACT_SYSTEMS */
};

ALWAYS_INLINE struct exact_system *exact_system_of(struct exact *w, const struct exact_regime *r)
{
    return &w->system[r->system];
}

#endif
