/* drive.c - one change, sample or segment of any drive within its limits: no number leaves its type. */
#include "tests/eva/angles.h"
#include "tests/eva/any_drive.h"

static double any_double(void)
{
    double x;
    eva_any(&x, sizeof x);
    return x;
}

static void change(void)
{
    struct drive d;
    const struct drive_setting s = {any_double(), eva_between(0.0, SEAM_TURNS),
                                    eva_between(-SEAM_PHASE, SEAM_PHASE),
                                    Frama_C_unsigned_long_interval(0, SEAM_RAMP)};
    any_drive(&d);
    drive_change(&d, &s);
    ASSERT(d.step <= SEAM_STEP && d.step_from <= SEAM_STEP && d.step_to <= SEAM_STEP);
    any_drive(&d);
    drive_start(&d, &s);
    (void)drive_target(&d);
    any_drive(&d);
    drive_sample(&d, any_double(), Frama_C_unsigned_long_interval(0, SEAM_RAMP));
    drive_rescale(&d, any_double());
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
    struct segment e;
    any_drive(&d);
    for (int i = 0; i < MODEL_INPUTS; i++) {
        e.wave[i] = (struct wave){0};
        for (int k = 0; k < 3; k++)
            e.at[k][i] = (struct input){any_double(), any_double()};
    }
    const struct noise_span s = {eva_word(), eva_between(0.0, 1.0), eva_between(0x1p-16, 1.0),
                                 eva_between(0.0, 1.0), eva_between(1e-9, 1e12)};
    (void)noise_add(&d.noise, &s, &e, Frama_C_interval(0, MODEL_INPUTS - 1));
    const struct noise_setting to = {any_double(), eva_uint(0, NOISE_HOLD_MAX), eva_uint(0, UINT32_MAX)};
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
