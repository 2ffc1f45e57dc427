/* app.h - the plant on a bus: struct app owns everything, app_frame() is the whole data path.
 *
 *   bus -> hal.recv -> wire_decode -> mailbox -> (drives, parameters) -> plant_advance -> telemetry -> wire_encode
 *       -> hal.send -> bus
 *
 * The caller runs app_frame once per frame period (a timer interrupt, a real-time loop or a test). A frame that
 * starts late is reported with app_overrun first. struct app has no pointer into itself: a copy of it, with a copy
 * of the caller's scratch, stage and capture memory, is a snapshot. */
#ifndef FIRMWARE_APP_H
#define FIRMWARE_APP_H

#include "firmware/observe/capture.h"
#include "firmware/bus/diag.h"
#include "firmware/observe/lockin.h"
#include "firmware/bus/mailbox.h"
#include "firmware/plant/plant.h"
#include "firmware/app/selftest.h"
#include "firmware/observe/sensor.h"
#include "firmware/bus/settings.h"
#include "firmware/app/telemetry.h"
#include "firmware/observe/timing.h"
#include "firmware/observe/watch.h"
#include "firmware/bus/wire.h"
#include "hal/hal.h"

enum {
    APP_RECV_BUDGET = 256, /* frames taken from the hal in one plant frame; the rest waits for the next one */
    APP_LOOK_AHEAD = 1 << 17 /* frames of a flood that one plant frame looks through for STOP and ENABLE */
};

struct app_config {
    const struct model *model;
    const double *si;      /* [n_parameters] SI, or NULL for the defaults */
    const double *setting; /* [SETTINGS], or NULL for the defaults */
    const struct method *method;
    double frame_s;    /* bus seconds per frame, e.g. 1e-3 */
    uint32_t substeps; /* ticks per frame, 1..4096 */
    double dilation;   /* bus seconds per real second; 1 for none */
    uint32_t base_id;  /* multiple of WIRE_BASE_ALIGN; 11 bits, or 29 with extended */
    bool extended;
    double tol;      /* for methods that have a tolerance; 0 for their default */
    double *scratch; /* method->n_scratch(model) doubles, or those of `promote` where these are more */
    const struct plant_stage_calls
        *stage_calls;      /* &stage_calls for a plant that may have actuators and sensors */
    struct stages *stages; /* then memory for them; else both NULL */
    float *capture;        /* n_capture floats for the burst capture, or NULL */
    uint32_t n_capture;
    const struct watch_limits *watch; /* what is watched at run time, or NULL */
    const struct model *promote;      /* the full model to climb to when the watch trips, or NULL for never */
    /* Sees the plant at the end of each tick and changes nothing, or NULL. */
    void (*observe)(void *observer, const struct plant *pl);
    void *observer;
};

/* End-to-end state of one command identifier. */
struct receiver {
    bool seen;
    uint8_t counter;
};

/* The last command that was applied, to report its latency. */
struct latency {
    uint32_t number; /* commands applied so far */
    uint8_t kind, counter;
    uint64_t received_tick, applied_tick;
};

/* The last finished lock-in window, SI. */
struct lockin_result {
    uint32_t number; /* windows finished so far */
    double amplitude, phase;
};

struct app {
    const struct hal *hal;
    struct app_config config;
    struct wire_scene scene;
    struct plant plant;
    struct mailbox mailbox;
    double setting[SETTINGS];
    uint64_t frame; /* bus frames since start; goes on while plant time stands */
    enum plant_state state;
    enum reaction reaction; /* in force, REACTION_NONE while heartbeats come, and in OFF */
    uint8_t faults;         /* latched enum fault_bit */
    bool enabled;
    uint8_t session; /* in force, or the last one */
    uint64_t
        echo_from; /* the oldest bus frame that a command may echo: the one after the last session's end */
    uint64_t heartbeat_frame; /* bus frame before which the last good ENABLE cannot have come */
    uint32_t
        absent;    /* frames that the plant has missed since; so many of them are the time-out's to forgive */
    uint32_t away; /* so many of them just before this one */
    uint32_t due;  /* app_frame calls due now, more than one by overrun policy `catch_up` */
    uint64_t step_left; /* frames still to run while paused */
    uint32_t
        jump; /* bus frames just before this one that the plant had no turn in: echoes may be so much older */
    uint32_t skip;      /* frames that the next one must make up for, by overrun policy `skip` */
    unsigned streaming; /* bit i: input i has had a sample in this session */
    struct receiver receiver[WIRE_COMMANDS]; /* one per command kind */
    bool crowded;                            /* the last frame took as many frames from the hal as it may */
    struct latency latency;
    struct lockin lockin[LOCKIN_SLOTS];
    uint8_t lockin_channel[LOCKIN_SLOTS], lockin_output[LOCKIN_SLOTS]; /* of each slot: the settings */
    struct lockin_result lockin_result[LOCKIN_SLOTS];
    struct sensor sensor;
    struct capture capture;
    struct watch watch;
    struct timing timing;
    uint32_t count[DIAG_COUNTERS];
    double balance_residual_J; /* of the ledger when it was last judged */
    struct selftest_result selftest;
    struct telemetry telemetry;
};

/* NULL, or the reason why this configuration cannot run (then *a is not to be used). */
MUST_CHECK const char *app_init(struct app *a, const struct app_config *c, const struct hal *hal);

/* After app_init: what the self-test found. It is told on the bus now and whenever a session is opened; where a check
 * failed, FAULT_SELF_TEST is latched and no session can be opened. Without this call the plant has no self-test. */
void app_take_selftest(struct app *a, const struct selftest_result *r);

/* After app_init on a board that restarted: what ended the last run (HEALTH last_run). FAULT_ASSERT is latched until a reset
 * command. */
void app_take_last_run(struct app *a, uint32_t kind);

/* One frame of work: receive, watch the commands' age, advance plant time by one frame, report. */
void app_frame(struct app *a);

/* `missed` whole frame periods (65535 at most are told apart) went by before this frame could start: counts and reports
 * them, and applies the overrun policy. Returns how many app_frame calls are due now (catch_up: all, up to 100 and this
 * one's; else 1). Where more than one is due, it is called again before each, with the periods that have begun meanwhile:
 * so the app knows the time also when its frames take longer than they may.
 *   catch_up  every missed frame runs now, with its own bus exchange; plant time keeps pace with the bus
 *   skip      the next frame advances plant time over the missed ones in one go, without their bus exchange
 *   freeze    plant time stands during the missed frames; it slips against the bus and the slip is counted
 *   stop      latched fault FAULT_OVERRUN, drives off, plant time stands
 * Where plant time stands anyway, or is stepped, there is nothing to make up: one call is due. Absences are
 * forgiven once: from the last good heartbeat on up to timeout_frames of them in all are not held against the controller, so
 * that a time-out comes after twice timeout_frames and one frame at the latest, whatever the plant misses. One of timeout_frames
 * is a time-out here and now, so that the commands that waited meanwhile are refused, those that name no instant too. */
MUST_CHECK uint32_t app_overrun(struct app *a, uint32_t missed);

#endif
