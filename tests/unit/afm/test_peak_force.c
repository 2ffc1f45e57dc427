/* test_peak_force.c - cycles of peak force tapping beside the closed forms of Derjaguin, Muller & Toporov,
 * and the loop that holds the peak. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/afm/station.h"

static struct station station;
static double lever_si[LEVER_PARAMETERS], number[STATION_NUMBERS];
static struct station_config config;

/* A lever whose ringing dies within a cycle, over 1 GPa, cold; 5 nN at 2 kHz. */
static void begin(void)
{
    for (int i = 0; i < LEVER_PARAMETERS; i++)
        lever_si[i] = afm_lever.parameter[i].initial;
    lever_si[LEVER_Q] = 20.0;
    station_defaults(number);
    number[STATION_TICKS] = 2.0;
    number[STATION_KI] = 800.0;
    number[STATION_PEAK_FORCE] = 5e-9;
    config = (struct station_config){
        .si = lever_si, .tick_s = 1.0 / (64.0 * lever_si[LEVER_F0]), .number = number};
}

static void start_station(void)
{
    check_no_error("station", station_init(&station, &config));
}

/* Until a cycle has ended; false: the motion left the finite numbers. */
static bool run_cycle(const struct microscope_in *in)
{
    do
        if (!station_run(&station, in))
            return false;
    while (!station.cycle_ready);
    return true;
}

static void run_cycles(int n)
{
    static const struct microscope_in in = {.z_m = 0.0};
    for (int i = 0; i < n; i++)
        if (!run_cycle(&in))
            check_true("the motion is finite", false);
}

/* ---- closed forms, no heat ---- */

static double adhesion_N(void)
{
    return lever_si[LEVER_HAMAKER_OUT] * lever_si[LEVER_RADIUS] /
           (6.0 * lever_si[LEVER_A0] * lever_si[LEVER_A0]);
}

/* The indentation at a force of the tip. */
static double indentation_m(double force_N)
{
    return pow((force_N + adhesion_N()) /
                   (4.0 / 3.0 * lever_si[LEVER_MODULUS] * sqrt(lever_si[LEVER_RADIUS])),
               2.0 / 3.0);
}

/* A settled cycle on a sample so stiff. */
static void check_sample(double modulus_Pa, double ticks, double frequency_Hz)
{
    const struct force_cycle *c = &station.swing.cycle;
    begin();
    lever_si[LEVER_MODULUS] = modulus_Pa;
    number[STATION_TICKS] = ticks;
    number[STATION_FREQUENCY] = frequency_Hz;
    number[STATION_PIXEL] = 1.0 / frequency_Hz;
    number[STATION_KI] = 0.4 * frequency_Hz;
    start_station();
    run_cycles(300);
    check_true("a modulus is found", c->fitted);
    check_near("modulus, share of the law's", c->modulus_Pa / modulus_Pa, 1.0, 0.005);
    check_near("adhesion, share of H R/(6 a0^2)", c->adhesion_N / adhesion_N(), 1.0, 0.01);
    check_near("peak, nN; a stiff sample throws the tip", c->peak_N * 1e9, 5.0,
               modulus_Pa < 5e9 ? 0.005 : 0.1);
    check_near("deformation, nm", c->deformation_m * 1e9, (indentation_m(5e-9) - indentation_m(0.0)) * 1e9,
               0.01);
    check_near("baseline, pN", c->baseline_N * 1e12, 0.0, 2.0);
    check_is("work of an elastic sample, share of adhesion times deformation", fabs(c->work_J), <,
             0.03 * adhesion_N() * c->deformation_m);
}

TEST(afm_peak_force_closed_forms)
{
    check_sample(1e8, 2.0, 2e3);
    check_sample(1e9, 2.0, 2e3);
    check_sample(1e10, 1.0, 2e3);
    check_sample(1e9, 2.0, 500.0);
}

/* The indentation now, by the state of the lever. */
static double true_indentation(void)
{
    const struct microscope *m = &station.microscope;
    const struct input u[MODEL_INPUTS] = {[LEVER_Z] = m->base};
    double out[MODEL_OUTPUTS];
    afm_lever.output(m->p[m->material], u, m->x, out);
    return out[2] * m->length_m;
}

/* A viscous sample takes the integral of eta sqrt(R delta) delta'^2, here from the true state. */
TEST(afm_peak_force_work)
{
    static const struct microscope_in in = {.z_m = 0.0};
    begin();
    number[STATION_TICKS] = 1.0;
    lever_si[LEVER_VISCOSITY] = 100.0;
    start_station();
    run_cycles(300);
    double taken = 0.0, was = true_indentation(), dt = station.sample_s;
    do {
        if (!station_run(&station, &in))
            break;
        double now = true_indentation(), rate = (now - was) / dt;
        taken += 100.0 * sqrt(lever_si[LEVER_RADIUS] * 0.5 * (now + was)) * rate * rate * dt;
        was = now;
    } while (!station.cycle_ready);
    check_near("work, aJ", station.swing.cycle.work_J * 1e18, taken * 1e18, 0.03 * taken * 1e18);
    check_is("  which is no small one, aJ", taken * 1e18, >, 1.0);
}

/* ---- heat ---- */

/* Means over many cycles, each with its standard error. */
TEST(afm_peak_force_heat)
{
    enum { N = 400 };
    double sum[2] = {0.0}, square[2] = {0.0};
    begin();
    lever_si[LEVER_TEMPERATURE] = 295.0;
    lever_si[LEVER_SEED] = 5.0;
    start_station();
    run_cycles(300);
    int n = 0;
    for (int i = 0; i < N; i++) {
        run_cycles(1);
        const struct force_cycle *c = &station.swing.cycle;
        if (!c->fitted)
            continue;
        double value[2] = {c->modulus_Pa / 1e9, c->adhesion_N / adhesion_N()};
        n++;
        for (int k = 0; k < 2; k++) {
            sum[k] += value[k];
            square[k] += value[k] * value[k];
        }
    }
    check_is("cycles with a modulus", n, >, N * 0.98);
    for (int k = 0; k < 2; k++) {
        double mean = sum[k] / n, error = sqrt((square[k] / n - mean * mean) / n);
        check_near(k ? "adhesion, of 4 standard errors" : "modulus, of 4 standard errors",
                   (mean - 1.0) / (4.0 * error), 0.0, 1.0);
    }
}

/* ---- the loop ---- */

/* Without adhesion, and with a viscous sample, the tip does not ring in contact: then the law alone gives the
 * peak. */
static void begin_gentle(void)
{
    begin();
    lever_si[LEVER_HAMAKER] = lever_si[LEVER_HAMAKER_OUT] = 0.0;
    lever_si[LEVER_VISCOSITY] = 100.0;
}

/* The share of a small step of height that the deflection at the peak follows: k_ts/(k + k_ts). */
static double slope_at_peak(void)
{
    double tip = 2.0 * lever_si[LEVER_MODULUS] * sqrt(lever_si[LEVER_RADIUS] * indentation_m(5e-9));
    return tip / (lever_si[LEVER_K] + tip);
}

/* The largest error from one cycle to another over the one in the first, after a step of 0.1 nm. */
static double measured_ratio(double ki, int from, int to)
{
    begin_gentle();
    number[STATION_KI] = ki;
    number[STATION_SURFACE] = SURFACE_STEP;
    number[STATION_SURFACE_HEIGHT] = 0.1e-9;
    start_station();
    run_cycles(300);
    struct microscope_in in = {.x_m = 1e-6};
    double first = 0.0, largest = 0.0;
    for (int i = 0; i <= to && run_cycle(&in); i++) {
        first = i == 0 ? station.error_m : first;
        largest = i >= from && fabs(station.error_m) > fabs(largest) ? station.error_m : largest;
    }
    return largest / first;
}

/* z is set once a cycle, of the last peak: an error is 1 - ki T slope of the one before. So the loop is
 * stable up to ki = 2/(T slope). */
TEST(afm_peak_force_loop_by_theory)
{
    static const double ki[] = {400.0, 800.0, 1600.0, 3000.0};
    begin_gentle();
    for (int i = 0; i < 4; i++)
        check_near("ratio of errors", measured_ratio(ki[i], 1, 1), 1.0 - ki[i] * 0.5e-3 * slope_at_peak(),
                   0.03);
    double limit = 2.0 / (0.5e-3 * slope_at_peak());
    check_is("below the limit, the error dies", fabs(measured_ratio(0.95 * limit, 190, 200)), <, 0.01);
    check_is("above the limit, it stays", fabs(measured_ratio(1.1 * limit, 190, 200)), >, 0.5);
}

/* On a plateau of a grating the peak is the one that is asked for, to 1 %, 20 ms after its flank. */
TEST(afm_peak_force_holds_on_a_grating)
{
    double worst = 0.0, highest = -1.0, lowest = 1.0;
    begin();
    number[STATION_SURFACE] = SURFACE_GRATING;
    number[STATION_PIXEL] = 1e-3;
    number[STATION_LINES] = 1.0;
    start_station();
    run_cycles(300);
    station_begin_scan(&station);
    static const struct microscope_in in = {.z_m = 0.0};
    while (station.scanned < raster_samples(&station.raster)) {
        if (!station_run(&station, &in))
            break;
        const struct pixel *p = &station.pixel;
        if (!station.pixel_ready)
            continue;
        double at = fmod((double)p->column / 128.0 * 1e-6, 250e-9) / 250e-9; /* on its plateau */
        if (p->back || p->column < 16 || at < 0.6 || at > 0.9)
            continue;
        worst = fmax(worst, fabs(p->force.peak_N / 5e-9 - 1.0));
        highest = fmax(highest, p->height_m);
        lowest = fmin(lowest, p->height_m);
    }
    check_is("worst peak on the plateaus, share", worst, <, 0.01);
    check_near("height of the lines, nm", (highest - lowest) * 1e9, 20.0, 0.1);
}

/* The zero of a detector, m. */
static double drifted_m;

static void drift(void *who, double *value, uint32_t n)
{
    (void)who;
    for (uint32_t i = 0; i < n; i++)
        value[i] += drifted_m;
}

/* The far half of each cycle is the zero of its forces. So 10 nm of drift, or 20 nN, move nothing; the z loop
 * on the deflection goes with it. */
TEST(afm_peak_force_and_drift)
{
    begin();
    config.sensor = (struct microscope_stage){drift, NULL};
    drifted_m = 0.0;
    start_station();
    run_cycles(300);
    double height = station.swing.cycle.low_m;
    drifted_m = 10e-9;
    run_cycles(2);
    run_cycles(300);
    check_near("height after a drift, nm", station.swing.cycle.low_m * 1e9, height * 1e9, 0.001);
    check_near("baseline, nN: 10 nm by 2 N/m", station.swing.cycle.baseline_N * 1e9, 20.0, 0.01);
    check_near("peak, nN", station.swing.cycle.peak_N * 1e9, 5.0, 0.005);
}

TEST(afm_peak_force_user_z)
{
    begin();
    number[STATION_Z_LOOP] = 0.0;
    start_station();
    struct microscope_in in = {.z_m = -95e-9};
    for (int i = 0; i < 5; i++)
        check_true("runs", run_cycle(&in));
    check_near("lowest point, nm", station.swing.cycle.low_m * 1e9, -95.0, 0.1);
    check_near("no contact, nN", station.swing.cycle.peak_N * 1e9, 0.0, 0.01);
    check_true("and no modulus", !station.swing.cycle.fitted);
    check_true("no contact, and what belongs to one is 0",
               !station.swing.cycle.touched && station.swing.cycle.deformation_m == 0.0 &&
                   station.swing.cycle.adhesion_N == 0.0 && station.swing.cycle.work_J == 0.0);
}

/* ---- changes and refusals ---- */

TEST(afm_peak_force_changes)
{
    int which;
    begin();
    start_station();
    run_cycles(300);
    double z = station.in.z_m;
    number[STATION_PEAK_FORCE] = 8e-9;
    check_no_error("another peak", station_change(&station, &config, &which));
    check_near("z goes on, nm", station.in.z_m * 1e9, z * 1e9, 0.0);
    run_cycles(60);
    check_near("its peak, nN", station.swing.cycle.peak_N * 1e9, 8.0, 0.08);
    number[STATION_PEAK_FORCE] = 1e-9;
    check_no_error("less than a quarter of the first", station_change(&station, &config, &which));
    run_cycles(60);
    check_near("its peak, nN", station.swing.cycle.peak_N * 1e9, 1.0, 0.05);
    check_true("counts as a contact", station.swing.cycle.touched);
    number[STATION_PEAK_FORCE] = 0.0;
    check_no_error("off", station_change(&station, &config, &which));
    check_true("runs", station_run(&station, &(struct microscope_in){.z_m = 0.0}));
    check_true("a tone instead", station.microscope.tone[0].force_N > 0.0);
}

static void refused_number(int which, double value, int named, const char *part)
{
    int got;
    begin();
    number[which] = value;
    const char *why = station_check(&config, &got);
    check_true(part, why && strstr(why, part));
    check_int("  of the number", got, named);
}

TEST(afm_peak_force_refusals)
{
    refused_number(STATION_PLL, 1.0, STATION_PEAK_FORCE, "without a tone");
    refused_number(STATION_TICKS, 4.0, STATION_TICKS, "fewer than 32 samples");
    refused_number(STATION_FREQUENCY, 99.0, STATION_FREQUENCY, "100 Hz to an eighth of f0");
    refused_number(STATION_FREQUENCY, 8751.0, STATION_FREQUENCY, "100 Hz to an eighth of f0");
    refused_number(STATION_DRIVE, 2.5e-9, STATION_DRIVE, "would not leave the sample");
    refused_number(STATION_PIXEL, 0.4e-3, STATION_PIXEL, "shorter than a cycle");
    refused_number(STATION_KI, 0.0, STATION_KI, "would not move");
    int which;
    begin();
    number[STATION_PEAK_FORCE] = 1e-11;
    lever_si[LEVER_TEMPERATURE] = 295.0;
    const char *why = station_check(&config, &which);
    check_true("a peak below the heat", why && strstr(why, "noise of a cycle"));
}
