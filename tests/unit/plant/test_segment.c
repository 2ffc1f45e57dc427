/* test_segment.c - parts of a segment against the uncut waves. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "tests/fixture/exact.h"

/* Head and tail of a segment against the uncut waves, with offset, slope, growth and any frequency. */
TEST(segment_split)
{
    struct segment whole, e, head, cut_head, rest;
    uint64_t seed = 3;
    int different = 0;
    double error = 0.0, rate = 0.0, length = 0.0;
    for (int i = 0; i < 2000; i++) {
        whole = (struct segment){.length = 0.05 + exact_uniform(&seed), .active = 7};
        for (int k = 0; k < MODEL_INPUTS; k++) {
            double phase = 6.0 * exact_uniform(&seed);
            whole.wave[k] = (struct wave){exact_uniform(&seed),
                                          exact_uniform(&seed),
                                          exact_uniform(&seed),
                                          exact_uniform(&seed),
                                          cos(phase),
                                          sin(phase),
                                          10.0 * exact_uniform(&seed) - 5.0};
            whole.at[2][k].value = (double)exact_wave(&whole.wave[k], (long double)whole.length);
            whole.at[2][k].rate = (double)exact_wave_rate(&whole.wave[k], (long double)whole.length);
        }
        e = whole;
        double done = 0.0;
        for (int cut = 0; cut < 3; cut++) { /* the tail of a tail of a tail */
            double part = e.length * exact_uniform(&seed);
            rest = e;
            segment_head(&e, MODEL_INPUTS, part, &head);
            segment_tail(&e, MODEL_INPUTS, part);
            segment_cut(&rest, MODEL_INPUTS, part, &cut_head);
            different += memcmp(&rest, &e, sizeof e) != 0 || cut_head.length != part ||
                         cut_head.active != e.active ||
                         memcmp(cut_head.at, head.at, 3 * sizeof head.at[0]) != 0;
            exact_worst(&length, (long double)head.length - (long double)part);
            exact_worst(&length, (long double)(done + part + e.length) - (long double)whole.length);
            for (int k = 0; k < 3; k++) {
                const struct wave *w = &whole.wave[k];
                for (int j = 0; j < 3; j++) {
                    long double s = (long double)done + 0.5L * (long double)part * j;
                    long double t = (long double)done + (long double)part + 0.5L * (long double)e.length * j;
                    if (j > 0) {
                        exact_worst(&error, (long double)head.at[j][k].value - exact_wave(w, s));
                        exact_worst(&rate, (long double)head.at[j][k].rate - exact_wave_rate(w, s));
                    }
                    exact_worst(&error, (long double)e.at[j][k].value - exact_wave(w, t));
                    exact_worst(&rate, (long double)e.at[j][k].rate - exact_wave_rate(w, t));
                }
                exact_worst(&error, exact_wave(&e.wave[k], 0.01L) -
                                        exact_wave(w, (long double)done + (long double)part + 0.01L));
            }
            done += part;
        }
    }
    check_int("cuts with other bits than head and tail", different, 0);
    check_true("the tail is marked as changed", e.changed);
    check_below("values of heads and tails", error, 1e-13);
    check_below("rates of heads and tails", rate, 1e-9);
    check_below("lengths", length, 1e-15);
    segment_head(&whole, MODEL_INPUTS, 0.01, &head);
    check_is("an input that is not active stays as it was", head.at[1][3].value, ==, whole.at[1][3].value);
}
