/* test_afm_thermal.c - the density of a free lever's heat by Welch's method beside the
 * fluctuation-dissipation theorem, and the calibration that follows from the fit. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "host_sim/afm/thermal.h"

#define K_B 1.380649e-23

static struct afm_bench bench;

static void thermal_begin(double modes, double seed)
{
    memset(&bench, 0, sizeof bench);
    for (int i = 0; i < LEVER_PARAMETERS; i++)
        bench.si[i] = afm_lever.parameter[i].initial;
    bench.si[LEVER_TEMPERATURE] = 295.0;
    bench.si[LEVER_MODES] = modes;
    bench.si[LEVER_SEED] = seed;
    bench.tick_s = 1.0 / (64.0 * bench.si[LEVER_F0]);
    station_defaults(bench.number);
    thermal_prepare(&bench);
    check_int("station", afm_bench_start(&bench), 0);
}

/* One-sided density of the deflection, m^2/Hz. */
static double theorem(double f)
{
    double f0 = 70e3, q = 400.0, k = 2.0, floor = 2.0 * K_B * 295.0 / (3.141592653589793 * k * q * f0);
    return floor * pow(f0, 4.0) / (pow(f0 * f0 - f * f, 2.0) + pow(f0 * f / q, 2.0));
}

TEST(afm_thermal_spectrum)
{
    static const struct {
        double hz, density;
    } row[] = {{0.0, 4.63017488e-29},  {35e3, 8.23139915e-29},   {69.3e3, 1.15139634e-25},
               {70e3, 7.40827981e-24}, {70.7e3, 1.12824977e-25}, {140e3, 5.14462447e-30}};
    struct thermal t;
    thermal_begin(1.0, 5.0);
    check_int("listens", thermal_listen(&bench, 2.0, &t), 0);
    const struct spectrum *s = &t.spectrum;
    for (int i = 0; i < 6; i++) {
        double f = row[i].hz, wide = 1.0 / spectrum_frequency(s, 1), got = 0.0, mean = 0.0;
        check_near(check_name("closed form at %g kHz over the number", f * 1e-3), theorem(f) / row[i].density,
                   1.0, 1e-8);
        /* bins of 40 Hz around it; the theorem is averaged over them, too */
        long first = lround(f * wide) - (f > 0.0 ? 2 : -3), n = f > 0.0 ? 5 : 60;
        for (long k = first; k < first + n; k++) {
            got += s->density[k] / (double)n;
            mean += theorem(spectrum_frequency(s, (size_t)k)) / (double)n;
        }
        /* segments overlap by half and bins of a Hann window correlate: 0.5 of them count */
        double error = 1.0 / sqrt(0.5 * (double)s->segments * (double)n);
        check_near("  measured over the closed form", got / mean, 1.0, 4.0 * error);
    }
    check_near("force, N/sqrt(Hz)", sqrt(theorem(0.0)) * 2.0, 1.360908e-14, 1e-20);
    check_near("peak, m/sqrt(Hz)", sqrt(theorem(70e3)), 2.7218e-12, 1e-16);
    double spread = sqrt(2.0 * 400.0 / (6.283185307179586 * 70e3 * 2.0));
    check_near("f0 by the fit, Hz", t.fit.f0_Hz, 70e3, 4.0 * spread * 70e3 / 800.0);
    check_near("Q by the fit", t.fit.quality / 400.0, 1.0, 4.0 * spread * 1.5);
    check_near("stiffness by equipartition, N/m", t.stiffness, 2.0, 4.0 * spread * 2.0);
    check_near("its factor", t.factor, 1.0, 0.0);
    spectrum_free(&t.spectrum);
}

/* The first mode of a beam at a sensor of slope has 0.8174 of kT/k (Butt & Jaschke 1995). */
TEST(afm_thermal_calibration)
{
    struct thermal t;
    double spread = sqrt(2.0 * 400.0 / (6.283185307179586 * 70e3 * 2.0));
    thermal_begin(2.0, 10.0);
    check_int("listens", thermal_listen(&bench, 2.0, &t), 0);
    check_near("factor of the beam", t.factor, 0.81743479, 1e-8);
    check_near("stiffness, N/m", t.stiffness, 2.0, 4.0 * spread * 2.0);
    spectrum_free(&t.spectrum);
}

/* ---- the fit beside a sensor's white noise ---- */

/* An exact density gives exact numbers. */
TEST(afm_thermal_fit_exact)
{
    static const double white[] = {0.0, 1e-28, 1e-26, 1e-24, 3e-24};
    struct spectrum s;
    struct resonance r, q = {70e3, 400.0, 4.63e-29, 0.0};
    check_true("memory", spectrum_init(&s, 1 << 16, 1.0 / 1.12e6));
    for (int i = 0; i < 5; i++) {
        q.white = white[i];
        for (size_t k = 0; k <= s.length / 2; k++)
            s.density[k] = resonance_density(&q, spectrum_frequency(&s, k));
        check_true("found", spectrum_fit(&s, 66.5e3, 73.5e3, &r));
        check_near("f0", r.f0_Hz / q.f0_Hz, 1.0, 1e-9);
        check_near("Q", r.quality / q.quality, 1.0, 1e-9);
        check_near("density below the resonance", r.low / q.low, 1.0, 1e-9);
        check_near("white noise over the peak", (r.white - q.white) / 7.4e-24, 0.0, 1e-9);
    }
    for (size_t k = 0; k <= s.length / 2; k++)
        s.density[k] = 1e-26;
    check_true("no resonance in white noise", !spectrum_fit(&s, 66.5e3, 73.5e3, &r));
    spectrum_free(&s);
}

/* A photodiode's noise, 0.3 pm/sqrt(Hz) a tick: 5 % of the peak, 20 times the wings. A sample is every fourth
 * tick without a filter: four times the density. */
TEST(afm_thermal_noisy_sensor)
{
    struct thermal t;
    double spread = sqrt(2.0 * 400.0 / (6.283185307179586 * 70e3 * 2.0)), density = 0.3e-12;
    memset(&bench.scene, 0, sizeof bench.scene);
    thermal_begin(1.0, 7.0);
    afm_bench_free(&bench);
    bench.scene.model = &afm_lever;
    double *sensor = bench.scene.stage[0];
    sensor[STAGE_AT] = 1.0 + MODEL_INPUTS + LEVER_DEFLECTION;
    sensor[STAGE_SET_GAIN] = 1.0;
    sensor[STAGE_SET_NOISE] = density;
    check_int("station", afm_bench_start(&bench), 0);
    check_int("listens", thermal_listen(&bench, 2.0, &t), 0);
    double white = 4.0 * density * density,
           n = (double)t.spectrum.segments * 5600.0 / spectrum_frequency(&t.spectrum, 1);
    check_near("f0 by the fit, Hz", t.fit.f0_Hz, 70e3, 1.5 * 4.0 * spread * 70e3 / 800.0);
    check_near("white noise over the closed form", t.fit.white / white, 1.0, 4.0 / sqrt(0.5 * n));
    check_near("Q by the fit", t.fit.quality / 400.0, 1.0, 1.5 * 4.0 * spread * 1.5);
    check_near("stiffness by equipartition, N/m", t.stiffness, 2.0, 1.5 * 4.0 * spread * 2.0);
    spectrum_free(&t.spectrum);
}
