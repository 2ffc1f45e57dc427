/* session.h - ends a session or stops the plant: faults, the age of commands, drives to zero. Everything of
 * the app may call it; it calls nothing of the app. */
#ifndef FIRMWARE_SESSION_H
#define FIRMWARE_SESSION_H

#include <stdint.h>
#include "firmware/bus/wire.h"

struct app;

/* Latches a fault and pulls the capture's trigger for faults. FAULT_NOT_FINITE, FAULT_OVERRUN,
 * FAULT_ASSERT and FAULT_SELF_TEST also put the plant into STATE_FAULT with drives off; the others only
 * report. */
void session_fault(struct app *a, enum fault_bit fault);

/* Moves every drive and sample to zero over ramp_s >= 0 bus seconds (at least one tick) and empties the
 * mailbox. */
void session_drives_to_zero(struct app *a, double ramp_s);

/* Ends the session and empties the mailbox; drives go on. The next session needs an ENABLE that echoes a
 * later frame, so that no ENABLE from before can reopen it. */
void session_end(struct app *a);

/* Notes that a good heartbeat came in this frame. It is dated to the begin of an absence of the plant just
 * before. */
void session_hear_heartbeat(struct app *a);

/* Bus frames since the last good heartbeat, including those that the plant has missed. */
uint64_t session_command_age(const struct app *a);

/* Frames still to be made up after this one. */
uint32_t session_behind(const struct app *a);

/* Ends the session, latches FAULT_TIMEOUT, counts it and starts the reaction of the setting `reaction`:
 * hold, ramp to zero over reaction_ramp_s, zero now, or freeze plant time. */
void session_time_out(struct app *a);

/* Calls session_time_out when a session is open and the last good heartbeat is older than timeout_frames.
 * Frames that the plant itself has missed do not count, up to timeout_frames of them. */
void session_check_age(struct app *a);

#endif
