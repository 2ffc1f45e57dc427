/* settings.h - settings of the app itself, handled like the model's parameters.
 *
 * On the wire a setting has the index SETTING_FIRST + its number; staged, committed and echoed like a
 * parameter. */
#ifndef FIRMWARE_SETTINGS_H
#define FIRMWARE_SETTINGS_H

#include <stdbool.h>
#include "models/model.h"

enum {
    SETTING_FIRST = 64,
    LOCKIN_SLOTS = 4,
    SENSOR_SIGNALS = 4,    /* the first outputs of every model: those of MOTION and CONTACT */
    SENSOR_DELAY_MAX = 32, /* frames */
    STAGE_SLOTS = 4        /* actuators and sensors (stages.h) */
};

/* Settings of one stage, in this order. */
enum stage_setting {
    STAGE_AT, /* 0: off, 1 to 4: before this input, 5 to 16: behind this output */
    STAGE_SET_GAIN,
    STAGE_SET_SLEW,
    STAGE_SET_RANGE,
    STAGE_SET_SHARE,
    STAGE_SET_CREEP,
    STAGE_SET_RESONANCE,
    STAGE_SET_DAMPING,
    STAGE_SET_NOISE,
    STAGE_SET_CORNER,
    STAGE_SET_DRIFT,
    STAGE_SET_LAG,
    STAGE_SET_CLIP,
    STAGE_SET_QUANTUM,
    STAGE_SET_DELAY,
    STAGE_SETTINGS
};

enum setting {
    SET_TIMEOUT_FRAMES,
    SET_REACTION,
    SET_REACTION_RAMP_S,
    SET_AGE_LIMIT_FRAMES,
    SET_HORIZON_FRAMES,
    SET_OVERRUN_POLICY,
    SET_LEDGER_ALARM,
    SET_MOTION_EVERY,
    SET_CONTACT_EVERY,
    SET_SYNC_EVERY,
    SET_STATUS_EVERY,
    SET_LEDGER_EVERY,
    SET_HEALTH_EVERY,
    SET_ECHO_EVERY,
    SET_SUMMARY_EVERY,
    SET_HASH_EVERY,
    SET_EVENTS_PER_FRAME,
    SET_STREAM_LINEAR, /* .. one per input */
    SET_STREAM_LINEAR_LAST = SET_STREAM_LINEAR + MODEL_INPUTS - 1,
    SET_LOCKIN_FRAMES,
    SET_LOCKIN_CHANNEL, /* one per slot */
    SET_LOCKIN_CHANNEL_LAST = SET_LOCKIN_CHANNEL + LOCKIN_SLOTS - 1,
    SET_LOCKIN_HARMONIC, /* one per slot */
    SET_LOCKIN_HARMONIC_LAST = SET_LOCKIN_HARMONIC + LOCKIN_SLOTS - 1,
    SET_LOCKIN_OUTPUT, /* one per slot */
    SET_LOCKIN_OUTPUT_LAST = SET_LOCKIN_OUTPUT + LOCKIN_SLOTS - 1,
    SET_CAPTURE_EVERY_TICKS,
    SET_CAPTURE_SAMPLES,
    SET_CAPTURE_PRETRIGGER,
    SET_CAPTURE_TRIGGER,
    SET_CAPTURE_PER_FRAME,
    /* faults of the sensors (sensor.h), one of each kind per signal; these without whole numbers first */
    SET_SENSOR_OFFSET,
    SET_SENSOR_NOISE = SET_SENSOR_OFFSET + SENSOR_SIGNALS,
    SET_SENSOR_SATURATION = SET_SENSOR_NOISE + SENSOR_SIGNALS,
    SET_SENSOR_QUANTUM = SET_SENSOR_SATURATION + SENSOR_SIGNALS,
    SET_SENSOR_DELAY = SET_SENSOR_QUANTUM + SENSOR_SIGNALS,
    SET_SENSOR_STUCK = SET_SENSOR_DELAY + SENSOR_SIGNALS,
    SET_SENSOR_SEED = SET_SENSOR_STUCK + SENSOR_SIGNALS,
    SENSOR_FAULTS = SET_SENSOR_SEED - SET_SENSOR_OFFSET,
    SET_STAGE = SET_SENSOR_SEED + 1, /* STAGE_SETTINGS for each slot */
    SET_STREAM_ECHO_EVERY = SET_STAGE + STAGE_SLOTS * STAGE_SETTINGS,
    SETTINGS
};

enum overrun_policy { OVERRUN_CATCH_UP, OVERRUN_SKIP, OVERRUN_FREEZE, OVERRUN_STOP };

extern const struct parameter setting_table[SETTINGS];

/* The default of setting i for this model and frame period (bus seconds). It is the table's, but for two
 * cases. A lock-in slot whose input the model lacks follows input 0. The time-out is 0.1 s and at least 20
 * frames, the age limit 0.05 s and at least 50 frames; neither exceeds its range. */
double setting_initial(int i, const struct model *m, double frame_s);

/* True for a value that setting i may take. It must be inside its range, and a whole number unless the
 * setting is a time, a fraction or a sensor's value. A NaN is refused. */
bool setting_accepts(int i, double value);

#endif
