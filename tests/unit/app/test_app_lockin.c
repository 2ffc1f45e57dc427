/* test_app_lockin.c - LOCKIN over the wire at every frequency and window, against the closed form of the
 * linear rig, 1/(k - m w^2 + i w c). */
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include "models/math/elementary.h"
#include "models/hertz_rig.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { TICKS = 64, SETTLED = 1600 /* frames */ };
#define TWO_PI 6.283185307179586477
#define J      ((double complex)I) /* I is a complex float */

static struct bus bus;

static double complex response(double hertz)
{
    const double *si = bus.app.plant.si;
    double zs =
        cbrt(si[RIG_PRELOAD] / si[RIG_CONTACT_STIFFNESS] * (si[RIG_PRELOAD] / si[RIG_CONTACT_STIFFNESS]));
    double k = 1.5 * si[RIG_PRELOAD] / zs, w = TWO_PI * hertz;
    return 1.0 / (k - si[RIG_MASS] * w * w + J * si[RIG_DAMPING] * w);
}

static void start(const struct model *m)
{
    struct app_config c = bus_config();
    c.model = m;
    c.substeps = TICKS;
    bus_start_running(&bus, &c);
}

/* Arms a drive and lets it sound with the next frame. */
static void sound(int input, double amplitude, double hertz, double ramp_s)
{
    bus_drive(&bus, input, amplitude, hertz, 0.3, ramp_s);
    bus_fire(&bus, 1u << input, false, bus.app.plant.now.tick + 2 * TICKS, 0);
    bus_run(&bus, 3);
}

static void run(int frames)
{
    for (int i = 0; i < frames; i += 100) {
        bus_forget(&bus);
        bus_run(&bus, 100);
    }
}

/* The last result of a slot in windows of so many frames; NaN: not available. */
static double complex slot(int i, int frames)
{
    double complex z = 0.0;
    bus_set(&bus, SETTING_FIRST + SET_LOCKIN_FRAMES, frames);
    bus_forget(&bus);
    bus_run(&bus, frames + 4);
    for (int k = 0; k < bus.n_seen; k++) {
        const struct message *m = &bus.seen[k];
        if (m->kind == WIRE_LOCKIN && m->value[LOCKIN_SLOT] == i)
            z = m->value[LOCKIN_AMPLITUDE] * cexp(J * m->value[LOCKIN_PHASE]);
    }
    return z;
}

static void check_slot(int i, double hertz, int frames, double complex right, double within)
{
    double complex z = slot(i, frames);
    check_below(
        check_name("slot %d: %g Hz, %d frames: |z| %.4g m, off the closed form", i, hertz, frames, cabs(z)),
        cabs(z / right - 1.0), within);
}

TEST(app_lockin_everywhere)
{
    static const double hertz[] = {3.0,   7.3,   11.7,  23.0,  43.7,   63.3,
                                   97.77, 225.0, 331.0, 613.7, 1234.5, 2000.0};
    static const int window[] = {10, 13, 37, 100, 333, 1000};
    for (int i = 0; i < 12; i++) {
        start(&hertz_rig_linear);
        sound(RIG_FORCE, 1.0, hertz[i], 0.0);
        run(SETTLED);
        for (int k = 0; k < 6; k++) {
            double periods = hertz[i] * 1e-3 * window[k];
            uint32_t before = bus.app.lockin.n_short;
            if (periods >= 1.0) {
                check_slot(0, hertz[i], window[k], response(hertz[i]), 1e-3);
                continue;
            }
            check_true("not available below one period a window", isnan(creal(slot(0, window[k]))));
            check_above("counted by cause", bus.app.lockin.n_short, before);
        }
    }
}

/* Each drive's tone is told beside the others', twenty times as large, and no harmonic is seen where there is
 * none. */
TEST(app_lockin_beside)
{
    static const double hertz[][2] = {
        {97.77, 137.1}, {43.7, 63.3}, {225.0, 251.3}, {613.7, 43.7}, {331.0, 3.0}};
    for (int i = 0; i < 5; i++) {
        start(&hertz_rig_linear);
        bus_set(&bus, SETTING_FIRST + SET_LOCKIN_HARMONIC + 1, 3.0);
        bus_set(&bus, SETTING_FIRST + SET_LOCKIN_CHANNEL + 1, RIG_FORCE);
        sound(RIG_FORCE, 0.5, hertz[i][0], 0.0);
        sound(RIG_FAST_FORCE, 10.0, hertz[i][1], 0.0);
        run(SETTLED);
        for (int frames = 50; frames <= 200; frames += 75) {
            double complex right = 0.5 * response(hertz[i][0]);
            check_slot(0, hertz[i][0], frames, right, 1e-3);
            if (hertz[i][1] * 1e-3 * frames >= 1.0)
                check_slot(3, hertz[i][1], frames, 10.0 * response(hertz[i][1]), 1e-3);
            check_below("harmonic 3 of the first, m", cabs(slot(1, frames)), 1e-4 * cabs(right));
            check_below("harmonic 2, m", cabs(slot(2, frames)), 1e-4 * cabs(right));
        }
    }
}

/* Drives of one frequency have one tone. A beat of less than three quarters of a window is not told. */
TEST(app_lockin_near)
{
    static const double other[] = {120.0, 123.0, 128.0};
    for (int i = 0; i < 3; i++) {
        start(&hertz_rig_linear);
        sound(RIG_FORCE, 1.0, 120.0, 0.0);
        sound(RIG_FAST_FORCE, 1.0, other[i], 0.0);
        run(SETTLED);
        double turns = turns_to_double(bus.app.plant.drive[RIG_FAST_FORCE].carrier -
                                       bus.app.plant.drive[RIG_FORCE].carrier);
        double complex both = response(120.0) * (1.0 + cexp(J * TWO_PI * turns));
        if (i == 1) {
            check_true("not available", isnan(creal(slot(0, 100))));
            check_above("counted by cause", bus.app.lockin.n_close, 0);
            check_near("HEALTH tells", bus_item(&bus, WIRE_HEALTH, DIAG_LOCKIN_SHORT), 0.0, 0.0);
        } else
            check_slot(0, 120.0, 100, i == 0 ? both : response(120.0), 1e-3);
    }
}

/* A slow sweep: windows of few periods follow the response, though the mean is a hundred times as large. */
TEST(app_lockin_sweep)
{
    start(&hertz_rig_linear);
    sound(RIG_FORCE, 1.0, 35.0, 0.0);
    run(SETTLED);
    bus_drive(&bus, RIG_FORCE, 1.0, 55.0, 0.3, 20.0);
    bus_fire(&bus, 1u << RIG_FORCE, false, bus.app.plant.now.tick + 2 * TICKS, 0);
    double worst = 0.0;
    for (int i = 0; i < 50; i++) {
        run(200);
        double complex z = slot(0, 100);
        double now = drive_turns_per_tick(&bus.app.plant.drive[RIG_FORCE]) * 1e3 * TICKS;
        worst = fmax(worst, cabs(z / response(now) - 1.0));
    }
    check_below("off the response at its frequency", worst, 3e-4);
}

/* Windows in which the tones of two strong drives can hardly be told apart: neither is seen as a harmonic. */
TEST(app_lockin_harmonic_alone)
{
    static const double hertz[][2] = {{37.877, 38.917}, {38.589, 38.434}, {11.113, 10.79}};
    static const int frames[] = {20, 47, 61};
    for (int i = 0; i < 3; i++) {
        start(&hertz_rig_linear);
        bus_set(&bus, SETTING_FIRST + SET_LOCKIN_CHANNEL + 1, RIG_FORCE);
        sound(RIG_FORCE, 0.5, hertz[i][0], 0.0);
        sound(RIG_FAST_FORCE, 10.0, hertz[i][1], 0.0);
        run(SETTLED);
        int told = 0;
        for (int n = 2; n <= 4; n++) {
            bus_set(&bus, SETTING_FIRST + SET_LOCKIN_HARMONIC + 1, n);
            double complex z = slot(1, frames[i]);
            if (isnan(creal(z)))
                continue;
            check_below("of the strong one's motion", cabs(z / (10.0 * response(hertz[i][1]))), 1e-8);
            told++;
        }
        check_above("harmonics that are told", told, 1);
    }
}

/* At 8 ticks a period the samples of harmonics 7 and 1 are equal: 7 is not told. */
TEST(app_lockin_folded)
{
    static const bool told[] = {true, true, false, false, false};
    start(&hertz_rig_linear);
    bus_set(&bus, SETTING_FIRST + SET_LOCKIN_CHANNEL + 1, RIG_FORCE);
    sound(RIG_FORCE, 1.0, 1e3 * TICKS / 8.0, 0.0);
    run(SETTLED);
    for (int n = 2; n <= 6; n++) {
        bus_set(&bus, SETTING_FIRST + SET_LOCKIN_HARMONIC + 1, n + (n > 3));
        double complex z = slot(1, 100);
        printf("      harmonic %d: %g m\n", n + (n > 3), cabs(z));
        check_int("told", !isnan(creal(z)), told[n - 2]);
    }
}

/* A slot measures its own output, also where that is not the first one, or is that of a slot whose drive is
 * silent. Harmonic 2 of the velocity is 2 i w times that of the displacement. */
TEST(app_lockin_outputs)
{
    static const double output[] = {0, 1, 0, 0}, channel[] = {RIG_BASE, RIG_FORCE, RIG_FORCE, RIG_FORCE};
    const double hertz = 250.0;
    start(&hertz_rig);
    for (int i = 0; i < LOCKIN_SLOTS; i++) {
        bus_set(&bus, SETTING_FIRST + SET_LOCKIN_OUTPUT + (unsigned)i, output[i]);
        bus_set(&bus, SETTING_FIRST + SET_LOCKIN_CHANNEL + (unsigned)i, channel[i]);
        bus_set(&bus, SETTING_FIRST + SET_LOCKIN_HARMONIC + (unsigned)i, i == 3 ? 1 : 2);
    }
    sound(RIG_FORCE, 0.5, hertz, 0.0);
    run(SETTLED);
    check_slot(3, hertz, 40, 0.5 * response(hertz), 1e-3);
    check_slot(1, hertz, 40, 2.0 * J * TWO_PI * hertz * slot(2, 40), 1e-5);
    check_true("a slot whose drive is silent says nothing", cabs(slot(0, 40)) == 0.0);
}
