/* test_fit.c - the fit of a mean and a wave in `contactplant test`, against waves that are known. */
#include <math.h>
#include <stdio.h>
#include "host_sim/trial/fit.h"
#include "models/math/elementary.h"
#include "tests/unit/test.h"

enum { SAMPLES = 6400 };

/* mean 7, a wave of 0.1 with so many periods in the window, and another one of size 1. */
static bool fitted(double periods, double other, double *amplitude, double *phase_deg)
{
    struct fit f = {0};
    for (int i = 0; i < SAMPLES; i++) {
        double at = (i + 0.5) / SAMPLES, turns = periods * at + 0.123;
        fit_add(&f, at, turns_of(turns),
                7.0 + 0.1 * cos(2.0 * M_PI * turns + 0.5) +
                    (other > 0.0 ? cos(2.0 * M_PI * other * at) : 0.0));
    }
    return fit_solve(&f, amplitude, phase_deg);
}

TEST(fit_wave)
{
    static const double periods[] = {1.0, 1.3, 2.5, 4.37, 97.7};
    double amplitude = 0.0, phase_deg = 0.0;
    for (int i = 0; i < 5; i++) {
        printf("      %g periods\n", periods[i]);
        check_true("told", fitted(periods[i], 0.0, &amplitude, &phase_deg));
        check_near("amplitude", amplitude, 0.1, 1e-11);
        check_near("phase, deg", phase_deg, 90.0 / M_PI, 1e-8);
    }
    for (int d = 3; d < 40; d += 9) {
        double leak = 1.0 / (M_PI * (d + 0.5) * ((d + 0.5) * (d + 0.5) - 1.0));
        check_true("beside another wave", fitted(50.0, 50.5 + d, &amplitude, &phase_deg));
        check_near("amplitude, within its leakage", amplitude, 0.1, leak);
    }
    check_true("not told: 0.9 of a period", !fitted(0.9, 0.0, &amplitude, &phase_deg));
}
