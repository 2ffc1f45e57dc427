/* decoder.h - the messages of one plant as events of the scope, decoded by the tables of monitor and log.
 *
 * Events wait in lists, one for each kind, until decoder_send gives them to the server, or a list is full. */
#ifndef HOST_SIM_DECODER_H
#define HOST_SIM_DECODER_H

#include "host_sim/listen/decode_rows.h"
#include "host_sim/live/bus.h"
#include "host_sim/live/client.h"
#include "host_sim/live/explain.h"
#include "host_sim/scene/scene.h"
#include "host_sim/scope/server.h"

enum { DECODER_CONTRACT = 1, DECODER_NAME = 1024, DECODER_LIST = 1 << 16 };

enum event_list { LIST_ROWS, LIST_CONTACT, LIST_SUMMARY, LIST_LOCKIN, LIST_MESSAGES, LIST_BURST, LISTS };

/* The latest values that browsers were sent. */
struct decoder_sent {
    double health[DIAG_COUNTERS], ledger[LATEST_LEDGER], info[INFO_ITEMS], parameter[LATEST_PARAMETERS],
        drive[MODEL_INPUTS][LATEST_DRIVE_FIELDS];
    struct message status;
    double status_s; /* when; of the clock */
    enum client_identity identity;
    char why[EXPLAIN_REASON]; /* it is another plant; "" for none */
    double why_s;             /* when that was found, and its parts one by one; of the clock */
    double capture_tick, capture_pretrigger;
};

struct decoder {
    int number; /* the plant has it on the page */
    char name[DECODER_NAME], bus[BUS_REASON];
    bool has_commands; /* it also gets what controllers send */
    bool has_timing;
    struct server *server;
    struct scene_app scene;
    struct client client; /* without a bus; it never sends */
    struct decode rows;
    unsigned bursts; /* begun */
    double burst_at; /* sample and signal that came last, as one number */
    uint64_t withheld;
    double received_s; /* when anything came last; of the clock */
    struct decoder_sent sent;
    struct json list[LISTS];
    char text[LISTS][DECODER_LIST];
};

/* scene, name, bus and server are there; the rest begins. */
void decoder_begin(struct decoder *d);

/* True for a frame with an identifier of this plant. */
bool decoder_owns(const struct decoder *d, const struct frame *f);

/* Takes a frame that is its own. */
void decoder_take(struct decoder *d, const struct frame *f);

/* Gives the server what has come since the last time. */
void decoder_send(struct decoder *d);

#endif
