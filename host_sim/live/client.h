/* client.h - the controller's side of the bus, on the public headers only (wire.h, hal.h, mailbox.h).
 *
 * Numbers are SI as on the bus. Ticks and frames, of which a message carries the low bits only, are extended
 * to 64 bits from the last ones seen. Only the functions with `seconds` wait: by the client's waiter, which
 * is the host's clock (client_host.h) or the caller's own.
 *
 * LOCKSTEP, where the link offers it: commands go out together when the client waits, as one word, which may
 * be empty. The wait goes on when the plant's bus frame was heard whole. All seconds are then bus frames, and
 * a wait makes one bus frame at least where a command has not gone out yet. */
#ifndef HOST_SIM_CLIENT_H
#define HOST_SIM_CLIENT_H

#include <stdbool.h>
#include <stdint.h>
#include "hal/hal.h"
#include "host_sim/listen/latest.h"

enum client_answer { CLIENT_ANSWERED, CLIENT_UNANSWERED, CLIENT_REFUSED };

/* How a client waits on the transport below its hal. */
struct client_link {
    void *context;
    /* Waits until something may have come, `seconds` at most, less when a signal comes. */
    void (*wait)(void *context, double seconds);
    /* In lockstep: whether the plant has answered the words that were flushed; CLIENT_REFUSED: it has ended.
     * NULL: not in lockstep. */
    enum client_answer (*answer)(void *context);
    double patience_s; /* in lockstep: how long, by the clock, a silent plant is waited for; 0: for ever */
};

/* The clock of a client, and its rest where there is no link. */
struct client_waiter {
    void *context;
    double (*now_s)(void *context);
    bool (*is_interrupted)(void *context);       /* the user wants an end */
    void (*rest)(void *context, double seconds); /* until something may have come, at most that long */
};

/* The first REPLY to a command that client_expect announced. */
struct client_reply {
    unsigned kind, first_counter;
    bool came;
    enum cause cause;
};

struct client {
    const struct hal *hal;
    const struct client_waiter *waiter;
    const struct client_link *link; /* NULL: waits rest by the waiter */
    struct wire_scene scene;
    uint8_t session;
    uint8_t counter[WIRE_COMMANDS]; /* COUNTER of the next command of each kind */
    uint64_t turns;                 /* in lockstep: bus frames that were answered */
    bool unsaid;                    /* in lockstep: a command has not gone out yet */
    bool silent;                    /* in lockstep: the plant did not answer the last word, or has ended */
    struct latest latest;
    struct client_reply reply;
    uint64_t bad;        /* frames with our identifiers that did not decode */
    uint64_t unsent;     /* commands that the hal had no room for */
    uint64_t bus_faults; /* hal_fault reports from recv */
    void (*heard)(void *context, const struct frame *f,
                  const struct message *m); /* each message; NULL for none */
    void *heard_context;
};

/* The plant's identity (firmware/bus/identity.h) beside the one that this client assumes: not heard yet,
 * equal, or another. */
enum client_identity { CLIENT_UNTOLD, CLIENT_SAME, CLIENT_OTHER };

/* A new client without a session, with a waiter of the caller's. */
void client_begin(struct client *c, const struct hal *hal, const struct wire_scene *scene,
                  const struct client_waiter *waiter);

/* True while the plant is in a session, this client's or another one's. */
bool client_in_session(const struct client *c);

enum client_identity client_identity(const struct client *c);

/* Waits until the plant has told its identity; where it is
 * another one, also for the parts of it. True when it is ours. */
bool client_wait_identity(struct client *c, double seconds);

/* Waits for the plant and opens a session of our own; or, with `join`, also takes part in one that is
 * open. False after `seconds`, when the user interrupts, when somebody else has the session, or when the
 * plant's identity is another one or stays unknown. Then no command was sent, or the session that was
 * opened is closed again. */
bool client_open(struct client *c, bool join, double seconds);

/* Closes the session, again where the frame was lost: a plant that is left open latches a time-out. Nothing
 * to do where it has ended, by CONTROL stop or a time-out. False when the plant does not confirm it within
 * `seconds`, or when the user interrupts. */
bool client_close(struct client *c, double seconds);

/* Takes everything that has arrived; returns the number of messages. */
int client_poll(struct client *c);

/* Takes a frame that came in another way. */
void client_take(struct client *c, const struct frame *f);

/* The commands below go out at once; in lockstep with the next wait. Integers that are longer than their
 * field are cut to its bits. False when the bus had no room. */

/* Heartbeat: ENABLE (or its withdrawal) that echoes the
 * last frame seen. Call it well within timeout_frames. */
bool client_enable(struct client *c, bool on);

/* The argument of START, PAUSE and RESET is the last frame seen; of STEP a number of frames; of RUN_UNTIL a
 * tick. STOP ends the session: client_open before the next command. */
bool client_control(struct client *c, enum control_operation operation, uint64_t argument);

/* Stages one drive: SI, Hz on the bus, rad, s. NaN leaves that field as it is. */
bool client_arm(struct client *c, int channel, double amplitude, double frequency_Hz, double phase_rad,
                double ramp_s);

/* Arms all fields that ARM knows: [ARM_FIELDS], SI. */
bool client_arm_fields(struct client *c, int channel, const double *field);

/* Applies what is armed on these channels (bit mask) at tick + fraction. */
bool client_fire(struct client *c, unsigned channels, bool parameters, uint64_t tick, double fraction);

/* One sample of a sampled command, applied at the start of that plant frame (tick / substeps: it stands while
 * the plant is paused). */
bool client_stream(struct client *c, int channel, uint64_t frame, double value);

/* Writes n parameters (wire indices) and commits them as one set. */
bool client_set(struct client *c, int n, const unsigned *index, const double *value, enum commit_when when);

/* From here on the first REPLY counts to a command of this kind that is sent from here on, up to 14 of them.
 * An answer to an earlier command may still be on its way, and an earlier try be the one that was taken. */
void client_expect(struct client *c, unsigned kind);

bool client_read(struct client *c, unsigned index);
bool client_capture(struct client *c, enum capture_operation operation, uint32_t first, uint32_t count);

/* Polls until the condition holds, `seconds` have passed, or the user interrupts while it waits (a wait that
 * begins after that is part of the orderly end and goes on). True when the condition holds. In lockstep it
 * ends, too, when the plant stays silent. */
bool client_wait(struct client *c, bool (*condition)(const struct client *c, const void *argument),
                 const void *argument, double seconds);

/* Waits for STATUS and SYNC, for a state, for plant time, for the CONTACT of that tick. */
bool client_wait_alive(struct client *c, double seconds);
bool client_wait_state(struct client *c, enum plant_state state, double seconds);
bool client_wait_tick(struct client *c, uint64_t tick, double seconds);
bool client_wait_contact(struct client *c, uint64_t tick, double seconds);

/* Waits for the REPLY that is expected; true when it came. */
bool client_wait_reply(struct client *c, double seconds);

#endif
