/* latest.h - the latest of everything that a plant has said. Numbers are SI as on the bus. */
#ifndef HOST_SIM_LATEST_H
#define HOST_SIM_LATEST_H

#include <stdbool.h>
#include <stdint.h>
#include "firmware/bus/diag.h"
#include "firmware/bus/mailbox.h"
#include "firmware/bus/settings.h"
#include "firmware/bus/wire.h"
#include "firmware/plant/ledger.h"

enum {
    LATEST_PARAMETERS = STAGED_VALUES, /* wire indices of parameters and settings */
    LATEST_LEDGER = 16,
    LATEST_DRIVE_FIELDS = 8 /* fields of DRIVE_ECHO: amplitude, Hz, phase, .. in the order of the wire */
};

/* NaN until it was said. */
struct latest {
    struct message message[WIRE_KINDS]; /* the last message of each kind */
    uint64_t count[WIRE_KINDS];         /* messages of each kind */
    uint64_t frame, tick;               /* bus frame of SYNC and STATUS, plant tick of SYNC */
    uint64_t status_frame;              /* that of the newest STATUS */
    uint64_t contact_tick;              /* tick of the last CONTACT */
    enum plant_state state;
    uint8_t session; /* the one in force, or the last one */
    enum reaction reaction;
    unsigned faults;
    double displacement_m, velocity_m_per_s;
    double penetration_m, force_N;
    bool in_contact;
    double parameter[LATEST_PARAMETERS];             /* by wire index */
    double drive[MODEL_INPUTS][LATEST_DRIVE_FIELDS]; /* DRIVE_ECHO, by channel and field */
    double lockin_amplitude[LOCKIN_SLOTS], lockin_phase[LOCKIN_SLOTS];
    double ledger[LATEST_LEDGER];
    double health[DIAG_COUNTERS];
    double info[INFO_ITEMS];
    double contact_loss;           /* EVENT_SUMMARY: fraction of time */
    uint64_t touchdowns, liftoffs; /* events seen */
    uint64_t reply[CAUSES];        /* REPLY messages by cause, CAUSE_OK included */
};

/* Nothing was said yet. */
void latest_begin(struct latest *l);

/* A message of the plant, which has so many ticks a frame. */
void latest_take(struct latest *l, uint32_t substeps, const struct message *m);

#endif
