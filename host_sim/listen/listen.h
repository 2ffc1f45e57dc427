/* listen.h - the one listener of telemetry: it makes whole the frames and ticks, of which messages carry the
 * low bits, and the contact events, which are two messages each. All who receive messages of a plant use it.
 */
#ifndef HOST_SIM_LISTEN_H
#define HOST_SIM_LISTEN_H

#include <stdbool.h>
#include <stdint.h>
#include "firmware/bus/wire.h"

/* The 64-bit number that ends in these low bits and is nearest to `last`, but none below 0. */
uint64_t listen_nearest(uint64_t last, double low, int bits);

/* That number for a field of this message. */
uint64_t listen_extend(uint64_t last, const struct message *m, int field);

/* A SYNC: *frame and *tick of the one before become its own. True where plant time begins anew before it: the
 * plant was started again, or this is another log. Then the frame counts from 0 again, by its low bits. */
bool listen_sync(uint32_t substeps, const struct message *m, uint64_t *frame, uint64_t *tick);

/* A contact has closed or opened. */
struct listen_event {
    uint64_t tick;
    double fraction; /* a part of a tick, behind it */
    double t_s;      /* both, as plant time */
    bool touch;
    unsigned contact;
    bool has_data;              /* else EVENT_DATA is missing, and what follows is not known */
    double speed, peak_force_N; /* NaN: beyond the bus's range, or not known */
};

/* EVENT_TIME and EVENT_DATA of one event have the same COUNTER, contact and kind. */
struct listen_events {
    double tick_s;
    void (*take)(void *context, const struct listen_event *e); /* each event, in order; NULL for none */
    void *context;
    struct listen_event last; /* whose EVENT_TIME came last */
    uint8_t counter;          /* that message's */
    bool waits;               /* for its EVENT_DATA */
};

/* Any message, the newest SYNC being at `tick`. Data without a time are no event. */
void listen_events_take(struct listen_events *l, const struct message *m, uint64_t tick);

/* Nothing more comes: the last event is given as it is. */
void listen_events_end(struct listen_events *l);

#endif
