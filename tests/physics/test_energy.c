/* test_energy.c - the energy that motions keep which lose none: free vibration over ten thousand periods,
 * contacts one by one and by the hundred, against quadrature of the energy. */
#include "tests/unit/test.h"

#include <math.h>
#include "models/hertz_rig.h"
#include "tests/fixture/free_motion.h"
#include "tests/fixture/paper.h"
#include "tests/fixture/trajectory.h"

/* Extended precision is the point here. */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdouble-promotion"

enum { FREE_PERIODS = 10000, PHASES = 32, BISECTIONS = 60 };

static double scratch[METHOD_SCRATCH];

/* The undamped rig, free from eta and its rate; eta is its x[0], time is 1/nu. */
static void start_free(struct plant *pl, const struct method *method, double tol, double h, double eta,
                       double rate)
{
    double paper[MODEL_PARAMETERS];
    paper_defaults(&hertz_rig, paper);
    paper[RIG_PAPER_XI] = 0.0;
    paper_start_by(pl, &hertz_rig, method, tol, scratch, paper, h, (double[]){1.5 * eta - 1.5, 1.5 * rate});
}

static void tick(struct plant *pl)
{
    if (!plant_run(pl, 1))
        check_true("the rig stays finite", 0);
}

/* The instant of the top in the last tick, for a plant that has just passed it with contact kept. It solves
 * rate = 0 by Newton's method, with the series of the rate around the state from the equation of motion. */
static double time_of_top(const struct plant *pl)
{
    double eta = pl->x[0], v = pl->x[1], root = sqrt(eta), s = 0.0;
    double a = (2.0 / 3.0) * (1.0 - eta * root), j = -root * v; /* derivatives of the rate */
    double k = -root * a - 0.5 * v * v / root,
           l = -root * j - 1.5 * v * a / root + 0.25 * v * v * v / (eta * root);
    for (int i = 0; i < BISECTIONS; i++) {
        double rate = v + s * (a + s * (j / 2.0 + s * (k / 6.0 + s * l / 24.0)));
        s -= rate / (a + s * (j + s * (k / 2.0 + s * l / 6.0)));
    }
    return (double)pl->now.tick * pl->tick_s + s;
}

/* The energy drifts by less than half a tolerance a period, and the mean period follows. */
static void check_free_energy(double eta_max, double away, double tol)
{
    const double h = 0.2;
    struct plant pl;
    double period = free_period(eta_max), worst = 0.0, before;
    long double energy = free_energy(eta_max, 0.0L);
    start_free(&pl, &taylor, tol, h, eta_max, 0.0);
    uint64_t ticks = (uint64_t)((FREE_PERIODS - 0.25) * period / h);
    while (pl.now.tick < ticks) {
        tick(&pl);
        if (pl.x[0] > 0.0)
            worst = fmax(worst, (double)fabsl(free_energy(pl.x[0], pl.x[1]) - energy));
    }
    do {
        before = pl.x[1];
        tick(&pl);
    } while (!(before > 0.0 && pl.x[1] <= 0.0));
    check_below(check_name("eta_max %.4g, grazing %+.0e, tol %.0e: worst energy error over the energy",
                           eta_max, away, tol),
                worst / (double)(energy + 0.4L), 0.5 * tol * FREE_PERIODS);
    check_near("mean period over that by quadrature", time_of_top(&pl) / FREE_PERIODS / period, 1.0,
               0.05 * tol * FREE_PERIODS);
    check_int("budgets reached, roots not converged", pl.counts.work + pl.counts.budget + pl.counts.residual,
              0);
}

TEST(energy_free)
{
    const double edge = pow(2.5, 2.0 / 3.0);
    for (int i = 0; i < 5; i++) {
        check_free_energy(1.5 + 0.5 * i, 1.5 + 0.5 * i - edge, 1e-9);
        check_free_energy(1.5 + 0.5 * i, 1.5 + 0.5 * i - edge, 1e-12);
    }
}

/* Contact just kept and just lost. */
TEST(energy_grazing)
{
    const double edge = pow(2.5, 2.0 / 3.0);
    for (int k = 3; k <= 12; k += 3) {
        for (int side = -1; side <= 1; side += 2) {
            double away = side * pow(10.0, -k);
            check_free_energy(edge * (1.0 + away), away, 1e-9);
            check_free_energy(edge * (1.0 + away), away, 1e-12);
        }
    }
}

/* Arrives with speed v, leaves with the speed of the second
 * event: how long it stayed, and what became of v^2. */
struct contact_error {
    double energy, time; /* worst errors over v^2 and over the contact time */
};

/* The phase at which a contact meets the ticks decides the error: the worst of many. */
static struct contact_error bounce(const struct method *method, double tol, double h, double v)
{
    struct contact_error worst = {0.0, 0.0};
    double truth = free_contact_time(v);
    for (int i = 0; i < PHASES; i++) {
        struct plant pl;
        struct event e[2];
        double s = h * (i + 0.37) / PHASES, v0 = v - (2.0 / 3.0) * s; /* s before touchdown */
        start_free(&pl, method, tol, h, -(v0 + s / 3.0) * s, v0);
        for (int n = 0; n < 2;) {
            tick(&pl);
            while (n < 2 && plant_take_event(&pl, &e[n]))
                n++;
        }
        double time = ((double)(e[1].tick - e[0].tick) + (e[1].fraction - e[0].fraction)) * h;
        worst.energy = fmax(worst.energy, fabs(e[1].speed * e[1].speed / (v * v) - 1.0));
        worst.time = fmax(worst.time, fabs(time / truth - 1.0));
    }
    return worst;
}

/* rk4 at the limit of its guard and below, order 2.5 from there; taylor whatever the step. */
TEST(energy_contact)
{
    for (int k = 0; k < 3; k++) {
        double v = pow(10.0, k);
        struct contact_error guard = bounce(&rk4, 0.0, 0.2, v), coarse = bounce(&rk4, 0.0, 0.05, v),
                             fine = bounce(&rk4, 0.0, 0.0125, v);
        check_below(check_name("rk4, step 0.2, speed %g: energy lost or made in a contact", v), guard.energy,
                    2e-3);
        check_near(check_name("speed %g: order of the energy error", v),
                   log2(coarse.energy / fine.energy) / 2.0, 2.5, 0.3);
        check_above("order of the contact time", log2(coarse.time / fine.time) / 2.0, 2.3);
        for (int i = 0; i < 4; i++) {
            double tol = i % 2 ? 1e-12 : 1e-9, h = i / 2 ? 0.05 : 0.2;
            struct contact_error c = bounce(&taylor, tol, h, v);
            check_below(check_name("taylor, tol %.0e, step %g, speed %g: energy error over tol", tol, h, v),
                        c.energy / tol, 2.0);
            check_below("contact time over tol", c.time / tol, 1.0);
        }
    }
}

/* Energy at touchdown over that at the start, after 350 bounces from 10 static compressions above. */
static double after_bounces(const struct method *method, double tol, double h)
{
    struct plant pl;
    struct event e;
    double speed = 0.0;
    start_free(&pl, method, tol, h, -10.0, 0.0);
    for (int n = 0; n < 700;) {
        tick(&pl);
        while (plant_take_event(&pl, &e))
            n++, speed = e.speed;
    }
    return 0.5 * speed * speed / (double)free_energy(-10.0L, 0.0L);
}

TEST(energy_bounces)
{
    check_near("rk4 at the limit of its guard: energy after 350 bounces", after_bounces(&rk4, 0.0, 0.2), 1.0,
               0.03);
    check_near("at a quarter of it", after_bounces(&rk4, 0.0, 0.05), 1.0, 1e-4);
    check_near("taylor, tol 1e-9", after_bounces(&taylor, 1e-9, 0.2), 1.0, 0.2 * 350 * 1e-9);
    check_near("taylor, tol 1e-12", after_bounces(&taylor, 1e-12, 0.2), 1.0, 0.2 * 350 * 1e-12);
}

/* Contact time with preload by quadrature, which for large speeds goes over into that without: 2.943275
 * delta/v, delta = (5 m v^2/(4 k))^{2/5}, here m = 3/2, k = 1. */
TEST(energy_contact_time)
{
    double longer = 0.0;
    for (int k = -2; k <= 4; k++) {
        double v = pow(10.0, k), exact_time = free_contact_time(v), before = longer;
        longer = exact_time * v / (2.943275 * pow(1.875 * v * v, 0.4)) - 1.0;
        check_below(check_name("speed %g: contact time over the quadrature's, worst error", v),
                    bounce(&taylor, 1e-12, fmin(0.01 * exact_time, v), v).time, 5e-12);
        if (k > 1)
            check_near("preload makes it longer by v^{-6/5}", longer / before, pow(10.0, -1.2), 0.01);
    }
    check_below("longer at speed 10000 by", longer, 1e-5);
}

#pragma GCC diagnostic pop
