/* test_drive_change.c - a change of a drive: values that it keeps, and values that it begins anew. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include "firmware/plant/drive.h"

#define PER_TIME 40.0

static const double TURNS_PER_TICK = 0.01;
static const double TWO_64 = 18446744073709551616.0;

static struct drive_setting setting(double amplitude, double phase_turns, uint64_t ramp_ticks)
{
    return (struct drive_setting){amplitude, TURNS_PER_TICK, phase_turns, ramp_ticks};
}

static void run_segment(struct drive *d, uint32_t length)
{
    struct wave w;
    struct input at[3];
    drive_segment(d, length, PER_TIME, &w, &at[0], &at[1], &at[2]);
}

static void run_ticks(struct drive *d, int n)
{
    for (int i = 0; i < n; i++)
        run_segment(d, TICK_FRACTIONS);
}

static void change(struct drive *d, double amplitude, double phase_turns, uint64_t ramp_ticks)
{
    const struct drive_setting s = setting(amplitude, phase_turns, ramp_ticks);
    drive_change(d, &s);
}

static double turns(uint64_t phase)
{
    return (double)phase / TWO_64;
}

/* A drive that sounds, or is about to, goes on where it is; a silent one begins at its own phase. */
TEST(drive_change_phase)
{
    struct drive d;
    const struct drive_setting sounding = setting(1.0, 0.25, 0);
    drive_init(&d);
    drive_start(&d, &sounding);
    run_ticks(&d, 10);
    change(&d, 2.0, 0.5, 4);
    check_near("sounding: its carrier goes on", turns(d.carrier), 0.1, 1e-15);
    check_near("and the phase begins where it is", turns(d.offset), 0.25, 0.0);
    run_ticks(&d, 4);
    check_near("the ramp ends at the new phase", turns(d.offset), 0.5, 0.0);
    check_near("and amplitude", d.amplitude, 2.0, 0.0);
    change(&d, 0.0, 0.5, 4);
    run_ticks(&d, 2);
    change(&d, 3.0, 0.75, 4);
    check_near("on the way to silence: its carrier goes on", turns(d.carrier), 0.16, 1e-15);
    change(&d, 0.0, 0.75, 1);
    run_ticks(&d, 30);
    change(&d, 1.0, 0.125, 8);
    check_near("silent: its carrier begins anew", turns(d.carrier), 0.0, 0.0);
    check_near("at the new phase", turns(d.offset), 0.125, 0.0);
    change(&d, 1.0, 0.625, 8);
    check_near("told again at the same instant: the first phase is where it stands", turns(d.offset), 0.125,
               0.0);
}

/* One tick of a drive of period 1/frequency ticks whose phase changes by `change` turns: the wave is a cosine
 * of constant frequency that turns by both together. `part` of the tick, in 1/65536. */
static void one_tick_change(double frequency, double change_turns, uint32_t part)
{
    const double pi = 3.14159265358979324, share = (double)part / TICK_FRACTIONS;
    const double turned = (frequency + change_turns) * share, time = share / PER_TIME;
    const struct drive_setting sounding = {1.5, frequency, 0.125, 0};
    const struct drive_setting changed = {1.5, frequency, 0.125 + change_turns, 1};
    struct drive d;
    struct wave w;
    struct input at[3], u;
    drive_init(&d);
    drive_start(&d, &sounding);
    drive_change(&d, &changed);
    drive_segment(&d, part, PER_TIME, &w, &at[0], &at[1], &at[2]);
    check_near("omega, turns per time", w.omega / (2.0 * pi), turned / time, 1e-9 * PER_TIME);
    for (int i = 0; i < 3; i++) {
        double angle = 2.0 * pi * (0.125 + turned * i / 2.0);
        check_near("value", at[i].value, 1.5 * cos(angle), 1e-9);
        check_near("rate", at[i].rate, -1.5 * 2.0 * pi * turned / time * sin(angle), 1e-6);
        wave_at(&w, time * i / 2.0, &u);
        check_near("and the wave says the same", u.value, at[i].value, 1e-9);
    }
}

/* Together they may be more than half a turn: the wave runs forwards all the same. Backwards it runs only
 * where the change itself is backwards and more than the carrier makes good. */
TEST(drive_change_half_turn)
{
    static const double frequency[] = {0.0, 0.01, 0.05, 0.25, 0.4999};
    static const double change_turns[] = {0.3, 0.4, 0.45, 0.49, 0.4999, -0.3, -0.45, -0.4999};
    for (size_t i = 0; i < sizeof frequency / sizeof frequency[0]; i++) {
        for (size_t k = 0; k < sizeof change_turns / sizeof change_turns[0]; k++) {
            printf("      %g turns a tick, changed by %g turns\n", frequency[i], change_turns[k]);
            one_tick_change(frequency[i], change_turns[k], TICK_FRACTIONS);
            one_tick_change(frequency[i], change_turns[k], TICK_FRACTIONS - 1);
            one_tick_change(frequency[i], change_turns[k], TICK_FRACTIONS / 4);
        }
    }
}

/* Started in silence after it had sounded: what it once went to is forgotten. */
static void silenced(void)
{
    struct drive d;
    const struct drive_setting silence = setting(0.0, 0.25, 0);
    drive_init(&d);
    change(&d, 1.0, 0.0, 1);
    run_ticks(&d, 10);
    drive_start(&d, &silence);
    run_ticks(&d, 5);
    change(&d, 1.0, 0.125, 8);
    check_near("silenced and told again: its carrier begins anew", turns(d.carrier), 0.0, 0.0);
}

TEST(drive_change_target)
{
    silenced();
    struct drive d;
    drive_init(&d);
    change(&d, 2.0, 0.25, 0);
    check_int("a ramp of 0 ticks takes one", (int64_t)d.ramp_left, TICK_FRACTIONS);
    run_segment(&d, TICK_FRACTIONS - 1);
    struct drive_setting target = drive_target(&d);
    check_int("1/65536 tick before its end", (int64_t)d.ramp_left, 1);
    check_near("target amplitude", target.amplitude, 2.0, 0.0);
    check_near("target phase", target.phase_turns, 0.25, 0.0);
    check_near("target frequency", target.turns_per_tick, TURNS_PER_TICK, 0.0);
    check_int("a target has no ramp", (int64_t)target.ramp_ticks, 0);
    run_segment(&d, 1);
    check_near("target after the ramp", drive_target(&d).amplitude, 2.0, 0.0);
}

TEST(drive_change_begin)
{
    struct drive d;
    struct wave w;
    struct input at[3];
    const struct drive_setting first = setting(1.0, 0.0, 0), second = setting(1.0, 0.25, 0);
    drive_init(&d);
    check_near("a fresh phasor is (1, 0)", d.cosine + d.sine, 1.0, 0.0);
    check_near("and turns by nothing", d.half_cosine + d.half_sine, 1.0, 0.0);
    drive_start(&d, &first);
    run_ticks(&d, 3);
    drive_start(&d, &second);
    drive_segment(&d, TICK_FRACTIONS, PER_TIME, &w, &at[0], &at[1], &at[2]);
    check_near("started again a quarter turn on: begins at 0", at[0].value, 0.0, 1e-15);
    check_near("and goes down by the sine of its step", at[2].value, -sin(2.0 * M_PI * TURNS_PER_TICK),
               1e-15);
}

/* Just before the end of the longest ramp its position rounds
 * to 1: the phase then is the one commanded, to the last bit. */
TEST(drive_change_long)
{
    const struct drive_setting first = setting(1.0, 1e-6, 0);
    struct drive d;
    drive_init(&d);
    drive_start(&d, &first);
    change(&d, 1.0, 0.3, UINT64_C(137329101562499));
    d.ramp_left = TICK_FRACTIONS; /* all ticks but the last are over */
    run_segment(&d, TICK_FRACTIONS - 1);
    check_int("left of the ramp, 1/65536 tick", (int64_t)d.ramp_left, 1);
    check_hex("phase, turns * 2^64", d.offset, d.offset_to);
}

/* A new unit in the middle of a ramp, between two ticks: the ramp goes on. */
TEST(drive_change_rescale)
{
    const struct drive_setting first = setting(1.0, 0.1, 0);
    struct drive d;
    drive_init(&d);
    drive_start(&d, &first);
    change(&d, 3.0, 0.1, 8);
    run_ticks(&d, 4);
    drive_rescale(&d, 0.5);
    check_near("half of 2 in the middle", d.amplitude, 1.0, 0.0);
    run_ticks(&d, 4);
    check_near("half of 3 at the end", d.amplitude, 1.5, 0.0);
    check_int("which is reached", (int64_t)d.ramp_left, 0);
}
