/* drive.c - one change, sample or segment of any drive within its limits: no number leaves its type. The limits are those that
 * arm_accepts, setting_accepts and plant_init allow; a ramp's remains is at most its length. */
/* Under another name, so that its turns_of, which resists (docs/PROOFS.md), can stand back: a phase is any integer. */
#define turns_of turns_of_proved_elsewhere
#include "models/elementary.c"
#undef turns_of
uint64_t turns_of(double turns);

#include "firmware/drive.h"
#include "tests/eva/eva.h"

uint64_t turns_of(double turns)
{
    (void)turns;
    return eva_word();
}

#define LIMIT (2.0 * DRIVE_LIMIT)
#define RAMP  ((uint64_t)41 << 40) /* ticks: 1e4 s in ticks of 1e-6/4096 s */

static void any_drive(struct drive *d)
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
    d->asleep = eva_bool();
    d->noise.level = eva_between(0.0, LIMIT);
    d->noise.level_from = eva_between(0.0, LIMIT);
    d->noise.x = eva_between(0.0, 1.0);
    d->noise.rest = eva_between(-LIMIT, LIMIT);
    d->noise.value = eva_between(-LIMIT, LIMIT);
    d->noise.here = eva_between(-NOISE_PEAK, NOISE_PEAK);
    d->noise.next = eva_between(-NOISE_PEAK, NOISE_PEAK);
    d->noise.hold = eva_uint(1, NOISE_HOLD_MAX);
    d->noise.straight = eva_bool();
    d->noise.active = eva_bool();
    d->noise.anew = eva_bool();
    d->noise.known = eva_bool();
}

static void change(void)
{
    struct drive d;
    const struct drive_setting s = {eva_between(-DRIVE_LIMIT, DRIVE_LIMIT), eva_between(0.0, 0.125),
                                    eva_between(-1.6e5, 1.6e5), Frama_C_unsigned_long_interval(0, RAMP)};
    any_drive(&d);
    drive_change(&d, &s);
    any_drive(&d);
    drive_start(&d, &s);
    (void)drive_target(&d);
    any_drive(&d);
    drive_sample(&d, eva_between(-DRIVE_LIMIT, DRIVE_LIMIT), Frama_C_unsigned_long_interval(0, RAMP));
    drive_rescale(&d, eva_between(1e-30, 1e30));
    drive_init(&d);
}

static void segment(bool whole)
{
    struct drive d;
    struct wave w;
    struct input u[3];
    any_drive(&d);
    uint32_t length = whole ? (uint32_t)TICK_FRACTIONS : eva_uint(1, TICK_FRACTIONS);
    (void)drive_segment(&d, length, eva_between(1e-9, 1e12), &w, &u[0], &u[1], &u[2]);
}

static void noise(void)
{
    struct drive d;
    struct excitation e;
    any_drive(&d);
    for (int i = 0; i < MODEL_INPUTS; i++) {
        e.wave[i] = (struct wave){0};
        for (int k = 0; k < 3; k++)
            e.at[k][i] = (struct input){eva_between(-LIMIT, LIMIT), eva_between(-1e30, 1e30)};
    }
    const struct noise_span s = {eva_word(), eva_between(0.0, 1.0), eva_between(0x1p-16, 1.0),
                                 eva_between(0.0, 1.0), eva_between(1e-9, 1e12)};
    (void)noise_add(&d.noise, &s, &e, Frama_C_interval(0, MODEL_INPUTS - 1));
    const struct noise_setting to = {eva_between(0.0, NOISE_LIMIT), eva_uint(0, NOISE_HOLD_MAX),
                                     eva_uint(0, 16777215)};
    noise_leave(&d.noise);
    noise_aim(&d.noise, &to);
}

int main(void)
{
    change();
    segment(true);
    segment(false);
    noise();
    return 0;
}
