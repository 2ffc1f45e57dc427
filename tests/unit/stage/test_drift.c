/* test_drift.c - slow faults of detector and piezo against closed forms: spectrum of 1/f noise, drift, creep,
 * third harmonic of a hysteresis. Then a drift in peak force tapping, alone and over a bus. */
#include "tests/unit/test.h"

#include <complex.h>
#include <math.h>
#include "firmware/afm/afm_plant.h"
#include "firmware/stage/stage.h"
#include "tests/fixture/afm/plant_bus.h"
#include "tests/fixture/bus.h"
#include "tests/fixture/imaginary.h"

#define PI 3.14159265358979323846

static struct stage stage;

static void make(double tick_s, enum stage_kind kind, double a, double b)
{
    const struct stage_part part = {kind, a, b};
    check_no_error("stage", stage_init(&stage, tick_s, 1, &part, 1));
}

/* ---- 1/f noise ---- */

#define CORNER  10.0
#define TICK_S  (0.01 / CORNER)
#define DENSITY 3.0

/* One-sided. */
static double closed(double f)
{
    return DENSITY * DENSITY * CORNER / f;
}

/* 13 poles from 10 corners down, two in a decade, each with the same variance. */
static double of_poles(double f)
{
    double sum = 0.0;
    for (int k = 0; k < 13; k++) {
        double pole = 10.0 * CORNER * pow(10.0, -0.5 * k);
        sum += 2.0 / PI * log(sqrt(10.0)) * DENSITY * DENSITY * CORNER * pole / (pole * pole + f * f);
    }
    return sum;
}

TEST(stage_flicker_poles)
{
    static const double band[][3] = {{4e-4, 0.28, 0.01}, {7e-5, 1.4, 0.05}}; /* corners; share */
    for (int i = 0; i < 2; i++) {
        double worst = 0.0;
        for (double f = band[i][0]; f <= band[i][1]; f *= 1.01)
            worst = fmax(worst, fabs(of_poles(f * CORNER) / closed(f * CORNER) - 1.0));
        check_is("largest distance of the poles' spectrum from 1/f", worst, <, band[i][2]);
    }
}

/* The noise at f by segments of four periods under Hann's window, whose three bins see f 3/4, 1 and 5/4. */
static void check_density(const float *noise, int n, double f)
{
    int length = (int)(4.0 / (f * TICK_S)), segments = n / length;
    double sum = 0.0;
    for (int k = 0; k < segments; k++) {
        double complex z = 0.0, turn = cexp(-i_unit * 2.0 * PI * 4.0 / length), at = 1.0;
        double complex window = cexp(i_unit * 2.0 * PI / length), wave = 1.0;
        for (int i = 0; i < length; i++, at *= turn, wave *= window)
            z += (double)noise[k * length + i] * (1.0 - creal(wave)) * at;
        sum += creal(z * conj(z)) * 2.0 * TICK_S / (1.5 * length);
    }
    double seen = (closed(0.75 * f) + 4.0 * closed(f) + closed(1.25 * f)) / 6.0;
    check_near("density over that of the closed form", sum / segments / seen, 1.0, 4.0 / sqrt(segments));
}

TEST(stage_flicker_spectrum)
{
    enum { TICKS = 4 << 20 };
    static float noise[TICKS];
    make(TICK_S, STAGE_FLICKER, CORNER, DENSITY);
    for (int i = 0; i < TICKS; i++)
        noise[i] = (float)stage_run(&stage, 0.0);
    for (double f = 0.512; f > 3e-3; f /= 2.0)
        check_density(noise, TICKS, f * CORNER);
}

/* A function of seed and tick: another seed has another noise; a settled stage begins at 0 again. */
TEST(stage_flicker_seed)
{
    const struct stage_part part = {STAGE_FLICKER, 10.0, 1.0};
    double first[2];
    for (unsigned i = 0; i < 2; i++) {
        check_no_error("stage", stage_init(&stage, 1e-3, i, &part, 1));
        first[i] = stage_run(&stage, 0.0);
    }
    check_true("another seed", first[0] != first[1]);
    for (int i = 0; i < 100; i++)
        (void)stage_run(&stage, 0.0);
    stage_settle(&stage, 2.0, 0);
    check_near("settled", stage.result, 2.0, 0.0);
    check_near("and anew", stage_run(&stage, 0.0), first[1], 0.0);
}

/* ---- drift ---- */

TEST(stage_drift_line)
{
    double worst = 0.0;
    make(1e-3, STAGE_DRIFT, -0.25, 0.0);
    stage_settle(&stage, 5.0, 17);
    check_near("from 0", stage.result, 5.0, 0.0);
    for (int i = 1; i <= 100000; i++)
        worst = fmax(worst, fabs(stage_run(&stage, 3.0) - (3.0 - 0.25e-3 * i)));
    check_near("largest distance from the line", worst, 0.0, 1e-13);
}

/* ---- the piezo ---- */

/* y = 1 + g log10(t/t0); t0 = 0.1 s/10^(1/4 + 0.5772../ln 10): half a lag before the first, and Euler's
 * constant. */
TEST(stage_creep_law)
{
    const double share = 0.02, t0 = 0.1 * pow(10.0, -0.25 - 0.57721566490153286 / log(10.0));
    double worst = 0.0;
    make(1e-3, STAGE_CREEP, share, 0.0);
    for (int i = 1; i <= 3000000; i++) {
        double y = stage_run(&stage, 1.0);
        if (i >= 1000)
            worst = fmax(worst, fabs((y - 1.0) / share - log10(i * 1e-3 / t0)));
    }
    check_near("t0, s", t0, 0.0316, 1e-4);
    check_is("largest distance from 1 s to 3000 s, decades", worst, <, 0.01);
}

/* The integral of e^(-i n a) from `from` to `to`. */
static double complex turned(int n, double from, double to)
{
    return (cexp(-i_unit * n * to) - cexp(-i_unit * n * from)) / (-i_unit * n);
}

/* Harmonic 3 of a play of half width r under A cos a. It stays at A - r until cos a = 1 - 2 r/A, then is
 * A cos a + r. The other half of the period has the other sign. */
static double complex third_of_play(double r, double amplitude)
{
    double free = acos(1.0 - 2.0 * r / amplitude);
    double complex moves =
        0.5 * amplitude * (turned(2, free, PI) + turned(4, free, PI)) + r * turned(3, free, PI);
    return 2.0 / PI * ((amplitude - r) * turned(3, 0.0, free) + moves);
}

TEST(stage_hysteresis_third_harmonic)
{
    enum { POINTS = 100000 };
    const double amplitude = 0.9, share = 0.15;
    double complex got = 0.0, expected = 0.0;
    for (int i = 1; i < 8; i++)
        expected += share / 7.0 * third_of_play(i / 16.0, amplitude);
    make(1e-3, STAGE_HYSTERESIS, 1.0, share);
    for (int i = 0; i < 2 * POINTS; i++) {
        double angle = 2.0 * PI * i / POINTS, y = stage_run(&stage, amplitude * cos(angle));
        if (i >= POINTS)
            got += 2.0 / POINTS * y * cexp(-i_unit * 3.0 * angle);
    }
    check_is("third harmonic, share of the amplitude", cabs(expected) / amplitude, >, 5e-3);
    check_near("distance from the closed form", cabs(got - expected), 0.0, 1e-8);
}

/* ---- peak force tapping ---- */

static void run_sensor(void *who, double *value, uint32_t n)
{
    stage_run_many(who, value, n);
}

/* 10 nm a minute, here 120 times as fast: after half a second the detector is off by 10 nm, or 20 nN. */
TEST(stage_drift_in_peak_force)
{
    static struct station station;
    static const struct microscope_in in = {.z_m = 0.0};
    double si[LEVER_PARAMETERS], number[STATION_NUMBERS], height = 0.0;
    for (int i = 0; i < LEVER_PARAMETERS; i++)
        si[i] = afm_lever.parameter[i].initial;
    si[LEVER_Q] = 20.0;
    station_defaults(number);
    number[STATION_TICKS] = 2.0;
    number[STATION_KI] = 800.0;
    number[STATION_PEAK_FORCE] = 5e-9;
    const double tick_s = 1.0 / (64.0 * si[LEVER_F0]);
    const struct station_config c = {
        .si = si, .tick_s = tick_s, .number = number, .sensor = {run_sensor, &stage}};
    make(tick_s, STAGE_DRIFT, 20e-9, 0.0);
    check_no_error("station", station_init(&station, &c));
    for (int i = 0; (double)i * station.sample_s < 0.6 && station_run(&station, &in); i++)
        if ((double)i * station.sample_s < 0.1)
            height = station.swing.cycle.low_m;
    check_near("baseline, nN", station.swing.cycle.baseline_N * 1e9, 24.0, 0.1);
    check_near("height after a drift of 10 nm, nm", station.swing.cycle.low_m * 1e9, height * 1e9, 0.01);
    check_near("peak, nN", station.swing.cycle.peak_N * 1e9, 5.0, 0.005);
}

/* The mean over the last frame of what this slot reads, as the bus says it: size and sign. */
static double heard(const struct bus *bus, int slot)
{
    double mean = (double)NAN;
    for (int i = 0; i < bus->n_seen; i++) {
        const struct message *m = &bus->seen[i];
        if (m->kind == WIRE_LOCKIN && m->value[LOCKIN_SLOT] == slot)
            mean = m->value[LOCKIN_AMPLITUDE] * cos(m->value[LOCKIN_PHASE]);
    }
    return mean;
}

/* Slots 12 to 15 of a microscope are those of the last cycle; here under a drift of its sensor. */
TEST(stage_cycle_over_a_bus)
{
    static struct bus bus;
    static double scratch[METHOD_SCRATCH];
    double si[MODEL_PARAMETERS], setting[SETTINGS], *number = si + AFM_PLANT_NUMBERS;
    plant_bus_defaults(si, setting, 1e-3);
    si[LEVER_Q] = 20.0;
    number[STATION_TICKS] = 2.0;
    number[STATION_KI] = 800.0;
    number[STATION_PEAK_FORCE] = 5e-9;
    for (int i = 0; i < LOCKIN_SLOTS; i++)
        setting[SET_LOCKIN_OUTPUT + i] = MODEL_OUTPUTS + i;
    setting[SET_STAGE + STAGE_AT] = 1 + MODEL_INPUTS + AFM_PLANT_DISPLACEMENT;
    setting[SET_STAGE + STAGE_SET_DRIFT] = 20e-9;
    struct app_config c = plant_bus_config(si, setting, 2240, scratch);
    bus_start_running(&bus, &c);
    const struct force_cycle *cycle = &afm_plant_station(scratch)->swing.cycle;
    bus_run(&bus, 200);
    check_near("snap-in, nN", heard(&bus, 0) * 1e9, cycle->snap_in_N * 1e9, 1e-3);
    check_is("  which is one", cycle->snap_in_N * 1e9, >, 3.0);
    check_near("baseline, nN", heard(&bus, 1) * 1e9, 20e-9 * 0.2 * si[LEVER_K] * 1e9, 0.1);
    check_near("deformation, nm", heard(&bus, 2) * 1e9, cycle->deformation_m * 1e9, 1e-3);
    check_near("work, aJ", heard(&bus, 3) * 1e18, cycle->work_J * 1e18, 1e-2);
}
