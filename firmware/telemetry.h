/* telemetry.h - from the plant to the bus: which message goes out in which frame. */
#ifndef FIRMWARE_TELEMETRY_H
#define FIRMWARE_TELEMETRY_H

#include <stdbool.h>
#include "firmware/wire.h"

struct app;

/* Everything due in this frame, in which plant time moved by so many plant frames. */
void telemetry_report(struct app *a, uint32_t advanced);

/* SELF_TEST goes out again, where there was one; every item of INFO goes out again, IDENTITY first. */
void telemetry_tell_selftest(struct app *a);
void telemetry_tell_info(struct app *a);

/* Sends a message now, or keeps it as the newest of its kind until there is room. */
void telemetry_send(struct app *a, const struct message *m);

/* What was kept goes first, in the order of arrival. */
void telemetry_send_kept(struct app *a);

/* True while a message of this kind is kept. */
bool telemetry_waits(const struct app *a, unsigned kind);

/* Answers a command. */
void telemetry_reply(struct app *a, const struct message *command, enum cause cause, unsigned index,
                     uint64_t ticks_late);

#endif
