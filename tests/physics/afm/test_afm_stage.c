/* test_afm_stage.c - piezo and sensor of an AFM against closed forms: resonance, play operators, creep,
 * quantiser, optical noise, and a z loop with its delay. Numbers without a source are those of an independent
 * program. */
#include "tests/unit/test.h"

#include <complex.h>
#include <math.h>
#include "firmware/stage/stage.h"
#include "tests/fixture/imaginary.h"

#define PI 3.14159265358979323846

static struct stage stage;

static void make(double tick_s, enum stage_kind kind, double a, double b)
{
    const struct stage_part part = {kind, a, b};
    check_no_error("stage", stage_init(&stage, tick_s, 1, &part, 1));
}

/* ---- the piezo's resonance ---- */

/* A step is held from its first tick on. The peak of the exact response falls on a tick. */
TEST(afm_stage_step)
{
    const double peak_s = 1.0 / (2.0 * 5e3 * sqrt(1.0 - 0.05 * 0.05));
    double largest = 0.0, at = 0.0;
    enum { TICKS = 1000 };
    make(peak_s / TICKS, STAGE_RESONANCE, 5e3, 0.05);
    for (int i = 1; i <= 5 * TICKS; i++) {
        double y = stage_run(&stage, 1.0);
        if (i == TICKS)
            check_near("overshoot", y - 1.0, 0.854467893, 1e-9);
        if (y > largest) {
            largest = y;
            at = i * peak_s / TICKS;
        }
    }
    check_near("time of the peak, s", at, 1.001252349e-4, 1e-12);
}

/* One tick is exact whatever its length: 7 long ones end where 7000 short ones do, on the closed form. */
TEST(afm_stage_any_tick)
{
    const double omega = 2.0 * PI * 5e3, damped = omega * sqrt(1.0 - 0.05 * 0.05), t = 7 * 3.7e-5;
    double closed = 1.0 - exp(-0.05 * omega * t) *
                              (cos(damped * t) + 0.05 / sqrt(1.0 - 0.05 * 0.05) * sin(damped * t)),
           y = 0.0;
    make(3.7e-5, STAGE_RESONANCE, 5e3, 0.05);
    for (int i = 0; i < 7; i++)
        y = stage_run(&stage, 1.0);
    check_near("7 long ticks", y, closed, 1e-14);
    make(3.7e-8, STAGE_RESONANCE, 5e3, 0.05);
    for (int i = 0; i < 7000; i++)
        y = stage_run(&stage, 1.0);
    check_near("7000 short ones", y, closed, 1e-12);
}

/* The steady response to a tone over whole periods, of the value that is held in the middle of each tick. */
static double complex respond(double tick_s, int ticks, double f)
{
    double complex sum = 0.0;
    const int settle = 8 * ticks;
    for (int i = 0; i < settle + ticks; i++) {
        double y = stage_run(&stage, cos(2.0 * PI * f * (i + 0.5) * tick_s));
        if (i >= settle)
            sum += y * cexp(-i_unit * 2.0 * PI * f * (i + 1) * tick_s);
    }
    return 2.0 * sum / ticks;
}

/* Far below the resonance the gain rises by (f/f0)^2. The
 * held tone is short of a pure one by (omega h)^2/24, 3e-11. */
TEST(afm_stage_gain)
{
    const double f = 500.0, period = 1.0 / f;
    enum { TICKS = 240000 };
    make(period / TICKS, STAGE_RESONANCE, 5e3, 0.05);
    double complex got = respond(period / TICKS, TICKS, f),
                   expected = 1.0 / (1.0 - 0.01 + i_unit * 2.0 * 0.05 * 0.1);
    check_near("gain at a tenth of it", cabs(got), cabs(expected), 1e-9);
    check_near("published gain", cabs(got), 1.010049, 5e-7);
    check_near("phase, degrees", carg(got) * 180.0 / PI, carg(expected) * 180.0 / PI, 1e-7);
    check_near("published phase, degrees", carg(got) * 180.0 / PI, -0.5787, 5e-5);
}

/* ---- hysteresis ---- */

TEST(afm_stage_play)
{
    static const double path[][2] = {{0.25, 0.22053571428571428},
                                     {0.5, 0.4625},
                                     {0.75, 0.7125},
                                     {1.0, 0.9625},
                                     {0.75, 0.74732142857142857},
                                     {0.5, 0.52142857142857143},
                                     {0.25, 0.28482142857142857},
                                     {0.0, 0.0375},
                                     {0.25, 0.25267857142857142},
                                     {0.5, 0.47857142857142857},
                                     {0.75, 0.71517857142857143},
                                     {1.0, 0.9625}};
    make(1e-3, STAGE_HYSTERESIS, 1.0, 0.15);
    for (unsigned i = 0; i < sizeof path / sizeof path[0]; i++)
        check_near("play operators", stage_run(&stage, path[i][0]), path[i][1], 1e-12);
}

enum { LOOP = 3200 };

/* Up and down between 0 and 1; keeps the way up and gives the largest opening. */
static double loop(double up[LOOP + 1], double *area)
{
    double opening = 0.0, before = 0.0;
    for (int i = 0; i <= LOOP; i++)
        up[i] = stage_run(&stage, (double)i / LOOP);
    *area = 0.0;
    for (int i = LOOP; i >= 0; i--) {
        double gap = stage_run(&stage, (double)i / LOOP) - up[i];
        opening = gap > opening ? gap : opening;
        *area += i < LOOP ? 0.5 * (gap + before) / LOOP : 0.0;
        before = gap;
    }
    return opening;
}

/* Madelung's rules: the loop closes, and an inner loop is wiped out by the outer one. */
TEST(afm_stage_loop)
{
    static double first[LOOP + 1], second[LOOP + 1], third[LOOP + 1];
    double area, differ = 0.0;
    make(1e-3, STAGE_HYSTERESIS, 1.0, 0.15);
    (void)loop(first, &area);
    double opening = loop(second, &area);
    check_near("largest opening", opening / (second[LOOP] - second[0]), 0.046332, 1e-6);
    check_near("area", area, 0.028125, 1e-12);
    for (int i = 0; i < 400; i++)
        (void)stage_run(&stage, i % 2 ? 0.3 : 0.6);
    (void)stage_run(&stage, 1.0);
    (void)stage_run(&stage, 0.0);
    (void)loop(third, &area);
    for (int i = 0; i <= LOOP; i++)
        differ += third[i] != second[i];
    check_near("points of the loop that an inner one has changed", differ, 0.0, 0.0);
}

/* ---- creep ---- */

/* Slope over decades, and the ripple about it: a straight line through the logarithm of the time, from 10^1.5
 * to 10^4.5 times 0.1 s. */
TEST(afm_stage_creep)
{
    enum { POINTS = 601 };
    const double tick_s = 1e-3, share = 0.02;
    static double x[POINTS], y[POINTS];
    int n = 0;
    make(tick_s, STAGE_CREEP, share, 0.0);
    for (int i = 1; n < POINTS; i++) {
        double now = (stage_run(&stage, 1.0) - 1.0) / share;
        for (; n < POINTS && i * tick_s >= 0.1 * pow(10.0, 1.5 + 3.0 * n / (POINTS - 1)) * (1.0 - 1e-12);
             n++) {
            x[n] = log10(i * tick_s / 0.1);
            y[n] = now;
        }
    }
    double mx = 0.0, my = 0.0, xx = 0.0, xy = 0.0, ripple = 0.0;
    for (int i = 0; i < POINTS; i++) {
        mx += x[i] / POINTS;
        my += y[i] / POINTS;
    }
    for (int i = 0; i < POINTS; i++) {
        xx += (x[i] - mx) * (x[i] - mx);
        xy += (x[i] - mx) * (y[i] - my);
    }
    for (int i = 0; i < POINTS; i++) {
        double off = fabs(y[i] - my - xy / xx * (x[i] - mx));
        ripple = off > ripple ? off : ripple;
    }
    check_near("creep per decade", xy / xx, 0.998498, 1e-4);
    check_near("ripple", ripple, 3.8e-3, 1e-4);
}

/* ---- the quantiser and the optical noise ---- */

/* Mean square of n samples of a difference. */
struct spread {
    double sum, square;
    int n;
};

static void spread_take(struct spread *s, double x)
{
    s->sum += x;
    s->square += x * x;
    s->n++;
}

static double variance(const struct spread *s)
{
    double mean = s->sum / s->n;
    return s->square / s->n - mean * mean;
}

/* 16 bits over +-10 V at 500 kS/s: white, LSB/sqrt(6 fs). A golden-ratio ramp fills each step evenly. */
TEST(afm_stage_quantiser)
{
    enum { SAMPLES = 100000 };
    const double fs = 500e3, lsb = 20.0 / 65536.0;
    struct spread s = {0};
    make(1.0 / fs, STAGE_QUANTISER, lsb, 0.0);
    check_near("LSB, V", stage_run(&stage, 1.6 * lsb), 2.0 * 3.051758e-4, 1e-10);
    uint64_t state = 1;
    for (int i = 0; i < SAMPLES; i++) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        double u = 9.0 * ((double)(state >> 11) * 0x1p-52 - 1.0);
        spread_take(&s, stage_run(&stage, u) - u);
    }
    double density = sqrt(variance(&s) * 2.0 / fs);
    /* the variance of a uniform error has the standard error sqrt(4/5/n) */
    check_near("density, V/sqrt(Hz)", density / 1.761933e-7, 1.0, 4.0 * 0.5 * sqrt(0.8 / SAMPLES));
    check_near("at 50 nm/V, m/sqrt(Hz)", 1.761933e-7 * 50e-9, 8.8e-15, 1e-17);
}

/* The density of a noise is the one asked for, at each sample rate: density^2 fs/2 is its variance. It is
 * white: Welch's estimate in eight bands, each within 4 standard errors. */
TEST(afm_stage_noise)
{
    enum { SEGMENTS = 4000, POINTS = 64, BANDS = 8 };
    const double fs = 4.48e6, density = 100e-15;
    static double power[POINTS];
    make(1.0 / fs, STAGE_NOISE, density, 0.0);
    for (int k = 0; k < SEGMENTS; k++) {
        double y[POINTS];
        for (int i = 0; i < POINTS; i++)
            y[i] = stage_run(&stage, 0.0);
        for (int j = 1; j <= BANDS; j++) {
            double complex sum = 0.0;
            for (int i = 0; i < POINTS; i++)
                sum += y[i] * cexp(-i_unit * 2.0 * PI * 3 * j * i / POINTS);
            power[j] += 2.0 * creal(sum * conj(sum)) / (fs * POINTS) / SEGMENTS;
        }
    }
    for (int j = 1; j <= BANDS; j++)
        check_near("density in a band", power[j] / (density * density), 1.0, 4.0 / sqrt(SEGMENTS));
}

/* ---- the z loop ---- */

/* Grows or falls: the ratio of the error's size late and early of a loop z' = ki (setpoint - amplitude),
 * through the lever's pole and a delay. */
static double stage_growth(double ki, double tau, double delay_s, double tick_s)
{
    const double ticks = delay_s / tick_s;
    const struct stage_part part[2] = {{STAGE_LAG, 1.0 / (2.0 * PI * tau), 0.0}, {STAGE_DELAY, ticks, 0.0}};
    double z = 0.0, size[2] = {0.0, 0.0}, period = 2.0 * PI * sqrt(tau * delay_s);
    check_no_error("loop", stage_init(&stage, tick_s, 0, part, 2));
    int n = (int)(40.0 * period / tick_s);
    for (int i = 0; i < n; i++) {
        double error = 1.0 - stage_run(&stage, z);
        double *largest = &size[i > n / 2];
        z += ki * tick_s * error;
        if (i > n / 4 && fabs(error) > *largest)
            *largest = fabs(error);
    }
    return size[1] / size[0];
}

/* The ultimate gain Ku of a pure integral with slope 1,
 * the lever's pole of 1.818914 ms and a delay: by halving. */
TEST(afm_z_loop_gain)
{
    static const double want[3][2] = {{1e-4, 10090.5}, {5e-4, 2086.34}, {1e-3, 1081.42}};
    for (int i = 0; i < 3; i++) {
        double low = 0.5 * want[i][1], high = 2.0 * want[i][1];
        for (int k = 0; k < 14; k++) {
            double middle = 0.5 * (low + high);
            *(stage_growth(middle, 1.818914e-3, want[i][0], want[i][0] / 400.0) > 1.0 ? &high : &low) =
                middle;
        }
        check_near("ultimate gain, 1/s", low / want[i][1], 1.0, 0.05);
    }
}
