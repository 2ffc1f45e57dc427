/* wire.h - bytes <-> messages, pure functions; every bit is in the table of wire_table.c and in
 * docs/reference/message_tables.md.
 *
 * All messages are 8-byte CAN frames with identifier base + kind, little endian. Byte 0 is CHECKSUM, the
 * low nibble of byte 1 is COUNTER (0..14). CHECKSUM is the CRC of AUTOSAR E2E profile 1 (polynomial 0x1D,
 * effective start value 0 and final xor 0) over the identifier's low byte, its second byte, and bytes
 * 1..7. */
#ifndef FIRMWARE_WIRE_H
#define FIRMWARE_WIRE_H

#include <stdbool.h>
#include <stdint.h>
#include "hal/hal.h"
#include "models/model.h"

enum {
    WIRE_BASE_ALIGN = FRAME_IDS, /* a plant owns 64 identifiers */
    WIRE_KINDS = FRAME_IDS,
    WIRE_COMMANDS = 0x10, /* kinds below are commands */
    WIRE_FIELDS = 6,      /* fields of one message, CHECKSUM and COUNTER not counted */
    WIRE_COUNTER_STATES = 15,
    WIRE_SESSIONS = 15, /* 1..15; each is followed by the next, 15 by 1 */
    WIRE_VERSION = 2
};

/* Message kinds are offsets from the base identifier: a lower one wins arbitration. */
enum wire_kind {
    /* controller to plant */
    WIRE_FIRE = 0x00,
    WIRE_ENABLE = 0x01,
    WIRE_CONTROL = 0x02,
    WIRE_CAPTURE = 0x03,
    WIRE_STREAM = 0x04, /* .. 0x07, one per input */
    WIRE_ARM = 0x08,    /* .. 0x0B, one per input */
    WIRE_PARAM_WRITE = 0x0C,
    WIRE_PARAM_COMMIT = 0x0D,
    WIRE_PARAM_READ = 0x0E,
    WIRE_DAC = 0x0F,
    /* plant to controller */
    WIRE_STATUS = 0x10,
    WIRE_REPLY = 0x11,
    WIRE_EVENT_TIME = 0x12,
    WIRE_EVENT_DATA = 0x13,
    WIRE_MOTION = 0x14,
    WIRE_CONTACT = 0x15,
    WIRE_SYNC = 0x16,
    WIRE_LOCKIN = 0x17,
    WIRE_DRIVE_ECHO = 0x18,
    WIRE_LEDGER = 0x19,
    WIRE_HEALTH = 0x1A,
    WIRE_PARAM_ECHO = 0x1B,
    WIRE_HASH = 0x1C,
    WIRE_CAPTURE_DATA = 0x1D,
    WIRE_EVENT_SUMMARY = 0x1E,
    WIRE_LATENCY = 0x1F,
    WIRE_OVERRUN = 0x20,
    WIRE_INFO = 0x21,
    WIRE_SELF_TEST = 0x22,
    WIRE_WATCH = 0x23,
    WIRE_ADC = 0x24,
    WIRE_STREAM_ECHO = 0x25 /* .. 0x28, one per input */
};

/* Field indices of each message, in the order of the table. SESSION is field 0 of every command, STATUS
 * and REPLY. */
enum { SESSION = 0 };
enum { FIRE_CHANNELS = 1, FIRE_PARAMETERS, FIRE_FRACTION, FIRE_TICK };
enum { ENABLE_REQUEST = 1, ENABLE_FRAME };
enum { CONTROL_OPERATION = 1, CONTROL_COMPLEMENT, CONTROL_ARGUMENT };
enum { CAPTURE_OPERATION = 1, CAPTURE_FIRST, CAPTURE_COUNT };
enum { STREAM_FRAME = 1, STREAM_SAMPLE };
enum { ARM_FIELD = 1, ARM_VALUE };
enum { PARAM_WRITE_INDEX = 1, PARAM_WRITE_VALUE };
enum { PARAM_COMMIT_COUNT = 1, PARAM_COMMIT_WHEN, PARAM_COMMIT_CRC };
enum { PARAM_READ_INDEX = 1 };
enum { DAC_TICK = 1, DAC_DITHER, DAC_Z };
enum { STATUS_STATE = 1, STATUS_REACTION, STATUS_WATCH, STATUS_FAULTS, STATUS_FRAME };
enum { REPLY_MESSAGE = 1, REPLY_CAUSE, REPLY_COUNTER, REPLY_INDEX, REPLY_TICKS_LATE };
enum { EVENT_TOUCH, EVENT_CONTACT, EVENT_TIME_FRACTION, EVENT_TIME_TICK };
enum { EVENT_DATA_SPEED = 2, EVENT_DATA_PEAK_FORCE };
enum { MOTION_IN_CONTACT, MOTION_DISPLACEMENT, MOTION_VELOCITY };
enum { CONTACT_IN_CONTACT, CONTACT_PENETRATION, CONTACT_FORCE };
enum { SYNC_FRAME, SYNC_TICK };
enum { LOCKIN_SLOT, LOCKIN_AMPLITUDE, LOCKIN_PHASE };
enum { DRIVE_ECHO_CHANNEL, DRIVE_ECHO_FIELD, DRIVE_ECHO_VALUE };
enum { LEDGER_ITEM, LEDGER_VALUE };
enum { HEALTH_ITEM, HEALTH_VALUE };
enum { PARAM_ECHO_INDEX, PARAM_ECHO_VALUE };
enum { HASH_VALUE };
enum { CAPTURE_DATA_SIGNAL, CAPTURE_DATA_SAMPLE, CAPTURE_DATA_VALUE };
enum { SUMMARY_TOUCHDOWNS, SUMMARY_LOSS, SUMMARY_NOT_SENT };
enum { LATENCY_MESSAGE, LATENCY_COUNTER, LATENCY_APPLY, LATENCY_SEND };
enum { OVERRUN_MISSED, OVERRUN_FRAME };
enum { INFO_ITEM, INFO_VALUE };
enum { SELF_TEST_ITEM, SELF_TEST_VERDICT, SELF_TEST_VALUE };
enum { WATCH_OBSERVABLE, WATCH_TICK, WATCH_VALUE };
enum { ADC_TICK, ADC_DEFLECTION, ADC_Z_SENSOR };
enum { STREAM_ECHO_FRAME, STREAM_ECHO_SAMPLE };

/* Values of enumerated fields. */
enum control_operation {
    CONTROL_START = 1, /* argument: last frame seen (age-limited) */
    CONTROL_STOP,      /* argument ignored; always accepted: the safe direction. Ends the session */
    CONTROL_PAUSE,     /* argument: last frame seen */
    CONTROL_STEP,      /* argument: number of frames; only while paused */
    CONTROL_RUN_UNTIL, /* argument: tick, low 32 bits, a frame boundary; only while paused */
    /* argument: last frame seen; clears faults, state to rest, the tick goes on; not while running */
    CONTROL_RESET,
    CONTROL_OPERATIONS
};
enum capture_operation { CAPTURE_STOP, CAPTURE_ARM, CAPTURE_TRIGGER, CAPTURE_READ, CAPTURE_OPERATIONS };
enum arm_field {
    ARM_AMPLITUDE,
    ARM_FREQUENCY,
    ARM_PHASE,
    ARM_RAMP,
    ARM_NOISE,
    ARM_NOISE_HOLD,
    ARM_NOISE_SEED,
    ARM_FIELDS
};
enum commit_when { COMMIT_NOW, COMMIT_WITH_FIRE };
enum plant_state {
    STATE_OFF,
    STATE_READY,
    STATE_RUNNING,
    STATE_PAUSED,
    STATE_STOPPED,
    STATE_FROZEN,
    STATE_FAULT
};
enum reaction {
    REACTION_HOLD,
    REACTION_RAMP,
    REACTION_ZERO,
    REACTION_FREEZE,
    REACTION_NONE, /* heartbeats come */
    REACTION_STOP  /* a command has ended the session: CONTROL stop, or in FAULT ENABLE off */
};
enum cause {
    CAUSE_OK,
    CAUSE_RANGE,      /* a value outside its range or not finite */
    CAUSE_LATE,       /* the instant named has passed */
    CAUSE_STALE,      /* the frame echoed is too old, or the instant beyond the horizon */
    CAUSE_SESSION,    /* not the session in force */
    CAUSE_STATE,      /* not possible in this state */
    CAUSE_FULL,       /* no room to wait in, or no memory for the burst */
    CAUSE_INCOMPLETE, /* nothing armed, or the staged set does not match its count and CRC */
    CAUSE_UNKNOWN,    /* no such operation, index or field */
    CAUSE_SELF_TEST,  /* the power-on self-test failed */
    CAUSES
};
enum fault_bit {
    FAULT_NOT_FINITE = 1 << 0, /* the state left the finite numbers; stopped at the last good state */
    FAULT_BUDGET = 1 << 1,     /* a substep reached its bound on switches or work */
    FAULT_LEDGER = 1 << 2,     /* the integrator made or lost more energy than ledger_alarm allows */
    FAULT_OVERRUN = 1 << 3,    /* an overrun under the policy `stop` */
    FAULT_BUS = 1 << 4,        /* bus-off or interface down was seen */
    FAULT_TIMEOUT = 1 << 5,    /* heartbeats stopped; the reaction is in force */
    FAULT_ASSERT = 1 << 6,     /* the last run on the target ended by a fault: HEALTH last_run */
    FAULT_SELF_TEST = 1 << 7   /* the power-on self-test failed */
};
enum info_item {
    INFO_VERSION,       /* WIRE_VERSION */
    INFO_FRAME_RATE_HZ, /* frames per bus second */
    INFO_SUBSTEPS,      /* ticks per frame */
    INFO_F0_REAL_HZ,    /* contact eigenfrequency of the real rig */
    INFO_DILATION,      /* bus seconds per real second */
    INFO_F0_BUS_HZ,     /* f0 as the bus sees it: real / dilation */
    INFO_PROMOTED,      /* 1 once the plant has climbed to the full model */
    INFO_IDENTITY,      /* the check of firmware/bus/identity.h */
    INFO_MODEL,         /* a check of the name of the model that the plant began with */
    INFO_LSB,           /* .. one for each of wire_scene.lsb */
    INFO_LSB_LAST = INFO_LSB + 3,
    INFO_SETTINGS, /* a check of the settings that give messages their meaning, as they were at the start */
    INFO_ITEMS
};

enum self_test_verdict { SELF_TEST_ABSENT, SELF_TEST_PASSED, SELF_TEST_FAILED };

enum ledger_item {
    LEDGER_STORED,   /* energy in the plant now */
    LEDGER_DAMPING,  /* lost in the dampers since the ledger began */
    LEDGER_RESIDUAL, /* energy that does not balance */
    LEDGER_CHANGE,   /* brought in by parameter changes */
    LEDGER_WORK      /* delivered by input 0, one per input follows */
};

/* The scale of a field's number. A signed 24-bit field with LSB takes a scene's output_lsb. */
enum field_scale {
    SCALE_ONE,
    SCALE_FRACTION_8,  /* 1/256 */
    SCALE_FRACTION_16, /* 1/65536 */
    SCALE_LOSS,        /* 1/65535: a fraction of time, 0..1 */
    SCALE_ANGLE,       /* pi/32768 rad per unit */
    SCALE_DISPLACEMENT,
    SCALE_VELOCITY,
    SCALE_PENETRATION,
    SCALE_FORCE
};

/* A decoded message. value[] follows the layout's fields, scaled; NaN means not available. */
struct message {
    uint8_t kind;
    uint8_t counter;
    double value[WIRE_FIELDS];
};

/* Fixed for a scene's life: the plant's identifiers on the bus, and one unit of each scaled output in SI. */
struct wire_scene {
    uint32_t base_id;
    bool extended;
    double lsb[4]; /* displacement_m, velocity_m_per_s, penetration_m, force_N */
    double frame_rate_Hz, dilation;
    uint32_t substeps;
    uint32_t model, settings, identity; /* checks, see firmware/bus/identity.h */
};

enum wire_status { WIRE_OK, WIRE_NOT_OURS, WIRE_BAD_LENGTH, WIRE_BAD_CRC, WIRE_BAD_COUNTER, WIRE_BAD_KIND };

/* Continues a CRC with polynomial 0x1D by one byte; start with 0. */
uint8_t wire_crc8_byte(uint8_t crc, uint8_t byte);

/* CRC of AUTOSAR E2E profile 1 over the identifier's two low bytes and data[1..length-1], 1 <= length <=
 * 8. The result belongs into data[0]. */
uint8_t wire_crc8(uint32_t id, const uint8_t *data, int length);

/* CRC-32 (IEEE 802.3, as in zlib) of n bytes, continuing from crc (0 to begin). Eight steps a byte, no
 * table: not for every tick. */
uint32_t wire_crc32(uint32_t crc, const uint8_t *data, int n);

/* The CRC-32 over the 5 bytes of one entry: the index, then the value as float32, little endian. */
uint32_t wire_crc32_entry(uint32_t crc, unsigned index, double value);

/* The size of one unit of a field's number, in the field's unit: value = number * factor. */
double wire_factor(const struct wire_scene *s, enum field_scale scale);

/* The frame of a message; a kind without a layout is an error of the caller (assertion). Numbers are
 * rounded to the nearest, ties away from zero. A value may not fit its field. A signed 24-bit number
 * becomes "not available" then, and a float infinite. An unsigned one is limited to 0 or the field's
 * largest value (NaN: 0). Angles wrap. Unused bits are 0. */
void wire_encode(const struct wire_scene *s, const struct message *m, struct frame *f);

/* The message of a frame: WIRE_OK, or the first thing that is wrong, and then *m is untouched. Looked at
 * in this order: identifier, length, kind, CRC, counter. Unused bits are ignored (the CRC covers them); a
 * float may be anything, NaN and infinity included: the caller must check its range. */
enum wire_status wire_decode(const struct wire_scene *s, const struct frame *f, struct message *m);

/* One LSB for a quantity whose typical size is `typical`: the largest 1, 2 or 5 times 10^k not above
 * typical * 1e-5. A 24-bit field then spans at least 33 times the typical size. k is held to -22..22,
 * where 10^k is exact. */
double wire_lsb(double typical);

/* The 64-bit number nearest to `now` that ends in these 32 (16) bits: the wire carries no more of a tick
 * or frame. */
static inline uint64_t wire_nearest_32(uint64_t now, double low)
{
    return now + (uint64_t)(int64_t)(int32_t)((uint32_t)low - (uint32_t)now);
}

static inline uint64_t wire_nearest_16(uint64_t now, double low)
{
    return now + (uint64_t)(int64_t)(int16_t)((uint16_t)low - (uint16_t)now);
}

#endif
