/* test_rig.c - the Hertz rig against exact integrals, identities and published numbers. */
#include "tests/unit/test.h"

#include <math.h>
#include <stddef.h>
#include "firmware/plant/plant_report.h"
#include "models/hertz_rig.h"
#include "tests/fixture/free_motion.h"
#include "tests/fixture/rig.h"

#define TWO_PI 6.283185307179586477

/* SI scale of a rig by its formulas: zs = (N/k)^(2/3), nu^2 = 3 k sqrt(zs)/(2 m), xi = c/(2 m nu). */
TEST(rig_scale)
{
    double si[4], p[MODEL_DERIVED];
    struct scale s;
    for (int i = 0; i < 4; i++)
        si[i] = hertz_rig.parameter[i].initial;
    hertz_rig.prepare(si, p, &s);
    double zs = pow(si[RIG_PRELOAD] / si[RIG_CONTACT_STIFFNESS], 2.0 / 3.0);
    double nu = sqrt(1.5 * si[RIG_CONTACT_STIFFNESS] * sqrt(zs) / si[RIG_MASS]);
    check_near("static compression, m", s.length_m, zs, 1e-14 * zs);
    check_near("time unit, s", s.time_s, 1.0 / nu, 1e-14 / nu);
    check_near("damping term 2 xi", p[RIG_P_TWO_XI], si[RIG_DAMPING] / (si[RIG_MASS] * nu), 1e-16);
    check_near("energy unit m zs^2 nu^2, J", s.energy_J, si[RIG_MASS] * zs * zs * nu * nu,
               1e-14 * s.energy_J);
    check_near("default contact resonance, Hz (a few hundred)", nu / TWO_PI, 230.0, 1.0);
}

/* Free motion from rest at eta_max: the time of n whole periods, by the zero of the velocity. */
static double measured_period(double eta_max, double h, int n)
{
    struct plant pl;
    double paper[PAPER];
    rig_paper(paper);
    paper[XI] = 0.0;
    rig_start(&pl, paper, h, 1.5 * eta_max - 1.5, 0.0);
    int tops = 0;
    double before = 0.0;
    while (tops < n) {
        before = pl.x[1];
        rig_run(&pl, 1);
        tops += before > 0.0 && pl.x[1] <= 0.0;
    }
    /* v goes through zero with acceleration (2/3)(1 - eta^1.5); a cubic would not add a digit at this h */
    return ((double)pl.now.tick * h - h * pl.x[1] / (pl.x[1] - before)) / n;
}

TEST(rig_free_period)
{
    const double eta_max[] = {1.01, 1.2, 1.5, 1.6, 1.9, 2.5, 3.5, 4.0}, edge = pow(2.5, 2.0 / 3.0),
                 edge_period = 6.59237210; /* 2 sqrt(3) (5/2)^(1/3) B(1/3,1/2)/3 */
    for (size_t i = 0; i < sizeof eta_max / sizeof eta_max[0]; i++)
        check_near("free period", measured_period(eta_max[i], 2e-3, 10), free_period(eta_max[i]), 1e-8);
    check_near("free period at the edge of contact loss", measured_period(edge, 2e-3, 10), edge_period, 1e-8);
}

/* Contact is lost exactly when eta_max exceeds (5/2)^(2/3). */
TEST(rig_contact_loss)
{
    double edge = pow(2.5, 2.0 / 3.0), paper[PAPER];
    struct plant pl;
    rig_paper(paper);
    paper[XI] = 0.0;
    for (int side = -1; side <= 1; side += 2) {
        double eta = edge * (1.0 + side * 1e-6);
        rig_start(&pl, paper, TWO_PI / 4096, 1.5 * eta - 1.5, 0.0);
        rig_run(&pl, 5000);
        check_int(side < 0 ? "switches just below the edge" : "switches just above the edge",
                  pl.counts.switches, side < 0 ? 0 : 2);
        check_near("energy kept, of 0.4", plant_energy(&pl) / pl.scale.energy_J, pl.ledger.start.value, 1e-9);
    }
}

/* A bounded stationary motion: averages over whole periods
 * of the slow drive (Omega is a multiple of omega). */
struct rig_average {
    double force, left, right;
};

/* <(1 + a_k cos) eta^1.5>, and both sides of 2 xi <p'^2>
 * = <p' (sigma cos + a_f cos - qe'' - a_k cos eta^1.5)>. */
static struct rig_average averages(const double *paper, int n_per_period, int settle, int periods)
{
    struct plant pl;
    struct rig_average a = {0.0, 0.0, 0.0};
    double h = TWO_PI / paper[OMEGA] / n_per_period;
    rig_start(&pl, paper, h, 0.0, 0.0);
    rig_run(&pl, (uint64_t)settle * (uint64_t)n_per_period);
    for (long i = 0; i < (long)periods * n_per_period; i++) {
        double t = (double)pl.now.tick * h;
        double slow = cos(paper[OMEGA] * t), fast = cos(paper[FAST_OMEGA] * t),
               sine = sin(paper[FAST_OMEGA] * t);
        double p = rig_q(&pl) - paper[A_BASE] * fast;
        double p_dot = rig_q_dot(&pl) + paper[A_BASE] * paper[FAST_OMEGA] * sine;
        double eta = 1.0 + (2.0 / 3.0) * p, e = eta > 0.0 ? eta : 0.0, contact = e * sqrt(e);
        double base = paper[A_BASE] * paper[FAST_OMEGA] * paper[FAST_OMEGA] * fast; /* -qe'' */
        a.force += (1.0 + paper[A_STIFF] * fast) * contact;
        a.left += 2.0 * paper[XI] * p_dot * p_dot;
        a.right +=
            p_dot * (paper[SIGMA] * slow + paper[A_FORCE] * fast + base - paper[A_STIFF] * fast * contact);
        rig_run(&pl, 1);
    }
    double n = (double)periods * n_per_period;
    return (struct rig_average){a.force / n, a.left / n, a.right / n};
}

static const struct {
    const char *name;
    double sigma, omega, a_force, a_base, a_stiff;
} steady[] = {
    {"slow drive, contact kept", 0.01, 0.8, 0, 0, 0}, {"slow drive, contact lost", 0.9, 0.8, 0, 0, 0},
    {"fast force 60", 0.04, 0.8, 60, 0, 0},           {"fast base 5", 0.04, 0.8, 0, 5, 0},
    {"fast stiffness 4", 0.04, 0.8, 0, 0, 4},
};

static struct rig_average steady_average(int i)
{
    double paper[PAPER];
    rig_paper(paper);
    paper[XI] = 0.05;
    paper[SIGMA] = steady[i].sigma;
    paper[OMEGA] = steady[i].omega;
    paper[A_FORCE] = steady[i].a_force;
    paper[A_BASE] = steady[i].a_base;
    paper[A_STIFF] = steady[i].a_stiff;
    return averages(paper, 2000, 100, 100);
}

/* The mean contact force is the preload in any bounded stationary motion. */
TEST(rig_mean_force)
{
    for (int i = 0; i < 5; i++)
        check_near(steady[i].name, steady_average(i).force, 1.0, 1e-5);
}

/* The damper takes out the energy that the drives put in. */
TEST(rig_power_balance)
{
    for (int i = 0; i < 5; i++) {
        struct rig_average a = steady_average(i);
        check_near(steady[i].name, a.right / a.left, 1.0, 1e-6);
    }
}

/* Slope of log(error) over log(h) on smooth motion (contact kept): rk4 is of order 4. Steps are not fractions
 * of the period, so that no lucky alignment fakes a higher order. */
TEST(rig_order)
{
    double paper[PAPER], error[3], reference[2] = {0.0, 0.0};
    struct plant pl;
    rig_paper(paper);
    paper[SIGMA] = 0.01;
    paper[OMEGA] = 0.9;
    const int n[4] = {331, 709, 1511, 20011};
    for (int i = 3; i >= 0; i--) {
        rig_start(&pl, paper, 30.0 / n[i], 0.3, 0.1);
        rig_run(&pl, (uint64_t)n[i]);
        if (i == 3) {
            reference[0] = rig_q(&pl);
            reference[1] = rig_q_dot(&pl);
        } else {
            error[i] = hypot(rig_q(&pl) - reference[0], rig_q_dot(&pl) - reference[1]);
        }
    }
    for (int i = 0; i < 2; i++)
        check_near("order of rk4 on smooth motion",
                   log(error[i] / error[i + 1]) / log((double)n[i + 1] / n[i]), 4.0, 0.1);
}

TEST(rig_bounce)
{
    const double speed[] = {1.0, 10.0, 100.0}, longer[] = {0.18, 0.02, 0.0013};
    double paper[PAPER];
    struct plant pl;
    struct event e;
    rig_paper(paper);
    paper[XI] = 0.0;
    for (int i = 0; i < 3; i++) {
        double v = speed[i], above = 1e-3 * v, truth = free_contact_time(v), at[2] = {0, 0};
        /* without preload: 2.943275 delta/v, delta = (5 m v^2/(4 k))^(2/5), here m = 1.5, k = 1 */
        double free_time = 2.943275 * pow(1.25 * 1.5 * v * v, 0.4) / v;
        check_near("preload makes the contact longer by", truth / free_time - 1.0, longer[i],
                   0.05 * longer[i]);
        rig_start(&pl, paper, truth / 300.0, 0.0, 0.0);
        /* dropped from `above`, so that it arrives with speed v */
        plant_set_state(&pl, (double[]){-above, sqrt(v * v - (4.0 / 3.0) * above)});
        rig_run(&pl, 400);
        for (int k = 0; k < 2 && plant_take_event(&pl, &e); k++)
            at[k] = ((double)e.tick + e.fraction) * pl.tick_s;
        check_near("contact time by the event log over the exact one", (at[1] - at[0]) / truth, 1.0, 1e-7);
        check_near("rebound speed over touchdown speed", e.speed / v, 1.0, 1e-7);
        check_near("peak force over the exact one", e.peak_force / pow(free_peak(v), 1.5), 1.0, 3e-5);
    }
}
