/* nayak_forced.c - see nayak_forced.h. */
#include "tests/papers/rig/nayak_forced.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "models/rolling_contact.h"
#include "tests/fixture/paper.h"
#include "tests/papers/contact.h"
#include "tests/papers/rows.h"

struct branch nayak_branch(double zeta, double xi0, double from, double to)
{
    struct branch b = {.model = &rolling_contact,
                       .swept = ROLLING_PAPER_OMEGA,
                       .turn = MOTION_TWO_PI,
                       .unit = 1.0,
                       .ticks = 64,
                       .coordinate = -1,
                       .from = from,
                       .to = to,
                       .step = 0.04};
    paper_defaults(&rolling_contact, b.paper);
    b.paper[ROLLING_PAPER_ZETA] = zeta;
    b.paper[ROLLING_PAPER_XI0] = xi0;
    return b;
}

struct sweep nayak_sweep(int swept, double zeta, int steps)
{
    struct sweep s = {
        .model = &rolling_contact, .swept = swept, .omega = ROLLING_PAPER_OMEGA, .steps = steps, .tol = 1e-8};
    paper_defaults(&rolling_contact, s.paper);
    s.paper[ROLLING_PAPER_ZETA] = zeta;
    return s;
}

/* Amplitude of the mass, y = eta - xi, from that of eta
 * (first harmonic): its force over inertia and damper. */
static double mass_amplitude(double a1, double stiffness, double zeta, double omega)
{
    return a1 * stiffness / (omega * hypot(omega, 2.0 * zeta));
}

static void draw_balance(const char *figure, double zeta, double xi0)
{
    double omega[2];
    for (int side = 0; side < 2; side++) {
        for (int i = 1; i <= 110; i++) {
            double a1 = 5.0 * i * i / (110.0 * 110.0);
            if (contact_balance_omega(a1, zeta, xi0, omega) > side && omega[side] < 1.5)
                rows_point(figure, "theory", omega[side],
                           mass_amplitude(a1, contact_balance(a1).stiffness, zeta, omega[side]));
            else
                rows_break();
        }
        rows_break();
    }
}

static void draw_forced(const char *figure, double zeta, double xi0)
{
    static struct branch_point point[BRANCH_POINTS];
    struct branch b = nayak_branch(zeta, xi0, 1.5, 0.35);
    char name[64];
    double x = HUGE_VAL, y = HUGE_VAL;
    bool stable = true;
    int n = branch_follow(&b, point);
    draw_balance(figure, zeta, xi0);
    for (int i = 0; i <= 60; i++) {
        double w = 0.35 + 1.15 * i / 60.0;
        rows_point(figure, "linear", w, xi0 / hypot(1.0 - w * w, 2.0 * zeta * w));
    }
    rows_break();
    for (int i = 0; i < n; i++) {
        const struct branch_point *p = &point[i];
        bool now = p->multiplier < 1.0;
        double amplitude = 0.5 * (p->high - p->low);
        if (now == stable && !p->fold && hypot(p->at - x, 0.3 * (amplitude - y)) < 0.02)
            continue;
        if (now != stable)
            rows_break();
        x = p->at;
        y = amplitude;
        stable = now;
        rows_point(figure, now ? "true" : "true unstable", x, y);
        snprintf(name, sizeof name, "fig %s: fold of the true contact at Omega", figure);
        if (p->fold)
            rows_number(name, x);
    }
    rows_break();
}

/* Figure 12's synthesis: the downward jump (eq 61) and the half-power points, a level of the spline and zeta
 * to either side (eqs 63, 65). */
static void draw_heuristics(const char *figure, double zeta, double xi0)
{
    for (int half = 0; half < 2; half++) {
        double low = 1.0001, high = 9.0, ratio = xi0 / zeta / (half ? 2.0 * sqrt(2.0) : 2.0);
        for (int i = 0; i < 50; i++) {
            double middle = 0.5 * (low + high);
            struct free_vibration f = contact_free(middle);
            *(f.amplitude / f.omega < ratio ? &low : &high) = middle;
        }
        struct free_vibration f = contact_free(low);
        for (int side = -half; side <= half; side += 2) {
            double omega = f.omega + side * zeta,
                   mass = mass_amplitude(f.amplitude, f.omega * f.omega, zeta, omega);
            rows_point(figure, half ? "half power" : "jump", omega, mass);
            rows_number(half ? "fig 12: half-power point at Omega"
                             : "fig 12: downward jump by eq 61 at Omega",
                        omega);
            rows_number("  amplitude of the mass", mass);
        }
        rows_break();
    }
}

/* Swept both ways: half the range of eta, with the motions of a longer period too. */
static void draw_subharmonic(const char *figure, double zeta, double xi0)
{
    enum { STEPS = 120 };
    static struct seen seen[STEPS + 1];
    struct sweep s = nayak_sweep(ROLLING_PAPER_OMEGA, zeta, STEPS);
    s.tick = 0.1;
    s.wait = 20.0 / zeta;
    s.look = 200.0;
    s.paper[ROLLING_PAPER_XI0] = xi0;
    for (int back = 0; back < 2; back++) {
        double most = 0.0, last = 0.0;
        s.from = back ? 1.5 : 0.3;
        s.to = back ? 0.3 : 1.5;
        sweep_run(&s, seen);
        for (int i = 0; i <= STEPS; i++) {
            double half = 0.5 * (seen[i].high - seen[i].low), omega = sweep_at(&s, i);
            rows_point(figure, back ? "down" : "up", omega, half);
            if (fabs(half - last) > 1.0 && i > 0)
                rows_number(back ? "fig 12, swept down: a jump at Omega"
                                 : "fig 12, swept up: a jump at Omega",
                            omega);
            most = omega > 0.9 ? fmax(most, half) : most;
            last = half;
        }
        rows_break();
        rows_number("  largest amplitude of eta above Omega 0.9", most);
    }
}

void nayak_draw_forced(void)
{
    draw_forced("6 zeta=0.05", 0.05, 0.9);
    draw_forced("6 zeta=0.1", 0.1, 0.9);
    draw_forced("7", 0.05, 0.5);
    draw_heuristics("6 zeta=0.05", 0.05, 0.9);
    draw_subharmonic("12", 0.05, 0.9);
}
