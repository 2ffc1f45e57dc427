/* test_lockin_fit.c - a mean and waves that are known, told by their sums under a Hann window. */
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include "firmware/observe/lockin_fit.h"
#include "models/math/elementary.h"
#include "tests/unit/test.h"

#define TWO_PI 6.283185307179586477
#define J      ((double complex)I) /* I is a complex float */

/* Waves by their periods in the window; amplitude and phase of wave k are k + 1 and k / 2. */
struct waves {
    uint32_t n_ticks;
    int n;
    double periods[LOCKIN_TONES];
    double mean;
};

/* The last wave as the fit tells it. */
static enum lockin_verdict told(const struct waves *s, double complex *last)
{
    struct lockin_tone tone[LOCKIN_TONES];
    struct lockin_window w;
    struct lockin_sum z = {0.0, 0.0};
    double mean = 0.0;
    lockin_begin(&w, s->n_ticks);
    for (int k = 0; k < s->n; k++) {
        double rate = s->periods[k] / s->n_ticks;
        tone[k] = (struct lockin_tone){rate, turns_of(0.5 * rate * (s->n_ticks - 1.0)), {0.0, 0.0}};
    }
    for (uint32_t i = 0; i < s->n_ticks; i++) {
        double y = s->mean, weight = lockin_weight(&w);
        for (int k = 0; k < s->n; k++)
            y += (k + 1) * cos(TWO_PI * tone[k].rate * i + 0.5 * k);
        mean += weight * y;
        for (int k = 0; k < s->n; k++)
            lockin_add(&tone[k].sum, 1, weight * y, cos(TWO_PI * tone[k].rate * i),
                       sin(TWO_PI * tone[k].rate * i));
    }
    enum lockin_verdict v = lockin_fit(&w, tone, s->n, mean, &z);
    *last = z.re + J * z.im;
    return v;
}

TEST(lockin_fit_waves)
{
    static const struct waves set[] = {
        {1000, 1, {1.0}, 100.0},
        {1000, 1, {1.37}, 100.0},
        {641, 2, {3.1, 4.2}, -30.0},
        {641, 2, {320.4, 4.2}, 10.0}, /* near half a turn a tick, and folded about it */
        {641, 2, {637.9, 4.2}, 10.0},
        {640, 3, {0.3, 6.3, 3.1}, 100.0}, /* one that mean and others cannot be told from */
        {64, 5, {2.0, 5.5, 8.1, 11.3, 14.9}, 100.0},
        {640000, 1, {43.7}, 1e6},
        {10, 1, {2.2}, 100.0},
    };
    for (int i = 0; i < 9; i++) {
        double complex z = 0.0, right = set[i].n * cexp(J * 0.5 * (set[i].n - 1));
        int verdict = (int)told(&set[i], &z);
        printf("      %u ticks, %d waves\n", (unsigned)set[i].n_ticks, set[i].n);
        check_int("told", verdict, LOCKIN_TOLD);
        check_below("off the wave", cabs(z - right), i == 5 ? 1e-4 : 1e-6);
    }
}

TEST(lockin_fit_verdicts)
{
    double complex z = 0.0;
    static const struct waves brief = {1000, 1, {0.97}, 0.0}, beside = {1000, 2, {10.6, 10.0}, 0.0},
                              clear = {1000, 2, {10.8, 10.0}, 0.0}, folded = {1000, 1, {500.0}, 0.0};
    check_int("0.97 periods", (int)told(&brief, &z), LOCKIN_SHORT);
    check_int("0.6 periods beside another", (int)told(&beside, &z), LOCKIN_CLOSE);
    check_int("0.8 periods beside another", (int)told(&clear, &z), LOCKIN_TOLD);
    check_int("half a turn a tick has no sine", (int)told(&folded, &z), LOCKIN_CLOSE);
}
