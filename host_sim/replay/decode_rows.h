/* decode_rows.h - a recorded log as rows in SI, one for each SYNC, and its contact events. */
#ifndef HOST_SIM_DECODE_ROWS_H
#define HOST_SIM_DECODE_ROWS_H

#include <stdbool.h>
#include <stdint.h>
#include "firmware/bus/wire.h"
#include "hal/posix/log.h"
#include "host_sim/replay/log_tally.h"

enum {
    DECODE_OUTPUTS = 4, /* MOTION and CONTACT carry the first four of every model */
    DECODE_SIGNALS = DECODE_OUTPUTS + MODEL_INPUTS
};

struct decode_row {
    uint64_t frame, tick;         /* bus frame, low 16 bits extended; plant tick */
    double t_s;                   /* plant time */
    int state;                    /* as of the last STATUS */
    unsigned closed;              /* bit i: contact i is closed */
    bool contact_known;           /* `closed` was said */
    unsigned beyond;              /* bit i: output i was said to be not available */
    double value[DECODE_SIGNALS]; /* outputs, then the newest sample streamed to each input; NaN: not said */
};

struct decode_event {
    double t_s;
    bool touch;
    unsigned contact;
    double speed, peak_force_N; /* NaN: beyond the bus's range */
};

struct decode {
    struct log_reader reader;
    struct wire_scene scene;
    double tick_s;
    struct decode_row row; /* being read */
    bool begun, ended;
    double identity;      /* as INFO told it last; NaN: untold */
    uint64_t lines, ours; /* read; of these, the scene's own */
    struct log_tally tally;
    struct decode_event event;
    void (*heard)(void *context, const struct decode_event *e); /* NULL for none */
    void *context;
};

/* NULL, or the reason. `path` must stay valid. */
const char *decode_open(struct decode *d, const char *path, const struct wire_scene *scene, double tick_s);

/* A decoder without a log, for messages as they are heard. */
void decode_begin(struct decode *d, const struct wire_scene *scene, double tick_s);

/* Takes a message. True, with the row, where one is complete: with the SYNC that begins the next one. */
bool decode_take(struct decode *d, const struct message *m, struct decode_row *row);

/* 1 and the next row, 0 at the end, -1 for a bad line: d->reader.reason says which. */
int decode_next(struct decode *d, struct decode_row *row);

void decode_close(struct decode *d);

#endif
