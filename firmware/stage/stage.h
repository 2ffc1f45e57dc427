/* stage.h - an actuator or a sensor: a chain of elements that a signal passes once a tick.
 *
 *     static const struct stage_part shaker[] = {{STAGE_CLIP, 40.0, 0.0}, {STAGE_RESONANCE, 800.0, 0.3}};
 *     struct stage s;
 *     if (!stage_init(&s, 1e-5, 0, shaker, 2))
 *         force = stage_run(&s, command); // each tick
 *
 * The signal is held over the tick, and the result is that at the tick's end. A resonance or a lag is exact
 * for this signal, so a step has the exact response at every tick. An element without memory answers at once.
 * In a chain an element holds what the one before it has at the tick's end.
 *
 * A stage has no pointer into itself: a copy is a snapshot. It takes no memory and has no other state. Its
 * noise is a function of seed, tick and place in the chain. A signal that is not finite, or beyond
 * STAGE_LIMIT, is refused: the last good one is taken instead, and `refused` counts it. So no NaN comes out.
 * docs/reference/stage.md has the equations. */
#ifndef FIRMWARE_STAGE_H
#define FIRMWARE_STAGE_H

#include <stdint.h>
#include "models/check.h"

enum {
    STAGE_PARTS = 12,     /* elements of a chain */
    STAGE_PLAYS = 8,      /* play operators of a hysteresis */
    STAGE_LAGS = 13,      /* lags of a creep: two a decade over six decades */
    STAGE_RING = 512,     /* samples that a delay keeps */
    STAGE_DELAY_MAX = 510 /* ticks */
};

/* Signals and results stay below this, with room for every gain. */
#define STAGE_LIMIT 1e30

/* [unit] is that of the signal. */
enum stage_kind {
    STAGE_GAIN,       /* a: factor */
    STAGE_SLEW,       /* a: largest rate, unit/s */
    STAGE_HYSTERESIS, /* a: range, unit; b: share of the play, 0 to 1 */
    STAGE_CREEP,      /* a: share of a step that creeps in a decade of time */
    STAGE_RESONANCE,  /* a: undamped frequency, Hz; b: damping ratio below 1 */
    STAGE_NOISE,      /* a: density, unit/sqrt(Hz), one-sided */
    STAGE_FLICKER,    /* 1/f noise. a: corner, Hz; b: density that it has there, as that of STAGE_NOISE */
    STAGE_DRIFT,      /* a: rate, unit/s, from 0 where the stage settled */
    STAGE_LAG,        /* a: corner frequency, Hz */
    STAGE_CLIP,       /* a: largest magnitude, unit */
    STAGE_QUANTISER,  /* a: quantum, unit */
    STAGE_DELAY,      /* a: ticks, also a fraction; one in a chain */
    STAGE_KINDS
};

struct stage_part {
    enum stage_kind kind;
    double a, b;
};

/* A part as stage_init prepares it, and its state. */
struct stage_element {
    enum stage_kind kind;
    double c[STAGE_LAGS + 1];
    double x[STAGE_LAGS + 1];
};

struct stage {
    uint64_t tick; /* that the next signal has */
    uint64_t sequence;
    uint32_t refused; /* signals that were refused */
    int n;
    double signal, result; /* the last ones */
    struct stage_element element[STAGE_PARTS];
    double ring[STAGE_RING]; /* for the delay, by tick */
};

/* A chain settled at 0. tick_s: seconds of the real plant a tick; seed: below 2^28. NULL, or which value is
 * refused; then *s is not to be used. */
MUST_CHECK const char *stage_init(struct stage *s, double tick_s, uint32_t seed,
                                  const struct stage_part *part, int n);

/* NULL, or why stage_init would refuse these. */
MUST_CHECK const char *stage_refuse(double tick_s, const struct stage_part *part, int n);

/* As if the signal had always been u, with hysteresis and creep at rest: their result is what they are given.
 * Drift and 1/f noise begin at 0. The next signal is that of `tick`. */
void stage_settle(struct stage *s, double u, uint64_t tick);

/* One tick. 20 to 40 instructions an element; 130 for hysteresis, 150 for noise, 170 for creep, 350 for
 * 1/f noise. */
double stage_run(struct stage *s, double u);

/* n ticks, n > 0: u[k] becomes the result of each. Results are those of single ticks. Gain and resonance then
 * take 5 and 15 instructions. */
void stage_run_many(struct stage *s, double *u, uint32_t n);

/* Goes on with the hash of a state: everything that the next results follow from. */
uint64_t stage_hash(const struct stage *s, uint64_t hash);

/* The multiple of quantum nearest to x, ties to the even one; from 2^51 quanta on x as it is. */
static inline double stage_quantised(double x, double quantum)
{
    const double whole = 0x1.8p52;
    double n = x / quantum;
    return n < 0x1p51 && n > -0x1p51 ? (n + whole - whole) * quantum : x;
}

#endif
