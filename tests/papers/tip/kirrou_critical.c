/* kirrou_critical.c - see kirrou_paper.h: signs of rho_n and rho_n + rho_l, beside the stability of rest. */
#include <math.h>
#include "tests/fixture/mathieu.h"
#include "tests/papers/tip/kirrou_paper.h"
#include "tests/papers/rows.h"

enum { ROUNDS = 60 };
static const double silicon = 29.721805; /* beta of the lever of section 3.3 at the published indentation */

/* ---- figures 9 to 12 and 15: the critical amplitudes ---- */

/* rho_n, with (which 1) or without (0) rho_l. */
static double criterion(double beta, double r, double fast, int which)
{
    struct tip_theory t = kirrou_theory(beta, r, fast);
    return t.rho_n + which * t.rho_l;
}

/* The smallest r up to `most` where the criterion changes its sign with w1 real on both sides, for where w1
 * ends it has a pole; NaN: none. */
static double critical(double beta, double fast, int which, double most)
{
    double step = most / 400.0;
    for (int i = 1; i <= 400; i++) {
        double low = step * (i - 1), high = step * i, sign = criterion(beta, low, fast, which);
        bool real = kirrou_theory(beta, low, fast).w1 > 0.0 && kirrou_theory(beta, high, fast).w1 > 0.0;
        if (!(real && sign * criterion(beta, high, fast, which) < 0.0))
            continue;
        for (int k = 0; k < ROUNDS; k++) {
            double middle = 0.5 * (low + high);
            *(sign * criterion(beta, middle, fast, which) > 0.0 ? &low : &high) = middle;
        }
        return low;
    }
    return (double)NAN;
}

/* The smallest r at which the modulation destabilises the rest position of the linear part; NaN above 2. */
static double unstable_from(double beta, double fast)
{
    double low = 0.0;
    for (double step = 0.02; step > 1e-4; step *= 0.5) {
        for (;; low += step) {
            struct mathieu m = {0.02, 1.0 - beta, beta * (low + step), fast};
            double map[2][2];
            double complex mu[2];
            mathieu_map(&m, &taylor, 1e-11, 40, map);
            mathieu_multipliers(map, mu);
            if (cabs(mu[0]) >= 1.0)
                break;
            if (low > 2.0)
                return (double)NAN;
        }
    }
    return low;
}

void kirrou_draw_critical(void)
{
    for (int i = 0; i <= KIRROU_CURVE; i++) {
        struct tip_theory t = kirrou_theory(0.8, 1.0 * i / KIRROU_CURVE, 1.0);
        rows_point("9", "rho_n", 1.0 * i / KIRROU_CURVE, t.rho_n);
        rows_point("9", "rho_l", 1.0 * i / KIRROU_CURVE, t.rho_l);
        rows_point("9", "sum", 1.0 * i / KIRROU_CURVE, t.rho_n + t.rho_l);
    }
    rows_break();
    double at = 0.0, best = -1.0, a;
    for (double r = 0.0; r <= 1.0; r += 0.001) {
        struct tip_theory t = kirrou_theory(0.8, r, 1.0);
        double sigma = theory_tip_peak(&t, KIRROU_DRIVE, &a);
        if (sigma > best) {
            best = sigma;
            at = r;
        }
    }
    rows_number("fig 8: largest detuning of the peak at r", at);
    rows_number("r_l", critical(0.8, 1.0, 1, 1.0));
    rows_number("r_s", critical(0.8, 1.0, 0, 1.0));
    for (int i = 0; i <= 60; i++) {
        double fast = 0.4 + 0.02 * i;
        rows_point("10", "linear", critical(0.8, fast, 1, 1.5), fast);
        rows_point("10", "turn", critical(0.8, fast, 0, 1.5), fast);
        rows_point("10", "unstable", unstable_from(0.8, fast), fast);
        rows_point("15", "silicon", critical(silicon, 4.0 * fast, 1, 1.5), 4.0 * fast);
        rows_point("15", "linear", critical(0.8, fast, 1, 1.5), fast);
    }
    rows_break();
    rows_number("linear part unstable at Omega 1 from r", unstable_from(0.8, 1.0));
    rows_number("linear part unstable at Omega 1.5 from r", unstable_from(0.8, 1.5));
    rows_number("linear part unstable at Omega 0.6 from r", unstable_from(0.8, 0.6));
    rows_number("linear part unstable at Omega 1, beta 0.95 from r", unstable_from(0.95, 1.0));
}
