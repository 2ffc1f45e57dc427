/* watch.h - the run-time monitor of a choice of model: one observable of the plant against an interval.
 *
 * A cheaper model holds while some observable stays inside an interval (docs/guide/scenes.md, [watch]). At
 * the end of each tick the observable is compared with it. Between two ticks nothing is seen: with n ticks in
 * the fastest period a peak may stand out by (pi/n)^2/2 of its amplitude. The eigenfrequency changes with
 * parameters only: a change is seen at the end of the tick that it falls into. So is a change that `changes`
 * counts; a drive's frequency as it is at that instant, inside a ramp too, once its amplitude is not 0. Time
 * is the plant's, tick times tick_s; a reset sets back neither it nor the count. The first tick outside
 * latches the trip with its tick and value, until watch_clear; each further way out of the interval is a trip
 * to count. It changes nothing in the plant: who owns it does.
 *
 * Cost: the model's output function and a comparison each tick (docs/why/design.md has numbers); nothing
 * where it is not active. */
#ifndef FIRMWARE_WATCH_H
#define FIRMWARE_WATCH_H

#include "firmware/plant/plant.h"

struct watch_limits {
    int observable;   /* see model_observable */
    double low, high; /* SI, a frequency in Hz, in bus seconds; inside is low <= observable <= high */
};

struct watch {
    bool active;
    struct watch_limits limits;
    int state;       /* that is the observable, -1: it is none */
    bool outside;    /* at the end of the last tick */
    bool tripped;    /* latched */
    uint32_t number; /* trips latched so far */
    uint64_t tick;
    double value; /* SI; tick and value are those of the trip that latched */
};

/* Starts to watch: from the next watch_tick on. Returns NULL, or the reason why these limits do not fit
 * this model (no such observable, or low not below high); then *w is not active. */
MUST_CHECK const char *watch_start(struct watch *w, const struct watch_limits *l, const struct model *m);

/* Call it at the end of each tick. True when the observable has just left the interval; a NaN is outside.
 * False while it stays outside, and where *w is not active. */
bool watch_tick(struct watch *w, const struct plant *pl);

/* Forgets the latched trip. If the observable is outside at the end of the next tick, that is a new trip. */
void watch_clear(struct watch *w);

/* The observable now, SI or Hz, numbered as in watch_limits; it must exist (model_observable). */
double watch_read(const struct plant *pl, int observable);

#endif
