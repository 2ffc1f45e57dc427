/* test_noise.c - the noise generator against published numbers
 * and the normal distribution, and its path through a drive. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/plant.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/hertz_rig.h"
#include "tests/fixture/exact.h"
#include "tests/fixture/rig.h"

enum { SAMPLES = 1 << 21, CLASSES = 4096, WORD_SHIFT = 29 };

static double deviate(uint64_t sequence, uint64_t k)
{
    return noise_deviate(noise_word(sequence, k));
}

/* S. Vigna's reference implementation, state 1234567 and 0. */
TEST(noise_words)
{
    const uint64_t word[] = {6457827717110365317u, 3203168211198807973u, 9817491932198370423u,
                             4593380528125082431u, 16408922859458223821u};
    for (unsigned i = 0; i < 5; i++)
        check_hex("SplitMix64 of 1234567", noise_word(1234567, i), word[i]);
    check_hex("SplitMix64 of 0", noise_word(0, 0), 0xE220A8397B1DCDAFu);
    /* the examples of docs/reference/messages.md, computed
     * with Python's integers and statistics.NormalDist */
    check_hex("input 2, seed 1, word 0", noise_word((UINT64_C(2) << 32) + 1, 0), 0xC4858308E5949C49u);
    check_near("its deviate", deviate((UINT64_C(2) << 32) + 1, 0), 0.731169640465274, 1e-15);
    check_hex("input 0, largest seed, word 1000000", noise_word(16777215, 1000000), 0x486FEB4CC8B27537u);
    check_near("its deviate", deviate(16777215, 1000000), -0.574077288933346, 1e-15);
}

/* The relative correction that makes x the normal quantile of (n + 1/2)/2^35, to first order. */
static double inverse_error(uint64_t n)
{
    const long double half = 0.5L, root = sqrtl(half), turn = 2.0L * acosl(-1.0L);
    long double x = (long double)noise_deviate(n << WORD_SHIFT);
    bool upper = n >= UINT64_C(1) << 34;
    uint64_t mirror = (UINT64_C(1) << 35) - 1 - n;
    long double tail = ((long double)(upper ? mirror : n) + half) / 34359738368.0L;
    long double density = expl(-half * x * x) / sqrtl(turn);
    long double error = (upper ? 1.0L : -1.0L) * (half * erfcl(fabsl(x) * root) - tail) / density;
    return (double)(error / x);
}

/* At random words and along the tails; the values at 1/4 and 1/1000 are those that Wichura gives, moved by
 * the distance to the next of our probabilities. */
TEST(noise_inverse)
{
    double worst = 0.0, quarter = noise_deviate((UINT64_C(1) << 33) << WORD_SHIFT);
    for (uint64_t i = 0; i < 100000; i++)
        exact_worst(&worst, (long double)inverse_error(noise_word(5, i) >> WORD_SHIFT));
    for (uint64_t n = 0; n < 20000; n++) {
        exact_worst(&worst, (long double)inverse_error(n));
        exact_worst(&worst, (long double)inverse_error((UINT64_C(1) << 35) - 1 - n));
    }
    check_below("relative error of the inverse", worst, 1.5e-15);
    check_near("AS 241 at 0.25", quarter - 0.5 * 0x1p-35 / 0.31777657, -0.6744897501960817, 1e-15);
    check_near("AS 241 at 0.001", noise_deviate(UINT64_C(34359738) << WORD_SHIFT),
               -3.090232306167813 + (34359738.5 / 34359738.368 - 1.0) * 0.001 / 0.0033670900770, 2e-15);
    check_near("smallest", noise_deviate(0), -noise_deviate(UINT64_MAX), 0.0);
    check_below("largest", noise_deviate(UINT64_MAX), NOISE_PEAK);
    check_above("largest", noise_deviate(UINT64_MAX), NOISE_PEAK - 0.01);
}

/* In units of their standard errors over n independent
 * normal values: 1/n, 2/n, 6/n, 24/n are the variances. */
TEST(noise_moments)
{
    double sum[5] = {0.0}, n = SAMPLES;
    int beyond[3] = {0};
    for (int i = 0; i < SAMPLES; i++) {
        double x = deviate(42, (uint64_t)i), power = 1.0;
        for (int k = 0; k < 5; k++, power *= x)
            sum[k] += power;
        for (int k = 0; k < 3; k++)
            beyond[k] += fabs(x) > 2.0 + k;
    }
    double mean = sum[1] / n, variance = sum[2] / n, fourth = sum[4] / n;
    check_near("mean, standard errors", mean * sqrt(n), 0.0, 4.0);
    check_near("variance", (variance - 1.0) * sqrt(n / 2.0), 0.0, 4.0);
    check_near("third moment, of variance 15/n", sum[3] / n * sqrt(n / 15.0), 0.0, 4.0);
    check_near("fourth moment, of variance 96/n", (fourth - 3.0) * sqrt(n / 96.0), 0.0, 4.0);
    for (int k = 0; k < 3; k++) {
        double expected = n * erfc((2.0 + k) * sqrt(0.5));
        check_near("values beyond 2, 3, 4 standard deviations", (beyond[k] - expected) / sqrt(expected), 0.0,
                   4.0);
    }
}

/* Kolmogorov-Smirnov and chi-square over classes of equal
 * probability; bounds that chance passes once in 10^5. */
TEST(noise_distribution)
{
    static int count[CLASSES];
    const double expected = (double)SAMPLES / CLASSES;
    double chi = 0.0, worst = 0.0;
    int64_t below = 0;
    memset(count, 0, sizeof count);
    for (int i = 0; i < SAMPLES; i++) {
        double p = 0.5 * erfc(-deviate(7, (uint64_t)i) * sqrt(0.5));
        count[(int)(p * CLASSES)]++;
    }
    for (int i = 0; i < CLASSES; i++) {
        below += count[i];
        worst = fmax(worst, fabs((double)below - (i + 1) * expected));
        chi += (count[i] - expected) * (count[i] - expected) / expected;
    }
    check_below("Kolmogorov-Smirnov, sqrt(n) D", worst / sqrt(SAMPLES), 2.5);
    check_near("chi-square, standard deviations", (chi - (CLASSES - 1)) / sqrt(2.0 * (CLASSES - 1)), 0.0,
               4.5);
}

/* Mean product of two sequences at a lag, in standard errors. */
static double correlation(uint64_t a, uint64_t b, uint64_t lag)
{
    enum { PAIRS = 1 << 17 };
    double sum = 0.0;
    for (uint64_t i = 0; i < PAIRS; i++)
        sum += deviate(a, i) * deviate(b, i + lag);
    return sum / sqrt(PAIRS);
}

TEST(noise_correlation)
{
    double worst = 0.0;
    for (uint64_t lag = 1; lag <= 16; lag++)
        worst = fmax(worst, fabs(correlation(0, 0, lag)));
    check_below("lags 1 to 16, standard errors", worst, 4.5);
    check_near("next seed", correlation(3, 4, 0), 0.0, 4.5);
    check_near("next seed, next value", correlation(3, 4, 1), 0.0, 4.5);
    check_near("next input, same seed", correlation(3, (UINT64_C(1) << 32) + 3, 0), 0.0, 4.5);
}

/* A rig at rest in model units with noise on an input at once. */
static void start_noisy(struct plant *pl, int input, double deviation, uint32_t hold, uint32_t seed)
{
    double paper[PAPER];
    rig_paper(paper);
    rig_start(pl, paper, 0.05, 0.0, 0.0);
    plant_noise(pl, input, deviation, hold, seed, 0.0);
}

static void advance(struct plant *pl, uint64_t tick, uint32_t fraction)
{
    if (!plant_advance(pl, (struct instant){tick, fraction}))
        check_true("the plant stays finite", 0);
}

/* Value k at tick k hold: held by a force, met by a base on straight lines. The first tick is the ramp. */
TEST(noise_grid)
{
    const uint32_t hold[] = {1, 3, 64};
    for (int i = 0; i < 3; i++) {
        struct plant pl;
        double worst = 0.0;
        start_noisy(&pl, RIG_FORCE, 0.1, hold[i], 9);
        plant_noise(&pl, RIG_BASE, 1e-3, hold[i], 9, 0.0);
        rig_run(&pl, 1);
        for (uint64_t tick = 1; tick < 500; tick++) {
            struct segment *e = &pl.segment;
            uint64_t k = tick / hold[i];
            double part = (double)(tick % hold[i]) / hold[i], step = 1.0 / hold[i];
            uint64_t base = ((uint64_t)RIG_BASE << 32) + 9;
            double from = 1e-3 * deviate(base, k), rise = 1e-3 * deviate(base, k + 1) - from;
            rig_run(&pl, 1);
            for (int j = 0; j < 3; j++) {
                exact_worst(&worst, (long double)(e->at[j][RIG_FORCE].value - 0.1 * deviate(9, k)));
                exact_worst(&worst,
                            (long double)(e->at[j][RIG_BASE].value - from - rise * (part + 0.5 * step * j)));
                exact_worst(&worst, 1e-2L * (long double)(e->at[j][RIG_BASE].rate - rise * step / 0.05));
                exact_worst(&worst, (long double)e->at[j][RIG_FORCE].rate);
            }
        }
        check_below("from the grid's values", worst, 1e-16);
    }
}

/* The noise of a plant does not depend on when it began; a copy goes on with the same bits. */
TEST(noise_any_start)
{
    struct plant early, late, copy;
    start_noisy(&early, RIG_FORCE, 0.1, 7, 1);
    start_noisy(&late, RIG_FORCE, 0.0, 1, 1);
    rig_run(&early, 1000);
    rig_run(&late, 900);
    plant_noise(&late, RIG_FORCE, 0.1, 7, 1, 0.0);
    rig_run(&late, 100);
    copy = early;
    for (int i = 0; i < 50; i++) {
        rig_run(&early, 1);
        rig_run(&late, 1);
        if (early.segment.at[2][RIG_FORCE].value != late.segment.at[2][RIG_FORCE].value)
            check_true("the same value in the same tick", 0);
    }
    rig_run(&copy, 50);
    check_hex("a copy", plant_hash(&copy), plant_hash(&early));
    copy.drive[RIG_FORCE].noise.value += 1e-12;
    check_is("the hash sees the noise", plant_hash(&copy), !=, plant_hash(&early));
}

/* The deviation follows the ramp, from an instant inside a tick on; at its end the drive is silent. */
TEST(noise_ramp)
{
    struct plant pl;
    double worst = 0.0;
    start_noisy(&pl, RIG_FORCE, 0.0, 1, 0);
    advance(&pl, 10, 16384);
    plant_noise(&pl, RIG_FORCE, 0.4, 1, 3, 20 * 0.05);
    for (uint64_t tick = 10; tick < 40; tick++) {
        advance(&pl, tick + 1, 0);
        double x = fmin(1.0, ((double)(tick + 1) - 10.25) / 20.0);
        exact_worst(&worst, (long double)(pl.segment.at[2][RIG_FORCE].value - 0.4 * x * deviate(3, tick)));
        advance(&pl, tick + 1, 16384);
    }
    check_below("deviation along the ramp", worst, 1e-16);
    plant_noise(&pl, RIG_FORCE, 0.0, 1, 3, 5 * 0.05);
    rig_run(&pl, 4);
    check_true("still heard", drive_active(&pl.drive[RIG_FORCE]));
    rig_run(&pl, 2);
    check_true("silent", !drive_active(&pl.drive[RIG_FORCE]) && !pl.drive[RIG_FORCE].noise.active);
    check_near("input", pl.segment.at[2][RIG_FORCE].value, 0.0, 0.0);
}

/* A harmonic drive that begins in the noise's ramp starts
 * at its own phase: noise does not make a drive sound. */
TEST(noise_and_harmonic)
{
    const double h = 0.05, turn = 2.0 * acos(-1.0);
    struct plant pl;
    start_noisy(&pl, RIG_FORCE, 0.0, 1, 0);
    rig_run(&pl, 10);
    plant_noise(&pl, RIG_FORCE, 0.4, 1, 3, 20 * h);
    rig_run(&pl, 5);
    plant_drive(&pl, RIG_FORCE, 1.0, 0.5, 2.0, 10 * h);
    rig_run(&pl, 5);
    double noise = pl.drive[RIG_FORCE].noise.value;
    check_near("half-way: harmonic", pl.segment.at[2][RIG_FORCE].value - noise,
               0.5 * cos(2.0 + turn * 0.5 * 5 * h), 1e-12);
    check_near("half-way from 0.1 to 0.4: noise", noise, 0.25 * deviate(3, 19), 1e-15);
}

/* New parameters leave the noise in SI as it is. */
TEST(noise_new_parameters)
{
    struct plant pl;
    double si[MODEL_PARAMETERS], worst = 0.0;
    start_noisy(&pl, RIG_FORCE, 0.1, 1, 9);
    plant_noise(&pl, RIG_BASE, 1e-3, 7, 9, 0.0);
    rig_run(&pl, 50);
    memcpy(si, pl.si, sizeof si);
    si[RIG_PRELOAD] *= 0.7;
    const char *why = plant_change(&pl, si);
    if (why)
        check_string("plant_change", why, "no refusal");
    for (uint64_t tick = 50; tick < 100; tick++) {
        uint64_t base = ((uint64_t)RIG_BASE << 32) + 9, k = (tick + 1) / 7;
        double from = deviate(base, k), part = (double)((tick + 1) % 7) / 7.0;
        rig_run(&pl, 1);
        const struct input *u = pl.segment.at[2];
        exact_worst(&worst, (long double)(u[RIG_FORCE].value * pl.scale.force_N - 0.1 * deviate(9, tick)));
        exact_worst(&worst, (long double)(u[RIG_BASE].value * pl.scale.length_m -
                                          1e-3 * (from + (deviate(base, k + 1) - from) * part)));
    }
    check_below("from the noise in SI", worst, 1e-15);
}

/* New seeds, holds, levels and harmonics at any instant,
 * inside ramps and at the same instant: the base never jumps. */
TEST(noise_change)
{
    struct plant pl;
    uint64_t seed = 11;
    double jump = 0.0, end = 0.0, largest = 0.0;
    start_noisy(&pl, RIG_BASE, 1e-3, 1, 0);
    for (uint64_t i = 0; i < 20000; i++) {
        struct instant to = pl.now;
        to.fraction += 1 + (uint32_t)(40000.0 * exact_uniform(&seed));
        to.tick += to.fraction / TICK_FRACTIONS;
        to.fraction %= TICK_FRACTIONS;
        if (to.tick > pl.now.tick) /* one segment at a time */
            to = (struct instant){pl.now.tick + 1, 0};
        for (int n = (int)(1.3 * exact_uniform(&seed)); n >= 0 && exact_uniform(&seed) < 0.3; n--)
            plant_noise(&pl, RIG_BASE, 1e-3 * (double)(i % 3), 1 + (uint32_t)(6.0 * exact_uniform(&seed)),
                        (uint32_t)i, 0.2 * exact_uniform(&seed));
        if (exact_uniform(&seed) < 0.05)
            plant_drive(&pl, RIG_BASE, 1e-3, 0.5, 0.0, 0.1);
        uint64_t corner = drive_corner(&pl.drive[RIG_BASE]);
        if (corner < TICK_FRACTIONS - pl.now.fraction)
            to = (struct instant){pl.now.tick, pl.now.fraction + (uint32_t)corner};
        advance(&pl, to.tick, to.fraction);
        exact_worst(&jump, (long double)(pl.segment.at[0][RIG_BASE].value - end));
        end = pl.segment.at[2][RIG_BASE].value;
        largest = fmax(largest, fabs(end));
    }
    check_below("largest jump of the base", jump, 1e-17);
    check_above("it did move", largest, 3e-3);
}

/* Ticks cut into parts give the same path. */
TEST(noise_parts_of_a_tick)
{
    struct plant whole, parts;
    double worst = 0.0;
    start_noisy(&whole, RIG_BASE, 1e-3, 3, 5);
    start_noisy(&parts, RIG_BASE, 1e-3, 3, 5);
    for (uint64_t tick = 0; tick < 300; tick++) {
        rig_run(&whole, 1);
        for (uint32_t cut = 10000; cut < TICK_FRACTIONS; cut += 20000 + (uint32_t)tick)
            advance(&parts, tick, cut);
        advance(&parts, tick + 1, 0);
        exact_worst(&worst,
                    (long double)(whole.drive[RIG_BASE].noise.value - parts.drive[RIG_BASE].noise.value));
    }
    check_below("from the uncut path", worst, 1e-18);
}

/* Spectral density of an input at w, two-sided per rad/s: |integral
 * of u e^(-iwt)|^2/(2 pi time) over stretches of 64 cells. */
static double density(int input, double deviation, uint32_t hold, double h, double w)
{
    enum { STRETCHES = 3000, CELLS = 64 };
    struct plant pl;
    double sum = 0.0, turn = 2.0 * acos(-1.0);
    start_noisy(&pl, input, deviation, hold, 77);
    rig_run(&pl, hold);
    for (int i = 0; i < STRETCHES; i++) {
        double re = 0.0, im = 0.0;
        for (uint32_t k = 0; k < CELLS * hold; k++) {
            struct wave wave = {.cosine = 1.0};
            struct segment e = {.length = h};
            struct noise *n = &pl.drive[input].noise;
            const struct noise_span span = {pl.now.tick++, 0.0, 1.0, 1.0, 1.0 / h};
            e.wave[input] = wave;
            (void)noise_add(n, &span, &e, input);
            re += e.at[1][input].value * cos(w * h * (k + 0.5)) * h;
            im += e.at[1][input].value * sin(w * h * (k + 0.5)) * h;
        }
        sum += (re * re + im * im) / (turn * CELLS * hold * h);
    }
    return sum / STRETCHES;
}

/* Against sigma^2 T/(2 pi) sinc^2 or sinc^4; |X|^2 is exponentially distributed, so the standard error is
 * 1/sqrt(3000). The midpoint rule is 1e-3 off, the ends of the stretches of straight lines up to 1/64. */
TEST(noise_spectrum)
{
    const double T = 0.4, turn = 2.0 * acos(-1.0), f[] = {0.1, 0.35, 0.6};
    for (int i = 0; i < 3; i++) {
        double w = turn * f[i] / T, x = 0.5 * w * T, white = 0.09 * T / turn, sinc = sin(x) / x;
        double held = density(RIG_FORCE, 0.3, 8, T / 8, w) / white;
        double straight = density(RIG_BASE, 0.3, 8, T / 8, w) / white;
        check_near("held, over the level", held / (sinc * sinc), 1.0, 4.0 / sqrt(3000.0));
        check_near("straight", straight / pow(sinc, 4), 1.0, 4.0 / sqrt(3000.0) + 1.0 / 64.0);
    }
}
