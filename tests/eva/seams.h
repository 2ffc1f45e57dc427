/* seams.h - the limits on values that pass from one proof to the next, stated once.
 *
 * The harness of the producing side asserts a limit; that of the consuming side begins with any value
 * inside it. A limit that the firmware loses becomes an alarm on the producing side; one that is widened
 * here an alarm on the consuming side. */
#ifndef TESTS_EVA_SEAMS_H
#define TESTS_EVA_SEAMS_H

#include "firmware/app/app.h"
#include "tests/eva/eva.h"

#define ROUNDING (1.0 + 1e-12) /* room for the rounding of a quotient and a product */

/* Values from min to max; `below` is the next one that must be refused, above max all are. */
struct seam {
    double below, min, max;
};

/* ARM: from `arm` (drives_arm) to `arm` (app_apply_fire). */
static inline struct seam seam_arm(const struct app *a, int channel, int field)
{
    double unit = ROUNDING * scale_of(&a->plant.scale, a->plant.model->input_signal[channel].quantity);
    const double zero = -0x1p-1074, one = 0x1.fffffffffffffp-1; /* the largest double below 0, and below 1 */
    switch (field) {
    case ARM_AMPLITUDE:
        return (struct seam){-DRIVE_LIMIT * unit, -DRIVE_LIMIT * unit, DRIVE_LIMIT * unit};
    case ARM_FREQUENCY:
        return (struct seam){zero, 0.0, (1.0 + 2e-7) / (DRIVE_TICKS_MIN * a->plant.tick_s)};
    case ARM_PHASE:
        return (struct seam){-1e6 * ROUNDING, -1e6 * ROUNDING, 1e6 * ROUNDING};
    case ARM_RAMP:
        return (struct seam){zero, 0.0, 1e4 * ROUNDING};
    case ARM_NOISE:
        return (struct seam){zero, 0.0, NOISE_LIMIT * unit};
    case ARM_NOISE_HOLD:
        return (struct seam){one, 1.0, NOISE_HOLD_MAX * ROUNDING};
    default:
        return (struct seam){zero, 0.0, 16777215.0 * ROUNDING};
    }
}

/* The setting of a drive: from `arm` (app_apply_fire) to `drive`. Amplitudes may be any. Ramp: 1e4 s in
 * ticks of 1e-6/4096 s. */
#define SEAM_TURNS (0.25 + 0x1p-24)
#define SEAM_STEP  (((uint64_t)1 << 62) + ((uint64_t)1 << 40)) /* SEAM_TURNS * 2^64 */
#define SEAM_PHASE 1.6e5
#define SEAM_RAMP  ((uint64_t)41 << 40)

/* A setting as it is in force or staged: from `settings` (parameters_write) to `command`, `advance` and
 * `telemetry`. */
static inline bool seam_setting(int i, double value)
{
    return value >= setting_table[i].min && value <= setting_table[i].max;
}

/* Settings that name inputs and outputs fit the model: from `settings` (parameters_apply) to the same. */
static inline void any_settings(struct app *a)
{
    /*@ loop unroll SETTINGS; */
    for (int i = 0; i < SETTINGS; i++)
        a->setting[i] = eva_between(setting_table[i].min, setting_table[i].max);
    for (int i = 0; i < LOCKIN_SLOTS; i++) {
        a->setting[SET_LOCKIN_CHANNEL + i] = eva_uint(0, (uint32_t)a->plant.model->n_inputs - 1);
        a->setting[SET_LOCKIN_OUTPUT + i] = eva_uint(0, (uint32_t)a->plant.model->n_outputs - 1);
    }
}

/* The lock-in as set up by the settings: from `settings` to `advance`, which uses these as indices and shows
 * that they hold again. */
static inline bool seam_lockin(const struct app *a, int slot)
{
    return a->lockin.slot[slot].drive < a->plant.model->n_inputs &&
           a->lockin.slot[slot].output < a->plant.model->n_outputs && a->lockin.slot[slot].first <= slot &&
           a->lockin.slot[slot].harmonic <= LOCKIN_HARMONICS;
}

/* The counts of a burst in memory of n_floats: asserted of what is armed, and kept by each operation, in
 * `capture`. */
static inline bool seam_capture(const struct capture *c, uint32_t n_floats)
{
    return c->state == CAPTURE_IDLE ||
           (c->n_signals > 0 && c->n_samples > 0 && c->every > 0 && c->next < c->n_samples &&
            (uint64_t)c->n_signals * c->n_samples <= n_floats && c->filled <= c->n_samples);
}

/* The burst of an app samples no more outputs than the model has: from `command` (CAPTURE) to seam_burst. */
static inline bool seam_signals(const struct app *a)
{
    return a->capture.state == CAPTURE_IDLE || a->capture.n_signals <= (uint32_t)a->plant.model->n_outputs;
}

/* Both: from `capture` and `command` to `advance` and `telemetry`, which only hand the burst on. */
static inline bool seam_burst(const struct app *a)
{
    return seam_capture(&a->capture, a->config.n_capture) && seam_signals(a);
}

/* One burst of all that keep the seam, in any state: its numbers are looked at in `capture`. */
static inline void any_burst(struct app *a)
{
    a->config.n_capture = 7 * MODEL_OUTPUTS;
    a->capture =
        (struct capture){.n_signals = (uint32_t)a->plant.model->n_outputs, .n_samples = 7, .every = 1};
    a->capture.state = (enum capture_state)Frama_C_interval(CAPTURE_IDLE, CAPTURE_FULL);
    a->capture.trigger = (enum capture_trigger)Frama_C_interval(0, TRIGGERS - 1);
}

/* Blocks of codes come only to a plant with converters, and fit. From `command` (DAC) to `advance` and
 * `telemetry`. */
static inline bool seam_codes(const struct app *a)
{
    return a->streaming < APP_STREAMING_CODES ||
           (a->config.substeps <= MAILBOX_CODES && a->config.stage_calls && a->config.stage_calls->dac);
}

/* An app within it, with blocks of codes or without. */
static inline void any_codes(struct app *a, const struct plant_stage_calls *converters, bool come)
{
    a->config.stage_calls = come ? converters : NULL;
    a->config.substeps = eva_uint(1, come ? MAILBOX_CODES : 4096);
    a->streaming = eva_uint(come ? APP_STREAMING_CODES : 0,
                            come ? 2 * APP_STREAMING_CODES - 1 : APP_STREAMING_CODES - 1);
}

/* The instant of an event, in ticks from its own: from `plant` to `telemetry`. Each piece of a segment is
 * at most a tick long. */
static inline bool seam_event(const struct event *e)
{
    return e->fraction >= 0.0 && e->fraction <= PLANT_PIECES + 1.0;
}

/* The start of a report: telemetry's places in its rounds, and the reports that wait. From `command` and
 * `telemetry` to `telemetry`. PARAM_ECHO has no bit between the parameters and the settings. */
static inline bool seam_telemetry(const struct app *a)
{
    const struct telemetry *t = &a->telemetry;
    uint32_t n_inputs = (uint32_t)a->plant.model->n_inputs;
    return t->echo_next < n_inputs * ARM_FIELDS + INFO_ITEMS && t->ledger_next < LEDGER_WORK + n_inputs &&
           t->health_next < DIAG_COUNTERS && t->info_pending < 1u << INFO_ITEMS &&
           t->selftest_pending < 1u << SELFTEST_CHECKS && t->echo_pending[1] == 0 &&
           t->n_tx <= TELEMETRY_SLOTS;
}

#endif
