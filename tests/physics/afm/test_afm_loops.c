/* test_afm_loops.c - the AFM station's loops beside closed
 * forms: ultimate gains, parachuting, PLL and heat, DART. */
#include "tests/unit/test.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/afm/station.h"
#include "tests/fixture/imaginary.h"

#define TWO_PI 6.283185307179586
#define K_B    1.380649e-23

static struct station station;
static double si[LEVER_PARAMETERS], number[STATION_NUMBERS];

/* The lever `tapping` at 64 ticks a period, cold, far from the sample, every loop off. */
static void take_defaults(void)
{
    for (int i = 0; i < LEVER_PARAMETERS; i++)
        si[i] = afm_lever.parameter[i].initial;
    station_defaults(number);
    number[STATION_Z_LOOP] = 0.0;
}

static void start_station(void)
{
    struct station_config c = {.si = si, .tick_s = 1.0 / (64.0 * si[LEVER_F0]), .number = number};
    check_no_error("station", station_init(&station, &c));
}

static void run(double seconds, const struct microscope_in *in)
{
    long n = lround(seconds / station.sample_s);
    bool good = true;
    for (long i = 0; i < n && good; i++)
        good = station_run(&station, in);
    check_true("finite", good);
}

/* ---- z loop: ultimate gain of an integrator behind the lever's pole and a delay ---- */

/* An integrator and a delay: a controller of the user's own. Returns the largest error of the amplitude in
 * the last quarter over that in the second one. The controller sets what the lever's pole sees: free
 * amplitude. */
static double growth(double gain, long delay, double seconds)
{
    static double past[65536];
    double sum = 20e-9, early = 0.0, late = 0.0;
    long n = lround(seconds / station.sample_s);
    for (long i = 0; i < n; i++) {
        double error = station.lockin[0].amplitude - 14e-9;
        sum -= gain * error * station.sample_s;
        past[i % delay] = sum;
        double applied = past[(i + 1) % delay];
        station.microscope.tone[0].force_N = station.free_force * (i < delay ? 20e-9 : applied);
        if (!station_run(&station, &(struct microscope_in){0}))
            return (double)NAN;
        if (i > n / 4 && i <= n / 2)
            early = fmax(early, fabs(error));
        if (i > n / 4 * 3)
            late = fmax(late, fabs(error));
    }
    return late / early;
}

/* Ku and its frequency by the phase condition; `poles` of the detector at rate w each. */
static double closed_form(double tau, double delay, double rate, double *frequency)
{
    double low = 1.0, high = 1e6;
    for (int i = 0; i < 200; i++) {
        double w = 0.5 * (low + high);
        double lag = w * delay + atan(w * tau) + (rate > 0.0 ? 2.0 * atan(w / rate) : 0.0);
        if (lag > TWO_PI / 4.0)
            high = w;
        else
            low = w;
    }
    *frequency = low / TWO_PI;
    return low * sqrt(1.0 + low * low * tau * tau) * (rate > 0.0 ? 1.0 + low * low / (rate * rate) : 1.0);
}

TEST(afm_z_loop_ultimate_gain)
{
    static const struct {
        double delay, gain, hz;
    } row[] = {{1e-4, 10090.5, 369.79}, {5e-4, 2086.34, 159.62}, {1e-3, 1081.42, 108.22}};
    for (int i = 0; i < 3; i++) {
        take_defaults();
        number[STATION_BANDWIDTH] = 20e3;
        start_station();
        double hz, rate = TWO_PI * number[STATION_BANDWIDTH], tau = station_ring_time(si);
        check_near(check_name("delay %g ms: Ku, 1/s", row[i].delay * 1e3),
                   closed_form(tau, row[i].delay, 0.0, &hz), row[i].gain, 1e-4 * row[i].gain);
        check_near("  its frequency, Hz", hz, row[i].hz, 0.01);
        long delay = lround(row[i].delay / station.sample_s);
        double low = 0.3 * row[i].gain, high = 1.5 * row[i].gain,
               with = closed_form(tau, row[i].delay, rate, &hz);
        for (int k = 0; k < 7; k++) {
            double gain = sqrt(low * high);
            start_station();
            if (growth(gain, delay, 12.0 / row[i].hz) > 1.0)
                high = gain;
            else
                low = gain;
        }
        check_near("  measured, beside the form with the detector's poles", sqrt(low * high), with,
                   0.05 * with);
        if (row[i].delay >= 5e-4)
            check_near("  measured, beside the form without", sqrt(low * high), row[i].gain,
                       0.05 * row[i].gain);
    }
}

/* ---- parachuting ---- */

TEST(afm_parachute)
{
    take_defaults();
    si[LEVER_HAMAKER] = si[LEVER_HAMAKER_OUT] = 0.0;
    si[LEVER_HEIGHT] = 40e-9;
    number[STATION_Z_LOOP] = 1.0;
    number[STATION_SURFACE] = SURFACE_STEP;
    number[STATION_SURFACE_HEIGHT] = -50e-9;
    start_station();
    struct microscope_in in = {0.0, 0.0, 0.0, 0.0};
    run(0.06, &in);
    double before = station.in.z_m, touch = 0.0, at[2] = {0.0, 0.0}, tau = station_ring_time(si);
    check_near("amplitude at the set point, nm", station.lockin[0].amplitude * 1e9, 14.0, 0.05);
    in.x_m = 1e-6;
    for (long i = 0; touch == 0.0 && i < 1000000; i++) {
        if (!station_run(&station, &in))
            break;
        double t = (double)(i + 1) * station.sample_s;
        if (fabs(t - 15e-3) < 0.5 * station.sample_s)
            at[0] = station.in.z_m;
        if (fabs(t - 20e-3) < 0.5 * station.sample_s)
            at[1] = station.in.z_m;
        if (t > 1e-3 && station.out.peak_N > 0.0)
            touch = t;
    }
    check_near("speed of z, m/s", -(at[1] - at[0]) / 5e-3, 1.65e-6, 0.03 * 1.65e-6);
    check_near("touches again after, s", touch, 2.84856e-2, 0.03 * 2.84856e-2);
    check_near("  as tau + 44 nm/(Ki 6 nm), s", tau + 44e-9 / 1.65e-6, 2.84856e-2, 1e-6);
    check_near("z has gone down by, nm", (before - station.in.z_m) * 1e9, 44.0, 1.5);
}

/* ---- PLL ---- */

/* Mean frequency over the last half of `seconds`. */
static double mean_frequency(double seconds)
{
    long n = lround(seconds / station.sample_s);
    double sum = 0.0;
    for (long i = 0; i < n; i++) {
        if (!station_run(&station, &(struct microscope_in){0}))
            return (double)NAN;
        sum += i >= n / 2 ? station.frequency_Hz - si[LEVER_F0] : 0.0;
    }
    return sum / (double)(n - n / 2);
}

TEST(afm_pll_offset)
{
    take_defaults();
    number[STATION_PLL] = 1.0;
    number[STATION_FREQUENCY] = 70e3 + 80.0;
    start_station();
    /* the resonance of the velocity, at which the phase of the deflection is -90 degrees, is f0 itself */
    check_near("locked from 80 Hz away, Hz off f0", mean_frequency(0.1), 0.0, 0.01);
    check_near("  phase, rad", demodulator_phase(&station.lockin[0]), -TWO_PI / 4.0, 1e-3);
    double lag = TWO_PI * 2.5 / 64.0, closed = si[LEVER_F0] * tan(lag) / (2.0 * si[LEVER_Q]);
    number[STATION_PLL_PHASE] += lag;
    start_station();
    check_near("offset by a lag of 2.5 ticks of 64, closed form, Hz", closed, 21.918, 1e-3);
    check_near("  measured, Hz", -mean_frequency(0.1), closed, 0.01 * closed);
    check_near("phase slope, rad/Hz", 2.0 * si[LEVER_Q] / si[LEVER_F0], 0.011428571, 1e-9);
}

/* White noise of the frequency, one-sided f0 kT/(pi k A^2 Q) per Hz: half of it over T is the variance of the
 * mean over T. The loop is a low-pass of rate 2 Q ki/f0, which takes a part away. */
TEST(afm_pll_heat)
{
    take_defaults();
    si[LEVER_TEMPERATURE] = 295.0;
    number[STATION_PLL] = 1.0;
    number[STATION_DRIVE] = 10e-9;
    number[STATION_PLL_KI] = 200e3;
    number[STATION_PLL_KP] = 200e3 * station_ring_time(si);
    start_station();
    (void)mean_frequency(0.02);
    enum { BLOCKS = 160 };
    double T = 0.01, sum = 0.0, square = 0.0, lag = si[LEVER_F0] / (2.0 * si[LEVER_Q] * 200e3);
    long n = lround(T / station.sample_s);
    for (int b = 0; b < BLOCKS; b++) {
        double mean = 0.0;
        for (long i = 0; i < n; i++) {
            if (!station_run(&station, &(struct microscope_in){0}))
                return;
            mean += (station.frequency_Hz - si[LEVER_F0]) / (double)n;
        }
        sum += mean;
        square += mean * mean;
    }
    double density = si[LEVER_F0] * K_B * 295.0 / (TWO_PI / 2.0 * 2.0 * 1e-16 * si[LEVER_Q]);
    double variance = square / BLOCKS - sum / BLOCKS * (sum / BLOCKS);
    double expected = 0.5 * density / T * (1.0 - lag / T);
    check_near("thermal noise of the lever stiff, closed form, Hz",
               sqrt(300e3 * K_B * 295.0 * 1e3 / (TWO_PI / 2.0 * 40.0 * 1e-16 * 450.0)), 0.464838, 1e-6);
    check_near("  and soft", sqrt(13e3 * K_B * 295.0 * 1e3 / (TWO_PI / 2.0 * 0.2 * 1e-16 * 30.0)), 5.29997,
               1e-5);
    check_near("thermal noise of the frequency in 1 kHz, A 10 nm, closed form, Hz", sqrt(density * 1e3),
               1.06508, 1e-4);
    check_near("  measured, Hz", sqrt(variance / expected * density * 1e3), 1.06508,
               4.0 * 1.06508 / sqrt(2.0 * BLOCKS));
    check_near("  mean, Hz", sum / BLOCKS, 0.0, 4.0 * sqrt(expected / BLOCKS));
}

/* ---- DART ---- */

static double complex oscillator(double f, double f0, double quality)
{
    return 1.0 / (1.0 - f * f / (f0 * f0) + i_unit * f / (f0 * quality));
}

/* Resonance and quality of a simple harmonic oscillator from its amplitudes and phases (rad, negative for a
 * lag) at two drives of equal force (Rodriguez et al. 2007).
 *
 * With Om = f1 A1/(f2 A2) and D = p2 - p1: cot p1 = (1/Om - cos D)/sin D, cot p2 = (cos D - Om)/sin D, and
 * for each drive f0^2 = f^2 - f (f0/Q) cot p. */
static void find_resonance(const double f_Hz[2], const double amplitude[2], const double phase[2],
                           double *f0_Hz, double *quality)
{
    double apart = phase[1] - phase[0], c = cos(apart), s = sin(apart);
    double ratio = f_Hz[0] * amplitude[0] / (f_Hz[1] * amplitude[1]);
    double first = (1.0 / ratio - c) / s, second = (c - ratio) / s;
    double width = (f_Hz[1] * f_Hz[1] - f_Hz[0] * f_Hz[0]) / (f_Hz[1] * second - f_Hz[0] * first);
    double square = f_Hz[0] * (f_Hz[0] - width * first);
    *f0_Hz = sqrt(square);
    *quality = *f0_Hz / width;
}

TEST(afm_dart_recovery)
{
    double f[2] = {348e3, 352e3}, a[2], p[2], f0, quality;
    for (int i = 0; i < 2; i++) {
        double complex z = oscillator(f[i], 350e3, 120.0);
        a[i] = cabs(z);
        p[i] = carg(z);
    }
    check_near("A at 348 kHz", a[0], 70.973765706, 1e-9);
    check_near("A at 352 kHz", a[1], 70.429516054, 1e-9);
    check_near("phase at 348 kHz, rad", p[0], -0.628668496, 1e-9);
    check_near("phase at 352 kHz, rad", p[1], -2.510203801, 1e-9);
    double slope =
        (cabs(oscillator(348e3 + 1.0, 350e3, 120.0)) - cabs(oscillator(352e3 + 1.0, 350e3, 120.0)) -
         cabs(oscillator(348e3 - 1.0, 350e3, 120.0)) + cabs(oscillator(352e3 - 1.0, 350e3, 120.0))) /
        2.0;
    check_near("slope of A2 - A1 over the frequency, 1/Hz", -slope, -4.615813487e-2, 1e-7);
    find_resonance(f, a, p, &f0, &quality);
    check_near("f0, Hz", f0, 350e3, 350e3 * 1e-9);
    check_near("Q", quality, 120.0, 120.0 * 1e-9);
}

TEST(afm_dart_tracking)
{
    take_defaults();
    si[LEVER_F0] = 350e3;
    si[LEVER_Q] = 120.0;
    number[STATION_DART] = 1.0;
    number[STATION_DART_KI] = 0.0;
    number[STATION_BANDWIDTH] = 50.0;
    start_station();
    (void)mean_frequency(0.06);
    double a[2] = {station.lockin[0].amplitude / 20e-9 * 120.0, station.lockin[1].amplitude / 20e-9 * 120.0};
    double p[2] = {demodulator_phase(&station.lockin[0]), demodulator_phase(&station.lockin[1])};
    double f[2] = {348e3, 352e3}, f0, quality;
    check_near("A at 348 kHz over F/k", a[0], 70.973765706, 0.1);
    check_near("A at 352 kHz over F/k", a[1], 70.429516054, 0.1);
    find_resonance(f, a, p, &f0, &quality);
    check_near("f0 from the lock-ins, Hz", f0, 350e3, 350e3 * 1e-5);
    check_near("Q from the lock-ins", quality, 120.0, 0.12);
    number[STATION_DART_KI] = 2e6;
    number[STATION_BANDWIDTH] = 1e3;
    number[STATION_FREQUENCY] = 349e3;
    start_station();
    double mean = mean_frequency(0.04), balance = 0.0; /* where both amplitudes are equal */
    for (double low = -100.0, high = 100.0; high - low > 1e-9;) {
        balance = 0.5 * (low + high);
        if (cabs(oscillator(348e3 + balance, 350e3, 120.0)) > cabs(oscillator(352e3 + balance, 350e3, 120.0)))
            high = balance;
        else
            low = balance;
    }
    check_near("tracks from 349 kHz to equal amplitudes, Hz", mean, balance, 0.5);
}
