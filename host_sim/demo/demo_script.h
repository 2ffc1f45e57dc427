/* demo_script.h - the controller of the demonstration: a list of steps over the client, and its loop. */
#ifndef HOST_SIM_DEMO_SCRIPT_H
#define HOST_SIM_DEMO_SCRIPT_H

#include <stdio.h>
#include "host_sim/demo/demo_record.h"
#include "host_sim/live/bus.h"
#include "host_sim/live/client.h"
#include "host_sim/test/bench/child.h"

enum demo_end { DEMO_DONE, DEMO_FAILED, DEMO_INTERRUPTED, DEMO_BUSY }; /* busy: worth another try */

struct demo {
    struct client client;
    struct bus bus;
    struct child child; /* the plant */
    FILE *words;        /* plant.txt: what it prints */
    struct demo_record record;
    enum demo_end end;
    char why[DEMO_REASON];  /* the failure and its remedy */
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

#endif
