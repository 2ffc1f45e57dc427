/* decode_rows.h - messages of a plant as rows in SI, one for each SYNC, and as contact events.
 *
 * A row has what was said of its own tick. MOTION and CONTACT belong to the SYNC before them. Where COUNTERs
 * tell that frames are missing between, so that they may be a later tick's, the row is without them.
 * STREAM_ECHO names its frame. */
#ifndef HOST_SIM_DECODE_ROWS_H
#define HOST_SIM_DECODE_ROWS_H

#include <stdbool.h>
#include <stdint.h>
#include "firmware/bus/wire.h"
#include "host_sim/listen/listen.h"
#include "host_sim/listen/log_tally.h"

enum {
    DECODE_OUTPUTS = 4, /* MOTION and CONTACT carry the first four of every model */
    DECODE_PAIRS = 2,   /* which are these two */
    DECODE_SIGNALS = DECODE_OUTPUTS + MODEL_INPUTS
};

struct decode_row {
    uint64_t frame, tick;    /* bus frame, low 16 bits extended; plant tick */
    unsigned run;            /* how often plant time began anew before it */
    double t_s;              /* plant time */
    int state;               /* as of the last STATUS; -1: none came yet */
    unsigned closed;         /* bit i: contact i is closed */
    bool contact_known;      /* `closed` was said */
    bool said[DECODE_PAIRS]; /* MOTION and CONTACT came for this tick */
    bool due;                /* one of them was due by its pace, and did not come */
    unsigned beyond;         /* bit i: output i was said to be not available */
    unsigned echoed;         /* bit i: samples of input i are those that the plant echoes */
    /* Outputs, then the newest sample streamed to each input, or where no STREAM is heard, the plant's echo
     * of the one that acted in the frame before the row. NaN: not said. */
    double value[DECODE_SIGNALS];
};

/* The last message of a kind: the next one tells whether some are missing between. */
struct decode_counter {
    bool heard;
    uint8_t counter;      /* its COUNTER */
    uint64_t frame, tick; /* those of its SYNC */
    uint64_t missing;     /* messages of this kind, so far */
    double every; /* bus or plant frames from one to the next; 0: not known; -1: nor by the next one */
};

/* MOTION or CONTACT since the last SYNC. */
struct decode_pair {
    unsigned came;   /* with those that are missing between them */
    unsigned closed; /* as the first one says */
};

struct decode {
    struct wire_scene scene;
    double tick_s;
    struct decode_row row; /* being read */
    unsigned streamed;     /* bit i: STREAM to input i was heard */
    bool begun;            /* a SYNC came */
    struct decode_counter counter[WIRE_KINDS];
    struct decode_pair pair[DECODE_PAIRS];
    uint64_t missing; /* frames of the plant, so far */
    struct log_tally tally;
    struct listen_events events; /* the caller says who takes them */
};

void decode_begin(struct decode *d, const struct wire_scene *scene, double tick_s);

/* Takes a message. True, with the row, where one is complete: with the SYNC that begins the next one. */
bool decode_take(struct decode *d, const struct message *m, struct decode_row *row);

/* Nothing more comes: gives the last event, and the row that no SYNC ends. */
void decode_end(struct decode *d, struct decode_row *row);

/* A line on stderr where frames are missing of what was heard at `where`. */
void decode_tell_missing(const struct decode *d, const char *command, const char *where);

#endif
