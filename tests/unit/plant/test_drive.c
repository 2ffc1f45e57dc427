/* test_drive.c - drives against closed forms in extended precision. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/drive.h"
#include "models/math/elementary.h"
#include "tests/fixture/exact.h"

/* Every test counts model time in units of which a tick has PER_TIME. */
#define PER_TIME 40.0

static bool segment(struct drive *d, uint32_t length, struct wave *w, struct input at[3])
{
    return drive_segment(d, length, PER_TIME, w, &at[0], &at[1], &at[2]);
}

/* A drive with the plant's way of cutting time: at ticks, at corners, at chosen instants. */
struct bench {
    struct drive d;
    uint64_t tick;
    uint32_t fraction;
    struct wave w;
    struct input at[3];
    double worst_value, worst_rate, worst_unit; /* largest differences of at[] from the wave */
    double worst_jump;                          /* largest jump from an end to the next start */
    int joined;                                 /* the next start must meet the last end */
};

static void bench_init(struct bench *b)
{
    *b = (struct bench){.tick = 0};
    drive_init(&b->d);
}

static void bench_segment(struct bench *b, uint32_t length)
{
    double end = b->at[2].value, time = (double)length / TICK_FRACTIONS / PER_TIME;
    segment(&b->d, length, &b->w, b->at);
    if (b->joined)
        exact_worst(&b->worst_jump, (long double)b->at[0].value - (long double)end);
    b->joined = 1;
    for (int k = 0; k < 3; k++) {
        long double s = 0.5L * (long double)time * k, rate = exact_wave_rate(&b->w, s);
        exact_worst(&b->worst_value, (long double)b->at[k].value - exact_wave(&b->w, s));
        exact_worst(&b->worst_rate, ((long double)b->at[k].rate - rate) / (1.0L + fabsl(rate)));
    }
    exact_worst(&b->worst_unit, hypotl((long double)b->w.cosine, (long double)b->w.sine) - 1.0L);
    b->fraction += length;
    b->tick += b->fraction >> 16;
    b->fraction &= 0xFFFFu;
}

static void bench_to(struct bench *b, uint64_t tick, uint32_t fraction)
{
    while (b->tick < tick || (b->tick == tick && b->fraction < fraction)) {
        uint32_t length = (b->tick == tick ? fraction : TICK_FRACTIONS) - b->fraction;
        uint64_t corner = drive_corner(&b->d);
        bench_segment(b, corner < length ? (uint32_t)corner : length);
    }
}

static double bench_now(const struct bench *b)
{
    return (double)b->tick + (double)b->fraction / TICK_FRACTIONS;
}

static void check_bench(const struct bench *b)
{
    check_below("values against the wave's formula", b->worst_value, 1e-12);
    check_below("rates against the derivative by differences, relative to 1 + |rate|", b->worst_rate, 1e-9);
    check_below("phasor length minus 1", b->worst_unit, 1e-13);
    check_below("jump of the value between segments", b->worst_jump, 1e-12);
}

/* 2e7 ticks one by one, and the rest of 1e9 by the integer: phase is exact, the phasor near. */
TEST(drive_phase_exact)
{
    enum { STEPS = 20000000 };
    const double f = 0.1234567890123;
    const struct drive_setting s = {.amplitude = 1.0, .turns_per_tick = f, .phase_turns = 0.375};
    struct drive d;
    struct wave w;
    struct input at[3];
    double phasor = 0.0, value = 0.0, rate = 0.0;
    drive_init(&d);
    drive_start(&d, &s);
    check_hex("step against the double's digits", d.step, exact_phase(f, 1));
    for (uint64_t i = 0; i < STEPS; i++) {
        segment(&d, TICK_FRACTIONS, &w, at);
        if (i > 4 * PHASOR_RESYNC_TICKS && i < STEPS - 4 * PHASOR_RESYNC_TICKS)
            continue;
        long double omega = EXACT_TURN * (long double)f * (long double)PER_TIME;
        for (int k = 0; k < 3; k++) {
            uint64_t half = (uint64_t)k * (exact_phase(f, 1) >> 1);
            long double theta = exact_angle(exact_phase(f, i) + UINT64_C(0x6000000000000000) + half);
            exact_worst(&value, (long double)at[k].value - cosl(theta));
            exact_worst(&rate, (long double)at[k].rate + omega * sinl(theta));
            if (k == 0)
                exact_worst(&phasor,
                            hypotl((long double)w.cosine - cosl(theta), (long double)w.sine - sinl(theta)));
        }
    }
    check_hex("carrier after 2e7 ticks", d.carrier, exact_phase(f, STEPS));
    d.carrier += exact_phase(f, 1000000000 - STEPS);
    d.phasor_valid = false;
    segment(&d, TICK_FRACTIONS, &w, at);
    check_hex("carrier after 1e9 + 1 ticks", d.carrier, exact_phase(f, 1000000001));
    check_near("cosine at tick 1e9", w.cosine,
               (double)cosl(EXACT_TURN * (0.375L + fmodl(1e9L * (long double)f, 1.0L))),
               1e-10); /* the 64 bits of 1e9 f leave 1e-11 of a turn to the right hand side */
    check_below("phasor over 2000 ticks at either end against the exact phase", phasor, 1e-12);
    check_below("values there", value, 1e-12);
    check_below("rates there, omega about 31", rate, 4e-11);
}

/* Amplitude, frequency and phase move linearly over `ticks`
 * from the instant `begin`: the value in closed form. */
struct ramp {
    double begin, ticks;
    struct drive_setting from, to;
};

static long double ramp_value(const struct ramp *r, double now, double *frequency)
{
    long double t = (long double)now - (long double)r->begin;
    long double u = t < (long double)r->ticks ? t : (long double)r->ticks, x = u / (long double)r->ticks;
    long double f0 = (long double)r->from.turns_per_tick, f1 = (long double)r->to.turns_per_tick;
    long double a0 = (long double)r->from.amplitude, a1 = (long double)r->to.amplitude;
    long double p0 = (long double)r->from.phase_turns, p1 = (long double)r->to.phase_turns;
    long double turns = f0 * u + 0.5L * (f1 - f0) * u * x + f1 * (t - u) + p0 + (p1 - p0) * x;
    *frequency = (double)(f0 + (f1 - f0) * x);
    return (a0 + (a1 - a0) * x) * cosl(EXACT_TURN * fmodl(turns, 1.0L));
}

/* Runs a ramp that begins at the bench's instant; the bench's carrier must have been started there. */
static void check_ramp(struct bench *b, const struct ramp *r, double last)
{
    double start = 0.0, end = 0.0, middle = 0.0, frequency;
    while (bench_now(b) < last) {
        double before = bench_now(b), after;
        bench_to(b, b->tick + 1, 0);
        after = bench_now(b);
        exact_worst(&end, (long double)b->at[2].value - ramp_value(r, after, &frequency));
        if (after - before == 1.0 && !(before < r->begin + r->ticks && after > r->begin + r->ticks)) {
            exact_worst(&start, (long double)b->at[0].value - ramp_value(r, before, &frequency));
            exact_worst(&middle, (long double)b->at[1].value - ramp_value(r, before + 0.5, &frequency));
        }
    }
    check_below("value at the start of each tick against the closed form", start, 1e-12);
    check_below("value at its end", end, 1e-12);
    /* The frequency is constant within a tick: the middle of
     * a chirp is off by an eighth of its change in a tick. */
    double bend = fabs(r->to.turns_per_tick - r->from.turns_per_tick) / r->ticks;
    double amplitude = fmax(fabs(r->from.amplitude), fabs(r->to.amplitude));
    check_below("value at its middle, over the chirp's bound", middle,
                1.01 * amplitude * (double)EXACT_TURN * bend / 8.0 + 1e-12);
    check_bench(b);
}

TEST(drive_ramp)
{
    const struct drive_setting from = {1.0, 0.01, 0.2, 0};
    /* the last one runs its phase back faster than the carrier runs on: the wave turns the other way round */
    const struct drive_setting to[5] = {{2.5, 0.01, 0.2, 100},
                                        {1.0, 0.13, 0.2, 250},
                                        {1.0, 0.01, 0.55, 37},
                                        {0.3, 0.003, 0.6, 64},
                                        {1.0, 0.01, -0.2, 4}};
    for (int i = 0; i < 5; i++) {
        struct bench b;
        struct ramp r = {0.0, (double)to[i].ramp_ticks, from, to[i]};
        bench_init(&b);
        drive_start(&b.d, &from);
        drive_change(&b.d, &to[i]);
        check_ramp(&b, &r, 2.0 * r.ticks + 300.0);
        check_is("amplitude ends exactly", b.d.amplitude, ==, to[i].amplitude);
        check_hex("frequency ends exactly", b.d.step, exact_phase(to[i].turns_per_tick, 1));
    }
}

/* A ramp that begins at a fraction of a tick. */
TEST(drive_ramp_fraction)
{
    const struct drive_setting from = {1.0, 0.02, 0.0, 0}, to = {3.0, 0.05, 0.25, 20};
    struct bench b;
    bench_init(&b);
    drive_start(&b.d, &from);
    bench_to(&b, 10, 24321);
    struct ramp r = {bench_now(&b), 20.0, from, to};
    r.from.phase_turns = from.turns_per_tick * r.begin;
    r.to.phase_turns = to.phase_turns + r.from.phase_turns;
    drive_change(&b.d, &to);
    check_ramp(&b, &r, 400.0);
}

/* A second change during a ramp starts from where the first was left. */
TEST(drive_ramp_interrupted)
{
    const struct drive_setting from = {1.0, 0.02, 0.0, 0}, first = {2.0, 0.06, 0.0, 40},
                               second = {0.5, 0.01, 0.0, 30};
    struct bench b;
    double frequency;
    bench_init(&b);
    drive_start(&b.d, &from);
    drive_change(&b.d, &first);
    bench_to(&b, 10, 1000);
    struct ramp r = {0.0, 40.0, from, first};
    double now = bench_now(&b), x = now / 40.0;
    long double value = ramp_value(&r, now, &frequency);
    check_near("value when interrupted", b.at[2].value, (double)value, 1e-12);
    check_near("amplitude when interrupted", b.d.amplitude, 1.0 + x, 1e-15);
    check_near("frequency when interrupted, turns per tick", (double)b.d.step / 18446744073709551616.0,
               frequency, 1e-15);
    struct ramp next = {now, 30.0, {1.0 + x, frequency, 0.0, 0}, second};
    next.from.phase_turns = 0.02 * now + 0.5 * 0.04 * now * x;
    next.to.phase_turns = next.from.phase_turns;
    drive_change(&b.d, &second);
    check_ramp(&b, &next, 100.0);
}

/* A silent drive starts at the phase commanded; a sounding
 * one goes on, and moves to a new phase within its ramp. */
TEST(drive_start_phase)
{
    const struct drive_setting first = {1.0, 0.07, 0.125, 5}, faster = {1.0, 0.09, 0.125, 1},
                               off = {0, 0.09, 0.5, 3};
    struct bench b;
    bench_init(&b);
    bench_to(&b, 100, 777);
    drive_change(&b.d, &first);
    bench_segment(&b, 1);
    check_near("first cosine of a silent drive", b.w.cosine, sqrt(0.5), 1e-15);
    check_near("first sine of a silent drive", b.w.sine, sqrt(0.5), 1e-15);
    bench_to(&b, 120, 0);
    uint64_t carrier = b.d.carrier;
    drive_change(&b.d, &faster);
    bench_to(&b, 140, 0);
    /* one tick of ramp at the mean frequency 0.08, nineteen at 0.09 */
    check_near("phase of a sounding drive, turns since its change", turns_to_double(b.d.carrier - carrier),
               0.08 + 19 * 0.09 - 2.0, 1e-14);
    drive_change(&b.d, &off);
    bench_to(&b, 150, 0);
    check_true("silent at the end of a ramp to zero", !drive_active(&b.d));
    bench_to(&b, 161, 0);
    b.joined = 0;
    drive_change(&b.d, &first);
    bench_segment(&b, 1);
    check_near("first cosine after a silence", b.w.cosine, sqrt(0.5), 1e-15);
    check_bench(&b);
    drive_init(&b.d);
    drive_change(&b.d, &(struct drive_setting){2.0, 0.1, 0.0, 0});
    check_int("a ramp of 0 ticks takes one, in 1/65536 tick", (int64_t)drive_corner(&b.d), TICK_FRACTIONS);
}

TEST(drive_samples)
{
    struct bench b;
    double off = 0.0;
    bench_init(&b);
    drive_sample(&b.d, 0.7, 0);
    bench_segment(&b, 30000);
    check_is("hold: at the value from the first instant", b.at[0].value, ==, 0.7);
    check_is("hold: at the value from the first instant", b.at[2].value, ==, 0.7);
    check_is("hold: no rate", b.at[0].rate, ==, 0.0);
    check_is("hold: no rate", b.at[1].rate, ==, 0.0);
    check_is("hold: no rate", b.at[2].rate, ==, 0.0);
    drive_sample(&b.d, -0.1, 7);
    double begin = bench_now(&b);
    while (drive_corner(&b.d) < UINT64_MAX) {
        bench_to(&b, b.tick + 1, 0);
        double now = bench_now(&b);
        exact_worst(&off, (long double)b.at[2].value -
                              (0.7L - 0.8L * fminl((long double)(now - begin), 7.0L) / 7.0L));
    }
    check_below("linear: on the line", off, 1e-15);
    check_is("linear: ends exactly at the value", b.d.sample, ==, -0.1);
    check_is("linear: ends exactly at the value", b.at[2].value, ==, -0.1);
    check_near("linear: ends after 7 ticks", floor(bench_now(&b)), floor(begin) + 8.0, 0.0);
    drive_sample(&b.d, 0.3, 4);
    bench_to(&b, b.tick + 2, 0);
    check_near("half way", b.at[2].value, 0.1, 1e-15);
    check_near("rate of a slope, 0.1 a tick", b.at[1].rate, 0.1 * PER_TIME, 1e-13);
    drive_sample(&b.d, 0.0, 2);
    bench_to(&b, b.tick + 1, 0);
    check_near("a new sample bends the line where it is", b.at[2].value, 0.05, 1e-15);
    bench_to(&b, b.tick + 1, 0);
    check_true("silent when back at zero", !drive_active(&b.d));
    check_is("silent when back at zero", b.d.sample, ==, 0.0);
    drive_sample(&b.d, 1.0, 4);
    bench_to(&b, b.tick + 1, 0);
    drive_sample(&b.d, 0.25, 0);
    check_int("hold ends a running slope", drive_corner(&b.d), UINT64_MAX);
    check_is("hold ends a running slope", b.d.sample, ==, 0.25);
    check_bench(&b);
}

/* A sample moves the offset alone: beside 5000 samples, one each tick, the tone has the bits of one without
 * samples, and an input says each time that it changed. Slopes end the kept phasor; its phase stays exact. */
TEST(drive_samples_keep_phasor)
{
    const struct drive_setting tone = {
        .amplitude = 1.0, .turns_per_tick = 0.0123456789, .phase_turns = 0.375};
    struct drive held, bare;
    struct wave w, alone;
    struct input at[3], bare_at[3];
    double phasor = 0.0;
    int same = 0, told = 0;
    drive_init(&held);
    drive_start(&held, &tone);
    bare = held;
    for (uint64_t i = 0; i < 5000; i++) {
        drive_sample(&held, 1e-3 * (double)(i % 7), 0);
        told += segment(&held, TICK_FRACTIONS, &w, at);
        segment(&bare, TICK_FRACTIONS, &alone, bare_at);
        same += memcmp(&w.cosine, &alone.cosine, sizeof w.cosine) == 0 &&
                memcmp(&w.sine, &alone.sine, sizeof w.sine) == 0;
    }
    check_int("ticks whose tone has the bits of one without samples", same, 5000);
    check_int("ticks that tell of a new input", told, 5000);
    for (uint64_t i = 5000; i < 9000; i++) {
        drive_sample(&held, 1e-3 * (double)(i % 7), i % 50 == 0 ? 3 : 0);
        segment(&held, TICK_FRACTIONS, &w, at);
        long double theta = exact_angle(exact_phase(tone.turns_per_tick, i) + UINT64_C(0x6000000000000000));
        exact_worst(&phasor, hypotl((long double)w.cosine - cosl(theta), (long double)w.sine - sinl(theta)));
    }
    check_below("phasor between slopes and samples against the exact phase", phasor, 1e-12);
}

/* 20,000 commands of all kinds at fractional instants, several of them inside running ramps. */
TEST(drive_random_walk)
{
    struct bench b;
    uint64_t seed = 1;
    double phase = 0.0;
    bench_init(&b);
    for (int i = 0; i < 20000; i++) {
        int kind = (int)(3.0 * exact_uniform(&seed));
        double value = 2.0 * exact_uniform(&seed) - 1.0;
        struct drive_setting s = {value, 0.3 * exact_uniform(&seed), exact_uniform(&seed) - 0.5,
                                  (uint64_t)(6 * exact_uniform(&seed))};
        if (kind == 0)
            drive_change(&b.d, &s);
        else
            drive_sample(&b.d, value, kind == 1 ? 0 : 1 + (uint64_t)(5 * exact_uniform(&seed)));
        if (kind == 1)
            b.joined = 0;
        bench_to(&b, b.tick + 1 + (uint64_t)(8 * exact_uniform(&seed)),
                 (uint32_t)(65535 * exact_uniform(&seed)));
        long double theta = exact_angle(b.d.carrier + b.d.offset);
        /* the end of the last segment, by the drive's own integers */
        exact_worst(&phase, (long double)b.at[2].value -
                                ((long double)b.d.sample + (long double)b.d.amplitude * cosl(theta)));
    }
    check_below("ends against the integer phase", phase, 1e-12);
    check_bench(&b);
}

/* Cutting ticks into parts changes nothing but 2^-64 turn a cut. */
TEST(drive_parts_of_a_tick)
{
    const struct drive_setting from = {1.0, 0.2345678, 0.1, 0}, to = {2.0, 0.1, 0.3, 50};
    struct bench whole, parts;
    uint64_t seed = 7;
    double ends = 0.0;
    int64_t cuts = 0;
    bench_init(&whole);
    drive_start(&whole.d, &from);
    parts = whole;
    for (int i = 0; i < 2000; i++) {
        bench_to(&whole, whole.tick + 1, 0);
        while (parts.tick < whole.tick) {
            uint32_t fraction = parts.fraction + 1 + (uint32_t)(30000 * exact_uniform(&seed));
            bench_to(&parts, parts.tick + (fraction >= 65536), fraction >= 65536 ? 0 : fraction);
            cuts++;
        }
        exact_worst(&ends, (long double)whole.at[2].value - (long double)parts.at[2].value);
    }
    int64_t lost = (int64_t)(whole.d.carrier - parts.d.carrier);
    check_is("phase units lost are between 0 and the number of cuts", lost, >=, 0);
    check_is("phase units lost are between 0 and the number of cuts", lost, <=, cuts);
    check_below("values at tick ends", ends, 1e-13);
    drive_change(&whole.d, &to);
    drive_change(&parts.d, &to);
    while (whole.tick < 2100) {
        bench_to(&whole, whole.tick + 1, 0);
        bench_to(&parts, parts.tick, 1 + (uint32_t)(65534 * exact_uniform(&seed)));
        bench_to(&parts, parts.tick + 1, 0);
        exact_worst(&ends, (long double)whole.at[2].value - (long double)parts.at[2].value);
    }
    check_below("values at tick ends with a ramp", ends, 1e-12);
    check_bench(&parts);
}

TEST(drive_bookkeeping)
{
    struct bench b;
    bench_init(&b);
    check_true("a new drive is not active and has no corner", !drive_active(&b.d));
    check_int("a new drive is not active and has no corner", drive_corner(&b.d), UINT64_MAX);
    drive_change(&b.d, &(struct drive_setting){2.0, 0.11, -0.25, 10});
    drive_sample(&b.d, 5.0, 3);
    check_int("corner: the nearer of slope and ramp", (int64_t)drive_corner(&b.d), 3 * TICK_FRACTIONS);
    struct drive_setting t = drive_target(&b.d);
    check_near("target amplitude during the ramp", t.amplitude, 2.0, 0.0);
    check_near("target frequency", t.turns_per_tick, 0.11, 1e-16);
    check_near("target phase", t.phase_turns, -0.25, 1e-16);
    bench_to(&b, 3, 0);
    check_int("corner: then the ramp's end", (int64_t)drive_corner(&b.d), 7 * TICK_FRACTIONS);
    drive_rescale(&b.d, 4.0);
    check_near("rescaled amplitude now", b.d.amplitude, 4.0 * 2.0 * 0.3, 1e-14);
    check_near("rescaled sample", b.d.sample, 20.0, 0.0);
    bench_to(&b, 4, 0);
    check_near("rescaled ramp goes on to four times its end", drive_target(&b.d).amplitude, 8.0, 0.0);
    bench_to(&b, 20, 0);
    t = drive_target(&b.d);
    check_near("target after the ramp", t.amplitude, 8.0, 0.0);
    check_true("active while it sounds", drive_active(&b.d));
    drive_init(&b.d);
    drive_sample(&b.d, 1.0, 2);
    bench_segment(&b, TICK_FRACTIONS);
    drive_rescale(&b.d, 3.0);
    bench_segment(&b, TICK_FRACTIONS / 2);
    check_near("a rescaled slope goes on", b.d.sample, 2.25, 1e-15);
    bench_segment(&b, TICK_FRACTIONS / 2);
    check_near("and ends at the rescaled value", b.d.sample, 3.0, 0.0);
    check_true("a steady wave ran on",
               !segment(&b.d, TICK_FRACTIONS, &b.w, b.at) || !segment(&b.d, TICK_FRACTIONS, &b.w, b.at));
    drive_sample(&b.d, 2.0, 0);
    check_true("a jump is reported as a change", segment(&b.d, TICK_FRACTIONS, &b.w, b.at));
}
