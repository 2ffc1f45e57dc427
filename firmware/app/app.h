/* app.h - the plant on a bus: struct app owns everything, app_frame() is the whole data path.
 *
 *   bus -> hal.recv -> wire_decode -> mailbox -> (drives, parameters) -> plant_advance
 *       -> telemetry -> wire_encode -> hal.send -> bus
 *
 * The caller runs app_frame once per frame period (a timer interrupt, a real-time loop or a test). A frame
 * that starts late is reported with app_overrun first. struct app has no pointer into itself: a copy of
 * it, with a copy of the caller's scratch, stage and capture memory, is a snapshot. */
#ifndef FIRMWARE_APP_H
#define FIRMWARE_APP_H

#include "firmware/observe/capture.h"
#include "firmware/bus/diag.h"
#include "firmware/observe/lockin_slots.h"
#include "firmware/bus/mailbox.h"
#include "firmware/plant/plant_beside.h"
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
    APP_STREAMING_CODES = 1 << MODEL_INPUTS, /* the bit of blocks of codes in `streaming` */
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
        *stage_calls;      /* &stages_for_plants for a plant that may have actuators and sensors */
    struct stages *stages; /* then memory for them; else both NULL */
    float *capture;        /* n_capture floats for the burst capture, or NULL */
    uint32_t n_capture;
    /* Memory of n floats in place of `capture`, whose floats it has, for a burst that does not fit. NULL:
     * there is none, and `capture` stays. No such function: what does not fit is out of range. */
    float *(*grow_capture)(void *owner, uint32_t n);
    void *capture_owner;
    const struct watch_limits *watch; /* the observable to watch at run time and its interval, or NULL */
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
    uint8_t session;    /* in force, or the last one */
    bool crowded;       /* the last frame took as many frames from the hal as it may */
    unsigned streaming; /* bit i: input i has had a sample in this session; then codes */
    uint64_t echo_from; /* the oldest bus frame that a command may echo: that after the last session's end */
    uint64_t heartbeat_frame; /* bus frame before which the last good ENABLE cannot have come */
    uint32_t absent;          /* frames that the plant has missed since then: the time-out forgives them */
    uint32_t away;            /* frames missed just before this one */
    uint32_t due;             /* app_frame calls due now, more than one by overrun policy `catch_up` */
    uint32_t jump;            /* bus frames missed just before this one: echoes may be older by as many */
    uint64_t step_left;       /* frames still to run while paused */
    struct receiver receiver[WIRE_COMMANDS]; /* one per command kind */
    struct latency latency;
    struct lockin_slots lockin;
    struct sensor sensor;
    struct capture capture;
    struct watch watch;
    struct timing timing;
    uint32_t skip; /* frames that the next one must make up for, by overrun policy `skip` */
    uint32_t count[DIAG_COUNTERS];
    double balance_residual_J; /* residual of the ledger when account_judge last looked */
    struct selftest_result selftest;
    struct telemetry telemetry;
};

/* Sets up *a: state OFF at bus frame 0, the model at rest, drives silent, no session. Returns NULL, or a
 * constant text that says why this configuration cannot run; then *a must not be used. It refuses:
 *   - frame_s outside 1e-6..10 s, substeps outside 1..4096, dilation outside 1e-6..1e9;
 *   - a base identifier that is no multiple of WIRE_BASE_ALIGN or too large for its 11 or 29 bits;
 *   - settings, parameters, watch limits, or a `promote` without a watch, that do not fit the model;
 *   - a step that the method cannot take at these parameters, and missing scratch memory.
 * It copies *c. The hal, model, method, scratch and capture memory must outlive *a; si, setting and watch
 * need not.
 *
 *     struct app_config c = {.model = &hertz_rig, .method = &rk4, .frame_s = 1e-3, .substeps = 8,
 *                            .dilation = 1.0, .base_id = 0x100};
 *     const char *why = app_init(&app, &c, &hal);
 *     while (!why) {
 *         wait_for_timer();
 *         app_frame(&app);
 *     } */
MUST_CHECK const char *app_init(struct app *a, const struct app_config *c, const struct hal *hal);

/* Call it once after app_init with the result of selftest_run. SELF_TEST goes out on the bus now and
 * whenever a session is opened. Where a check failed, FAULT_SELF_TEST is latched, the plant is in FAULT
 * and no session can be opened. Without this call the plant reports no self-test. */
void app_take_selftest(struct app *a, const struct selftest_result *r);

/* Call it after app_init on a board that restarted by itself. `kind` is the cause that ended the last run,
 * as hal/board/board.h numbers it; HEALTH reports it as last_run. FAULT_ASSERT is latched until a reset
 * command. */
void app_take_last_run(struct app *a, uint32_t kind);

/* Does one bus frame: receives commands, checks the age of the last heartbeat, advances plant time by one
 * frame (in RUNNING, or while PAUSED and stepping) and reports. It never fails: trouble is latched in
 * a->faults, counted and sent. It blocks only where the hal does. Its work is bounded: APP_RECV_BUDGET
 * received frames (in a flood it looks through APP_LOOK_AHEAD more), and `substeps` ticks for each plant
 * frame, of which policy `skip` may add some. */
void app_frame(struct app *a);

/* app_frame for n apps on one bus, 1 to SIDES. Each sends and computes what it would alone, to the last bit;
 * each has 1/n of the time as its own. All receive, then all advance, then all report. Plants of one model by
 * one method go side by side then, which costs less (plant_run_beside). */
void app_frames(struct app *const *a, uint32_t n, plant_bind_sides *bind);

/* Call it when `missed` whole frame periods went by before this frame could start. It counts them, sends
 * OVERRUN and applies the overrun policy. More than 65535 count as 65535. Returns how many app_frame calls
 * are due now: with catch_up all of them, at most 100 and this one's; else 1. Where more than one is due,
 * call it again before each, with the periods that have begun meanwhile (0: none). So the app knows the
 * time also when its frames take longer than a period.
 *   catch_up  every missed frame runs now, with its own bus exchange; plant time keeps pace with the bus
 *   skip      the next frame advances plant time over the missed ones in one go, without their bus exchange
 *   freeze    plant time stands during the missed frames; it slips against the bus and the slip is counted
 *   stop      latched fault FAULT_OVERRUN, drives off, plant time stands
 * Where plant time stands anyway, or is stepped, there is nothing to make up: one call is due.
 *
 * The time-out forgives frames that the plant itself missed: at most timeout_frames of them since the last
 * good heartbeat. So a time-out comes after twice timeout_frames and one frame at the latest, whatever the
 * plant misses. An absence of timeout_frames or more ends the session at once. Then every command that
 * waited meanwhile is refused, also one that names no instant. */
MUST_CHECK uint32_t app_overrun(struct app *a, uint32_t missed);

#endif
