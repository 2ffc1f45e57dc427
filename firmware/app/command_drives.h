/* command_drives.h - the commands that move the inputs: ARM, FIRE, STREAM and DAC. */
#ifndef FIRMWARE_COMMAND_DRIVES_H
#define FIRMWARE_COMMAND_DRIVES_H

#include <stdint.h>
#include "firmware/bus/wire.h"

struct app;

/* Contents of a REPLY beside the cause. */
struct remark {
    unsigned index;      /* the field, operation, parameter or channel that the command names */
    uint64_t ticks_late; /* ticks by which the named instant has passed; UINT64_MAX: does not apply */
};

/* Each takes its command or refuses it with a cause and changes nothing; *r is filled for the REPLY.
 *   ARM     keeps one field of one input until a FIRE takes it: docs/reference/messages.md has the ranges
 *   FIRE    puts the armed drives, and the committed set if it asks for it, into the mailbox for its instant
 *   STREAM  puts one sample into the mailbox for its plant frame, at most 64 and horizon_frames frames ahead
 *   DAC     puts the codes of one tick of the coming frame into the block. The plant must have converters and
 *           at most MAILBOX_CODES ticks in a frame; the last block must have found room on the bus
 * All but ARM need a plant that is RUNNING or PAUSED. */
enum cause drives_arm(struct app *a, const struct message *m, struct remark *r);
enum cause drives_fire(struct app *a, const struct message *m, struct remark *r);
enum cause drives_stream(struct app *a, const struct message *m, struct remark *r);
enum cause drives_codes(struct app *a, const struct message *m, struct remark *r);

#endif
