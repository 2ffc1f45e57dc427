/* seams.h - what passes from one proof to the next, said once: the harness of the producing side asserts it, that of the consuming
 * side begins with any value inside. A limit that the firmware loses becomes an alarm on the producing side; one that is
 * widened here an alarm on the consuming side. */
#ifndef TESTS_EVA_SEAMS_H
#define TESTS_EVA_SEAMS_H

#include "firmware/app/app.h"
#include "tests/eva/eva.h"

#define ROUNDING (1.0 + 1e-12) /* of a quotient and a product */

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

/* What a drive is set to: from `arm` (app_apply_fire) to `drive`. Amplitudes may be any. Ramp: 1e4 s in ticks of 1e-6/4096 s. */
#define SEAM_TURNS (0.25 + 0x1p-24)
#define SEAM_STEP  (((uint64_t)1 << 62) + ((uint64_t)1 << 40)) /* SEAM_TURNS * 2^64 */
#define SEAM_PHASE 1.6e5
#define SEAM_RAMP  ((uint64_t)41 << 40)

/* What settings make of the lock-in: asserted by `settings`. The unit tests and fuzzers, not a proof, go on from there: the ticks of
 * a frame (app_advance.c) use these as indices. */
static inline bool seam_lockin(const struct app *a, int slot)
{
    return a->lockin_channel[slot] < a->plant.model->n_inputs &&
           a->lockin_output[slot] < a->plant.model->n_outputs && a->lockin[slot].harmonic <= LOCKIN_HARMONICS;
}

/* The counts of a burst in memory of n_floats: asserted of what is armed, and kept by each operation, in `capture`. Those who call
 * these operations (app_advance.c, telemetry.c) are in no proof. */
static inline bool seam_capture(const struct capture *c, uint32_t n_floats)
{
    return c->state == CAPTURE_IDLE ||
           (c->n_signals > 0 && c->n_samples > 0 && c->every > 0 && c->next < c->n_samples &&
            (uint64_t)c->n_signals * c->n_samples <= n_floats && c->filled <= c->n_samples);
}

#endif
