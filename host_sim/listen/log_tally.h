/* log_tally.h - counters, faults and events that were not sent, as a log tells them of the whole run. */
#ifndef HOST_SIM_LOG_TALLY_H
#define HOST_SIM_LOG_TALLY_H

#include "firmware/bus/diag.h"
#include "firmware/bus/wire.h"

struct log_tally {
    uint32_t count[DIAG_COUNTERS]; /* the newest of HEALTH, or what was heard besides where that is more */
    bool known[DIAG_COUNTERS];     /* by HEALTH */
    uint32_t overruns, missed, refused[CAUSES]; /* that OVERRUN and REPLY told */
    unsigned faults;                            /* ever set in STATUS */
    bool sensor_faults;                         /* one was in force at some time */
    double not_sent;                            /* contact events, by EVENT_SUMMARY */
};

/* Takes a message of the plant. */
void log_tally_take(struct log_tally *t, const struct message *m);

/* HEALTH has told every counter. */
bool log_tally_is_complete(const struct log_tally *t);

#endif
