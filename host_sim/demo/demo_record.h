/* demo_record.h - the demonstration as rows of ten frames. All of it came on the bus; SI unless a name says
 * otherwise. */
#ifndef HOST_SIM_DEMO_RECORD_H
#define HOST_SIM_DEMO_RECORD_H

#include <stdbool.h>
#include <stdint.h>
#include "host_sim/listen/latest.h"
#include "host_sim/listen/listen.h"

enum {
    DEMO_REASON = 512,
    DEMO_PATH = 512,
    DEMO_ROWS = 4096,        /* one each DEMO_ROW_FRAMES: room for 40 s */
    DEMO_ROW_FRAMES = 10,    /* plant frames of one row, of the loss in it, and between heartbeats */
    DEMO_RECENT = 50,        /* frames behind the minimum that the controller sees, and behind an envelope */
    DEMO_BURST = 512,        /* samples of the capture */
    DEMO_BURST_BEFORE = 160, /* samples before the lift-off */
    DEMO_BURST_SIGNALS = 5,  /* outputs of the rig */
    DEMO_REACTION_RAMP_MS = 500
};

enum demo_phase { DEMO_REST, DEMO_DRIVE, DEMO_CONTROL, DEMO_FAST, DEMO_SILENT, DEMO_PHASES };
extern const char *const demo_phase_name[DEMO_PHASES];

/* Columns of the CSV. Envelopes reach over the last DEMO_RECENT frames, the loss over DEMO_ROW_FRAMES. */
enum demo_column {
    DEMO_TIME, /* plant time at the end of the row */
    DEMO_PHASE,
    DEMO_DISPLACEMENT, /* minimum, then maximum; so the next two */
    DEMO_PENETRATION = DEMO_DISPLACEMENT + 2,
    DEMO_FORCE = DEMO_PENETRATION + 2,
    DEMO_COMMAND = DEMO_FORCE + 2, /* the last sample sent; NaN while the controller is silent */
    DEMO_SLOW_N,                   /* amplitude of the slow force drive */
    DEMO_BASE_M,                   /* amplitude of the fast base drive */
    DEMO_LOSS,                     /* share of time without contact, 0..1 */
    DEMO_AGE,
    DEMO_REACTION,
    DEMO_COLUMNS
};

/* An amplitude as the plant accepted it: a linear ramp in plant time. The plant's own reaction is one,
 * too. */
struct demo_ramp {
    double from, to, begin_s, length_s;
};

/* The last DEMO_RECENT values of one signal. */
struct demo_recent {
    double value[DEMO_RECENT];
    unsigned next;
};

struct demo_record {
    double column[DEMO_COLUMNS][DEMO_ROWS];
    int n_rows;
    struct demo_recent displacement, penetration, force;
    double tick_s; /* NaN until the plant told its rate */
    enum demo_phase phase;
    double command_N;
    struct demo_ramp slow, base;
    double rest_m, rest_N; /* static compression and preload, as heard before any drive */
    struct listen_events events;
    double first_loss_s, first_loss_N; /* first lift-off and the slow amplitude then; NaN before */
    double burst[DEMO_BURST_SIGNALS][DEMO_BURST];
    int n_burst;              /* values read out so far */
    double reaction_begin_s;  /* plant time then; NaN before */
    double reaction_end_s;    /* plant time at which every drive's ramp to zero had ended; NaN before */
    uint64_t reaction_frame;  /* bus frame of the first STATUS with a reaction, 0 before */
    uint64_t heartbeat_frame; /* frame named by the last heartbeat */
};

void demo_record_init(struct demo_record *r);

/* One message, as client's `heard`; latest is the client's. */
void demo_record_take(struct demo_record *r, const struct latest *latest, const struct message *m);

/* Smallest and largest of the recent values; NaN without any. */
void demo_recent_range(const struct demo_recent *recent, double *min, double *max);

/* The amplitude at a plant time. */
double demo_ramp_at(const struct demo_ramp *ramp, double t_s);

bool demo_burst_complete(const struct demo_record *r);

/* False: why says what went wrong. */
bool demo_write_csv(const struct demo_record *r, const char *path, char *why);

#endif
