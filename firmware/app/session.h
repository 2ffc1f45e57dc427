/* session.h - ends a session or stops the plant: faults, the age of commands, drives to zero. Everything of
 * the app may call it; it calls nothing of the app. */
#ifndef FIRMWARE_SESSION_H
#define FIRMWARE_SESSION_H

#include <stdint.h>
#include "firmware/bus/wire.h"

struct app;

/* Latches a fault; those that make the plant's state untrustworthy stop it with drives off. */
void session_fault(struct app *a, enum fault_bit fault);

/* Every drive and sample goes to zero over ramp_s (at least one tick); the mailbox is emptied. */
void session_drives_to_zero(struct app *a, double ramp_s);

/* No command acts until an ENABLE from after this frame; the mailbox is emptied. */
void session_end(struct app *a);

/* A good heartbeat was received in this frame. */
void session_hear_heartbeat(struct app *a);

/* Bus frames since the last good heartbeat, including those that the plant has missed. */
uint64_t session_command_age(const struct app *a);

/* Frames still to be made up after this one. */
uint32_t session_behind(const struct app *a);

/* The session ends with FAULT_TIMEOUT and the reaction that is set. */
void session_time_out(struct app *a);

/* session_time_out where the last good heartbeat is too old. Frames that the plant has missed are forgiven once, up to
 * timeout_frames of them. */
void session_check_age(struct app *a);

#endif
