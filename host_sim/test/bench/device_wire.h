/* device_wire.h - a run's measurements from the messages of its plant. */
#ifndef HOST_SIM_DEVICE_WIRE_H
#define HOST_SIM_DEVICE_WIRE_H

#include "host_sim/live/client.h"
#include "host_sim/listen/decode_rows.h"
#include "host_sim/test/bench/bench_plant.h"

/* All zero before device_wire_begin. */
struct device_wire {
    struct bench_plant *plant; /* the case's plant as the file has it: its measurements and names */
    struct decode rows;
    bool measures;     /* from the controller's start to the end of the case */
    uint64_t zero;     /* tick where the case begins */
    double now_s;      /* plant time of the case */
    bool echoes;       /* commands are those that the plant echoes */
    uint64_t row_tick; /* tick of the last row */
    double stopped_s;
    bool was_in_session;
    unsigned faults;
    uint32_t before[DIAG_COUNTERS]; /* counters of HEALTH, before the case */
    uint64_t until;                 /* the bus frame until which they are waited for */
    double not_sent;                /* contact switches that did not come */
    char not_heard[BENCH_TEXT];
};

/* Takes each message that the client hears; `context` is the struct device_wire. */
void device_wire_take(void *context, const struct frame *f, const struct message *m);

/* Names what no bus can tell. */
void device_wire_begin(struct device_wire *w, const struct test_case *c);

/* Nobody tells the controller's samples: this bus does not carry them, and the plant does not echo them. */
void device_wire_deafen(struct device_wire *w);

/* Every counter that metrics are about was told since the tally's `known` was cleared. */
bool device_wire_has_counters(const struct device_wire *w);

/* Outcomes and verdict into *r. `known`: the counters were told before and after the case. */
void device_wire_judge(struct device_wire *w, const struct test_case *c, bool known, struct bench_result *r);

#endif
