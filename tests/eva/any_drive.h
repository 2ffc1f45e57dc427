/* any_drive.h - a drive in any state that commands within their limits (seams.h) can bring it to. Amplitudes
 * and samples are any double, for a change of units takes them beyond every limit; a ramp's remains is at
 * most its length. */
#ifndef TESTS_EVA_ANY_DRIVE_H
#define TESTS_EVA_ANY_DRIVE_H

#include "firmware/plant/drive.h"
#include "tests/eva/seams.h"

static inline void any_noise(struct noise *n)
{
    n->x = eva_between(0.0, 1.0);
    n->here = eva_between(-NOISE_PEAK, NOISE_PEAK);
    n->next = eva_between(-NOISE_PEAK, NOISE_PEAK);
    n->hold = eva_uint(1, NOISE_HOLD_MAX);
    n->straight = eva_bool();
    n->active = eva_bool();
    n->anew = eva_bool();
    n->known = eva_bool();
}

static inline void any_drive(struct drive *d)
{
    eva_any(d, sizeof *d);
    d->ramp_length = TICK_FRACTIONS * (uint64_t)Frama_C_unsigned_long_interval(1, SEAM_RAMP);
    d->ramp_left = Frama_C_unsigned_long_interval(0, SEAM_RAMP * TICK_FRACTIONS);
    d->sample_left = Frama_C_unsigned_long_interval(0, SEAM_RAMP * TICK_FRACTIONS);
    d->step = Frama_C_unsigned_long_interval(0, SEAM_STEP);
    d->step_from = Frama_C_unsigned_long_interval(0, SEAM_STEP);
    d->step_to = Frama_C_unsigned_long_interval(0, SEAM_STEP);
    d->cosine = eva_between(-1.1, 1.1);
    d->sine = eva_between(-1.1, 1.1);
    d->half_cosine = eva_between(-1.1, 1.1);
    d->half_sine = eva_between(-1.1, 1.1);
    d->omega_tick = eva_between(0.0, 3.2);
    d->phasor_valid = (d->sample_left == 0 || d->sample_left >= TICK_FRACTIONS) && eva_bool();
    d->phasor_kept = eva_bool();
    any_noise(&d->noise);
}

#endif
