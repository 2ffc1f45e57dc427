/* mailbox.h - checked commands waiting for their plant tick: fired drive settings, streamed samples,
 * parameter sets.
 *
 * Nothing in here is applied late: an entry whose instant has passed when it is put in is refused, and
 * stop, freeze, reset and time-out empty everything. */
#ifndef FIRMWARE_MAILBOX_H
#define FIRMWARE_MAILBOX_H

#include "firmware/plant/plant.h"
#include "firmware/bus/settings.h"
#include "firmware/bus/wire.h"

enum {
    MAILBOX_FIRES = 4,    /* fires waiting for their tick */
    MAILBOX_SAMPLES = 32, /* streamed samples waiting for their frame, all channels together */
    MAILBOX_CODES = 32    /* samples of converters in a frame: so many bits has `given` */
};

/* One channel's drive command in SI as armed: which fields were given, and their values. */
struct armed {
    uint8_t given; /* bit per enum arm_field */
    double value[ARM_FIELDS];
};

struct fire {
    struct instant at;
    uint8_t channels; /* bit mask */
    bool parameters;  /* the committed set goes with it */
    uint8_t counter;  /* counter of the FIRE, for the latency echo */
    uint64_t received_tick;
    struct armed armed[MODEL_INPUTS];
};

struct sample {
    uint64_t frame; /* plant frame at whose start it applies */
    uint64_t received_tick;
    float value; /* as on the wire */
    uint8_t channel;
    uint8_t counter;
};

/* Codes of converters, one pair for each tick of a frame: those of the DACs until their tick has passed, then
 * those of the ADCs. */
struct code_block {
    uint32_t given; /* bit i: the DACs have codes for tick i of the coming frame */
    int16_t code[MAILBOX_CODES][2];
};

enum {
    STAGED_VALUES = SETTING_FIRST + SETTINGS, /* wire indices */
    STAGED_WORDS = (STAGED_VALUES + 31) / 32
};

/* Parameters and settings being collected, by wire index. */
struct staged {
    uint32_t given[STAGED_WORDS]; /* bit per index */
    double value[STAGED_VALUES];
};

struct mailbox {
    struct armed armed[MODEL_INPUTS];
    struct fire fire[MAILBOX_FIRES]; /* the next one to take stands last */
    uint32_t n_fires;
    struct sample sample[MAILBOX_SAMPLES];
    uint32_t n_samples;
    struct code_block block;
    struct staged staged;    /* written, not committed */
    struct staged committed; /* waiting for the next frame or a fire */
    bool commit_with_fire;   /* committed waits for a FIRE that asks for it */
};

/* Forgets everything that waits, also values that were armed or staged. An all-zero mailbox is empty. */
void mailbox_empty(struct mailbox *b);

/* Puts in a fire or a sample; false, and nothing changed, when there is no room for it. A sample for a
 * frame and channel that already has one replaces it. The caller has checked that its instant has not
 * passed. */
bool mailbox_put_fire(struct mailbox *b, const struct fire *f);
bool mailbox_put_sample(struct mailbox *b, const struct sample *s);

/* Takes out the earliest fire whose instant is `end` or before; false when there is none. Fires of one
 * instant come in order of arrival. */
bool mailbox_take_fire(struct mailbox *b, struct instant end, struct fire *f);

/* Takes out the sample of this frame and channel; false when there is none. Samples of other frames stay. */
bool mailbox_take_sample(struct mailbox *b, uint64_t frame, int channel, struct sample *s);

/* Tells the instant of the earliest fire and leaves it in; false when none waits. */
bool mailbox_next_fire(const struct mailbox *b, struct instant *at);

/* Values by wire index: put one (index < STAGED_VALUES; it replaces an earlier one), ask for one, count
 * all. */
void staged_put(struct staged *s, unsigned index, double value);
bool staged_has(const struct staged *s, unsigned index);
unsigned staged_count(const struct staged *s);

/* CRC-32 over index (one byte) and value (float32, little endian) of every staged entry in order of index:
 * what PARAM_COMMIT names. */
uint32_t staged_crc(const struct staged *s);

#endif
