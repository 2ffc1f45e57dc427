/* test_afm_tapping.c - the AFM lever driven over a sample: orbits by shooting (tests/data/tapping_orbits.txt,
 * an independent program), their energy balance, bistability, frequency modulation, and the tip of the
 * papers. */
#include "tests/unit/test.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/afm_tip.h"
#include "tests/fixture/afm/tapping.h"

#define TWO_PI 6.283185307179586
#define TICKS  64.0

static struct lever lever;

/* At the height `ratio` of the free amplitude, on the motion a cos(wt - lag). */
static void tap(const struct tapping_case *c, double ratio, double amplitude, double lag_deg)
{
    tapping_set(&lever, c, ratio);
    check_no_error("plant", lever_start(&lever, &modal, TICKS));
    tapping_begin(&lever, c, amplitude, lag_deg, 0.0);
}

static void settle(int periods)
{
    check_true("settles", plant_run(&lever.plant, (uint64_t)(TICKS * periods)));
}

/* Amplitude in nm and lag in degrees. */
static double measure(int periods, double *lag, double *peak)
{
    double complex a = lever_lock_in(&lever, 0, TICKS, periods, peak);
    *lag = carg(a) * 360.0 / TWO_PI;
    return cabs(a) * 1e9;
}

static int orbits(void check(const struct tapping_case *c, const struct tapping_orbit *o))
{
    struct tapping_orbit o;
    int rows = 0;
    FILE *file = fopen("tests/data/tapping_orbits.txt", "r");
    check_true("tests/data/tapping_orbits.txt", file != NULL);
    for (; file && tapping_read(file, &o); rows++)
        check(tapping_find(o.name), &o);
    if (file)
        fclose(file);
    return rows;
}

static void check_orbit(const struct tapping_case *c, const struct tapping_orbit *o)
{
    double lag, peak;
    tap(c, o->ratio, o->amplitude, o->lag);
    settle(3000);
    double a = measure(40, &lag, &peak);
    check_near(check_name("%s branch %d, height %.2f A0: amplitude, nm", o->name, o->branch, o->ratio), a,
               o->amplitude, 1e-3 * c->free * 1e9);
    check_near("  lag, degrees", lag, o->lag, 0.3);
    if (o->branch == 1)
        check_near("  peak force, nN", peak * 1e9, o->peak, 0.01 * o->peak);
}

TEST(afm_tapping_orbits)
{
    check_int("orbits in the file", orbits(check_orbit), 74);
}

/* Hertz alone: F = [(8/3)(k/Q) sqrt(A0^2 - A^2) sqrt(A/2)]^(3/4) [(4/3) E sqrt R]^(1/4), a closed form for a
 * short contact (exponents of Hu & Raman 2007); 6 % is what the orbits differ from it. */
static void check_peak(const struct tapping_case *c, const struct tapping_orbit *o)
{
    double a0 = c->free, a = o->amplitude * 1e-9, closed, lag, peak;
    if (strcmp(o->name, "H") || o->branch != 1 || o->ratio < 0.4 || o->ratio > 0.9)
        return;
    closed = pow(8.0 / 3.0 * c->k / 400.0 * sqrt(a0 * a0 - a * a) * sqrt(0.5 * a), 0.75) *
             pow(4.0 / 3.0 * c->modulus * sqrt(c->radius), 0.25);
    tap(c, o->ratio, o->amplitude, o->lag);
    settle(2000);
    (void)measure(20, &lag, &peak);
    check_near("peak force over the closed form", peak / closed, 1.0, 0.06);
    check_near("peak force, nN", peak * 1e9, o->peak, 5e-3 * o->peak);
}

TEST(afm_peak_force)
{
    (void)orbits(check_peak);
}

/* Cleveland et al. 1998: sin(lag) = A/A0 (1 + Q E/(pi k A^2)), E lost in the sample a cycle. */
TEST(afm_cleveland)
{
    const struct tapping_case *c = tapping_find("A+KV");
    double lag, peak;
    tap(c, 0.7, 15.217688, 56.845);
    settle(3000);
    double unit = lever.plant.scale.energy_J, free_loss = 0.0;
    double before = sum_of(&lever.plant.ledger.damping);
    double a = measure(64, &lag, &peak) * 1e-9;
    double lost = (sum_of(&lever.plant.ledger.damping) - before) * unit / 64.0;
    free_loss = TWO_PI * 0.5 * c->k * a * a / 400.0;
    double sample = lost - free_loss;
    check_near("lost in the sample a cycle, aJ", sample * 1e18, 0.36462, 0.02 * 0.36462);
    double closed = TWO_PI / 4.0 / sqrt(2.0) * 28.7595 * sqrt(c->radius) * sqrt(a) * TWO_PI * TAPPING_F0 *
                    pow(1.44665e-9, 2.0);
    check_near("by the closed form of a damper, aJ", sample * 1e18, closed * 1e18, 0.02 * closed * 1e18);
    double sine = a / c->free + 400.0 * sample / (TWO_PI / 2.0 * c->k * a * c->free);
    check_near("sine of the lag", sin(lag * TWO_PI / 360.0), sine, 1e-3);
    check_near("residual of the energy over what was lost",
               plant_residual(&lever.plant) / (sum_of(&lever.plant.ledger.damping) * unit), 0.0, 2e-3);
}

/* Brute force, slowly: the height at which a branch is lost. The repulsive one is lost on retract, A between
 * 0.940 and 0.941 A0, B between 0.885 and 0.886. */
static double lost_at(const char *name, double from, double to, double step, double amplitude, double lag_deg)
{
    const struct tapping_case *c = tapping_find(name);
    double lag, peak;
    tap(c, from, amplitude, lag_deg);
    settle(3000);
    for (double ratio = from; (to - ratio) * step >= 0.0; ratio += step) {
        plant_sample(&lever.plant, LEVER_Z, (ratio - from) * c->free, (uint64_t)(TICKS * 200));
        settle(2200);
        (void)measure(8, &lag, &peak);
        if ((lag > 90.0) == (lag_deg < 90.0))
            return ratio;
    }
    return 0.0;
}

TEST(afm_bistability)
{
    check_near("A: the repulsive branch is lost at, A0", lost_at("A", 0.92, 0.96, 0.0025, 19.4, 76.0), 0.9405,
               0.005);
    check_near("B: the repulsive branch is lost at, A0", lost_at("B", 0.87, 0.90, 0.0025, 9.8, 80.0), 0.8855,
               0.005);
    check_near("A: the attractive branch stays on approach to 0.25 A0",
               lost_at("A", 0.5, 0.25, -0.05, 9.580374, 151.378), 0.0, 0.0);
}

/* A frequency shift by van der Waals' force alone: df = -f0 H
 * R/(6 k (D^2 - A^2)^{3/2}), and the exact conservative orbit. */
TEST(afm_frequency_shift)
{
    const double A = 10e-9, D = 12e-9, ticks = 128.0;
    lever_defaults(&lever);
    lever.si[LEVER_HEIGHT] = D;
    lever.si[LEVER_Q] = 1e6;
    lever.si[LEVER_RANGE] = 30e-9;
    check_no_error("plant", lever_start(&lever, &modal, ticks));
    double x[MODEL_STATES] = {0.0}, unit = lever.plant.scale.length_m;
    x[0] = -A / unit; /* from the nearest point, d = 2 nm */
    plant_set_state(&lever.plant, x);
    /* Upward crossings of the rest, in ticks, by the angle
     * there. With this Q the amplitude decays by 1e-4 meanwhile. */
    double first = 0.0, last = 0.0, old = lever.plant.x[0];
    int n = 0;
    for (int i = 0; i < 128 * 40; i++) {
        if (!plant_run(&lever.plant, 1))
            break;
        double now = lever.plant.x[0];
        if (old < 0.0 && now >= 0.0) {
            double at = i + 1.0 - atan2(now, lever.plant.x[LEVER_RATE]) / (TWO_PI / ticks);
            if (n++ == 0)
                first = at;
            last = at;
        }
        old = now;
    }
    double f = (n - 1) * ticks * TAPPING_F0 / (last - first);
    check_near("frequency shift of the orbit, Hz", f - TAPPING_F0, -12.79751441, 1e-3 * 12.8);
    check_near("by the closed form, Hz", f - TAPPING_F0, -12.79139038, 1e-3 * 12.8 + 0.00612403);
}

/* ---- the tip of the papers ---- */

/* afm_tip with sign -1 is the lever with one mode, no attraction, and its base held at the static load. */
static void papers_tip(double beta, double modulation, double fast, double force, double omega)
{
    static struct plant tip;
    static double tip_scratch[METHOD_SCRATCH];
    const double c = 0.02, start[2] = {1.3, 0.1};
    double tip_si[TIP_PARAMETERS] = {1.13e-11, 0.404, 0.0, 0.0, 1e-9, -1.0};
    double k0 = beta * 0.404 / (1.5 * sqrt(1e-9)), nu = sqrt(0.404 / 1.13e-11), worst = 0.0;
    tip_si[TIP_DAMPING] = c * sqrt(0.404 * 1.13e-11);
    tip_si[TIP_CONTACT_STIFFNESS] = k0;
    lever_defaults(&lever);
    lever.si[LEVER_F0] = nu / TWO_PI;
    lever.si[LEVER_K] = 0.404;
    lever.si[LEVER_Q] = 1.0 / c;
    lever.si[LEVER_HAMAKER] = lever.si[LEVER_HAMAKER_OUT] = 0.0;
    lever.si[LEVER_MODULUS] = k0 * 0.75 / sqrt(10e-9);
    lever.si[LEVER_INDENTATION_MAX] = 3e-9;
    lever.si[LEVER_HEIGHT] = lever.si[LEVER_A0] - (1.0 + 2.0 / 3.0 * beta) * 1e-9;
    lever.si[LEVER_RANGE] = 30e-9;
    const double ticks = 1024.0;
    check_no_error("lever", lever_start(&lever, &modal, ticks));
    struct plant_config tc = {.model = &afm_tip,
                              .si = tip_si,
                              .method = &taylor,
                              .tick_s = TWO_PI / nu / ticks,
                              .dilation = 1.0,
                              .tol = 1e-10,
                              .scratch = tip_scratch};
    check_no_error("tip", plant_init(&tip, &tc));
    plant_set_state(&tip, start);
    double x[MODEL_STATES] = {0.0}, unit = lever.plant.scale.length_m;
    x[0] = ((1.0 - start[0]) + 2.0 / 3.0 * beta) * 1e-9 / unit;
    x[LEVER_RATE] = -start[1] * 1e-9 / unit;
    plant_drive_start(&tip, TIP_FORCE, force * 0.404e-9, omega * nu / TWO_PI, 0.3);
    plant_drive_start(&tip, TIP_STIFFNESS, modulation, fast * nu / TWO_PI, 0.0);
    plant_drive_start(&lever.plant, LEVER_FORCE, -force * 0.404e-9, omega * nu / TWO_PI, 0.3);
    plant_drive_start(&lever.plant, LEVER_STIFFNESS, modulation, fast * nu / TWO_PI, 0.0);
    plant_set_state(&tip, start);
    plant_set_state(&lever.plant, x);
    double length = 0.0;
    for (int i = 0; i < 1024 * 20; i++) {
        if (!plant_run(&tip, 1) || !plant_run(&lever.plant, 1))
            break;
        double apart =
            fabs((lever.si[LEVER_A0] - lever.si[LEVER_HEIGHT] - lever.plant.x[0] * unit) * 1e9 - tip.x[0]);
        worst = fmax(worst, apart);
        length = fmax(length, fabs(tip.x[0]));
    }
    check_above("the motion loses contact", tip.counts.switches, 2);
    check_near("contact switches of both", lever.plant.counts.switches, tip.counts.switches, 1.0);
    check_below("indentation of both apart over 20 periods, static indentations", worst, 2e-4 * length);
    check_near("work of the force, J",
               sum_of(&lever.plant.ledger.work[LEVER_FORCE]) * lever.plant.scale.energy_J,
               sum_of(&tip.ledger.work[TIP_FORCE]) * tip.scale.energy_J, 1e-3 * 0.404e-18);
    check_near("work of the modulation, J",
               sum_of(&lever.plant.ledger.work[LEVER_STIFFNESS]) * lever.plant.scale.energy_J,
               sum_of(&tip.ledger.work[TIP_STIFFNESS]) * tip.scale.energy_J, 1e-3 * 0.404e-18);
}

TEST(afm_is_afm_tip)
{
    papers_tip(0.8, 0.0, 1.0, 0.7, 1.2);
    papers_tip(0.8, 0.5, 2.5, 0.9, 1.1);
    papers_tip(29.7, 0.3, 5.0, 3.0, 5.4);
}

/* rk4 integrates the equations through rhs, modal by turns: one orbit, all inputs and all modes. */
TEST(afm_modal_against_rk4)
{
    static struct lever other;
    for (int modes = 1; modes <= 3; modes++) {
        double worst = 0.0, large = 0.0;
        struct lever *l[2] = {&lever, &other};
        for (int k = 0; k < 2; k++) {
            lever_defaults(l[k]);
            l[k]->si[LEVER_MODES] = modes;
            l[k]->si[LEVER_VISCOSITY] = 5.0;
            l[k]->si[LEVER_HEIGHT] = 12e-9;
            check_no_error("plant", lever_start(l[k], k ? &rk4 : &modal, 4096.0));
            plant_drive_start(&l[k]->plant, LEVER_FORCE, 0.6e-9, 70e3, 0.0);
            plant_drive_start(&l[k]->plant, LEVER_FORCE_2, 0.5e-9, 438.7e3, 1.0);
            plant_drive(&l[k]->plant, LEVER_Z, 0.4e-9, 69e3, 2.0, 200e-6);
            plant_drive_start(&l[k]->plant, LEVER_STIFFNESS, 0.2, 20e3, 0.5);
        }
        for (int i = 0; i < 60 * 4096; i++) {
            if (i % 8192 == 0)
                for (int k = 0; k < 2; k++)
                    plant_sample(&l[k]->plant, LEVER_Z, 1e-9 * ((i / 8192) % 3), 4096);
            if (!plant_run(&lever.plant, 1) || !plant_run(&other.plant, 1))
                break;
            worst = fmax(worst, fabs(lever.plant.x[0] - other.plant.x[0]));
            large = fmax(large, fabs(other.plant.x[0]));
        }
        check_above("contact switches", other.plant.counts.switches, 4);
        check_below("positions apart over the largest", worst / large, 2e-5);
        for (int i = 0; i < LEVER_INPUTS; i++)
            check_near("work of an input over the stored energy", sum_of(&lever.plant.ledger.work[i]),
                       sum_of(&other.plant.ledger.work[i]), 3e-4 * large * large);
        check_near("damping", sum_of(&lever.plant.ledger.damping), sum_of(&other.plant.ledger.damping),
                   3e-4 * large * large);
        check_near("residual of modal", plant_residual(&lever.plant) / lever.plant.scale.energy_J, 0.0,
                   3e-4 * large * large);
    }
}
