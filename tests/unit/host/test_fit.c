/* test_fit.c - the fit of a mean and a wave in `contactplant test`, against waves that are known. */
#include <math.h>
#include <stdio.h>
#include "host_sim/test/fit.h"
#include "models/math/elementary.h"
#include "tests/unit/test.h"

enum { SAMPLES = 6400 };

/* mean 7, a wave of 0.1 with so many periods in the window, and another one of size 1, which a drive plays
 * where `told`. */
static enum lockin_verdict fitted(double periods, double other, bool told, double *amplitude,
                                  double *phase_deg)
{
    struct fit f = {0};
    for (int i = 0; i < SAMPLES; i++) {
        double at = (i + 0.5) / SAMPLES, turns = periods * at + 0.123;
        double own = 2.0 * M_PI * (turns - 0.3), beside = 2.0 * M_PI * (other * at + 0.2);
        const struct fit_drive drive[MODEL_INPUTS] = {{cos(own), sin(own), periods / SAMPLES},
                                                      {cos(beside), sin(beside), other / SAMPLES}};
        fit_add(&f, at, turns_of(turns),
                7.0 + 0.1 * cos(2.0 * M_PI * turns + 0.5) +
                    (other > 0.0 ? cos(2.0 * M_PI * other * at) : 0.0),
                told ? drive : NULL);
    }
    return fit_solve(&f, periods / SAMPLES, SAMPLES, amplitude, phase_deg);
}

TEST(fit_wave)
{
    static const double periods[] = {1.0, 1.3, 2.5, 4.37, 97.7};
    double amplitude = 0.0, phase_deg = 0.0;
    for (int i = 0; i < 5; i++) {
        printf("      %g periods\n", periods[i]);
        check_int("told", fitted(periods[i], 0.0, i % 2, &amplitude, &phase_deg), LOCKIN_TOLD);
        check_near("amplitude", amplitude, 0.1, 1e-11);
        check_near("phase, deg", phase_deg, 90.0 / M_PI, 1e-8);
    }
    for (int d = 3; d < 40; d += 9) {
        double leak = 1.0 / (M_PI * (d + 0.5) * ((d + 0.5) * (d + 0.5) - 1.0));
        check_int("beside another wave", fitted(50.0, 50.5 + d, false, &amplitude, &phase_deg), LOCKIN_TOLD);
        check_near("amplitude, within its leakage", amplitude, 0.1, leak);
    }
    check_int("not told: 0.9 of a period", fitted(0.9, 0.0, true, &amplitude, &phase_deg), LOCKIN_SHORT);
}

/* Another drive's wave, ten times as large, does not leak, however near it is; or the fit says so. */
TEST(fit_beside_drive)
{
    static const double other[] = {0.4, 3.8, 5.9, 7.31, 200.0};
    double amplitude = 0.0, phase_deg = 0.0;
    for (int i = 0; i < 5; i++) {
        printf("      5 periods beside %g\n", other[i]);
        check_int("told", fitted(5.0, other[i], true, &amplitude, &phase_deg), LOCKIN_TOLD);
        check_near("amplitude", amplitude, 0.1, 1e-9);
        check_near("phase, deg", phase_deg, 90.0 / M_PI, 1e-6);
    }
    check_int("not told: half a beat", fitted(5.0, 5.5, true, &amplitude, &phase_deg), LOCKIN_CLOSE);
    check_int("equal drives are one wave", fitted(5.0, 5.0, true, &amplitude, &phase_deg), LOCKIN_TOLD);
}
