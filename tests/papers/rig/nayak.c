/* nayak.c - figures 3, 5, 10, 11, 13 of Nayak 1972 and the statistics of its section 5: closed forms,
 * harmonic balance and heuristics against the true contact; 6, 7 and 12 by nayak_forced.c. Prints
 * docs/img/papers/nayak.csv. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "models/rolling_contact.h"
#include "tests/fixture/paper.h"
#include "tests/papers/branch.h"
#include "tests/papers/contact.h"
#include "tests/papers/rig/nayak_forced.h"
#include "tests/papers/rows.h"

static const double PI = 3.14159265358979323846;
static struct branch_point point[BRANCH_POINTS];

/* ---- figures 3 and 5: free vibration ---- */

/* Frequency of the model itself, released at rest from
 * eta_max without damping: by its returns to a largest value. */
static double free_frequency(double eta_max)
{
    static struct motion m;
    enum { RETURNS = 6 };
    double paper[MODEL_PARAMETERS], h = 0.05, last;
    int returns = 0;
    paper_defaults(&rolling_contact, paper);
    paper[ROLLING_PAPER_ZETA] = 0.0;
    if (motion_start(&m, &rolling_contact, paper, h, 1e-11, (const double[2]){eta_max, 0.0}) != NULL)
        return (double)NAN;
    for (int i = 1; i < 100000; i++) {
        last = m.pl.x[1];
        if (!plant_run(&m.pl, 1))
            break;
        if (last > 0.0 && m.pl.x[1] <= 0.0 && ++returns == RETURNS)
            return 2.0 * PI * RETURNS / (h * (i - 1 + last / (last - m.pl.x[1])));
    }
    return (double)NAN;
}

static void draw_free(void)
{
    for (int i = 0; i <= 60; i++) {
        double eta = 1.005 + 3.2 * i / 60.0;
        struct free_vibration f = contact_free(eta);
        rows_point("3", "largest", f.omega, eta);
        rows_point("3", "amplitude", f.omega, f.amplitude);
        rows_point("3", "area", f.omega, f.area);
        rows_point("3", "stress", f.omega, sqrt(eta));
    }
    rows_break();
    for (int i = 0; i <= 12; i++) {
        double eta = 1.2 + 0.25 * i;
        rows_point("3", "true", free_frequency(eta), eta);
    }
    rows_break();
    for (int i = 1; i <= 60; i++) {
        double a1 = 6.0 * i / 60.0;
        struct balance b = contact_balance(a1);
        rows_point("5", "balance largest", sqrt(b.stiffness), b.a0 + a1);
        rows_point("5", "balance amplitude", sqrt(b.stiffness), a1);
    }
    rows_break();
}

/* ---- figures 10 and 11: jumps ---- */

static void draw_jumps(void)
{
    static const double zeta[] = {0.02, 0.05};
    char name[64];
    for (int i = 0; i <= 60; i++) {
        struct free_vibration f = contact_free(1.6 + 2.2 * i / 60.0);
        rows_point("10", "down", 2.0 * f.amplitude / f.omega, f.omega);
        rows_point("10", "half", 2.0 * sqrt(2.0) * f.amplitude / f.omega, f.omega);
    }
    rows_break();
    for (int k = 0; k < 2; k++) {
        snprintf(name, sizeof name, "true zeta=%g", zeta[k]);
        for (int i = 1; i <= 9; i++) {
            double ratio = 2.0 * i;
            struct branch b = nayak_branch(zeta[k], ratio * zeta[k], 1.7, 0.4);
            int n = branch_follow(&b, point);
            rows_point("10", name, ratio, branch_fold(point, n, 0.0));
        }
        rows_break();
    }
    static const double loss[] = {0.05, 0.1, 0.2};
    for (int k = 0; k < 3; k++) {
        for (int i = 1; i <= 35; i++) {
            double jump = contact_balance_jump(loss[k], 0.1 * i);
            snprintf(name, sizeof name, "balance zeta=%g", loss[k]);
            rows_point("11", name, 0.1 * i, jump);
            if (i % 2 == 0 && i > 12)
                continue;
            struct branch b = nayak_branch(loss[k], 0.1 * i, 0.25, 1.0);
            int n = branch_follow(&b, point);
            snprintf(name, sizeof name, "true zeta=%g", loss[k]);
            rows_point("11", name, 0.1 * i, branch_fold(point, n, 1.0));
        }
        rows_break();
    }
    rows_number("upward jump at xi0 0.9, zeta 0.05: harmonic balance", contact_balance_jump(0.05, 0.9));
}

/* The largest damping at which the branch still folds, by bisection between `low` (it does) and `high`. */
static double last_fold(double xi0, double low, double high)
{
    while (high - low > 2e-4) {
        double middle = 0.5 * (low + high);
        struct branch b = nayak_branch(middle, xi0, 0.25, 1.0);
        int n = branch_follow(&b, point);
        *(isnan(branch_fold(point, n, 0.6)) ? &high : &low) = middle;
    }
    return low;
}

/* ---- figure 13: the smallest waviness that loses contact ---- */

/* Nayak's: the smaller of eq 50, which holds for incipient
 * loss, and of the downward jump at this frequency. */
static double threshold_theory(double zeta, double omega)
{
    double a0 = 0.8853413770001135, k = 0.903 - omega * omega, d = 2.0 * zeta * omega;
    double incipient = a0 * sqrt(k * k + d * d) / (omega * sqrt(omega * omega + 4.0 * zeta * zeta));
    double low = 1.8421, high = 6.0;
    if (omega > 0.9530)
        return incipient;
    for (int i = 0; i < 40; i++) {
        double middle = 0.5 * (low + high);
        *(contact_free(middle).omega > omega ? &low : &high) = middle;
    }
    return fmin(incipient, 2.0 * zeta * contact_free(low).amplitude / omega);
}

/* Stepping the waviness up and down: the least with contact loss either way. */
static double threshold_true(double zeta, double omega)
{
    enum { STEPS = 150 };
    static struct seen seen[STEPS + 1];
    double least = HUGE_VAL;
    struct sweep s = nayak_sweep(ROLLING_PAPER_XI0, zeta, STEPS);
    s.tick = 2.0 * PI / omega / 32.0;
    s.wait = 10.0 / zeta;
    s.look = 40.0;
    s.paper[ROLLING_PAPER_OMEGA] = omega;
    for (int back = 0; back < 2; back++) {
        s.from = back ? 1.2 : 0.004;
        s.to = back ? 0.004 : 1.2;
        sweep_run(&s, seen);
        for (int i = 0; i <= STEPS; i++)
            least = seen[i].loss > 0.0 ? fmin(least, sweep_at(&s, i)) : least;
    }
    return least < 1.19 ? least : (double)NAN;
}

static void draw_thresholds(void)
{
    static const double zeta[] = {0.02, 0.05, 0.1, 0.5};
    char name[32];
    for (int k = 0; k < 4; k++) {
        for (int i = 0; i <= 40; i++) {
            double w = 0.5 + 0.025 * i;
            snprintf(name, sizeof name, "theory %g", zeta[k]);
            rows_point("13", name, w, fmin(threshold_theory(zeta[k], w), 1.3));
            snprintf(name, sizeof name, "true %g", zeta[k]);
            rows_point("13", name, w, threshold_true(zeta[k], w));
        }
        rows_break();
    }
}

/* ---- section 5: random motion ---- */

enum { BINS = 45, LEVELS = 25, TICKS = 3000000 };
static const double bottom = -1.0, width = 0.08;

struct tally {
    double share[BINS], above[LEVELS], crossings[LEVELS], area, stress, square, mean, time;
};

/* The model under held noise of the density Phi at the eigenfrequency. */
static void tally_motion(double zeta, double phi, struct tally *t)
{
    static struct motion m;
    double paper[MODEL_PARAMETERS], h = 0.1;
    memset(t, 0, sizeof *t);
    paper_defaults(&rolling_contact, paper);
    paper[ROLLING_PAPER_ZETA] = zeta;
    if (motion_start(&m, &rolling_contact, paper, h, 1e-7, NULL) != NULL)
        return;
    plant_noise(&m.pl, ROLLING_FORCE, 1.5 * sqrt(2.0 * PI * phi / h), 1, 7, 0.0);
    if (!plant_run(&m.pl, 2000))
        return;
    for (int i = 0; i < TICKS; i++) {
        double before = m.pl.x[0];
        if (!plant_run(&m.pl, 1))
            return;
        double eta = m.pl.x[0];
        int bin = (int)floor((eta - bottom) / width);
        if (bin >= 0 && bin < BINS)
            t->share[bin] += 1.0 / TICKS;
        for (int k = 0; k < LEVELS; k++) {
            double z = 0.1 * k;
            t->above[k] += eta > z ? 1.0 / TICKS : 0.0;
            t->crossings[k] += eta > z && before <= z ? 1.0 / (h * TICKS) : 0.0;
        }
        t->area += fmax(eta, 0.0) / TICKS;
        t->stress += sqrt(fmax(eta, 0.0)) / TICKS;
        t->mean += eta / TICKS;
        t->square += eta * eta / TICKS;
    }
}

static void draw_random(void)
{
    static struct tally t;
    struct density d = contact_density(0.1);
    double zeta = 0.05, s = d.speed;
    tally_motion(zeta, 0.1 * zeta, &t);
    for (int i = 0; i < BINS; i++) {
        double eta = bottom + width * (i + 0.5);
        rows_point("density", "theory", eta, contact_density_at(&d, eta));
        rows_point("density", "gauss", eta,
                   exp(-0.5 * (eta - 1.0) * (eta - 1.0) / (s * s)) / (s * sqrt(2.0 * PI)));
        rows_point("density", "true", eta, t.share[i] / width);
    }
    rows_break();
    for (int k = 0; k < LEVELS; k++) {
        double z = 0.1 * k, p = contact_above(&d, z), v = contact_crossings(&d, z);
        double gauss = exp(-0.5 * (z - 1.0) * (z - 1.0) / (s * s)) / (2.0 * PI);
        double gauss_above = 0.5 * erfc((z - 1.0) / (s * sqrt(2.0)));
        rows_point("crossings", "theory", z, v);
        rows_point("crossings", "gauss", z, gauss);
        rows_point("crossings", "true", z, t.crossings[k]);
        rows_point("length", "theory", z, p / v);
        rows_point("length", "gauss", z, gauss_above / gauss);
        rows_point("length", "true", z, t.crossings[k] > 3e-5 ? t.above[k] / t.crossings[k] : (double)NAN);
    }
    rows_break();
    rows_number("up-crossings of 1.5, theory", contact_crossings(&d, 1.5));
    rows_number("up-crossings of 1.5, true", t.crossings[15]);
    rows_number("share without contact, theory", 1.0 - contact_above(&d, 0.0));
    rows_number("share without contact, true", 1.0 - t.above[0]);
}

/* Contact area, stress and spread against the speed, Phi/zeta = 0.1 (V/V0)^3 (eqs 80, 81). */
static void draw_speed(void)
{
    static struct tally t;
    for (int i = 0; i <= 40; i++) {
        double v = 0.1 * pow(25.0, i / 40.0), ratio = 0.1 * v * v * v;
        struct density d = contact_density(ratio);
        rows_point("speed", "theory", v, contact_deviation(&d));
        rows_point("speed", "gauss", v, sqrt(0.5 * PI * ratio));
        rows_point("area", "theory", v, contact_mean(&d, 1.0));
        rows_point("stress", "theory", v, contact_mean(&d, 0.5));
        if (i % 8 == 0 && i > 8) {
            tally_motion(0.05, 0.05 * ratio, &t);
            rows_point("speed", "true", v, sqrt(t.square - t.mean * t.mean));
            rows_point("area", "true", v, t.area);
            rows_point("stress", "true", v, t.stress);
        }
    }
    rows_break();
}

/* Statistics over the load r = P0/Pp, with spread c r^(-11/12) (eq 87) and level r^(-2/3). They are the
 * probability of the plastic limit, its up-crossings, and the mean length of a stay above it. The density
 * is that of eq 68 or the Gaussian of eq 74. */
enum { PROBABILITY, CROSSINGS, LENGTH, STATISTICS };
static const char *const statistic[STATISTICS] = {"plastic", "plastic crossings", "duration"};

static void load_statistics(double spread, double r, bool gauss, double value[STATISTICS])
{
    double s = spread * pow(r, -11.0 / 12.0), z = pow(r, -2.0 / 3.0);
    struct density d = contact_density(s * s * 2.0 / PI);
    value[PROBABILITY] = gauss ? 0.5 * erfc((z - 1.0) / (s * sqrt(2.0))) : contact_above(&d, z);
    value[CROSSINGS] =
        gauss ? exp(-0.5 * (z - 1.0) * (z - 1.0) / (s * s)) / (2.0 * PI) : contact_crossings(&d, z);
    value[LENGTH] = value[PROBABILITY] / value[CROSSINGS];
}

static void draw_plastic(void)
{
    static const double spread[] = {0.1, 0.3};
    char name[64];
    for (int k = 0; k < 4; k++) {
        bool gauss = k % 2;
        double least[STATISTICS] = {1e9, 1e9, 1e9}, at[STATISTICS], value[STATISTICS];
        for (int i = 0; i <= 400; i++) {
            double r = 0.004 * pow(250.0, i / 400.0);
            load_statistics(spread[k / 2], r, gauss, value);
            snprintf(name, sizeof name, "%s %g", gauss ? "gauss" : "theory", spread[k / 2]);
            for (int j = 0; j < STATISTICS; j++) {
                if (i % 10 == 0)
                    rows_point(statistic[j], name, r, value[j]);
                at[j] = value[j] < least[j] ? r : at[j];
                least[j] = fmin(least[j], value[j]);
            }
        }
        rows_break();
        for (int j = 0; j < STATISTICS; j++) {
            snprintf(name, sizeof name, "%s %g, %s: least at P0/Pp", gauss ? "Gaussian" : "exact",
                     spread[k / 2], statistic[j]);
            rows_number(name, at[j]);
        }
    }
}

int main(void)
{
    rows_print_header();
    draw_free();
    nayak_draw_forced();
    draw_jumps();
    rows_number("largest damping with a jump, xi0 0.9", last_fold(0.9, 0.1, 0.3));
    rows_number("largest damping with a jump, xi0 0.3", last_fold(0.3, 0.05, 0.3));
    rows_number("largest damping with a jump, xi0 3", last_fold(3.0, 0.1, 0.5));
    draw_thresholds();
    draw_random();
    draw_speed();
    draw_plastic();
    nayak_tell_numbers();
    struct free_vibration f = contact_free(1.842015749320193);
    rows_number("frequency at loss of contact", f.omega);
    return 0;
}
