/* settings.c - the table of settings. Counts are whole numbers below 2^24: exact as the float32 of the
 * wire. */
#include "firmware/bus/settings.h"
#include <stdint.h>

#define EVERY(name, initial, message)                                                                        \
    {                                                                                                        \
        name, "frames", 0, 10000, initial, "frames from one " message " to the next, 0 for none"             \
    }
#define ALWAYS(name, initial, message)                                                                       \
    {                                                                                                        \
        name, "frames", 1, 10000, initial, "frames from one " message " to the next"                         \
    }
#define LINEAR(name, min, initial)                                                                           \
    {                                                                                                        \
        name, "", min, 1, initial,                                                                           \
            "how a streamed sample is taken: 0 jumps, 1 ramps over the frame it names"                       \
    }
#define CHANNEL(slot, initial)                                                                               \
    {                                                                                                        \
        "lockin_channel_" slot, "", 0, MODEL_INPUTS - 1, initial, "input whose phase this lock-in slot uses" \
    }
#define HARMONIC(slot, initial)                                                                              \
    {                                                                                                        \
        "lockin_harmonic_" slot, "", 0, 16, initial, "harmonic that this lock-in slot measures, 0: the mean" \
    }
#define OUTPUT(slot, initial)                                                                                \
    {                                                                                                        \
        "lockin_output_" slot, "", 0, MODEL_OUTPUTS + STAGE_SLOTS - 1, initial,                              \
            "output that this lock-in slot measures; 12 to 15: result of stage 0 to 3, of a microscope "     \
            "snap-in, baseline, deformation, work"                                                           \
    }

/* The faults of signal i, whose settings end in its unit. */
#define SENSOR(i, signal, suffix, unit)                                                                      \
    [SET_SENSOR_OFFSET +                                                                                     \
        i] = {signal "_offset" suffix, unit, -1e6, 1e6, 0, "sensor fault: added to what is sent"},           \
        [SET_SENSOR_NOISE + i] = {signal "_noise" suffix,                                                    \
                                  unit,                                                                      \
                                  0,                                                                         \
                                  1e6,                                                                       \
                                  0,                                                                         \
                                  "sensor fault: standard deviation of noise, a value a frame"},             \
        [SET_SENSOR_SATURATION + i] = {signal "_saturation" suffix,                                          \
                                       unit,                                                                 \
                                       0,                                                                    \
                                       1e6,                                                                  \
                                       0,                                                                    \
                                       "sensor fault: largest magnitude sent, 0: no limit"},                 \
        [SET_SENSOR_QUANTUM + i] = {signal "_quantum" suffix,                                                \
                                    unit,                                                                    \
                                    0,                                                                       \
                                    1e6,                                                                     \
                                    0,                                                                       \
                                    "sensor fault: only multiples of it are sent, 0: all"},                  \
        [SET_SENSOR_DELAY + i] = {signal "_delay_frames", "frames", 0,                                       \
                                  SENSOR_DELAY_MAX,       0,        "sensor fault: age of what is sent"},    \
        [SET_SENSOR_STUCK +                                                                                  \
            i] = {signal "_stuck", "", 0, 1, 0, "sensor fault: 1 repeats what was sent last"}

#define STAGE_ROW(i, number, what, unit, min, max, initial, meaning)                                         \
    [SET_STAGE + STAGE_SETTINGS * (i) + (number)] = {"stage_" #i "_" what, unit, min, max, initial, meaning}

/* Stage i; without a unit where that is its signal's. */
#define STAGE(i)                                                                                             \
    STAGE_ROW(                                                                                               \
        i, STAGE_AT, "at", "", 0, MODEL_INPUTS + MODEL_OUTPUTS, 0,                                           \
        "where this stage stands: 0 nowhere, 1 to 4 before input 0 to 3, 5 to 16 behind output 0 to 11"),    \
        STAGE_ROW(i, STAGE_SET_GAIN, "gain", "1", -1e9, 1e9, 1, "result over signal"),                       \
        STAGE_ROW(i, STAGE_SET_SLEW, "slew_per_s", "", 0, 1e10, 0,                                           \
                  "largest rate, signal's unit a second, 0: no limit"),                                      \
        STAGE_ROW(i, STAGE_SET_RANGE, "hysteresis_range", "", 0, 1e10, 0,                                    \
                  "range of the play operators, signal's unit, 0: none"),                                    \
        STAGE_ROW(i, STAGE_SET_SHARE, "hysteresis_share", "1", 0, 1, 0.15, "share of the play operators"),   \
        STAGE_ROW(i, STAGE_SET_CREEP, "creep_per_decade", "1", 0, 1, 0,                                      \
                  "share of a step that creeps in a decade of time"),                                        \
        STAGE_ROW(i, STAGE_SET_RESONANCE, "resonance_Hz", "Hz", 0, 1e9, 0, "undamped frequency, 0: none"),   \
        STAGE_ROW(i, STAGE_SET_DAMPING, "damping_ratio", "1", 0, 1, 0.05,                                    \
                  "of the resonance; above 0, at most 0.999"),                                               \
        STAGE_ROW(i, STAGE_SET_NOISE, "noise_density", "", 0, 1e9, 0,                                        \
                  "one-sided density of white noise, signal's unit per root hertz"),                         \
        STAGE_ROW(i, STAGE_SET_CORNER, "noise_corner_Hz", "Hz", 0, 1e9, 0,                                   \
                  "below it noise rises as 1/f from noise_density, 0: none"),                                \
        STAGE_ROW(i, STAGE_SET_DRIFT, "drift_per_s", "", -1e9, 1e9, 0,                                       \
                  "of the zero, signal's unit a second"),                                                    \
        STAGE_ROW(i, STAGE_SET_LAG, "lag_Hz", "Hz", 0, 1e10, 0, "corner frequency of a lag, 0: none"),       \
        STAGE_ROW(i, STAGE_SET_CLIP, "clip", "", 0, 1e10, 0,                                                 \
                  "largest magnitude, signal's unit, 0: no limit"),                                          \
        STAGE_ROW(i, STAGE_SET_QUANTUM, "quantum", "", 0, 1e10, 0,                                           \
                  "only multiples of it, signal's unit, 0: all"),                                            \
        STAGE_ROW(i, STAGE_SET_DELAY, "delay_ticks", "ticks", 0, 510, 0, "delay, also a fraction of a tick")

/* Why these values: time-outs are 100 ms and ages 50 ms. A controller on a PC with its jitter keeps them;
 * a dead controller does not. The telemetry rates keep a 1 Mbit/s bus below half load
 * (docs/reference/messages.md). */
const struct parameter setting_table[SETTINGS] = {
    [SET_TIMEOUT_FRAMES] =
        {"timeout_frames", "frames", 1, 10000, 100,
         "bus frames without a good ENABLE until the reaction runs; unless set, those of 0.1 s, "
         "20 at least"},
    [SET_REACTION] = {"reaction", "", 0, 3, 1,
                      "reaction to a time-out: 0 hold, 1 ramp to zero, 2 zero, 3 freeze"},
    [SET_REACTION_RAMP_S] = {"reaction_ramp_s", "s", 0, 3600, 0.2, "length of the ramp to zero, bus seconds"},
    [SET_AGE_LIMIT_FRAMES] =
        {"age_limit_frames", "frames", 1, 10000, 50,
         "the oldest bus frame that ENABLE and CONTROL may name; unless set, those of 0.05 s, 50 at "
         "least"},
    [SET_HORIZON_FRAMES] = {"horizon_frames", "frames", 1, 30000, 5000,
                            "how far ahead FIRE and STREAM may name an instant"},
    [SET_OVERRUN_POLICY] = {"overrun_policy", "", 0, 3, 0,
                            "handling of missed frames: 0 catch up, 1 skip, 2 freeze, 3 stop"},
    [SET_LEDGER_ALARM] = {"ledger_alarm", "1", 0, 1, 0.01,
                          "energy that does not balance within 100 plant frames, as a fraction of "
                          "the energy that flowed and swings, above which FAULT_LEDGER is set"},
    [SET_MOTION_EVERY] = EVERY("motion_every", 1, "MOTION"),
    [SET_CONTACT_EVERY] = EVERY("contact_every", 1, "CONTACT"),
    [SET_SYNC_EVERY] = ALWAYS("sync_every", 1, "SYNC"),
    [SET_STATUS_EVERY] = ALWAYS("status_every", 10, "STATUS"),
    [SET_LEDGER_EVERY] = EVERY("ledger_every", 10, "LEDGER"),
    [SET_HEALTH_EVERY] = EVERY("health_every", 5, "HEALTH"),
    [SET_ECHO_EVERY] = EVERY("echo_every", 20, "DRIVE_ECHO"),
    [SET_SUMMARY_EVERY] = EVERY("summary_every", 100, "EVENT_SUMMARY"),
    [SET_HASH_EVERY] = EVERY("hash_every", 1000, "HASH"),
    [SET_EVENTS_PER_FRAME] = {"events_per_frame", "", 0, 16, 4,
                              "contact events sent per bus frame, EVENT_SUMMARY counts the others"},
    [SET_STREAM_LINEAR] = LINEAR("stream_linear_force", 0, 0),
    [SET_STREAM_LINEAR + 1] = LINEAR("stream_linear_fast_force", 0, 0),
    /* a jump of the base would be an impulse in velocity */
    [SET_STREAM_LINEAR + 2] = LINEAR("stream_linear_base", 1, 1),
    [SET_STREAM_LINEAR + 3] = LINEAR("stream_linear_stiffness", 0, 0),
    [SET_LOCKIN_FRAMES] = {"lockin_frames", "frames", 0, 10000, 100, "window of every lock-in slot, 0: off"},
    [SET_LOCKIN_CHANNEL] = CHANNEL("0", 0),
    [SET_LOCKIN_CHANNEL + 1] = CHANNEL("1", 2),
    [SET_LOCKIN_CHANNEL + 2] = CHANNEL("2", 0),
    [SET_LOCKIN_CHANNEL + 3] = CHANNEL("3", 1),
    [SET_LOCKIN_HARMONIC] = HARMONIC("0", 1),
    [SET_LOCKIN_HARMONIC + 1] = HARMONIC("1", 1),
    [SET_LOCKIN_HARMONIC + 2] = HARMONIC("2", 2),
    [SET_LOCKIN_HARMONIC + 3] = HARMONIC("3", 1),
    [SET_LOCKIN_OUTPUT] = OUTPUT("0", 0),
    [SET_LOCKIN_OUTPUT + 1] = OUTPUT("1", 0),
    [SET_LOCKIN_OUTPUT + 2] = OUTPUT("2", 0),
    [SET_LOCKIN_OUTPUT + 3] = OUTPUT("3", 0),
    [SET_CAPTURE_EVERY_TICKS] = {"capture_every_ticks", "ticks", 1, 65535, 1,
                                 "ticks from one sample to the next"},
    [SET_CAPTURE_SAMPLES] = {"capture_samples", "", 1, 65535, 1000, "samples of a burst"},
    [SET_CAPTURE_PRETRIGGER] = {"capture_pretrigger", "", 0, 65535, 100,
                                "samples of the burst that lie before its trigger"},
    [SET_CAPTURE_TRIGGER] = {"capture_trigger", "", 0, 4, 0,
                             "trigger of the burst: 0 command, 1 touchdown, 2 lift-off, 3 fire, 4 fault"},
    [SET_CAPTURE_PER_FRAME] = {"capture_per_frame", "", 1, 16, 8, "values of a burst sent per bus frame"},
    SENSOR(0, "displacement", "_m", "m"),
    SENSOR(1, "velocity", "_m_per_s", "m/s"),
    SENSOR(2, "penetration", "_m", "m"),
    SENSOR(3, "contact_force", "_N", "N"),
    [SET_SENSOR_SEED] = {"sensor_seed", "", 0, 65535, 0, "seed of the noise of sensors and stages"},
    STAGE(0),
    STAGE(1),
    STAGE(2),
    STAGE(3),
    [SET_STREAM_ECHO_EVERY] = EVERY("stream_echo_every", 0, "STREAM_ECHO"),
};

/* The frames of so many seconds, `least` at least, as far as setting i goes. */
static double frames_of(int i, double seconds, double least, double frame_s)
{
    double frames = seconds / frame_s + 0.5, most = setting_table[i].max;
    if (!(frames < most))
        return most;
    return frames > least ? (double)(int32_t)frames : least;
}

double setting_initial(int i, const struct model *m, double frame_s)
{
    if (i == SET_TIMEOUT_FRAMES)
        return frames_of(i, 0.1, 20.0, frame_s);
    if (i == SET_AGE_LIMIT_FRAMES)
        return frames_of(i, 0.05, 50.0, frame_s);
    bool channel = i >= SET_LOCKIN_CHANNEL && i <= SET_LOCKIN_CHANNEL_LAST;
    double initial = setting_table[i].initial;
    return channel && initial >= m->n_inputs ? 0.0 : initial;
}

bool setting_accepts(int i, double value)
{
    const struct parameter *s = &setting_table[i];
    bool whole =
        i != SET_REACTION_RAMP_S && i != SET_LEDGER_ALARM && (i < SET_SENSOR_OFFSET || i >= SET_SENSOR_DELAY);
    if (i >= SET_STAGE && i < SET_STREAM_ECHO_EVERY)
        whole = (i - SET_STAGE) % STAGE_SETTINGS == STAGE_AT;

    if (!(value >= s->min && value <= s->max))
        return false;
    return !whole || value == (double)(int)value;
}
