/* decode_log.h - a recorded log as rows and contact events. */
#ifndef HOST_SIM_DECODE_LOG_H
#define HOST_SIM_DECODE_LOG_H

#include "host_sim/listen/decode_rows.h"
#include "host_sim/replay/plant_log.h"

struct decode_log {
    struct plant_log log;
    struct decode rows; /* rows.events.take takes the events */
    bool ended;
    void (*hear)(void *context, const struct message *m); /* each, before the rows take it; NULL: none */
    void *context;
};

/* NULL, or the reason; see plant_log_open. */
const char *decode_log_open(struct decode_log *d, const char *path, const char *interface,
                            const struct wire_scene *scene, double tick_s);

/* 1 and the next row, 0 at the end, -1 for a file that cannot be read: d->log.reader.reason says why. */
int decode_log_next(struct decode_log *d, struct decode_row *row);

/* Lines on stderr for people: what was passed over, and how many frames are missing. */
void decode_log_tell(const struct decode_log *d, const char *command);

void decode_log_close(struct decode_log *d);

#endif
