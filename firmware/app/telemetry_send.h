/* telemetry_send.h - messages on their way out, and those for which there was no room. */
#ifndef FIRMWARE_TELEMETRY_SEND_H
#define FIRMWARE_TELEMETRY_SEND_H

#include "firmware/app/telemetry.h"

/* Gives a message the next counter of its kind and sends it. Where the hal has no room, or older frames
 * still wait, it is kept; it replaces a kept frame of its kind, which is counted in tx_replaced. */
void telemetry_send(struct telemetry *t, const struct app *a, const struct message *m);

/* Sends kept frames in their order until the hal has no room; the rest stays kept. */
void telemetry_send_kept(struct telemetry *t, const struct app *a);

/* Drops all kept frames and counts them as replaced. */
void telemetry_drop_kept(struct telemetry *t);

/* True while a message of this kind is kept for want of room. */
bool telemetry_waits(const struct telemetry *t, const struct app *a, unsigned kind);

/* Answers a command with REPLY: its cause, and `index` and `ticks_late` as struct remark has them. 65535
 * ticks and more are sent as not available. */
void telemetry_reply(struct telemetry *t, const struct app *a, const struct message *command,
                     enum cause cause, unsigned index, uint64_t ticks_late);

#endif
