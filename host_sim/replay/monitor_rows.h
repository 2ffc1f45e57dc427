/* monitor_rows.h - telemetry as a row a frame: a table, or JSON for a plotting program. */
#ifndef HOST_SIM_MONITOR_ROWS_H
#define HOST_SIM_MONITOR_ROWS_H

#include "host_sim/cli/options.h"
#include "host_sim/out/json.h"
#include "host_sim/listen/decode_rows.h"
#include "host_sim/scene/scene_app.h"

/* --wide, --json and --batch. */
extern const struct option monitor_rows_options[];

enum { MONITOR_PACKET = 16384 };

struct monitor_rows {
    const struct options *o;
    const struct model *model;
    bool wide, json;
    int socket;     /* -1: standard output */
    uint64_t batch; /* rows of a packet */
    struct decode rows;
    char packet[MONITOR_PACKET];
    struct json text; /* in packet */
    uint64_t n_rows;  /* in the packet */
    uint64_t printed; /* rows, so far */
};

/* 0, or the exit status after a line on stderr. */
int monitor_rows_open(struct monitor_rows *k, const struct options *o, const struct scene_app *s);

/* Takes a message; false when rows are not asked for. */
bool monitor_rows_take(struct monitor_rows *k, const struct message *m);

/* Sends what is left. */
void monitor_rows_close(struct monitor_rows *k);

#endif
