/* diag.h - every counter of the plant: one enum, one table of names, sent one after the other as HEALTH.
 *
 * A counter wraps after 2^32; it is never reset while the plant runs. A new one goes at the end of the
 * enum, because its number is its item in HEALTH; docs/reference/numbers.md lists them. */
#ifndef FIRMWARE_DIAG_H
#define FIRMWARE_DIAG_H

#include <stdint.h>

enum diag {
    /* frames refused before they were commands */
    DIAG_FRAMES_RECEIVED, /* addressed to this plant */
    DIAG_CRC,
    DIAG_LENGTH,
    DIAG_UNKNOWN_ID,      /* inside our 64 identifiers, but no command */
    DIAG_COUNTER_INVALID, /* 15 */
    DIAG_REPEATED,        /* counter not advanced: not taken */
    DIAG_LOST,            /* counters skipped: taken, the gap counted */
    /* commands refused, one per cause */
    DIAG_RANGE,
    DIAG_LATE,
    DIAG_STALE,
    DIAG_SESSION,
    DIAG_STATE,
    DIAG_FULL,
    DIAG_INCOMPLETE,
    DIAG_UNKNOWN,
    DIAG_SELF_TEST,
    /* the link */
    DIAG_TIMEOUTS,
    DIAG_COMMAND_AGE_FRAMES, /* a value, not a count */
    DIAG_STREAM_MISSED,      /* frames of an active stream without a sample */
    DIAG_RX_DROPPED,
    DIAG_RX_FOREIGN,
    DIAG_BUS_OFF,
    DIAG_BUS_PASSIVE,
    DIAG_BUS_DOWN,
    DIAG_TX_DEFERRED, /* no room: kept, newest of each kind */
    DIAG_TX_REPLACED, /* a kept frame was overtaken by a newer one and lost */
    DIAG_RX_BUDGET,   /* frames in which the receive bound was reached */
    /* the plant */
    DIAG_SWITCHES,
    DIAG_SWITCH_BUDGET,
    DIAG_METHOD_BUDGET,
    DIAG_SWITCH_RESIDUAL,
    DIAG_EVENTS_LOST,
    DIAG_NOT_FINITE,
    DIAG_PIECES_MAX,
    DIAG_FIRE_APPLIED,
    DIAG_STREAM_APPLIED,
    /* the capture: values, not counts */
    DIAG_CAPTURE_STATE,
    DIAG_CAPTURE_PRETRIGGER, /* samples before the trigger; fewer than asked for when it came early */
    DIAG_CAPTURE_TICK,       /* tick of the trigger, low 32 bits */
    /* timing, microseconds */
    DIAG_OVERRUNS,
    DIAG_FRAMES_MISSED,
    DIAG_FRAMES_SLIPPED, /* bus frames by which plant time fell behind */
    DIAG_COMPUTE_MAX_US,
    DIAG_COMPUTE_MAX_FRAME,
    DIAG_LATENESS_MAX_US,
    DIAG_LATENESS_MAX_FRAME,
    /* the watch */
    DIAG_WATCH_TRIPS,
    DIAG_WATCH_TICK, /* a value: tick of the trip that WATCH reports, low 32 bits */
    /* the cause that ended the run before this one: a value; the numbers are a board's, 0 for nothing */
    DIAG_LAST_RUN,
    /* faults of the sensors in force: a value, bit k for setting SET_SENSOR_OFFSET + k */
    DIAG_SENSOR_FAULTS,
    /* the link again */
    DIAG_RX_FLOOD,  /* frames beyond the receive bound twice in a row: dropped, but for STOP and ENABLE */
    DIAG_TX_UNSENT, /* one of several peers could not be sent to */
    DIAG_LOG_ENDED, /* the recording ended before the run */
    /* results of the lock-in that were not available, by cause */
    DIAG_LOCKIN_SHORT,
    DIAG_LOCKIN_CLOSE,
    DIAG_COUNTERS
};

struct diag_name {
    const char *name, *unit, *meaning;
};

/* For help, tools and the .dbc: name as in HEALTH, unit or "", and the meaning in a line. */
extern const struct diag_name diag_name[DIAG_COUNTERS];

#endif
