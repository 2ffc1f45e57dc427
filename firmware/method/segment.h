/* segment.h - a time span with every input as a function of time, and parts of it: up to an instant (head)
 * and from an instant on (tail). */
#ifndef FIRMWARE_SEGMENT_H
#define FIRMWARE_SEGMENT_H

#include <stdbool.h>
#include "models/model.h"

/* One input over a segment, s being the model time from the segment's start:
 *
 *     value(s) = offset + slope s + (amplitude + growth s) cos(theta + omega s)
 *
 * `taylor` takes its series from this, `exact` its phasor, `rk4` the three instants of struct segment. */
struct wave {
    double offset, slope;
    double amplitude, growth;
    double cosine, sine; /* cos theta, sin theta */
    double omega;        /* per model time */
};

struct segment {
    double length;    /* model time, >= 0 */
    unsigned active;  /* bit i: input i is not identically zero */
    bool changed;     /* false while every wave only runs on from the previous segment */
    uint64_t instant; /* its begin in 1/65536 tick since tick 0; a method numbers its noise by it */
    struct wave wave[MODEL_INPUTS];
    struct input at[3][MODEL_INPUTS]; /* the inputs at 0, length/2 and length */
};

/* Value and rate of a wave at model time s from its start. */
void wave_at(const struct wave *w, double s, struct input *u);
/* The rate of its rate there, where the input is u. */
double wave_acceleration(const struct wave *w, double s, const struct input *u);

/* `head` becomes the part of the segment up to `length`. */
void segment_head(const struct segment *e, int n_inputs, double length, struct segment *head);
/* `e` becomes what is left of it from `done` on, with `changed` set: it begins inside a tick. */
void segment_tail(struct segment *e, int n_inputs, double done);
/* Both at once: `e` becomes what is left. Only what a ledger reads of `head` is written: its length, its
 * active inputs and the inputs at its three instants. */
void segment_cut(struct segment *e, int n_inputs, double done, struct segment *head);

#endif
