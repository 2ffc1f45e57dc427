/* log_drives.h - the tones of a plant's inputs, as its log tells them, and from when on they hold.
 *
 * DRIVE_ECHO tells them one by one; a log without it has no tones. A FIRE, the end of a run, a parameter set,
 * or an echo that differs begins another part of the log. The phase of a tone is known where its begin is: at
 * a FIRE that found the input silent, or before any FIRE at tick 0, with the scene. */
#ifndef HOST_SIM_FIT_LOG_DRIVES_H
#define HOST_SIM_FIT_LOG_DRIVES_H

#include "firmware/bus/wire.h"
#include "models/model.h"

struct log_tone {
    double value[ARM_FIELDS];       /* bus units */
    unsigned told;                  /* bit f: value[f] is known */
    double ramp_s;                  /* armed for the next FIRE */
    double begin_tick;              /* where it began at its phase; NaN: not known */
    uint64_t told_tick[ARM_FIELDS]; /* the newest echo of the field */
};

struct log_drives {
    double tick_s; /* bus seconds */
    struct log_tone tone[MODEL_INPUTS];
    uint64_t acts_tick;    /* the last FIRE acts here */
    uint64_t settled_tick; /* from here on no ramp runs */
    uint64_t holds_tick;   /* the part that ended holds up to here */
    uint64_t status_tick;  /* the newest STATUS */
    int state, reaction;   /* as STATUS tells; -1: none came */
    bool begun;
    bool echoes; /* the log tells tones */
};

/* tick_s: bus seconds of a tick. */
void log_drives_begin(struct log_drives *d, double tick_s);

/* A message, while the newest SYNC is at `tick`. True: another part of the log begins. */
bool log_drives_take(struct log_drives *d, const struct message *m, uint64_t tick);

/* Amplitude and noise of this input are known. */
bool log_drives_knows(const struct log_drives *d, int input);

/* The phase of this input's tone at a tick, rad; NaN: not known. */
double log_drives_phase(const struct log_drives *d, int input, uint64_t tick);

#endif
