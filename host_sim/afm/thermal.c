/* thermal.c - the subcommand `thermal`: the spectrum of a
 * free lever's heat, and the stiffness that follows from it. */
#include "host_sim/commands.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/afm/afm_bench.h"
#include "host_sim/afm/thermal.h"
#include "host_sim/cli/chart.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/ticks.h"

#define TWO_PI 6.283185307179586

enum { LENGTH_MOST = 1 << 22, AROUND = 20 /* half widths of the resonance in the fit */ };

static const struct option thermal_options[] = {
    {"seconds", "S", "how long to measure (2)", OPTION_NUMBER, 1e-3, 1e4, .initial = "2"},
    {"set", "NAME=VALUE", "a number of lever or microscope, with its unit; repeatable", OPTION_TEXT,
     .many = true},
    {"out", "FILE", "rows of frequency, density and fit as CSV (standard output)", OPTION_WRITES,
     .initial = NULL},
    {"svg", "FILE", "a picture of density and fit", OPTION_WRITES, .initial = NULL},
    {.name = NULL},
};

static const struct usage thermal_usage = {
    .name = "thermal",
    .words = "[SCENE]",
    .summary =
        "Measures the thermal motion of a free AFM lever: density by Welch's method, the resonance fitted to "
        "it, and\n"
        "the stiffness by equipartition, with the factor of the beam and its sensor of slope (Butt & "
        "Jaschke\n"
        "1995).",
    .words_help =
        "SCENE is tapping, soft, stiff or a scene file of afm_lever; without SCENE it is tapping.\n",
    .examples = "  contactplant thermal --out heat.csv --svg heat.svg\n"
                "  contactplant thermal soft --seconds 10 --set modes=4 --set heat_seed=3 --out heat.csv\n",
    .min_words = 0,
    .max_words = 1,
    .table = {thermal_options},
};

/* Bins of 1/16 of the resonance's width. */
static size_t segment_of(const struct afm_bench *b)
{
    double wanted = 16.0 * b->si[LEVER_Q] / (b->si[LEVER_F0] * b->station.sample_s);
    size_t length = 64;
    while ((double)length < wanted && length < LENGTH_MOST)
        length *= 2;
    return length;
}

static const char too_short[] = "fewer than two segments: give --seconds %.3g or more";
static const double rounded_up = 1.005; /* so that three digits are enough */

/* s_1^2 k/k_1 of the beam: the share of kT/k that its first mode has in what the sensor of the slope reads.
 */
static double factor_of(const double *si)
{
    double beta = beam_modes[0].beta,
           share = beam_modes[0].sensor * beam_modes[0].sensor * 12.0 / (beta * beta * beta * beta);
    return si[LEVER_MODES] > 1.0 ? share : 1.0;
}

double thermal_square(const double *si)
{
    return factor_of(si) * BOLTZMANN_J_PER_K * si[LEVER_TEMPERATURE] / si[LEVER_K];
}

int thermal_listen(struct afm_bench *b, double seconds, struct thermal *t)
{
    struct station *s = &b->station;
    size_t length = segment_of(b);
    uint64_t samples = ticks_ended(seconds, s->sample_s);
    double ring = station_ring_time(b->si);
    if (samples < 2 * length)
        return options_misuse(b->usage, too_short, rounded_up * 2.0 * (double)length * s->sample_s);
    if (!spectrum_init(&t->spectrum, length, s->sample_s))
        return options_failure(b->usage, "out of memory");
    clock_catch_signals();
    int status = afm_bench_run(b, (uint64_t)(5.0 * ring / s->sample_s));
    for (uint64_t i = 0; i < samples && !status; i++) {
        status = afm_bench_run_on(b, 1);
        spectrum_add(&t->spectrum, s->out.deflection_m);
    }
    spectrum_finish(&t->spectrum);
    double f0 = b->si[LEVER_F0], half = AROUND * f0 / b->si[LEVER_Q];
    half = half < 0.3 * f0 ? half : 0.3 * f0;
    if (!status && !spectrum_fit(&t->spectrum, f0 - half, f0 + half, &t->fit))
        status = options_failure(b->usage, "no resonance within %.4g Hz of f0: give more --seconds", half);
    t->factor = factor_of(b->si);
    t->square_m2 = 0.25 * TWO_PI * t->fit.f0_Hz * t->fit.quality * t->fit.low;
    t->stiffness = t->factor * BOLTZMANN_J_PER_K * b->si[LEVER_TEMPERATURE] / t->square_m2;
    return status;
}

void thermal_prepare(struct afm_bench *b)
{
    b->number[STATION_DRIVE] = b->number[STATION_Z_LOOP] = 0.0;
    b->number[STATION_AGC] = b->number[STATION_PLL] = b->number[STATION_DART] = 0.0;
    /* away from the sample, whose forces would shift the resonance */
    b->si[LEVER_HEIGHT] = b->si[LEVER_HEIGHT] > 1e-6 ? b->si[LEVER_HEIGHT] : 1e-6;
}

static int write_rows(struct afm_bench *b, const struct thermal *t)
{
    FILE *f = options_given(&b->o, "out") ? options_compose(&b->o, "out") : stdout;
    if (!f)
        return STATUS_FAILED;
    fprintf(f, "frequency_Hz,density_m2_per_Hz,fit_m2_per_Hz\n");
    for (size_t i = 1; i <= t->spectrum.length / 2; i++) {
        double hz = spectrum_frequency(&t->spectrum, i);
        fprintf(f, "%.9g,%.6g,%.6g\n", hz, t->spectrum.density[i], resonance_density(&t->fit, hz));
    }
    return options_close(&b->o, "out", f, NULL);
}

int thermal_panel(struct chart *c, const struct thermal *t, double height)
{
    const struct spectrum *s = &t->spectrum;
    double step = spectrum_frequency(s, 1), half = 6.0 * t->fit.f0_Hz / t->fit.quality;
    size_t from = t->fit.f0_Hz > half + step ? (size_t)((t->fit.f0_Hz - half) / step) : 1;
    size_t to = (size_t)((t->fit.f0_Hz + half) / step) + 1,
           n = (to < s->length / 2 ? to : s->length / 2) - from;
    double *x = calloc(3 * n, sizeof *x), *y = x + n, *fit = y + n, min = (double)INFINITY,
           max = -(double)INFINITY;
    if (!x)
        return 1;
    for (size_t i = 0; i < n; i++) {
        double hz = spectrum_frequency(s, from + i);
        x[i] = hz * 1e-3;
        y[i] = log10(s->density[from + i]);
        fit[i] = log10(resonance_density(&t->fit, hz));
    }
    chart_range_add(&min, &max, y, n);
    chart_range_finish(&min, &max);
    chart_x_range(c, x[0], x[n - 1]);
    chart_panel(c, "thermal motion: log10 of the density (m\xC2\xB2/Hz)", height, min, max);
    chart_line(c, x, y, n, CHART_GREY, "lever");
    chart_line(c, x, fit, n, CHART_RED, "fitted oscillator");
    chart_x_axis(c, "frequency (kHz)");
    free(x);
    return 0;
}

static int draw_spectrum(struct afm_bench *b, const struct thermal *t)
{
    struct chart c;
    FILE *f = options_compose(&b->o, "svg");
    if (!f)
        return STATUS_FAILED;
    chart_begin(&c, "contactplant thermal", b->o.n_words ? b->o.word[0] : "tapping");
    bool bad = thermal_panel(&c, t, 260.0) != 0;
    const char *why = chart_end(&c, f);
    return options_close(&b->o, "svg", f, why ? why : bad ? "no memory for the chart" : NULL);
}

static void report_fit(const struct afm_bench *b, const struct thermal *t)
{
    FILE *f = options_summary(&b->o);
    fprintf(f, "resonance %.6g Hz (lever %.6g), Q %.4g (%.4g), %zu segments of %.3g Hz\n", t->fit.f0_Hz,
            b->si[LEVER_F0], t->fit.quality, b->si[LEVER_Q], t->spectrum.segments,
            spectrum_frequency(&t->spectrum, 1));
    fprintf(f, "white noise of the sensor %.4g fm/sqrt(Hz)\n", sqrt(t->fit.white) * 1e15);
    fprintf(f, "mean square of the first mode %.4g pm^2; stiffness %.4g kT over it: %.4g N/m (lever %.4g)\n",
            t->square_m2 * 1e24, t->factor, t->stiffness, b->si[LEVER_K]);
}

int cmd_thermal(int argc, char **argv)
{
    static struct afm_bench b;
    struct thermal t;
    int status;
    memset(&b, 0, sizeof b);
    memset(&t, 0, sizeof t);
    if (!options_parse(&b.o, &thermal_usage, argc, argv, &status))
        return status;
    status = afm_bench_read(&b);
    if (!status && b.si[LEVER_TEMPERATURE] == 0.0)
        status = options_misuse(&thermal_usage,
                                "this lever is at 0 K, where nothing moves: --set temperature=\"295 K\"");
    thermal_prepare(&b);
    status = status ? status : afm_bench_start(&b);
    status = status ? status : thermal_listen(&b, options_number(&b.o, "seconds"), &t);
    status = status ? status : write_rows(&b, &t);
    if (!status && options_given(&b.o, "svg"))
        status = draw_spectrum(&b, &t);
    if (!status)
        report_fit(&b, &t);
    spectrum_free(&t.spectrum);
    afm_bench_free(&b);
    return status;
}
