/* nayak_numbers.c - see nayak_forced.h: statements of Nayak
 * 1972 that are numbers and stand in no chart of their own. */
#include <math.h>
#include <stdio.h>
#include "tests/papers/contact.h"
#include "tests/papers/rig/nayak_forced.h"
#include "tests/papers/rows.h"

static const double PI = 3.14159265358979323846;

/* Section 4.1: balance against the exact free vibration, at one frequency. */
static void tell_balance(double omega)
{
    double low = 1.001, high = 6.0, first = 0.01, last = 6.0;
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high), between = 0.5 * (first + last);
        *(contact_free(middle).omega > omega ? &low : &high) = middle;
        *(contact_balance(between).stiffness > omega * omega ? &first : &last) = between;
    }
    rows_number("fig 5, Omega", omega);
    rows_number("  largest compression, exact", low);
    rows_number("  by harmonic balance", contact_balance(first).a0 + first);
}

/* Figure 11: how little the upward jump depends on the damping. */
static void tell_upward(double xi0)
{
    static struct branch_point point[BRANCH_POINTS];
    static const double zeta[] = {0.02, 0.05, 0.1};
    rows_number("fig 11, xi0", xi0);
    for (int k = 0; k < 3; k++) {
        struct branch b = nayak_branch(zeta[k], xi0, 0.25, 1.0);
        int n = branch_follow(&b, point);
        rows_number("  zeta", zeta[k]);
        rows_number("    upward jump, true contact", branch_fold(point, n, 1.0));
        rows_number("    by harmonic balance", contact_balance_jump(zeta[k], xi0));
    }
}

/* Third moment over the cube of the spread. */
static double skewness(const struct density *d)
{
    double mean = 0.0, third = 0.0, h = 0.001, spread = contact_deviation(d);
    for (double eta = -20.0; eta < 6.0; eta += h)
        mean += h * eta * contact_density_at(d, eta);
    for (double eta = -20.0; eta < 6.0; eta += h)
        third += h * pow(eta - mean, 3.0) * contact_density_at(d, eta);
    return third / (spread * spread * spread);
}

static void tell_density(double phi_over_zeta)
{
    struct density d = contact_density(phi_over_zeta);
    double here = contact_density_at(&d, 1.0) / (d.speed * sqrt(2.0 * PI)),
           gauss = 1.0 / (2.0 * PI * d.speed * d.speed);
    rows_number("Phi/zeta", phi_over_zeta);
    rows_number("  spread of the rate, eq 70", d.speed);
    rows_number("  spread of eta", contact_deviation(&d));
    rows_number("  skewness of eta", skewness(&d));
    rows_number("  G of eq 73 over that of eq 69", gauss / here);
}

/* Sections 5.3, 5.4: at the load Pp, and where the up-crossings are most frequent. */
static void tell_load(double spread)
{
    double most = 0.0, at = 0.0;
    for (int i = 0; i <= 800; i++) {
        double r = 0.05 * pow(400.0, i / 800.0), s = spread * pow(r, -11.0 / 12.0);
        struct density d = contact_density(s * s * 2.0 / PI);
        double rate = contact_crossings(&d, pow(r, -2.0 / 3.0));
        at = rate > most ? r : at;
        most = fmax(most, rate);
    }
    struct density d = contact_density(spread * spread * 2.0 / PI);
    rows_number("spread at Pp", spread);
    rows_number("  up-crossings of the plastic limit are most at P0/Pp", at);
    rows_number("  their rate", most);
    rows_number("  mean length above it at P0 = Pp", contact_above(&d, 1.0) / contact_crossings(&d, 1.0));
}

void nayak_tell_numbers(void)
{
    tell_balance(0.95);
    tell_balance(0.7);
    tell_balance(0.5);
    tell_upward(0.9);
    tell_upward(3.0);
    tell_density(0.01);
    tell_density(0.1);
    tell_load(0.1);
    tell_load(0.3);
}
