/* demo.h - the parts of the demonstration: the script, the record, the report.
 *
 * Everything that is recorded, drawn or summed up was heard on the bus; SI unless a name says otherwise. */
#ifndef HOST_SIM_DEMO_H
#define HOST_SIM_DEMO_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include "host_sim/live/bus.h"
#include "host_sim/live/client.h"
#include "host_sim/trial/bench/child.h"

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

/* ---- demo_record.c ---- */

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
    double rest_m, rest_N;             /* static compression and preload, as heard before any drive */
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
void demo_record_hear(struct demo_record *r, const struct latest *latest, const struct message *m);

/* Smallest and largest of the recent values; NaN without any. */
void demo_recent_range(const struct demo_recent *recent, double *min, double *max);

/* The amplitude at a plant time. */
double demo_ramp_at(const struct demo_ramp *ramp, double t_s);

bool demo_burst_complete(const struct demo_record *r);

/* False: why says what went wrong. */
bool demo_write_csv(const struct demo_record *r, const char *path, char *why);

/* ---- demo_script.c ---- */

enum demo_end { DEMO_DONE, DEMO_FAILED, DEMO_INTERRUPTED, DEMO_BUSY }; /* busy: worth another try */

struct demo {
    struct client client;
    struct bus bus;
    struct child child; /* the plant */
    FILE *words;        /* plant.txt: what it prints */
    struct demo_record record;
    enum demo_end end;
    char why[DEMO_REASON];  /* the failure and its remedy */
    int answer[WIRE_KINDS]; /* cause of the last REPLY to each command since it was sent, -1 for none yet */
    uint64_t n_syncs;       /* SYNC messages handled */
    double heard_s, turn_s; /* host time of the last one, and of the last turn */
    double stall_s;         /* the longest time this process was kept from running */
    double t_s;             /* plant time now */
    double until_s;         /* plant time at which the present step ends */
    uint64_t plant_frame;   /* tick / substeps, now */
    uint64_t streamed;      /* plant frame of the last sample sent */
    double integral_N;      /* the controller's integral */
    double stream_missed;   /* counter at the end of the controlled phases */
    double shown_s;         /* host time of the last status line */
    bool tty, started;
};

/* The conversation, from a silent bus to the plant's time-out reaction: its end, and the reason of any but
 * DEMO_DONE in why. */
void demo_converse(struct demo *d);

/* ---- demo_picture.c, demo_report.c ---- */

bool demo_write_picture(const struct demo_record *r, const char *path, char *why);
void demo_print_summary(const struct demo *d);
/* The summary as text. */
void demo_sum_up(const struct demo *d, char *text, size_t size);

/* ---- demo_html.c ---- */

/* The report --report. NULL, or what went wrong. */
const char *demo_write_html(const struct demo *d, const char *path, int argc, char **argv);

#endif
