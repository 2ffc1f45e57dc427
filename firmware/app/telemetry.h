/* telemetry.h - from the plant to the bus: which message goes out in which frame.
 *
 * It reads the app and changes only its own state: nothing happens in the plant because something is or is
 * not sent. A result that goes out once has a number; telemetry remembers the number that it has sent. */
#ifndef FIRMWARE_TELEMETRY_H
#define FIRMWARE_TELEMETRY_H

#include <stdbool.h>
#include "firmware/observe/capture.h"
#include "firmware/bus/mailbox.h"
#include "firmware/bus/settings.h"
#include "firmware/bus/wire.h"

struct app;

enum { TELEMETRY_SLOTS = WIRE_KINDS - WIRE_COMMANDS };

struct telemetry {
    uint8_t tx_counter[WIRE_KINDS];
    struct frame tx[TELEMETRY_SLOTS]; /* frames for which the hal had no room: the newest of each kind */
    uint32_t n_tx;
    uint32_t deferred, replaced;                  /* frames kept; of them those that were not sent later */
    uint32_t echo_next, ledger_next, health_next; /* round-robin positions of the slow messages */
    uint32_t echo_pending[STAGED_WORDS];          /* bit per wire index: PARAM_ECHO to be sent */
    uint32_t info_pending;                        /* bit per item: INFO to be sent */
    uint16_t selftest_pending;                    /* bit per check: SELF_TEST to be sent */
    uint32_t touchdowns, not_sent;                /* since the last EVENT_SUMMARY */
    double loss_s, total_s; /* since the last EVENT_SUMMARY: bus seconds with every contact open, and all */
    uint32_t status_sent;   /* the last STATUS, in one word */
    uint32_t latency_sent, watch_sent, lockin_sent[LOCKIN_SLOTS]; /* numbers of the last results sent */
    double said[SENSOR_SIGNALS];    /* last value of each sensor; NaN: nothing yet */
    struct capture_reading reading; /* read-out of the capture's burst */
};

/* Starts with nothing sent and every item of INFO due. */
void telemetry_init(struct telemetry *t);

/* Sends all that is due in this bus frame, in which plant time moved by `advanced` plant frames. Call it
 * once per frame: it adds up the plant's events and times of that frame. */
void telemetry_report(struct telemetry *t, const struct app *a, uint32_t advanced);

/* Sends SELF_TEST again, one check per frame; nothing without a self-test. */
void telemetry_tell_selftest(struct telemetry *t, const struct app *a);

/* For a session that opens: sends SELF_TEST, INFO and a latched WATCH again. */
void telemetry_greet(struct telemetry *t, const struct app *a);

/* Marks the value of this wire index, 0..127, for PARAM_ECHO; at most four go out per frame. */
static inline void telemetry_echo(struct telemetry *t, unsigned index)
{
    t->echo_pending[index / 32] |= 1u << (index % 32);
}

#endif
