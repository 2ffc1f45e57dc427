/* test_afm_lever.c - the AFM lever and its method against closed forms: modes, contact resonances, heat,
 * ring-down, approach, dissipation. Numbers without a source are roots or algebra of an independent program
 * (mpmath). */
#include "tests/unit/test.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/app/plant_scene.h"
#include "firmware/method/modal_run.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "host_sim/scene/scene_load.h"
#include "tests/fixture/afm/lever.h"
#include "tests/fixture/imaginary.h"

#define TWO_PI    6.283185307179586
#define BOLTZMANN 1.380649e-23

static struct lever lever;

/* The four levers: f0, k, Q. */
static const struct {
    const char *name;
    double f0, k, quality, rms, tau;
} levers[4] = {
    {"soft", 13e3, 0.2, 30.0, 1.427044945e-10, 7.345613e-4},
    {"seed", 30.09e3, 0.404, 50.0, 1.004065320e-10, 5.289297e-4},
    {"tapping", 70e3, 2.0, 400.0, 4.512712350e-11, 1.818914e-3},
    {"stiff", 300e3, 40.0, 450.0, 1.009073158e-11, 4.774648e-4},
};

static void take_lever(int i)
{
    lever_defaults(&lever);
    lever.si[LEVER_F0] = levers[i].f0;
    lever.si[LEVER_K] = levers[i].k;
    lever.si[LEVER_Q] = levers[i].quality;
}

static void start_lever(const struct method *method, double ticks)
{
    check_no_error("plant", lever_start(&lever, method, ticks));
}

/* ---- modes ---- */

/* Butt & Jaschke 1995: their 0.8174 is the first mode's share
 * of the heat seen by an optical sensor, 4/3 that of all. */
TEST(afm_modes)
{
    static const double want[4][5] = {
        {1.87510406871196, 1.0, 1.03019694736, 0.9176703231, 1.565983512},
        {4.69409113297417, 6.26689302577, 40.4599015428, 3.187185607, -0.8678717902},
        {7.85475743823761, 17.5474819368, 317.212188866, 5.232444031, 0.5088505937},
        {10.9955407348755, 34.3860611572, 1218.10610876, 7.330606447, -0.3637960433},
    };
    static const double share[4] = {0.81743479, 0.25106715, 0.086309642, 0.044115854};
    lever_defaults(&lever);
    lever.si[LEVER_MODES] = 4.0;
    start_lever(&modal, 256.0);
    struct modal_form f;
    afm_lever.modal_form(lever.plant.p, &f);
    for (int i = 0; i < 4; i++) {
        double k = pow(beam_modes[i].beta, 4.0) / 12.0, s = beam_modes[i].sensor;
        check_near("beta", beam_modes[i].beta, want[i][0], 1e-9);
        check_near("f_n/f_1", f.omega[i], want[i][1], 1e-9 * want[i][1]);
        check_near("k_n/k", k, want[i][2], 1e-9 * want[i][2]);
        check_near("sensor", s, want[i][3], 1e-9 * want[i][3]);
        check_near("participation of the base", f.participation[i], want[i][4], 1e-9);
        check_near("share of the heat", s * s / k, share[i], 1e-8);
    }
}

/* A static force deflects the tip by F/k, and the sensor is calibrated by that, for any number of modes. */
TEST(afm_static)
{
    for (int modes = 1; modes <= 4; modes++) {
        double out[MODEL_OUTPUTS];
        lever_defaults(&lever);
        lever.si[LEVER_MODES] = modes;
        lever.si[LEVER_K] = 0.2;
        lever.si[LEVER_Q] = 5.0;
        lever.si[LEVER_HAMAKER] = lever.si[LEVER_HAMAKER_OUT] = 0.0;
        lever.si[LEVER_HEIGHT] = -20e-9;
        lever.si[LEVER_INDENTATION_MAX] = 20e-9;
        start_lever(&modal, 256.0);
        plant_output(&lever.plant, out);
        double placed = out[0];
        double force = 4.0 / 3.0 * 1e9 * sqrt(10e-9) * pow(out[2], 1.5);
        check_near("force of Hertz at the indentation, N", out[3], force, 1e-12 * force);
        check_near("deflection of the tip, m", out[0], force / 0.2, 1e-11 * force / 0.2);
        check_near("reading of the sensor, m", out[LEVER_DEFLECTION], force / 0.2, 1e-11 * force / 0.2);
        check_true("runs", plant_run(&lever.plant, 256 * 40));
        plant_output(&lever.plant, out);
        check_near("by the method: off by (w h)^2/12 a mode", out[0] / placed, 1.0, modes * 1e-6);
    }
}

/* So near that the pull's gradient is above the lever's stiffness, a tip rests in contact only: there the
 * lever's force is the sample's, the Hertzian one less the adhesion H R / (6 a0^2). */
TEST(afm_rest_attracted)
{
    static const double height[] = {0.2e-9, 0.4e-9, 0.8e-9};
    for (size_t i = 0; i < sizeof height / sizeof height[0]; i++) {
        double out[MODEL_OUTPUTS];
        take_lever(0);
        lever.si[LEVER_HEIGHT] = height[i];
        start_lever(&modal, 256.0);
        plant_output(&lever.plant, out);
        const double *si = lever.si;
        double gradient = si[LEVER_HAMAKER] * si[LEVER_RADIUS] / (3.0 * height[i] * height[i] * height[i]);
        double hertz = 4.0 / 3.0 * si[LEVER_MODULUS] * sqrt(si[LEVER_RADIUS]) * pow(out[2], 1.5);
        double adhesion = si[LEVER_HAMAKER] * si[LEVER_RADIUS] / (6.0 * si[LEVER_A0] * si[LEVER_A0]);
        check_above("gradient of the pull where the lever hangs, N/m", gradient, si[LEVER_K]);
        check_above("indentation at rest, m", out[2], 0.1e-9);
        check_near("force at rest, N", out[3], hertz - adhesion, 1e-9 * adhesion);
        check_near("the lever's force, N", si[LEVER_K] * out[0], out[3], 1e-9 * adhesion);
    }
}

/* A motion beyond the numbers ends the run, and leaves the state as it was. */
TEST(afm_not_finite)
{
    take_lever(2);
    start_lever(&modal, 128.0);
    lever.plant.x[0] = lever.plant.x[MODEL_MODES + 1] = 1.7e308;
    check_true("refused", !plant_run(&lever.plant, 1));
    check_int("counted", lever.plant.counts.not_finite, 1);
    check_near("deflection as before", lever.plant.x[0], 1.7e308, 0.0);
}

/* ---- contact resonances ---- */

/* A lever pressed on a Hertzian sample whose stiffness is `ratio` k, with `eta`; at rest there. */
static void press(int modes, double ratio, double eta, double ticks)
{
    const double depth = 1e-9, k = 2.0;
    lever_defaults(&lever);
    lever.si[LEVER_MODES] = modes;
    lever.si[LEVER_Q] = 1e6;
    lever.si[LEVER_HAMAKER] = lever.si[LEVER_HAMAKER_OUT] = 0.0;
    lever.si[LEVER_MODULUS] = ratio * k / (2.0 * sqrt(lever.si[LEVER_RADIUS] * depth));
    lever.si[LEVER_VISCOSITY] = eta / sqrt(lever.si[LEVER_RADIUS] * depth);
    lever.si[LEVER_PERMANENT] = 1.0;
    lever.si[LEVER_INDENTATION_MAX] = 1.1 * depth;
    lever.si[LEVER_HEIGHT] = lever.si[LEVER_A0] - depth - 2.0 / 3.0 * ratio * depth;
    /* A still state of the method itself, which lies (w
     * h)^2/12 beside the model's: found with much damping. */
    double quality = lever.si[LEVER_Q];
    lever.si[LEVER_Q] = 2.0;
    start_lever(&modal, ticks);
    check_true("settles", plant_run(&lever.plant, (uint64_t)(60.0 * ticks)));
    lever.si[LEVER_Q] = quality;
    check_no_error("damping back", plant_change(&lever.plant, lever.si));
}

/* Frequency over f1, and quality. */
static double resonance(double guess, double ticks, double *quality)
{
    double complex z = clog(lever_multiplier(&lever, 1, cexp(i_unit * guess * TWO_PI / ticks), 1e-6));
    *quality = -0.5 * cimag(z) / creal(z);
    return cimag(z) * ticks / TWO_PI;
}

TEST(afm_contact_resonances)
{
    const double ticks = 256.0, first = 1.87510406871196;
    double ratio, root[4], quality;
    char line[200];
    FILE *file = fopen("tests/data/contact_resonances.txt", "r");
    int rows = 0;
    check_true("tests/data/contact_resonances.txt", file != NULL);
    while (file && fgets(line, sizeof line, file)) {
        if (sscanf(line, "%lf %lf %lf %lf %lf", &ratio, &root[0], &root[1], &root[2], &root[3]) != 5)
            continue;
        if (ratio == 0.0 || ratio > 100.0)
            continue;
        press(4, ratio, 0.0, ticks);
        for (int i = 0; i < 3; i++) {
            double want = pow(root[i] / first, 2.0);
            check_near(check_name("k*/k %g: f%d/f1", ratio, i + 1), resonance(want, ticks, &quality), want,
                       want * (ratio <= 30.0 ? 1e-4 : 1e-3));
        }
        rows++;
    }
    if (file)
        fclose(file);
    check_int("rows", rows, 9);
}

/* However stiff the sample, no mode passes that of a beam pinned at its end. */
TEST(afm_pinned)
{
    static const double pinned[3] = {4.38513617, 14.2106499, 29.6493867};
    double quality;
    press(4, 300.0, 0.0, 512.0);
    for (int i = 0; i < 3; i++)
        check_below("f/f1 at k*/k 300 below that of the pinned beam",
                    resonance(0.97 * pinned[i], 512.0, &quality), pinned[i]);
}

/* A weak spring: (f/f1)^2 = 1 + 12 K/beta_1^4 to the first order; and the beam's own root. */
TEST(afm_weak_spring)
{
    double quality;
    press(4, 0.1, 0.0, 256.0);
    check_near("f/f1 at k*/k 0.1", resonance(1.047, 256.0, &quality), 1.04741, 2e-4);
}

/* A spring with a damper at the end of the beam, Kc = K + i g x^2, x = beta L: roots in the complex plane. */
TEST(afm_contact_damping)
{
    static const struct {
        double g, f, quality;
    } want[3] = {
        {0.05, 3.708542268, 141.87343}, {0.05, 8.739660741, 40.02270}, {0.2, 3.711416276, 35.567121}};
    const double first = 1.87510406871196, omega = TWO_PI * 70e3;
    double quality;
    for (int i = 0; i < 3; i++) {
        press(4, 30.0, want[i].g * 2.0 * first * first / omega, 256.0);
        check_near("f/f1", resonance(want[i].f, 256.0, &quality), want[i].f, 1e-3 * want[i].f);
        check_near("quality", quality, want[i].quality, 0.01 * want[i].quality);
    }
}

/* ---- heat and ring-down ---- */

/* A tick of the free lever as a matrix, and the covariance C of its heat: equipartition P = diag(kT/k, kT/m)
 * is kept, E P E' + C = P, at any step. */
TEST(afm_equipartition)
{
    static const double ticks[] = {2.6, 5.0, 16.0, 64.0, 1000.0};
    for (int n = 0; n < 5; n++) {
        lever_defaults(&lever);
        lever.si[LEVER_INDENTATION_MAX] = 1e-12;
        lever.si[LEVER_MODULUS] = 1.0;
        lever.si[LEVER_HAMAKER] = lever.si[LEVER_HAMAKER_OUT] = 0.0;
        lever.si[LEVER_HEIGHT] = 1e-3;
        start_lever(&modal, ticks[n]);
        double e[2][2], h = lever.plant.h, lost = exp(-h / 400.0);
        for (int k = 0; k < 2; k++) {
            double x[MODEL_STATES] = {0.0};
            x[k ? LEVER_RATE : 0] = 1.0;
            plant_set_state(&lever.plant, x);
            check_true("a tick", plant_run(&lever.plant, 1));
            e[0][k] = lever.plant.x[0];
            e[1][k] = lever.plant.x[LEVER_RATE];
        }
        double noise = 1.0 - lost * lost; /* variance of the heat's kick over kT/m */
        check_near("position: E P E' + C - P", e[0][0] * e[0][0] + e[0][1] * e[0][1], 1.0, 1e-14);
        check_near("position and velocity", e[0][0] * e[1][0] + e[0][1] * e[1][1], 0.0, 1e-14);
        check_near("velocity", e[1][0] * e[1][0] + e[1][1] * e[1][1] + noise, 1.0, 1e-14);
        check_near("area of the phase plane", e[0][0] * e[1][1] - e[0][1] * e[1][0], lost, 1e-14);
    }
}

/* A kick of the heat, from rest: the fourth moment over the square of the second. It is 3 where the lever
 * hardly rings, as a Gaussian's is. It is 9/5, as a uniform number's, where many kicks add up to a Gaussian.
 */
TEST(afm_heat_distribution)
{
    static const double quality[] = {2.0, 400.0}, kurtosis[] = {3.0, 1.8};
    enum { KICKS_SEEN = 20000 }; /* a Gaussian has 3 within 0.035 */
    for (int n = 0; n < 2; n++) {
        double second = 0.0, fourth = 0.0;
        lever_defaults(&lever);
        lever.si[LEVER_Q] = quality[n];
        lever.si[LEVER_TEMPERATURE] = 295.0;
        lever.si[LEVER_HEIGHT] = 1e-3;
        start_lever(&modal, 16.0);
        for (int i = 0; i < KICKS_SEEN; i++) {
            plant_set_state(&lever.plant, (double[MODEL_STATES]){0.0});
            if (!plant_run(&lever.plant, 1))
                break;
            double square = lever.plant.x[LEVER_RATE] * lever.plant.x[LEVER_RATE];
            second += square / KICKS_SEEN;
            fourth += square * square / KICKS_SEEN;
        }
        check_near("kurtosis", fourth / (second * second), kurtosis[n], 0.15);
    }
}

/* The variance of the kicks themselves, from the spread of a tick that begins at rest. */
TEST(afm_heat_kick)
{
    enum { TICKS = 400000 };
    double sum = 0.0, square = 0.0, fourth = 0.0;
    take_lever(2);
    lever.si[LEVER_TEMPERATURE] = 295.0;
    lever.si[LEVER_HEIGHT] = 1e-3;
    start_lever(&modal, 64.0);
    double spread =
        sqrt(BOLTZMANN * 295.0 / lever.plant.scale.energy_J * (1.0 - exp(-2.0 * lever.plant.h / 400.0)));
    for (int i = 0; i < TICKS; i++) {
        plant_set_state(&lever.plant, (const double[MODEL_STATES]){0.0});
        if (!plant_run(&lever.plant, 1))
            break;
        double xi = lever.plant.x[LEVER_RATE] / spread;
        sum += xi;
        square += xi * xi;
        fourth += xi * xi * xi * xi;
    }
    check_near("mean, standard errors", sum / sqrt(TICKS), 0.0, 4.0);
    check_near("variance over that of equipartition", square / TICKS, 1.0, 4.0 * sqrt(0.8 / TICKS));
    check_near("fourth moment of uniform noise", fourth / TICKS, 1.8, 0.02);
}

TEST(afm_thermal_rms)
{
    for (int i = 0; i < 4; i++) {
        const double periods = 400.0 * levers[i].quality; /* the run */
        double square = 0.0, run = periods / levers[i].f0;
        take_lever(i);
        lever.si[LEVER_TEMPERATURE] = 295.0;
        lever.si[LEVER_HEIGHT] = 1e-3;
        start_lever(&modal, 16.0);
        check_near("rms by kT/k, m", sqrt(BOLTZMANN * 295.0 / levers[i].k), levers[i].rms,
                   1e-9 * levers[i].rms);
        check_true("settles", plant_run(&lever.plant, (uint64_t)(32.0 * levers[i].quality)));
        long n = lround(periods * 16.0);
        for (long t = 0; t < n && plant_run(&lever.plant, 1); t++)
            square += lever.plant.x[0] * lever.plant.x[0];
        double unit = lever.plant.scale.length_m, rms = sqrt(square / (double)n) * unit;
        double error = 0.5 * sqrt(2.0 * levers[i].quality / (TWO_PI * levers[i].f0 * run)) * levers[i].rms;
        check_near(levers[i].name, rms, levers[i].rms, 4.0 * error);
        double scratch = sum_of(&lever.plant.ledger.heat), lost = sum_of(&lever.plant.ledger.damping);
        check_near("heat that came in over what the damper took", scratch / lost, 1.0, 0.01);
        check_near("residual of the energy over what moved",
                   plant_residual(&lever.plant) / lever.plant.scale.energy_J / lost, 0.0, 1e-12);
    }
}

TEST(afm_ring_down)
{
    for (int i = 0; i < 4; i++) {
        static const double ticks[] = {8.0, 64.0, 256.0};
        double omega = TWO_PI * levers[i].f0, tau = 2.0 * levers[i].quality / omega;
        check_near("tau by Q and f0, s", tau, levers[i].tau, 1e-6 * tau);
        for (int k = 0; k < 3; k++) {
            take_lever(i);
            lever.si[LEVER_HEIGHT] = 1e-3;
            lever.si[LEVER_HAMAKER] = lever.si[LEVER_HAMAKER_OUT] = 0.0;
            start_lever(&modal, ticks[k]);
            double complex z = clog(lever_multiplier(&lever, 1, cexp(i_unit * TWO_PI / ticks[k]), 1.0));
            double rate = -creal(z) * levers[i].f0 * ticks[k];
            /* The linearisation by differences has rounding of its own, 1e-16 a tick. */
            check_near("1/tau of a tick, relative", rate * tau, 1.0, 1e-12 * ticks[k] * levers[i].quality);
            double damped = sqrt(1.0 - 0.25 / (levers[i].quality * levers[i].quality));
            double theta = TWO_PI / ticks[k], q = levers[i].quality;
            check_near("frequency over f0", cimag(z) * ticks[k] / TWO_PI, damped,
                       1e-12 + theta * theta / (16.0 * q * q));
        }
    }
    take_lever(2);
    lever.si[LEVER_HEIGHT] = 1e-3;
    lever.si[LEVER_HAMAKER] = lever.si[LEVER_HAMAKER_OUT] = 0.0;
    start_lever(&modal, 64.0);
    double complex z = clog(lever_multiplier(&lever, 1, cexp(i_unit * TWO_PI / 64.0), 1.0));
    check_near("damped frequency, Hz", cimag(z) * 70e3 * 64.0 / TWO_PI, 69999.945312, 1e-8 * 70e3);
    check_near("left after 100 periods", exp(creal(z) / cimag(z) * 100.0 * TWO_PI), 0.4559378480, 1e-9);
}

/* White force of the heat over white noise through the lever, one-sided: closed forms against the spectrum by
 * the tick's own matrix (algebra, no sampling): S(f) = |(e^{iw} - E)^{-1} c|^2 2 h. */
TEST(afm_thermal_density)
{
    static const double want[][2] = {{0.0, 4.63017488e-29},    {35e3, 8.23139915e-29},
                                     {69.3e3, 1.15139634e-25}, {70e3, 7.40827981e-24},
                                     {70.7e3, 1.12824977e-25}, {140e3, 5.14462447e-30}};
    const double ticks = 64.0, k = 2.0, quality = 400.0, kT = BOLTZMANN * 295.0;
    const double theta = TWO_PI / ticks, h = 1.0 / (70e3 * ticks), lost = exp(-theta / quality);
    for (int i = 0; i < 6; i++) {
        double r = want[i][0] / 70e3, chi = 1.0 / (pow(1.0 - r * r, 2.0) + r * r / (quality * quality));
        double density = 4.0 * kT / (k * TWO_PI * 70e3 * quality) * chi;
        check_near("density by the Lorentzian, m2/Hz", density, want[i][0] == 0.0 ? want[i][1] : want[i][1],
                   1e-8 * density);
        double complex z = cexp(i_unit * theta * r), c = cos(theta), s = sin(theta);
        double complex chain = s / ((z - c) * (z - lost * c) + lost * s * s);
        double tick = kT / k * (1.0 - lost * lost) * pow(cabs(chain), 2.0) * 2.0 * h;
        check_near("density of the method's ticks over it", tick / density, 1.0, r > 1.5 ? 0.01 : 2e-3);
    }
    check_near("force, N/rtHz", sqrt(4.0 * kT * k / (TWO_PI * 70e3 * quality)), 1.360908e-14, 1e-20);
}

/* ---- approach ---- */

/* The base goes to z over so many ticks, and the plant a little further. */
static void move_base(double z, uint64_t ticks)
{
    plant_sample(&lever.plant, LEVER_Z, z, ticks);
    check_true("base moves", plant_run(&lever.plant, ticks));
}

static double output_of(int which)
{
    double out[MODEL_OUTPUTS];
    plant_output(&lever.plant, out);
    return out[which];
}

static void soft_lever(void)
{
    lever_defaults(&lever);
    lever.si[LEVER_F0] = 13e3;
    lever.si[LEVER_K] = 0.2;
    lever.si[LEVER_Q] = 5.0;
    lever.si[LEVER_HAMAKER] = lever.si[LEVER_HAMAKER_OUT] = 1e-19;
    lever.si[LEVER_HEIGHT] = 10e-9;
}

/* Snap-in at the gap (HR/3k)^(1/3), with the base at 1.5 of
 * it; contact after it, pull-off, and the lever free again. */
TEST(afm_snap_in)
{
    double base = 0.0, gap = 0.0;
    soft_lever();
    start_lever(&modal, 96.0);
    move_base(-8e-9, 20000);
    for (int i = 0; i < 4000 && lever.plant.counts.switches == 0; i++) {
        base = output_of(LEVER_BASE);
        gap = output_of(LEVER_GAP);
        move_base(-8e-9 - 0.1e-12 * i - 0.1e-12, 300);
    }
    (void)gap;
    check_near("base at the snap, m", base, 1.7784467e-9, 0.01 * 1.7784467e-9);
    struct event e;
    check_true("counted as a touch", plant_take_event(&lever.plant, &e) && e.touch);
    /* Rest in contact at the base of the snap. */
    move_base(1.7784467e-9 - 10e-9, 2000);
    check_true("settles", plant_run(&lever.plant, 96 * 60));
    check_near("indentation, m", output_of(2), 1.2023238e-9, 1e-3 * 1.2023238e-9);
    check_near("deflection, m", output_of(0), -2.8157705e-9, 1e-3 * 2.8157705e-9);
}

TEST(afm_pull_off)
{
    double base = 0.0, deflection = 0.0;
    soft_lever();
    lever.si[LEVER_HEIGHT] = 0.0;
    start_lever(&modal, 96.0);
    move_base(30.5e-9, 40000);
    check_true("settles", plant_run(&lever.plant, 96 * 40));
    check_int("still in contact", (int)output_of(LEVER_IN_CONTACT), 1);
    for (int i = 0; i < 4000 && lever.plant.counts.switches == 0; i++) {
        base = output_of(LEVER_BASE);
        deflection = output_of(0);
        move_base(30.5e-9 + 0.5e-12 * i + 0.5e-12, 300);
    }
    check_near("base at pull-off, m", base, 3.0774122e-8, 1e-3 * 3.0774122e-8);
    check_near("deflection before it, m", deflection, -3.0609122e-8, 1e-3 * 3.0609122e-8);
    check_true("settles", plant_run(&lever.plant, 96 * 60));
    check_near("deflection after it, m", output_of(0), -8.8e-13, 0.2e-13);
}

/* The slope of the approach curve in contact, k_ts/(k + k_ts). */
TEST(afm_slope)
{
    static const struct {
        double modulus, hamaker, deflection, slope;
    } want[] = {{1e9, 1e-19, 1e-9, 0.9731138214},   {1e9, 1e-19, 5e-9, 0.9741336951},
                {1e9, 1e-19, 20e-9, 0.9769277944},  {1e6, 6.4e-20, 1e-9, 0.2388191919},
                {1e6, 6.4e-20, 5e-9, 0.2497425855}, {1e6, 6.4e-20, 20e-9, 0.2806500907}};
    for (int i = 0; i < 6; i++) {
        double k = 0.2, R = 10e-9, pull = want[i].hamaker * R / (6.0 * 0.165e-9 * 0.165e-9), x[2], d[2];
        double depth =
            pow((k * want[i].deflection + pull) / (4.0 / 3.0 * want[i].modulus * sqrt(R)), 2.0 / 3.0);
        double height = 0.165e-9 - depth - want[i].deflection;
        soft_lever();
        lever.si[LEVER_MODULUS] = want[i].modulus;
        lever.si[LEVER_HAMAKER] = lever.si[LEVER_HAMAKER_OUT] = want[i].hamaker;
        lever.si[LEVER_INDENTATION_MAX] = 2.0 * depth;
        lever.si[LEVER_HEIGHT] = height;
        start_lever(&modal, 96.0);
        for (int k2 = 0; k2 < 2; k2++) {
            move_base(k2 ? -0.01e-9 : 0.01e-9, 960);
            check_true("settles", plant_run(&lever.plant, 96 * 60));
            x[k2] = output_of(LEVER_BASE);
            d[k2] = output_of(0);
        }
        check_near("slope of the deflection", -(d[1] - d[0]) / (x[1] - x[0]), want[i].slope,
                   1e-4 * want[i].slope);
    }
}

/* ---- dissipation by two branches ---- */

/* In and out once over a sample: the loss is R (H_r - H_a)
 * (1/a0 - 1/release)/6 + dF_ad times the deepest indentation. */
TEST(afm_two_branches)
{
    lever_defaults(&lever);
    lever.si[LEVER_Q] = 1e6;
    lever.si[LEVER_HAMAKER_OUT] = 1e-19;
    lever.si[LEVER_RELEASE] = 20e-9;
    lever.si[LEVER_HEIGHT] = 60e-9;
    start_lever(&modal, 64.0);
    double x[MODEL_STATES] = {0.0};
    x[0] = 62e-9 / lever.plant.scale.length_m;
    plant_set_state(&lever.plant, x);
    double deepest = 0.0, before = sum_of(&lever.plant.ledger.damping);
    for (int i = 0; i < 64; i++) {
        for (int k = 0; k < 64; k++) {
            check_is("a part of a tick runs",
                     plant_advance(&lever.plant, (struct instant){lever.plant.now.tick + (k == 63),
                                                                  k == 63 ? 0 : (uint32_t)(k + 1) * 1024}),
                     >, 0);
            deepest = fmax(deepest, output_of(2));
        }
    }
    double moved = (sum_of(&lever.plant.ledger.damping) - before) * lever.plant.scale.energy_J;
    double lever_loss = 0.5 * 2.0 * 62e-9 * 62e-9 * (1.0 - exp(-TWO_PI / 1e6));
    double range = 10e-9 * (1e-19 - 6.4e-20) / 6.0, pull = range / (0.165e-9 * 0.165e-9);
    double want = range * (1.0 / 0.165e-9 - 1.0 / 20e-9) + pull * deepest;
    check_near("difference of the pull-off forces, N", pull, 2.203857e-9, 1e-6 * 2.2e-9);
    check_near("long range part, J", range / 0.165e-9, 3.636364e-19, 1e-6 * 3.6e-19);
    check_near("loss of a cycle, J", moved - lever_loss, want, 1e-3 * want + 0.01 * lever_loss);
}

/* ---- presets ---- */

/* Each runs by its own method for a thousand periods, warm; a map of it starts cold. */
TEST(afm_presets)
{
    static const char *const names[] = {"soft", "seed", "tapping", "stiff"};
    for (int i = 0; i < 4; i++) {
        const struct preset *preset = scenes_find(names[i]);
        char why[SCENE_REASON];
        struct scene cold;
        double si[MODEL_PARAMETERS];
        struct harmonic drive[MODEL_INPUTS];
        check_true(names[i], preset != NULL);
        scenes_resolve(&preset->scene, si, drive);
        const struct scene *s = &preset->scene;
        struct plant_config c = {.model = s->model,
                                 .si = si,
                                 .method = method_find(s->method),
                                 .tick_s = s->frame_s / s->substeps,
                                 .dilation = s->dilation,
                                 .scratch = lever.scratch};
        check_no_error("plant", plant_init(&lever.plant, &c));
        plant_scene_begin(&lever.plant, s, si, drive);
        check_near("f0, Hz", si[LEVER_F0], levers[i].f0, 0.0);
        check_near("k, N/m", si[LEVER_K], levers[i].k, 0.0);
        check_near("quality", si[LEVER_Q], levers[i].quality, 0.0);
        check_true("runs", plant_run(&lever.plant, 96000));
        check_above("heat came in", sum_of(&lever.plant.ledger.heat), 0.0);
        double moved = sum_of(&lever.plant.ledger.damping) + sum_of(&lever.plant.ledger.heat);
        check_near("residual of the energy over what moved",
                   plant_residual(&lever.plant) / lever.plant.scale.energy_J / moved, 0.0, 5e-3);
        check_int("loaded cold", scene_load_cold(names[i], &cold, why), SCENE_OF_PRESET);
        check_near("temperature of a map, K", cold.value[LEVER_TEMPERATURE], 0.0, 0.0);
        check_near("temperature of the preset, K", si[LEVER_TEMPERATURE], 295.0, 0.0);
    }
}

/* ---- bad input ---- */

static void refused(const char *part, int i, double value)
{
    lever_defaults(&lever);
    lever.si[i] = value;
    check_contains(afm_lever.parameter[i].name, lever_start(&lever, &modal, 64.0), part);
}

TEST(afm_refusals)
{
    refused("outside its range", LEVER_Q, 0.1);
    refused("outside its range", LEVER_Q, 1e7);
    refused("outside its range", LEVER_Q, (double)NAN);
    refused("inside the surface", LEVER_HEIGHT, -30e-9);
    refused("1, 2, 3 or 4", LEVER_MODES, 1.5);
    refused("2.5 rad", LEVER_MODES, 4.0);
    refused("0 or 1", LEVER_PERMANENT, 0.5);
    refused("whole number", LEVER_SEED, 0.5);
    refused("at least hamaker_J", LEVER_HAMAKER_OUT, 1e-20);
    refused("above a0_m", LEVER_RELEASE, 0.15e-9);
    refused("1 rad or more", LEVER_MODULUS, 1e13);
    lever_defaults(&lever);
    lever.si[LEVER_TEMPERATURE] = 295.0;
    check_contains("rk4", lever_start(&lever, &rk4, 4096.0), "heat needs method modal");
    lever_defaults(&lever);
    lever.si[LEVER_HAMAKER_OUT] = 1e-19;
    check_contains("rk4", lever_start(&lever, &rk4, 4096.0), "two branches");
}

/* A tick over another sample is one of a lever that never felt the first. */
TEST(lever_changes_sample)
{
    static struct lever soft, hard;
    static double other[METHOD_SCRATCH];
    double x[MODEL_STATES];
    struct segment still = {.length = 0.1};
    struct crossing c;
    lever_defaults(&soft);
    soft.si[LEVER_HEIGHT] = -1e-9;
    lever_defaults(&hard);
    hard.si[LEVER_HEIGHT] = -1e-9;
    hard.si[LEVER_MODULUS] = 3e9;
    check_no_error("soft", lever_start(&soft, &modal, 64.0));
    check_no_error("hard", lever_start(&hard, &modal, 64.0));
    step_function *step = modal.bind(&afm_lever);
    modal.prepare(&afm_lever, soft.plant.p, 0.1, 0.0, soft.scratch);
    modal.prepare(&afm_lever, hard.plant.p, 0.1, 0.0, other);
    memcpy(x, soft.plant.x, sizeof x);
    check_is("a tick on the soft one",
             step(&afm_lever, soft.plant.p, soft.scratch, &still, REGIME_ANY, x, &c), ==, STEP_END);
    double fresh[MODEL_STATES];
    memcpy(fresh, x, sizeof fresh);
    modal_change_sample(&afm_lever, hard.plant.p, soft.scratch);
    check_is("then on the hard one", step(&afm_lever, hard.plant.p, soft.scratch, &still, REGIME_ANY, x, &c),
             ==, STEP_END);
    check_is("from there, without the past",
             step(&afm_lever, hard.plant.p, other, &still, REGIME_ANY, fresh, &c), ==, STEP_END);
    check_bytes("equal bits", x, fresh, sizeof x);
}
