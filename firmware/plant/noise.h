/* noise.h - broadband noise of an input: seeded Gaussian values on a grid of plant ticks.
 *
 * Value k of a sequence is the standard normal deviate of word k of SplitMix64 (Steele, Lea & Flood 2014)
 * started at the sequence's number, by Wichura's AS 241 (Appl. Statist. 37, 1988). It is a function of
 * sequence and k alone. So a snapshot, a replay and any first tick give the same noise.
 *
 * Cell k spans the plant ticks k hold .. (k + 1) hold - 1. A force holds value k over the cell. A length
 * runs in a straight line from value k to value k + 1, because a jump of the base would be an impulse that
 * no ledger can book.
 *
 * With a hold time T and standard deviation sigma, R(s) = integral of Phi(w) e^(iws), the two-sided
 * spectral density per rad/s is
 *
 *     Phi(w) = sigma^2 T/(2 pi) sinc^2(w T/2)    held; sinc^4 in straight lines; sinc x = sin x/x
 *
 * and 4 pi Phi one-sided per Hz. So sigma^2 = 2 pi Phi/T gives a level Phi. It is 4 % low at f = 0.11/T
 * (held) or 0.08/T (straight lines). */
#ifndef FIRMWARE_NOISE_H
#define FIRMWARE_NOISE_H

#include <stdbool.h>
#include <stdint.h>
#include "firmware/method/method.h"
#include "models/math/deviate.h"

enum { NOISE_HOLD_MAX = 65535 /* ticks */ };

struct noise_setting {
    double deviation; /* standard, model units, >= 0; 0: none */
    uint32_t hold;    /* ticks, 0 counts as 1 */
    uint32_t seed;
};

/* Level and rest go along the ramp of the drive, whose position
 * x is 0 at its begin and 1 at its end and ever after. */
struct noise {
    uint64_t sequence; /* 2^32 input number + seed: inputs with equal seeds have different noise */
    uint32_t hold;
    bool straight;            /* straight lines between the grid's values, else held; the input's nature */
    bool active;              /* false while the noise is zero */
    bool anew;                /* sequence or hold changed since the last segment */
    double level_from, level; /* standard deviation at x = 0 and 1, model units */
    double x;                 /* at the end of the last segment */
    double rest;  /* a change of sequence or hold would jump by this at x = 0; it fades to 0 at x = 1 */
    double value; /* at the end of the last segment, model units */
    /* the cell of the last segment */
    bool known;
    uint64_t cell, begin_tick;
    double here, next; /* its value and the next cell's */
};

/* A stretch of plant time inside one tick. */
struct noise_span {
    uint64_t tick;
    double begin, length; /* in ticks, from the tick's start */
    double ramp_end;      /* position in the drive's ramp */
    double ticks_per_time;
};

/* Starts without noise on input `i_input`, whose number makes sequences of equal seeds differ. straight:
 * lines between the values, for a length; else held. */
void noise_init(struct noise *n, int i_input, bool straight);

/* Takes this setting now, without a ramp: for initial conditions only, because the input jumps. */
void noise_start(struct noise *n, const struct noise_setting *s);

/* Begins a new ramp at the present level and leaves the old one where it is; drive_change calls it. */
void noise_leave(struct noise *n);

/* Sets the target of the ramp that has just begun. The noise is continuous there, whichever of level, hold
 * and seed change. */
void noise_aim(struct noise *n, const struct noise_setting *s);

/* The setting that the noise has or is on its way to. */
struct noise_setting noise_target(const struct noise *n);

/* Adds the noise over a span to the wave and instants that input i of the segment already holds. In a ramp
 * a straight line joins the exact values at the span's ends. Returns false when the noise is the constant
 * of the previous span. Costs one noise_deviate for each new cell. */
bool noise_add(struct noise *n, const struct noise_span *s, struct segment *e, int i);

/* Converts to a new unit of the input: levels and value times `factor`. */
void noise_rescale(struct noise *n, double factor);

#endif
