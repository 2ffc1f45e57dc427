/* demo.h - the parts of the demonstration: the plant as a child process, the record, the controller, the report.
 *
 * Everything that is recorded, drawn or summed up was heard on the bus; SI unless a name says otherwise. */
#ifndef HOST_SIM_DEMO_H
#define HOST_SIM_DEMO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>
#include "host_sim/live/bus.h"
#include "host_sim/live/client.h"

enum {
    DEMO_REASON = 512,
    DEMO_PATH = 512,
    DEMO_ROWS = 4096,        /* one each DEMO_ROW_FRAMES: room for 40 s */
    DEMO_ROW_FRAMES = 10,    /* plant frames of one row, of the loss in it, and between heartbeats */
    DEMO_RECENT = 50,        /* frames behind the minimum that the controller sees, and behind an envelope */
    DEMO_BURST = 512,        /* samples of the capture */
    DEMO_BURST_BEFORE = 160, /* of these before the lift-off */
    DEMO_BURST_SIGNALS = 5,  /* outputs of the rig */
    DEMO_REACTION_RAMP_MS = 500
};

enum demo_phase { DEMO_REST, DEMO_DRIVE, DEMO_CONTROL, DEMO_FAST, DEMO_SILENT, DEMO_PHASES };

extern const char *const demo_phase_name[DEMO_PHASES];

/* One line of the CSV. Envelopes reach over the last DEMO_RECENT frames, the loss over DEMO_ROW_FRAMES. */
struct demo_row {
    double t_s; /* plant time at its end */
    enum demo_phase phase;
    double displacement_min, displacement_max;
    double penetration_min, penetration_max;
    double force_min, force_max;
    double command_N; /* the last sample sent; NaN while the controller is silent */
    double drive_N;   /* slow force amplitude, see demo_ramp */
    double base_m;    /* fast base amplitude */
    double loss;      /* share of time without contact, 0..1 */
    double age_frames;
    enum reaction reaction;
};

/* The last DEMO_RECENT values of one signal. */
struct demo_recent {
    double value[DEMO_RECENT];
    unsigned next;
};

/* An amplitude as the plant accepted it: a linear ramp in plant time. The plant's own reaction is one, too. */
struct demo_ramp {
    double from, to, begin_s, length_s;
};

struct demo_record {
    struct demo_row row[DEMO_ROWS];
    int n_rows;
    struct demo_recent displacement, penetration, force;
    double tick_s; /* NaN until the plant told its rate */
    enum demo_phase phase;
    double command_N;
    struct demo_ramp drive, base;
    double first_loss_s, first_loss_N; /* first lift-off and the slow amplitude then; NaN before */
    double burst[DEMO_BURST_SIGNALS][DEMO_BURST];
    int n_burst;              /* values read out so far */
    double reaction_begin_s;  /* plant time then */
    double reaction_end_s;    /* plant time at which every drive's ramp to zero had ended; NaN before */
    uint64_t reaction_frame;  /* bus frame of the first STATUS with a reaction, 0 before */
    uint64_t heartbeat_frame; /* frame named by the last heartbeat */
};

/* What the summary says, measured from the record. */
struct demo_result {
    double first_loss_s, first_loss_N;
    double loss_before, loss_controlled, loss_fast, loss_fast_end; /* 0..1 */
    double force_peak_N, force_held_N, force_fast_peak_N, force_fast_N;
    double penetration_held; /* m, minimum */
    double base_m;           /* fast base amplitude */
    double fast_begin_s;     /* first contact loss under the fast drive, plant time; NaN for none */
    double fast_lost_s;      /* from there to the last one */
    double reaction_frames;  /* from the last heartbeat to the reaction */
    double reaction_begin_s; /* plant time */
    double reaction_s;       /* from there until the drives are silent */
};

struct demo_rest {
    double penetration_m, force_N; /* static compression and preload, as heard before any drive */
};

/* ---- demo_child.c ---- */

struct demo_child {
    pid_t pid; /* 0 when there is none */
    int status;
};

/* Two UDP ports of the loopback interface that are free now. */
bool demo_free_ports(int port[2], char *why);

/* Starts `contactplant run` with these arguments (argv[0] included, NULL-terminated), its words into the file. */
bool demo_child_start(struct demo_child *c, char *const *argv, const char *words_path, char *why);

/* False when it has ended by itself; then status is known. */
bool demo_child_runs(struct demo_child *c);

/* Asks it to end and waits; true when it ended well. It is killed when it does not answer within some seconds. */
bool demo_child_end(struct demo_child *c, char *why);

/* ---- everything together ---- */

enum demo_end { DEMO_DONE, DEMO_FAILED, DEMO_INTERRUPTED, DEMO_BUSY }; /* busy: worth another try */

struct demo {
    struct client client;
    struct bus bus;
    struct demo_child child;
    struct demo_record record;
    struct demo_rest rest;
    char why[DEMO_REASON];  /* what failed and what to do */
    int answer[WIRE_KINDS]; /* cause of the last REPLY to each command since it was sent, -1 for none yet */
    uint64_t n_syncs;       /* SYNC messages handled */
    double heard_s, turn_s; /* host time of the last one, and of the last turn */
    double stall_s;         /* the longest time this process was kept from running */
    uint64_t plant_frame;   /* tick / substeps, now */
    double t_s;             /* plant time now */
    uint64_t streamed;      /* plant frame of the last sample sent */
    double integral_N;      /* of the controller */
    double stream_missed;   /* counter at the end of the controlled phases */
    struct demo_ramp fired; /* what the present fire asks for */
    int step;               /* of the script, within the phase */
    double step_s;          /* plant time at which it began */
    double fire_s;          /* plant time of the last fire sent */
    int n_fires;            /* tries of the present fire */
    double shown_s;         /* host time of the last status line */
    bool tty;
};

/* ---- demo_link.c ---- */

enum demo_turn { DEMO_IDLE, DEMO_FRAME, DEMO_ENDED };

/* Says in why what failed; false. */
bool demo_fail(struct demo *d, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Opens a session, sets what the demonstration needs and starts the plant. */
bool demo_begin(struct demo *d);

/* Hears what has arrived, keeps the session alive and shows the status; sleeps a little when there was nothing.
 * DEMO_ENDED: the plant is gone (why) or the user interrupts. */
enum demo_turn demo_turn(struct demo *d);

bool demo_is_running(const struct demo *d);

/* ---- demo_phases.c ---- */

/* The five phases, from a silent bus to the plant's time-out reaction. Any end but DEMO_DONE has its reason in why. */
enum demo_end demo_converse(struct demo *d);

/* ---- demo_record.c ---- */

void demo_record_init(struct demo_record *r);

/* One message, as client's `heard`; latest is the client's. */
void demo_record_hear(struct demo_record *r, const struct latest *latest, const struct message *m);

/* Smallest and largest of the recent values; NaN without any. */
void demo_recent_range(const struct demo_recent *recent, double *min, double *max);

/* The amplitude at a plant time. */
double demo_ramp_at(const struct demo_ramp *ramp, double t_s);

bool demo_burst_complete(const struct demo_record *r);

void demo_measure(const struct demo_record *r, struct demo_result *result);

/* ---- demo_report.c, demo_picture.c ---- */

bool demo_write_csv(const struct demo_record *r, const char *path, char *why);
bool demo_write_picture(const struct demo_record *r, const struct demo_rest *rest, const char *path,
                        char *why);
void demo_print_summary(const struct demo *d);

#endif
