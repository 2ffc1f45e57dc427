/* can_session.h - a controller's session with a plant in the same program, a frame of each in turn: no clock,
 * no host. Over two CAN controllers of a board or over hal/loopback, every byte of the traffic must be the
 * same.
 *
 * Controllers keep few frames: each frame is taken up by the other end as soon as it is sent, as an interrupt
 * would. */
#ifndef TESTS_CAN_SESSION_H
#define TESTS_CAN_SESSION_H

#include "firmware/app/app.h"

struct can_session {
    struct app app;
    struct hal wire;                 /* the app's end: `plant`, with `bench` listening to every frame */
    const struct hal *plant, *bench; /* the two ends of the bus */
    struct wire_scene scene;
    uint64_t frame; /* the plant's frame, as last heard */
    uint8_t session, counter[WIRE_COMMANDS];
    uint64_t traffic; /* hash of all frames that the plant sent, timing reports left out */
    uint32_t heard[WIRE_KINDS], cause[CAUSES], bad;
    uint32_t unsent, faults; /* sends that found no room, fault reports: none should be */
};

/* Runs it all. NULL, or why the plant did not start. *s is the caller's, and so are the two ends. */
const char *can_session_run(struct can_session *s, const struct hal *plant, const struct hal *bench);

/* Tells the result, a line at a time: what, number, digits of its hexadecimal form or 0 for decimal. */
void can_session_report(const struct can_session *s,
                        void (*line)(const char *what, uint64_t value, int digits));

#endif
