/* any_drive.h - a drive in any state that commands within their limits can bring it to. The limits are those that arm_accepts,
 * setting_accepts and plant_init allow; a ramp's remains is at most its length. */
#ifndef TESTS_EVA_ANY_DRIVE_H
#define TESTS_EVA_ANY_DRIVE_H

#include "firmware/drive.h"
#include "tests/eva/eva.h"

#define LIMIT (2.0 * DRIVE_LIMIT)
#define RAMP  ((uint64_t)41 << 40) /* ticks: 1e4 s in ticks of 1e-6/4096 s */

static inline void any_noise(struct noise *n)
{
    n->level = eva_between(0.0, LIMIT);
    n->level_from = eva_between(0.0, LIMIT);
    n->x = eva_between(0.0, 1.0);
    n->rest = eva_between(-LIMIT, LIMIT);
    n->value = eva_between(-LIMIT, LIMIT);
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
    d->ramp_length = TICK_FRACTIONS * (uint64_t)Frama_C_unsigned_long_interval(1, RAMP);
    d->ramp_left = Frama_C_unsigned_long_interval(0, RAMP * TICK_FRACTIONS);
    d->sample_left = Frama_C_unsigned_long_interval(0, RAMP * TICK_FRACTIONS);
    d->amplitude = eva_between(-LIMIT, LIMIT);
    d->amplitude_from = eva_between(-LIMIT, LIMIT);
    d->amplitude_to = eva_between(-LIMIT, LIMIT);
    d->sample = eva_between(-LIMIT, LIMIT);
    d->sample_to = eva_between(-LIMIT, LIMIT);
    d->sample_slope = eva_between(-LIMIT, LIMIT);
    d->cosine = eva_between(-1.1, 1.1);
    d->sine = eva_between(-1.1, 1.1);
    d->half_cosine = eva_between(-1.1, 1.1);
    d->half_sine = eva_between(-1.1, 1.1);
    d->omega_tick = eva_between(0.0, 3.2);
    d->phasor_valid = eva_bool();
    any_noise(&d->noise);
}

#endif
