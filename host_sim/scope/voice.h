/* voice.h - the messages of one plant as events of the scope, decoded by the tables of monitor and log.
 *
 * Messages collect in lanes, one for each kind of event, until voice_tell gives them to the server, or a lane
 * is full. */
#ifndef HOST_SIM_VOICE_H
#define HOST_SIM_VOICE_H

#include "host_sim/live/bus.h"
#include "host_sim/live/client.h"
#include "host_sim/live/explain.h"
#include "host_sim/scene/scene.h"
#include "host_sim/scope/server.h"

enum { VOICE_CONTRACT = 1, VOICE_NAME = 1024, VOICE_LANE = 1 << 16, VOICE_OUTPUTS = 4 };

enum lane { LANE_ROWS, LANE_CONTACT, LANE_SUMMARY, LANE_LOCKIN, LANE_SAID, LANE_BURST, LANES };

/* One SYNC and what came with it. */
struct voice_row {
    uint64_t frame, tick;
    bool begun, moved; /* a SYNC was heard; and outputs */
    unsigned closed;
    double output[VOICE_OUTPUTS], sample[MODEL_INPUTS];
};

/* The latest values that were told. */
struct voice_told {
    double health[DIAG_COUNTERS], ledger[CLIENT_LEDGER], info[INFO_ITEMS], parameter[CLIENT_PARAMETERS],
        drive[MODEL_INPUTS][CLIENT_DRIVE_FIELDS];
    struct message status;
    double status_s; /* when; of the clock */
    enum client_identity identity;
    char why[EXPLAIN_REASON]; /* it is another plant; "" for none */
    double why_s;             /* when that was found, and its parts told one by one; of the clock */
    unsigned bursts;
    double capture_tick, capture_pretrigger;
};

struct voice {
    int number; /* the plant has it on the page */
    char name[VOICE_NAME], bus[BUS_REASON];
    bool hears_commands;
    bool has_timing;
    struct server *server;
    struct scene_app scene;
    struct client client; /* on the hal below; it never sends */
    struct hal hal;       /* gives the one frame that waits */
    struct frame frame;
    bool waits;
    struct voice_row row;
    struct message touched; /* EVENT_TIME whose EVENT_DATA has not come yet */
    bool touch_waits;
    unsigned bursts; /* begun */
    double burst_at; /* sample and signal heard last, as one number */
    uint64_t withheld;
    double heard_s; /* when anything was heard last; of the clock */
    struct voice_told told;
    struct json lane[LANES];
    char text[LANES][VOICE_LANE];
};

/* scene, name, bus and server are there; the rest begins. */
void voice_begin(struct voice *v);

/* True for a frame with an identifier of this plant. */
bool voice_owns(const struct voice *v, const struct frame *f);

/* Hears a frame that is its own. */
void voice_hear(struct voice *v, const struct frame *f);

/* Tells the server what has been heard since the last time. */
void voice_tell(struct voice *v);

/* ---- voice_tell.c: the parts of that which are not lists ---- */

/* Takes note of what is known of the plant's identity now; true for news. */
bool voice_note_identity(struct voice *v);

/* The plant's tables: one element of hello. */
void voice_put_hello(const struct voice *v, struct json *j);

/* The event status. */
void voice_put_status(const struct voice *v, struct json *j);

/* The event values: all that is known, or what differs from `told`, which then is told. */
void voice_put_values(const struct voice *v, struct json *j, struct voice_told *told);

/* Stands in an event between the plant's number and its list. */
void voice_put_head(const struct voice *v, enum lane lane, struct json *j);

double voice_time(const struct voice *v);

/* A parameter or setting as it is now. */
double voice_parameter(const struct voice *v, int index);

#endif
