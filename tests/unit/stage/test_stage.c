/* test_stage.c - elements of actuators and sensors: algebra, delay, refusals, what a copy and a hash hold. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/hash.h"
#include "firmware/stage/stage.h"
#include "tests/fixture/exact.h"

static struct stage stage, other;

static void make(struct stage *s, double tick_s, enum stage_kind kind, double a, double b)
{
    const struct stage_part part = {kind, a, b};
    check_no_error("stage", stage_init(s, tick_s, 0, &part, 1));
}

/* ---- algebra ---- */

/* Let go at 1, the deviation falls by e^(-2 pi zeta/sqrt(1 - zeta^2)) a period of the damped motion. */
TEST(stage_ring_down)
{
    const double zeta = 0.02, f = 800.0, period = 1.0 / (f * sqrt(1.0 - zeta * zeta));
    double y = 0.0;
    make(&stage, period / 50, STAGE_RESONANCE, f, zeta);
    stage_settle(&stage, 1.0, 0);
    for (int i = 0; i < 50 * 20; i++)
        y = stage_run(&stage, 0.0);
    check_near("after 20 periods", y, exp(-20 * 6.283185307179586 * zeta / sqrt(1.0 - zeta * zeta)), 1e-13);
}

/* At rest, and after a long time, the result is gain times signal. */
TEST(stage_static_gain)
{
    static const struct stage_part part[] = {{STAGE_GAIN, 2.5, 0.0},
                                             {STAGE_SLEW, 100.0, 0.0},
                                             {STAGE_RESONANCE, 300.0, 0.4},
                                             {STAGE_LAG, 50.0, 0.0},
                                             {STAGE_DELAY, 3.25, 0.0}};
    double y = 0.0;
    check_no_error("chain", stage_init(&stage, 1e-3, 0, part, 5));
    stage_settle(&stage, -0.8, 0);
    check_near("settled", stage_run(&stage, -0.8), -2.0, 1e-15);
    for (int i = 0; i < 2000; i++)
        y = stage_run(&stage, 4.0);
    check_near("after 2 s", y, 10.0, 1e-13);
}

TEST(stage_lag_exact)
{
    double y = 0.0;
    make(&stage, 1e-3, STAGE_LAG, 20.0, 0.0);
    for (int i = 0; i < 30; i++)
        y = stage_run(&stage, 1.0);
    check_near("after 30 ms", y, 1.0 - exp(-6.283185307179586 * 20.0 * 0.03), 1e-14);
}

/* Whole ticks give the very samples; a fraction lies on the line between two. */
TEST(stage_delay_exact)
{
    static double past[3000];
    static const double ticks[] = {0.0, 1.0, 7.0, 510.0, 0.5, 12.75, 509.125};
    for (unsigned k = 0; k < sizeof ticks / sizeof ticks[0]; k++) {
        uint64_t seed = 1;
        int whole = (int)ticks[k], wrong = 0;
        double part = ticks[k] - whole;
        make(&stage, 1e-3, STAGE_DELAY, ticks[k], 0.0);
        for (int i = 0; i < 3000; i++) {
            past[i] = exact_uniform(&seed);
            double a = i >= whole ? past[i - whole] : 0.0, b = i >= whole + 1 ? past[i - whole - 1] : 0.0;
            wrong += stage_run(&stage, past[i]) != a + part * (b - a);
        }
        check_int("samples that differ", wrong, 0);
    }
}

TEST(stage_slew_clip_gain)
{
    make(&stage, 1e-3, STAGE_SLEW, 200.0, 0.0);
    check_near("rises by 0.2 a tick", stage_run(&stage, 1.0), 0.2, 1e-15);
    check_near("and falls", stage_run(&stage, -5.0), 0.0, 1e-15);
    make(&stage, 1e-3, STAGE_CLIP, 2.0, 0.0);
    check_near("clip", stage_run(&stage, -7.0), -2.0, 0.0);
    check_near("inside", stage_run(&stage, 1.5), 1.5, 0.0);
    make(&stage, 1e-3, STAGE_GAIN, -3.0, 0.0);
    check_near("gain", stage_run(&stage, 2.0), -6.0, 0.0);
    make(&stage, 1e-3, STAGE_QUANTISER, 0.25, 0.0);
    check_near("ties to the even multiple", stage_run(&stage, 0.375), 0.5, 0.0);
    check_near("ties to the even multiple", stage_run(&stage, 0.125), 0.0, 0.0);
    make(&stage, 1e-3, STAGE_QUANTISER, 1.0, 0.0);
    check_near("2^50 quanta and a half: to the even multiple", stage_run(&stage, 0x1p50 + 0.5), 0x1p50, 0.0);
    check_near("2^51 quanta and a half: as it is", stage_run(&stage, 0x1p51 + 0.5), 0x1p51 + 0.5, 0.0);
    check_near("the same below 0", stage_run(&stage, -0x1p51 - 0.5), -0x1p51 - 0.5, 0.0);
}

/* A settled creep starts from the signal that it has, and follows what changes. */
TEST(stage_creep_settled)
{
    make(&stage, 1.0, STAGE_CREEP, 0.02, 0.0);
    stage_settle(&stage, 5.0, 0);
    check_near("nothing creeps", stage_run(&stage, 5.0), 5.0, 0.0);
    make(&other, 1.0, STAGE_CREEP, 0.02, 0.0);
    for (int i = 0; i < 1000; i++)
        check_near("the same as from 0", stage_run(&stage, 6.0) - 6.0, stage_run(&other, 1.0) - 1.0, 1e-14);
}

/* ---- no NaN passes ---- */

TEST(stage_refuses_nan)
{
    static const double bad[] = {(double)NAN, (double)INFINITY, -(double)INFINITY, 1e31, -1e300};
    for (int kind = 0; kind < STAGE_KINDS; kind++) {
        double y = 0.0;
        bool resonance = kind == STAGE_RESONANCE;
        make(&stage, 1e-3, (enum stage_kind)kind, resonance ? 30.0 : 0.9,
             resonance || kind == STAGE_FLICKER ? 0.5 : 0.0);
        other = stage;
        for (int i = 0; i < 40; i++) {
            y = stage_run(&stage, i >= 10 && i < 15 ? bad[i - 10] : 0.1 * i);
            double held = stage_run(&other, i >= 10 && i < 15 ? 0.9 : 0.1 * i);
            check_true("finite, as if the last good signal were held", y == held);
        }
        check_int("refused signals are counted", stage.refused, 5);
        stage_settle(&stage, (double)NAN, 0);
        y = stage_run(&stage, 0.0);
        check_true("settles on 0", y == y);
    }
}

/* The largest signal and the largest gains stay finite. */
TEST(stage_largest)
{
    struct stage_part part[STAGE_PARTS];
    for (int i = 0; i < STAGE_PARTS; i++)
        part[i] = (struct stage_part){STAGE_GAIN, 1e9, 0.0};
    part[3] = (struct stage_part){STAGE_RESONANCE, 10.0, 1e-6};
    part[5] = (struct stage_part){STAGE_CREEP, 1.0, 0.0};
    check_no_error("chain", stage_init(&stage, 1e-3, 0, part, STAGE_PARTS));
    for (int i = 0; i < 1000; i++)
        check_true("finite", isfinite(stage_run(&stage, i % 2 ? 1e30 : -1e30)));
}

TEST(stage_refusals)
{
    static const struct {
        struct stage_part part;
        const char *why;
    } bad[] = {{{STAGE_RESONANCE, 100.0, 1.0}, "damping ratio"},
               {{STAGE_RESONANCE, 0.0, 0.1}, "resonance"},
               {{STAGE_LAG, 0.0, 0.0}, "lag"},
               {{STAGE_DELAY, 511.0, 0.0}, "delay"},
               {{STAGE_DELAY, -1.0, 0.0}, "delay"},
               {{STAGE_SLEW, 0.0, 0.0}, "slew"},
               {{STAGE_NOISE, -1.0, 0.0}, "noise"},
               {{STAGE_FLICKER, 1.0, 0.0}, "1/f noise"},
               {{STAGE_DRIFT, 2e9, 0.0}, "drift"},
               {{STAGE_CLIP, -1.0, 0.0}, "clip"},
               {{STAGE_QUANTISER, 0.0, 0.0}, "quantum"},
               {{STAGE_HYSTERESIS, 1.0, 1.5}, "share"},
               {{STAGE_CREEP, -0.1, 0.0}, "creep"},
               {{STAGE_GAIN, 1e10, 0.0}, "gain"},
               {{STAGE_KINDS, 1.0, 0.0}, "no such"},
               {{STAGE_GAIN, (double)NAN, 0.0}, "gain"}};
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++)
        check_contains("refused", stage_init(&stage, 1e-3, 0, &bad[i].part, 1), bad[i].why);
    const struct stage_part delay[2] = {{STAGE_DELAY, 1.0, 0.0}, {STAGE_DELAY, 1.0, 0.0}};
    check_contains("refused", stage_init(&stage, 1e-3, 0, delay, 2), "more than one delay");
    check_contains("refused", stage_init(&stage, 1e-3, 0, delay, STAGE_PARTS + 1), "more than 12");
    check_contains("refused", stage_init(&stage, 0.0, 0, delay, 1), "tick");
    check_contains("refused", stage_init(&stage, 2e12, 0, delay, 1), "tick");
}

/* ---- copies ---- */

static uint64_t hash(const struct stage *s)
{
    return stage_hash(s, HASH_BEGIN);
}

/* A copy goes on with equal bits, and each element's state is in the hash. */
TEST(stage_snapshot)
{
    static const struct stage_part piezo[] = {{STAGE_SLEW, 5e-3, 0.0},
                                              {STAGE_HYSTERESIS, 5e-6, 0.15},
                                              {STAGE_CREEP, 0.015, 0.0},
                                              {STAGE_RESONANCE, 5e3, 0.05}};
    static const struct stage_part diode[] = {
        {STAGE_NOISE, 100e-15, 0.0},   {STAGE_LAG, 2e6, 0.0},    {STAGE_CLIP, 500e-9, 0.0},
        {STAGE_FLICKER, 1e4, 100e-15}, {STAGE_DRIFT, 1e-9, 0.0}, {STAGE_QUANTISER, 1e-6 / 65536.0, 0.0}};
    for (int i = 0; i < 2; i++) {
        check_no_error("chain", stage_init(&stage, 2e-7, 9, i ? diode : piezo, i ? 6 : 4));
        for (int k = 0; k < 500; k++)
            (void)stage_run(&stage, 1e-7 * sin(0.1 * k));
        other = stage;
        for (int k = 0; k < 500; k++)
            check_true("equal bits", stage_run(&stage, 1e-9 * k) == stage_run(&other, 1e-9 * k));
        check_hex("equal hashes", hash(&stage), hash(&other));
        (void)stage_run(&other, 5e-7);
        check_true("another state has another hash", hash(&stage) != hash(&other));
    }
}

TEST(stage_hash_has_state)
{
    for (int kind = 0; kind < STAGE_KINDS; kind++) {
        bool drifts = kind == STAGE_FLICKER || kind == STAGE_DRIFT; /* whatever the signal */
        bool memory = kind != STAGE_GAIN && kind != STAGE_NOISE && kind != STAGE_CLIP &&
                      kind != STAGE_QUANTISER && !drifts;
        double b = kind == STAGE_RESONANCE || kind == STAGE_FLICKER ? 0.5
                   : kind == STAGE_HYSTERESIS                       ? 0.3
                                                                    : 0.0;
        make(&stage, 1e-3, (enum stage_kind)kind,
             kind == STAGE_SLEW    ? 300.0
             : kind == STAGE_DELAY ? 1.9
                                   : 0.9,
             b);
        other = stage;
        double last = kind == STAGE_SLEW ? 1.0 : 0.1;
        (void)stage_run(&stage, 0.5);
        (void)stage_run(&stage, last);
        (void)stage_run(&other, 0.2);
        (void)stage_run(&other, last);
        other.result = stage.result;
        check_int("the state alone changes the hash", hash(&stage) != hash(&other), memory);
    }
}

/* Noise is a function of seed, tick and place: two elements, two seeds and two ticks differ. */
TEST(stage_noise_numbers)
{
    const struct stage_part part[2] = {{STAGE_NOISE, 1.0, 0.0}, {STAGE_NOISE, 1.0, 0.0}};
    double first[50], second[50];
    check_no_error("one", stage_init(&stage, 0.5, 3, part, 1));
    for (int i = 0; i < 50; i++)
        first[i] = stage_run(&stage, 0.0);
    check_no_error("two", stage_init(&other, 0.5, 3, part, 2));
    for (int i = 0; i < 50; i++)
        second[i] = stage_run(&other, 0.0) - first[i];
    for (int i = 0; i < 50; i++)
        check_true("two elements have two noises", first[i] != second[i] && second[i] != 0.0);
    stage_settle(&stage, 0.0, 20);
    check_near("from any first tick", stage_run(&stage, 0.0), first[20], 0.0);
    check_no_error("seed", stage_init(&stage, 0.5, 4, part, 1));
    check_true("another seed", stage_run(&stage, 0.0) != first[0]);
}

/* The bits are those of every compiler: all kinds in two chains, 20,000 ticks. */
TEST(stage_bits)
{
    static const struct stage_part chain[] = {
        {STAGE_GAIN, 1.25, 0.0},  {STAGE_SLEW, 3e4, 0.0},       {STAGE_HYSTERESIS, 2.0, 0.2},
        {STAGE_CREEP, 0.02, 0.0}, {STAGE_RESONANCE, 9e3, 0.07}, {STAGE_NOISE, 1e-4, 0.0},
        {STAGE_LAG, 4e4, 0.0},    {STAGE_CLIP, 1.1, 0.0},       {STAGE_QUANTISER, 1e-4, 0.0},
        {STAGE_DELAY, 7.3, 0.0},  {STAGE_FLICKER, 4e4, 1e-4},   {STAGE_DRIFT, 3.0, 0.0}};
    uint64_t seed = 5, sum = HASH_BEGIN;
    double u = 0.0;
    check_no_error("chain", stage_init(&stage, 1e-6, 77, chain, STAGE_PARTS));
    for (int i = 0; i < 20000; i++) {
        u = i % 100 == 0 ? 2.0 * exact_uniform(&seed) - 1.0 : u;
        sum = hash_double(sum, stage_run(&stage, u));
    }
    check_hex("results", sum, UINT64_C(0x637bc64e8b983984));
    check_hex("state", hash(&stage), UINT64_C(0x3b60dd411a2df73b));
}
