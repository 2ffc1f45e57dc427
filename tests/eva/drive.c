/* drive.c - one change, sample or segment of any drive within its limits: no number leaves its type. */
#include "tests/eva/angles.h"
#include "tests/eva/any_drive.h"

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
