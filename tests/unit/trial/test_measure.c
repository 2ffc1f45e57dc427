/* test_measure.c - windows that begin inside a tick, the instant of equal peaks, and what a fault of the
 * plant is where a case names it and where not. */
#include "host_sim/test/verdict.h"
#include "models/models.h"
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>

#define TICK_S 1e-3

static struct metric_value measure_ticks(const struct metric_setting *s, int n, const double *x)
{
    struct measurement m;
    struct metric_value v;
    measurement_begin(&m, s, TICK_S, false);
    measurement_ticks(&m, 0, n, x, NULL);
    measurement_end(&m, n * TICK_S, 0, &v);
    return v;
}

TEST(measure_window_inside_tick)
{
    static const double x[8] = {9, 9, 9, 1, 2, 3, 4, 9};
    struct metric_setting s = {.kind = METRIC_MAX, .from_s = 2.5 * TICK_S, .to_s = 6.5 * TICK_S};
    struct metric_value v = measure_ticks(&s, 8, x);
    check_near("the largest of ticks 3 to 6", v.value, 4.0, 0.0);
    check_near("  at, s", v.when_s, 6 * TICK_S, 1e-15);
    s.kind = METRIC_MEAN;
    v = measure_ticks(&s, 8, x);
    check_near("their mean, by trapezoids", v.value, 2.5, 1e-15);
    s.from_s = 0.003; /* 3.0000000000000004 ticks as a double may have it */
    s.to_s = 0.006;
    v = measure_ticks(&s, 8, x);
    check_near("a window of whole ticks has both ends", v.value, 2.5, 1e-15);
}

TEST(measure_first_of_equal_peaks)
{
    static const double x[8] = {0, 1, 5, 1, 5, -2, 1, -2};
    static const struct {
        enum metric_kind kind;
        const char *name;
        double target, value, when_s;
    } row[] = {{METRIC_MAX, "max", 0.0, 5.0, 2 * TICK_S},
               {METRIC_MIN, "min", 0.0, -2.0, 5 * TICK_S},
               {METRIC_OVERSHOOT, "overshoot of 5 on the way to 4, %", 4.0, 25.0, 2 * TICK_S},
               {METRIC_OVERSHOOT, "overshoot of -2 on the way to -1, %", -1.0, 100.0, 5 * TICK_S}};
    for (int i = 0; i < 4; i++) {
        struct metric_setting s = {.kind = row[i].kind, .to_s = 1.0, .target = row[i].target, .band = 0.1};
        struct metric_value v = measure_ticks(&s, 8, x);
        check_near(row[i].name, v.value, row[i].value, 1e-12);
        check_near("  the first one dates it, s", v.when_s, row[i].when_s, 1e-15);
    }
}

/* Two touchdowns of equal speed, two lift-offs of equal force, at these ticks. */
static struct metric_value measure_events(enum metric_kind kind)
{
    const struct metric_setting s = {.kind = kind, .to_s = 1.0};
    struct measurement m;
    struct metric_value v;
    measurement_begin(&m, &s, TICK_S, false);
    for (int i = 0; i < 4; i++) {
        struct event e = {.tick = 10u * (unsigned)(i + 1), .fraction = 0.5, .touch = i % 2 == 0};
        e.speed = 0.25;
        e.peak_force = e.touch ? 0.0 : 40.0;
        measurement_event(&m, &e);
    }
    measurement_end(&m, 1.0, 0, &v);
    return v;
}

TEST(measure_first_of_equal_impacts)
{
    struct metric_value v = measure_events(METRIC_IMPACT_SPEED);
    check_near("impact_speed, m/s", v.value, 0.25, 0.0);
    check_near("  the first one dates it, s", v.when_s, 10.5 * TICK_S, 1e-15);
    v = measure_events(METRIC_PEAK_FORCE);
    check_near("peak_force, N", v.value, 40.0, 0.0);
    check_near("  the first one dates it, s", v.when_s, 20.5 * TICK_S, 1e-15);
}

TEST(measure_first_of_equal_silences)
{
    const struct metric_setting s = {.kind = METRIC_SILENCE, .to_s = 1.0};
    static const double silence_s[] = {0.0, 0.02, 0.05, 0.01, 0.05};
    struct measurement m;
    struct metric_value v;
    measurement_begin(&m, &s, TICK_S, false);
    for (int i = 0; i < 5; i++)
        measurement_frame(&m, 0.1 * i, silence_s[i]);
    measurement_end(&m, 1.0, 0, &v);
    check_near("silence, s", v.value, 0.05, 0.0);
    check_near("  the first one dates it, s", v.when_s, 0.2, 1e-15);
}

/* A case of a plant that latched a fault, which expects `kind == 0`. */
static void judge_fault(enum metric_kind kind, struct bench_result *r)
{
    static struct test_case c;
    static struct measurement m[VERDICT_MEASUREMENTS];
    static const uint32_t count[DIAG_COUNTERS];
    const struct evidence e = {1.0, 0, FAULT_LEDGER, count};
    struct metric_setting s[VERDICT_MEASUREMENTS];
    memset(&c, 0, sizeof c);
    memset(r, 0, sizeof *r);
    c.over_s = 1.0;
    c.n_expects = 1;
    c.expect[0] =
        (struct test_expect){.line = 7, .op = TEST_EQUAL, .one = 1.0, .what = {.kind = kind, .to_s = 1.0}};
    int n = verdict_settings(&c, s);
    for (int i = 0; i < n; i++) {
        measurement_begin(&m[i], &s[i], TICK_S, false);
        measurement_frame(&m[i], 0.5, s[i].kind == METRIC_FAULTS ? metric_faults(e.faults) : 0.0);
    }
    verdict_judge(&e, &c, m, n, r);
}

TEST(verdict_of_named_faults)
{
    static struct bench_result r;
    judge_fault(METRIC_FAULTS, &r);
    check_int("expect faults == 0, which does not hold", r.verdict, VERDICT_FAIL);
    check_contains("  names it", r.outcome[0].found, "ledger");
    judge_fault(METRIC_REFUSED, &r);
    check_int("a fault that the case does not name is the bench's error", r.verdict, VERDICT_ERROR);
}
