/* test_order.c - the order of each method across a contact switch, and how the error follows step or
 * tolerance.
 *
 * Compared with motions that return to their start (tests/fixture/orbit.h), published stability limits, and
 * identities. Phase and number of steps are random in each draw: a whole number of steps per contact would
 * fake a higher order. */
#include "tests/unit/test.h"

#include <math.h>
#include <stddef.h>
#include "firmware/plant/drive.h"
#include "tests/fixture/exact.h"
#include "tests/fixture/mathieu.h"
#include "tests/fixture/orbit.h"

#define TWO_PI 6.283185307179586477

/* Least squares of log(error) over log(step). */
struct fit {
    double n, sx, sy, sxx, sxy;
};

static void fit_add(struct fit *f, double step, double error)
{
    double x = log(step), y = log(error);
    f->n += 1.0;
    f->sx += x;
    f->sy += y;
    f->sxx += x * x;
    f->sxy += x * y;
}

static double fit_slope(const struct fit *f)
{
    return (f->n * f->sxy - f->sx * f->sy) / (f->n * f->sxx - f->sx * f->sx);
}

/* The quadrature behind the Hertz orbit, against the energy integral in multi-precision. */
TEST(order_periods)
{
    double speed;
    check_near("free period at eta_max 2.5", orbit_hertz_period(2.5, &speed), 8.246416605814711, 1e-14);
    check_near("free period at eta_max 3.5", orbit_hertz_period(3.5, &speed), 11.591380547230195, 1e-14);
}

static double order(enum orbit_kind kind, const struct orbit_way *w, double n, double up_to, uint64_t seed)
{
    enum { DRAWS = 25 };
    struct fit fit = {0};
    for (; n < up_to; n *= 1.6) {
        for (int i = 0; i < DRAWS; i++) {
            double step, error = orbit_draw(kind, w, n, &seed, &step);
            fit_add(&fit, step, error);
        }
    }
    return fit_slope(&fit);
}

/* A force ~ penetration^p caps the order at p + 1 unless
 * the switch is located; on Hertz it does even then. */
TEST(order_kink)
{
    const struct orbit_way plain = {"plain RK4", classical_rk4, NULL, 0.0},
                           located = {"rk4", NULL, &rk4, 0.0};
    check_near("plain RK4 across a Hertz contact", order(ORBIT_HERTZ, &plain, 200, 6000, 1), 2.5, 0.25);
    check_near("plain RK4 across gap springs", order(ORBIT_GAP, &plain, 650, 20000, 2), 2.0, 0.25);
    check_near("rk4 across a Hertz contact, located all the same", order(ORBIT_HERTZ, &located, 200, 6000, 3),
               2.5, 0.25);
    check_above("rk4 across gap springs, order restored", order(ORBIT_GAP, &located, 350, 6000, 4), 3.7);
}

/* Worst of a few draws at each decade: falls with the tolerance, and stays near it. */
TEST(order_tolerance)
{
    enum { DRAWS = 20 };
    double before = (double)INFINITY;
    for (int k = 4; k <= 12; k++) {
        struct orbit_way w = {"taylor", NULL, &taylor, pow(10.0, -k)};
        uint64_t seed = 5;
        double worst = 0.0, step;
        for (int i = 0; i < DRAWS; i++)
            worst = fmax(worst, orbit_draw(ORBIT_HERTZ, &w, 40.0, &seed, &step));
        check_below(check_name("taylor, tol 1e-%d: error over tolerance", k), worst / w.tol, 3.0);
        check_below("and below that at the tolerance before", worst, before);
        before = worst;
    }
}

TEST(order_exact)
{
    const struct orbit_way w = {"exact", NULL, &exact, 0.0};
    uint64_t seed = 6;
    double largest = 0.0, step;
    for (double n = 40.0; n < 6000.0; n *= 1.6) {
        for (int i = 0; i < 20; i++)
            largest = fmax(largest, orbit_draw(ORBIT_GAP, &w, n, &seed, &step));
    }
    check_below("exact across gap springs, h omega 1.6 to 0.01: largest error", largest, 1e-12);
}

/* ---- modulated stiffness ---- */

/* The multiplier of larger magnitude; returns the determinant of the map. */
static double multiplier(const struct mathieu *m, const struct method *method, double tol, int n,
                         double complex *mu)
{
    double map[2][2];
    double complex both[2];
    mathieu_map(m, method, tol, n, map);
    mathieu_multipliers(map, both);
    *mu = both[0];
    return map[0][0] * map[1][1] - map[0][1] * map[1][0];
}

/* rk4 with its step is a map with multipliers of its own: those of the plant to order 4. Inside the tongue,
 * where they are real and not small, beside it, and where the modulation is fast. */
TEST(order_multipliers)
{
    static const struct mathieu cases[] = {
        {0.02, 1.0, 0.3, 2.0}, {0.02, 1.0, 0.3, 1.6}, {0.02, 1.0, 0.8, 1.0}, {0.02, 0.2, 0.4, 1.0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct mathieu *m = &cases[i];
        double complex truth, mu;
        struct fit fit = {0};
        double worst = 0.0;
        double det = multiplier(m, &taylor, 1e-13, 40, &truth);
        check_near("taylor: determinant of the map", det, exp(-m->damping * TWO_PI / m->omega), 1e-12);
        for (int n = 40; n <= 640; n *= 2) {
            double h = TWO_PI / m->omega / n, error;
            multiplier(m, &rk4, 0.0, n, &mu);
            error = cabs(mu - truth);
            worst = fmax(worst, error / (h * h * h * h));
            fit_add(&fit, h, error);
        }
        check_near("rk4: order of its multipliers", fit_slope(&fit), 4.0, 0.1);
        check_below("rk4: error of its multipliers over h^4", worst, 1.0);
    }
}

/* Modulations at which a multiplier is -1, of the tip's linear part (k0 = 0.2) and of the rig's (k0 = 1), and
 * the rig under fast stiffness 4: from Hill's equation, computed independently. */
TEST(order_tongues)
{
    static const struct mathieu edge[] = {
        {0.02, 0.19999999999999996, 0.2907784562315997, 0.6},
        {0.02, 0.19999999999999996, 0.017890500261832906, 0.8944271909999159},
        {0.02, 0.19999999999999996, 1.4764094690557152, 2.0},
        {0.02, 1.0, 0.056289308152417505, 1.98},
        {0.02, 1.0, 0.05685485091192883, 2.02},
        {0.02, 1.0, 5.558268841362643, 4.0},
    };
    const struct mathieu fast = {0.02, 1.0, 4.0, 8.0};
    double complex mu;
    for (size_t i = 0; i < sizeof edge / sizeof *edge; i++) {
        double h = TWO_PI / edge[i].omega / 100.0, square = h * h * (edge[i].k0 + edge[i].k1);
        multiplier(&edge[i], &taylor, 1e-13, 40, &mu);
        check_near("taylor: multiplier on the edge of the first tongue", creal(mu), -1.0, 1e-10);
        multiplier(&edge[i], &rk4, 0.0, 100, &mu);
        check_near("rk4, 100 steps a period: the same to 10 (h omega)^4", creal(mu), -1.0,
                   10.0 * square * square);
    }
    multiplier(&fast, &taylor, 1e-13, 40, &mu);
    check_near("rig under fast stiffness 4: |multiplier|", cabs(mu), 0.9921767802925575, 1e-11);
    check_near("and its trace", 2.0 * creal(mu), 1.3297600040408004, 1e-11);
}

/* Ten million ticks through the drive as the plant uses it, against the phase by 128-bit arithmetic. */
TEST(order_drive)
{
    enum { TICKS = 10000000, WINDOW = 1000 };
    const double turns = 0.1234567890123e-2;
    struct drive d;
    struct wave w;
    struct input at[3];
    double worst = 0.0;
    drive_init(&d);
    drive_start(&d, &(struct drive_setting){1.0, turns, 0.0, 0});
    for (uint64_t n = 1; n <= TICKS; n++) {
        drive_segment(&d, TICK_FRACTIONS, 1.0, &w, &at[0], &at[1], &at[2]);
        if (n <= TICKS - WINDOW)
            continue;
        long double angle = exact_angle(exact_phase(turns, n));
        exact_worst(&worst, hypotl((long double)d.cosine - cosl(angle), (long double)d.sine - sinl(angle)));
    }
    check_below("phasor after 1e7 ticks, worst of the last thousand, rad", worst, 1e-13);
}
