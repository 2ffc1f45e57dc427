/* command_drives.h - the commands that move the inputs: ARM, FIRE and STREAM. */
#ifndef FIRMWARE_COMMAND_DRIVES_H
#define FIRMWARE_COMMAND_DRIVES_H

#include <stdint.h>
#include "firmware/bus/wire.h"

struct app;

/* For the REPLY, beside the cause. */
struct remark {
    unsigned index;
    uint64_t ticks_late;
};

enum cause drives_arm(struct app *a, const struct message *m, struct remark *r);
enum cause drives_fire(struct app *a, const struct message *m, struct remark *r);
enum cause drives_stream(struct app *a, const struct message *m, struct remark *r);

#endif
