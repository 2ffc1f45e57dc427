/* test_station.c - the AFM station: surfaces, raster,
 * ramps, refusals, crashes, stages of the caller, replay. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/afm/codes.h"
#include "firmware/afm/station.h"
#include "models/math/elementary.h"

static struct station station;
static double lever_si[LEVER_PARAMETERS], number[STATION_NUMBERS];
static struct station_config config;

/* The lever `tapping` over a flat sample, cold. */
static void begin(void)
{
    for (int i = 0; i < LEVER_PARAMETERS; i++)
        lever_si[i] = afm_lever.parameter[i].initial;
    station_defaults(number);
    config = (struct station_config){
        .si = lever_si, .tick_s = 1.0 / (64.0 * lever_si[LEVER_F0]), .number = number};
}

static void start_station(void)
{
    check_no_error("station", station_init(&station, &config));
}

static bool run(double seconds, const struct microscope_in *in)
{
    long n = lround(seconds / station.sample_s);
    bool good = true;
    for (long i = 0; i < n && good; i++)
        good = station_run(&station, in);
    return good;
}

/* ---- surfaces ---- */

TEST(afm_surface_shapes)
{
    struct surface s = {.kind = SURFACE_STEP, .height = 2.0, .pitch = 4.0, .edge = 1.0, .duty = 0.25};
    check_near("step, before", surface_height(&s, 3.4, 0.0), 0.0, 0.0);
    check_near("step, in its flank", surface_height(&s, 4.25, 0.0), 1.5, 1e-15);
    check_near("step, behind", surface_height(&s, 4.6, 0.0), 2.0, 0.0);
    s.kind = SURFACE_GRATING;
    check_near("grating, up", surface_height(&s, 0.0, 0.0), 1.0, 0.0);
    check_near("grating, high", surface_height(&s, -3.5, 0.0), 2.0, 0.0);
    check_near("grating, down", surface_height(&s, 5.25, 0.0), 0.5, 1e-15);
    check_near("grating, low", surface_height(&s, 6.0, 0.0), 0.0, 0.0);
    check_near("grating, next one rises", surface_height(&s, 7.75, 0.0), 0.5, 1e-15);
    s.edge = 0.0;
    check_near("no flank, before", surface_height(&s, -1e-9, 0.0), 0.0, 0.0);
    check_near("no flank, at", surface_height(&s, 0.0, 0.0), 2.0, 0.0);
    s.kind = SURFACE_SINE;
    check_near("sine, top", surface_height(&s, 1.0, 0.0), 1.0, 1e-15);
    check_near("sine, half a pitch on", surface_height(&s, 3.0, 0.0), -1.0, 1e-15);
    s.kind = SURFACE_FLAT;
    check_near("flat", surface_height(&s, 3.0, 5.0), 0.0, 0.0);
}

TEST(afm_surface_rough)
{
    struct surface s = {.kind = SURFACE_ROUGH, .height = 3.0, .pitch = 1.0};
    double power = 0.0, square = 0.0, mean = 0.0;
    surface_set_waves(&s, 7);
    for (int i = 0; i < SURFACE_WAVES; i++) {
        const struct surface_wave *w = &s.wave[i];
        power += 0.5 * w->amplitude * w->amplitude;
        double waves = sqrt(w->along_x * w->along_x + w->along_y * w->along_y);
        if (i == 0 || i == SURFACE_WAVES - 1)
            check_near("waves a metre", waves, i ? 64.0 : 1.0, 1e-9);
        if (i == SURFACE_WAVES - 1)
            check_near("amplitude ~ wavelength^1.3", log(s.wave[0].amplitude / w->amplitude) / log(64.0), 1.3,
                       1e-12);
    }
    check_near("rms from the amplitudes", sqrt(power), 3.0, 1e-12);
    enum { N = 200 };
    for (int i = 0; i < N; i++)
        for (int k = 0; k < N; k++) {
            double h = surface_height(&s, 0.37 * i, 0.41 * k);
            mean += h / (N * N);
            square += h * h / (N * N);
        }
    check_near("rms by sampling", sqrt(square), 3.0, 0.05);
    check_near("mean", mean, 0.0, 0.05);
    double before = surface_height(&s, 0.3, 0.4);
    surface_set_waves(&s, 7);
    check_near("the same seed", surface_height(&s, 0.3, 0.4), before, 0.0);
    surface_set_waves(&s, 8);
    check_is("another seed", fabs(surface_height(&s, 0.3, 0.4) - before), >, 1e-6);
}

TEST(afm_surface_grid_and_map)
{
    static const int16_t count[] = {0, 10, 20, 100, 110, 120};
    struct surface s = {.kind = SURFACE_GRID, .grid = {count, 3, 2, 2.0, 5.0, 0.5}};
    check_near("corner", surface_height(&s, 0.0, 0.0), 0.0, 0.0);
    check_near("between four", surface_height(&s, 0.5, 2.5), 27.5, 1e-12);
    check_near("other corner", surface_height(&s, 2.0, 5.0), 60.0, 1e-12);
    check_near("beyond", surface_height(&s, 3.0, -1.0), 10.0, 1e-12);
    s = (struct surface){.map = MAP_DISC, .map_size = 2.0, .map_x = 5.0, .map_y = 5.0};
    check_int("in the disc", surface_material(&s, 5.5, 5.5), 1);
    check_int("outside", surface_material(&s, 6.1, 5.0), 0);
    s.map = MAP_CHECKER;
    check_int("a square", surface_material(&s, 5.5, 5.5), 0);
    check_int("its neighbour", surface_material(&s, 4.5, 5.5), 1);
    check_int("across", surface_material(&s, 4.5, 4.5), 0);
    s.map = MAP_NONE;
    check_int("no map", surface_material(&s, 4.5, 5.5), 0);
}

/* ---- raster and ramp ---- */

TEST(afm_raster)
{
    struct raster r = {.width_m = 8.0, .length_m = 2.0, .pixels = 4, .lines = 2, .samples = 5};
    struct raster_place at;
    int seen[2][2][4] = {{{0}}}, last = 0;
    check_int("samples", (long long)raster_samples(&r), 80);
    for (uint64_t n = 0; raster_at(&r, n, &at); n++) {
        seen[at.line][at.back][at.pixel]++;
        last += at.last;
    }
    check_int("pixels completed", last, 16);
    for (int i = 0; i < 16; i++)
        check_int("samples of a pixel", seen[i / 8][i / 4 % 2][i % 4], 5);
    check_true("first", raster_at(&r, 0, &at));
    check_near("x at the end of the first sample", at.x_m, 0.4, 1e-15);
    check_true("turn", raster_at(&r, 19, &at));
    check_near("x at the turn", at.x_m, 8.0, 0.0);
    check_true("back", raster_at(&r, 39, &at));
    check_near("x when back", at.x_m, 0.0, 0.0);
    check_near("y after a line", at.y_m, 1.0, 1e-15);
    check_true("the end", !raster_at(&r, 80, &at));
}

TEST(afm_ramp)
{
    begin();
    lever_si[LEVER_HEIGHT] = 10e-9;
    number[STATION_DRIVE] = number[STATION_Z_LOOP] = 0.0;
    number[STATION_SETPOINT] = 3e-9;
    number[STATION_Z_MIN] = -30e-9;
    start_station();
    station_begin_ramp(&station, 10e-6, 1e-4);
    double lowest = 0.0, highest = 0.0, t = 0.0;
    for (; station.ramp.phase != RAMP_OFF && t < 0.02; t += station.sample_s) {
        if (!station_run(&station, &(struct microscope_in){0}))
            break;
        lowest = fmin(lowest, station.in.z_m);
        highest = fmax(highest, station.out.deflection_m);
    }
    check_true("turned at its trigger", station.ramp.triggered);
    check_near("deflection at the turn, nm", highest * 1e9, 3.0, 2.5);
    check_near("back at, nm", station.in.z_m * 1e9, 0.0, 1e-6);
    check_near("time: down, dwell, up, s", t, -2.0 * lowest / 10e-6 + 1e-4, 1e-5);
    lever_si[LEVER_HEIGHT] = 100e-9;
    start_station();
    station_begin_ramp(&station, 10e-6, 0.0);
    check_true("runs", run(0.0062, &(struct microscope_in){0}));
    check_true("no surface within reach", !station.ramp.triggered);
    check_int("back", station.ramp.phase, RAMP_OFF);
    begin();
    start_station();
    station_begin_ramp(&station, 10e-6, 0.0);
    check_true("amplitude below the set point at once: turns at once", run(1e-5, &(struct microscope_in){0}));
    check_true("  by its trigger", station.ramp.triggered && station.ramp.phase == RAMP_OFF);
    struct ramp still = {.z_m = 3e-9, .high_m = 9e-9, .speed_m_per_s = 1e-6, .phase = RAMP_OFF};
    check_near("one that is off stays where it is, m", ramp_run(&still, true, 1e-3), 3e-9, 0.0);
}

TEST(afm_loop_limits)
{
    struct loop l = {.kp = 2.0, .ki = 10.0, .min = -1.0, .max = 1.0};
    check_near("proportional and integral", loop_run(&l, 0.1, 0.1), 0.3, 1e-15);
    check_near("again", loop_run(&l, 0.1, 0.1), 0.4, 1e-15);
    for (int i = 0; i < 100; i++)
        check_true("stays within", loop_run(&l, 5.0, 0.1) <= 1.0 && l.limited);
    check_near("the integral has waited", loop_run(&l, 0.0, 0.1), 0.2, 1e-15);
    check_true("and the loop is free at once", !l.limited);
    check_near("the other limit", loop_run(&l, -9.0, 0.1), -1.0, 0.0);
}

/* ---- refusals ---- */

static void refused_number(int which, double value, int named, const char *part)
{
    double kept = number[which];
    int index;
    number[which] = value;
    check_contains(station_number[which].name, station_check(&config, &index), part);
    check_int("  its number", index, named);
    check_error("  so does init", station_init(&station, &config));
    number[which] = kept;
}

TEST(afm_station_refusals)
{
    begin();
    refused_number(STATION_TICKS, 0.0, STATION_TICKS, "range");
    refused_number(STATION_KI, (double)NAN, STATION_KI, "range");
    refused_number(STATION_KI, 0.0, STATION_KI, "would not move");
    refused_number(STATION_LINES, 2.5, STATION_LINES, "whole");
    refused_number(STATION_DRIVE, 0.0, STATION_DRIVE, "silent tone");
    refused_number(STATION_SETPOINT, 20e-9, STATION_SETPOINT, "not below the free amplitude");
    refused_number(STATION_SETPOINT, -1e-9, STATION_SETPOINT, "not below the free amplitude");
    refused_number(STATION_TICKS, 32.0, STATION_FREQUENCY, "4 samples");
    refused_number(STATION_SURFACE, SURFACE_GRID, STATION_SURFACE, "2 x 2");
    static const int16_t count[4];
    static const struct surface_grid few[] = {
        {NULL, 2, 2, 1.0, 1.0, 1.0}, {count, 1, 2, 1.0, 1.0, 1.0}, {count, 2, 1, 1.0, 1.0, 1.0}};
    for (int i = 0; i < 3; i++) {
        config.grid = &few[i];
        refused_number(STATION_SURFACE, SURFACE_GRID, STATION_SURFACE, "2 x 2");
    }
    config.grid = NULL;
    refused_number(STATION_Z_MIN, -50e-9, STATION_Z_MIN, "beyond the piezo");
    number[STATION_Z_LOOP] = Z_OFF;
    number[STATION_AGC] = 1.0;
    refused_number(STATION_DRIVE, 0.0, STATION_DRIVE, "silent tone");
    number[STATION_AGC] = 0.0;
    number[STATION_Z_LOOP] = Z_AMPLITUDE;
    number[STATION_PLL] = 1.0;
    refused_number(STATION_DART, 1.0, STATION_DART, "both");
    number[STATION_PLL] = 0.0;
    number[STATION_SURFACE] = SURFACE_GRATING;
    refused_number(STATION_SURFACE_EDGE, 300e-9, STATION_SURFACE_EDGE, "wider");
    number[STATION_SURFACE_DUTY] = 0.1;
    refused_number(STATION_SURFACE_EDGE, 60e-9, STATION_SURFACE_EDGE, "wider");
    number[STATION_SURFACE_DUTY] = 0.9;
    refused_number(STATION_SURFACE_EDGE, 60e-9, STATION_SURFACE_EDGE, "wider");
    number[STATION_SURFACE_HEIGHT] = 5e-6;
    check_contains("on a high line", station_init(&station, &config), "inside the surface");
    number[STATION_SURFACE_HEIGHT] = 20e-9;
    number[STATION_MAP] = 1.0;
    number[STATION_MAP_HAMAKER_OUT] = 1e-21;
    check_contains("second material", station_init(&station, &config), "make energy");
    number[STATION_MAP] = 0.0;
    config.tick_s *= 32.0;
    number[STATION_TICKS] = 1.0;
    number[STATION_DRIVE] = number[STATION_Z_LOOP] = 0.0;
    check_contains("ticks", station_init(&station, &config), "too coarse");
}

/* ---- microscope ---- */

/* The static lever over a sample that repels: F = k deflection = (4/3) E sqrt(R) depth^1.5. */
TEST(afm_station_contact_loop)
{
    begin();
    lever_si[LEVER_Q] = 5.0;
    lever_si[LEVER_HAMAKER] = lever_si[LEVER_HAMAKER_OUT] = 0.0;
    lever_si[LEVER_HEIGHT] = 5e-9;
    number[STATION_DRIVE] = 0.0;
    number[STATION_Z_LOOP] = 2.0;
    number[STATION_SETPOINT] = 2e-9;
    number[STATION_KI] = 2000.0;
    start_station();
    check_true("runs", run(0.02, &(struct microscope_in){0}));
    double force = 2.0 * 2e-9, depth = pow(force / (4.0 / 3.0 * 1e9 * sqrt(10e-9)), 2.0 / 3.0);
    check_near("deflection, nm", station.out.deflection_m * 1e9, 2.0, 1e-3);
    check_near("peak force, nN", station.out.peak_N * 1e9, force * 1e9, 1e-2);
    check_near("z, nm", station.out.z_m * 1e9, (0.165e-9 - depth + -2e-9 - 5e-9) * 1e9, 5e-3);
    check_int("no crash below 100 nN", station.microscope.n_crashes, 0);
}

/* A surface that rises 40 nm under a lever at rest 5 nm
 * above it does not shake the lever: it only meets it. */
TEST(afm_station_surface_moves_no_mass)
{
    begin();
    lever_si[LEVER_HAMAKER] = lever_si[LEVER_HAMAKER_OUT] = 0.0;
    lever_si[LEVER_HEIGHT] = 60e-9;
    lever_si[LEVER_MODES] = 3.0;
    number[STATION_TICKS] = 1.0;
    number[STATION_DRIVE] = number[STATION_Z_LOOP] = 0.0;
    number[STATION_SURFACE] = SURFACE_STEP;
    number[STATION_SURFACE_HEIGHT] = 40e-9;
    config.tick_s = 1.0 / (256.0 * lever_si[LEVER_F0]);
    start_station();
    check_true("runs", run(1e-3, &(struct microscope_in){.x_m = 1e-6}));
    check_near("surface, nm", station.out.surface_m * 1e9, 40.0, 1e-9);
    check_near("deflection, nm", station.out.truth_m * 1e9, 0.0, 1e-9);
    struct microscope_in in = {.x_m = 1e-6, .z_m = 5e-9};
    check_true("a sudden base does", run(1e-5, &in));
    check_is("deflection, nm", fabs(station.out.truth_m) * 1e9, >, 0.5);
}

TEST(afm_station_crash)
{
    begin();
    lever_si[LEVER_HEIGHT] = 5e-9;
    lever_si[LEVER_HAMAKER] = lever_si[LEVER_HAMAKER_OUT] = 0.0;
    number[STATION_DRIVE] = number[STATION_Z_LOOP] = 0.0;
    number[STATION_CRASH] = 10e-9;
    start_station();
    struct microscope_in in = {.z_m = -20e-9, .x_m = 3e-9};
    double largest = 0.0;
    for (int i = 0; i < 4000; i++) {
        if (!station_run(&station, &in))
            break;
        largest = fmax(largest, station.out.peak_N);
    }
    check_int("one crash while it rings", station.microscope.n_crashes, 1);
    check_near("its peak, nN", station.microscope.crash.peak_N * 1e9, largest * 1e9, 0.0);
    check_is("  which is more than 10 nN", largest, >, 10e-9);
    check_near("its place, nm", station.microscope.crash.x_m * 1e9, 3.0, 1e-12);
    in.z_m = 0.0;
    check_true("away, until it rings no more", run(2e-2, &in));
    in.z_m = -20e-9;
    check_true("again", run(1e-4, &in));
    check_int("another crash", station.microscope.n_crashes, 2);
    number[STATION_CRASH] = 0.0;
    start_station();
    check_true("the same way", run(1e-4, &in));
    check_int("with a bound of 0 there is none", station.microscope.n_crashes, 0);
}

/* A pressed lever is a crash in each tick. With the bound on for single ticks, crashes are as far apart as
 * told. */
TEST(afm_station_crash_apart)
{
    struct microscope_in in = {.z_m = -20e-9};
    begin();
    lever_si[LEVER_HEIGHT] = 5e-9;
    number[STATION_DRIVE] = number[STATION_Z_LOOP] = 0.0;
    number[STATION_TICKS] = 1.0;
    start_station();
    check_true("pressed at rest", run(2e-2, &in));
    check_is("the contact's force, N", station.out.peak_N, >, 1e-9);
    for (int apart = MICROSCOPE_APART; apart <= MICROSCOPE_APART + 1; apart++) {
        uint32_t before = station.microscope.n_crashes;
        for (int i = 0; i <= apart; i++) {
            station.microscope.crash_N = i % apart == 0 ? 1e-10 : 0.0;
            check_no_error("runs", station_run(&station, &in) ? NULL : "no");
        }
        check_int("crashes", (int64_t)(station.microscope.n_crashes - before),
                  apart > MICROSCOPE_APART ? 2 : 1);
        station.microscope.crash_N = 0.0;
        check_true("long without one", run(1e-1, &in));
    }
}

/* While z ramps its loop's integral goes along, whatever kp had added before: the loop goes on from z. */
TEST(afm_ramp_integral)
{
    int off = 0, n = 0;
    begin();
    lever_si[LEVER_HEIGHT] = 20e-9;
    number[STATION_KP] = 0.5;
    start_station();
    check_true("the loop is in", run(5e-3, &(struct microscope_in){0}));
    double kp_part = station.z.sum - station.in.z_m;
    check_is("the integral is not z, m", fabs(kp_part), >, 0.0);
    station_begin_ramp(&station, 10e-6, 1e-4);
    station.ramp.low_m = station.in.z_m - 5e-9;
    for (; station.ramp.phase != RAMP_OFF && n < 1000000; n++) {
        check_no_error("runs", station_run(&station, &(struct microscope_in){0}) ? NULL : "no");
        off += station.z.sum != station.in.z_m;
    }
    check_int("samples of the ramp in which the integral was elsewhere", off, 0);
}

TEST(afm_codes_limits)
{
    uint32_t clipped = 0;
    check_int("not a number: least code", codes_of_volt((double)NAN, &clipped), -32768);
    check_int("clipped", clipped, 1);
    check_int("beyond the top", codes_of_volt(11.0, &clipped), 32767);
    check_int("beyond the bottom", codes_of_volt(-11.0, &clipped), -32768);
    check_int("clipped", clipped, 3);
    check_int("1 V", codes_of_volt(1.0, &clipped), 3277);
    check_int("clipped", clipped, 3);
}

TEST(afm_station_not_finite)
{
    begin();
    start_station();
    check_true("good", run(1e-5, &(struct microscope_in){0}));
    check_true("refused", !station_run(&station, &(struct microscope_in){.force_N = 1e300}) ||
                              !station_run(&station, &(struct microscope_in){.force_N = 1e300}));
    check_true("latched", station.microscope.failed && !station_run(&station, &(struct microscope_in){0}));
}

/* Stages of the caller: a delay of one tick in z, a gain of 2 and an offset in the sensor. */
static void late(void *who, double *value, uint32_t n)
{
    double *kept = who;
    for (uint32_t k = 0; k < n; k++) {
        double before = *kept;
        *kept = value[k];
        value[k] = before;
    }
}

static void doubled(void *who, double *value, uint32_t n)
{
    *(long *)who += n;
    for (uint32_t k = 0; k < n; k++)
        value[k] = 2.0 * value[k] + 1e-9;
}

TEST(afm_station_stages)
{
    double kept = 0.0;
    long calls = 0;
    begin();
    number[STATION_DRIVE] = number[STATION_Z_LOOP] = 0.0;
    config.piezo = (struct microscope_stage){late, &kept};
    config.sensor = (struct microscope_stage){doubled, &calls};
    start_station();
    struct microscope_in in = {.z_m = 4e-12};
    check_true("runs", station_run(&station, &in));
    check_near("z is a quarter of the way behind, pm", station.out.z_m * 1e12, 3.0, 1e-9);
    check_true("runs", station_run(&station, &in));
    check_near("z, pm", station.out.z_m * 1e12, 4.0, 1e-9);
    check_int("the sensor sees each tick", calls, 8);
    check_near("reading, nm", station.out.deflection_m * 1e9, 2.0 * station.out.truth_m * 1e9 + 1.0, 1e-12);
}

/* ---- scan ---- */

enum { PIXELS = 24, LINES = 3 };
struct seen {
    struct pixel pixel[2 * PIXELS * LINES];
    int n;
};

/* A sample of two materials of the same height, one of them dissipative, with heat. */
static void scan(struct seen *image, uint64_t split)
{
    begin();
    lever_si[LEVER_TEMPERATURE] = 295.0;
    lever_si[LEVER_HEIGHT] = 30e-9;
    lever_si[LEVER_Q] = 50.0;
    number[STATION_DRIVE] = 30e-9;
    number[STATION_SETPOINT] = 20e-9;
    number[STATION_KI] = 1500.0;
    number[STATION_MAP] = MAP_DISC;
    number[STATION_MAP_SIZE] = 500e-9;
    number[STATION_MAP_VISCOSITY] = 400.0;
    number[STATION_SURFACE] = SURFACE_GRATING;
    number[STATION_SURFACE_HEIGHT] = 4e-9;
    number[STATION_SURFACE_EDGE] = 50e-9;
    number[STATION_PIXELS] = PIXELS;
    number[STATION_LINES] = LINES;
    config.tick_s = 1.0 / (32.0 * lever_si[LEVER_F0]);
    start_station();
    static struct station copy;
    bool good = run(0.02, &(struct microscope_in){0});
    memset(image, 0, sizeof *image);
    station_begin_scan(&station);
    for (uint64_t i = 0; good && (i == 0 || station.scans); i++) {
        if (i == split) { /* a snapshot is a copy */
            copy = station;
            memset(&station, 0, sizeof station);
            station = copy;
        }
        good = station_run(&station, &(struct microscope_in){0});
        if (good && station.pixel_ready)
            image->pixel[image->n++] = station.pixel;
    }
    check_true("finite", good);
}

/* FNV-1a over the numbers of all pixels. */
static uint64_t hash_of(const struct seen *image)
{
    uint64_t hash = UINT64_C(14695981039346656037);
    for (int i = 0; i < image->n; i++) {
        const struct pixel *p = &image->pixel[i];
        const double value[] = {p->height_m,  p->error_m, p->amplitude_m,
                                p->phase_rad, p->peak_N,  p->surface_m};
        const unsigned char *byte = (const unsigned char *)value;
        for (size_t k = 0; k < sizeof value; k++)
            hash = (hash ^ byte[k]) * UINT64_C(1099511628211);
    }
    return hash;
}

TEST(afm_station_scan)
{
    static struct seen image, again;
    scan(&image, 0);
    check_int("pixels", image.n, 2 * PIXELS * LINES);
    double worst = 0.0, wrong = 0.0, high = 0.0, low = 0.0, inside = 0.0, outside = 0.0;
    int n_high = 0, n_low = 0, n_in = 0, n_out = 0;
    for (int i = 0; i < image.n; i++) {
        const struct pixel *p = &image.pixel[i];
        worst = fmax(worst, p->error_m);
        wrong += p->line == 1 &&
                 (int)p->column != (i % (2 * PIXELS) < PIXELS ? i % PIXELS : PIXELS - 1 - i % PIXELS);
        bool top = p->surface_m > 3.9e-9, bottom = p->surface_m < 0.1e-9;
        bool disc = p->line == 1 && p->column >= 8 && p->column < 16, plain = p->line != 1 || p->column < 4;
        high += top ? p->height_m : 0.0;
        n_high += top;
        low += bottom ? p->height_m : 0.0;
        n_low += bottom;
        inside += disc ? p->phase_rad : 0.0;
        n_in += disc;
        outside += plain ? p->phase_rad : 0.0;
        n_out += plain;
    }
    check_near("columns out of order", wrong, 0.0, 0.0);
    check_near("height of the lines, nm", (high / n_high - low / n_low) * 1e9, 4.0, 0.5);
    check_is("a dissipative disc lags more, rad", inside / n_in, <, outside / n_out - 0.03);
    scan(&again, 1000);
    check_bytes("the same seed gives the same bits, also from a copy", &again, &image, sizeof image);
    check_hex("the same bits by every compiler", hash_of(&image), UINT64_C(0xdb726dc89bc82cc1));
}

/* The drive holds the amplitude, and knows the free lever. */
TEST(afm_station_agc)
{
    begin();
    lever_si[LEVER_HEIGHT] = 300e-9;
    number[STATION_Z_LOOP] = 0.0;
    number[STATION_AGC] = 1.0;
    number[STATION_AGC_SETPOINT] = 11e-9;
    start_station();
    check_true("runs", run(0.06, &(struct microscope_in){0}));
    check_near("amplitude, nm", station.lockin[0].amplitude * 1e9, 11.0, 0.02);
    check_near("force over k A/Q", station.microscope.tone[0].force_N / (2.0 * 11e-9 / 400.0), 1.0, 2e-3);
    check_near("ring time of the lever, s", station_ring_time(lever_si), 1.818914e-3, 1e-9);
}

/* Surfaces that need more than numbers: a grid of the caller, and waves. */
TEST(afm_station_grid_and_waves)
{
    static const int16_t count[] = {0, 100, 0, 100};
    const struct surface_grid grid = {count, 2, 2, 1e-6, 1e-6, 1e-10};
    begin();
    config.grid = &grid;
    number[STATION_SURFACE] = SURFACE_GRID;
    start_station();
    check_true("runs", run(5e-5, &(struct microscope_in){.x_m = 0.5e-6}));
    check_near("half way up, nm", station.out.surface_m * 1e9, 5.0, 1e-9);
    config.grid = NULL;
    number[STATION_SURFACE] = SURFACE_ROUGH;
    number[STATION_SURFACE_HEIGHT] = 1e-9;
    start_station();
    check_near("height at the start", station.microscope.below,
               surface_height(&station.microscope.surface, 0.0, 0.0), 0.0);
    check_is("which is not 0", fabs(station.microscope.below), >, 1e-12);
}

TEST(afm_station_z_limit)
{
    begin();
    number[STATION_Z_MIN] = -100e-9;
    number[STATION_SURFACE] = SURFACE_STEP;
    number[STATION_SURFACE_HEIGHT] = -1e-7;
    start_station();
    check_true("runs", run(0.01, &(struct microscope_in){.x_m = 1e-6}));
    check_int("not yet", station.n_limited, 0);
    check_true("runs", run(0.08, &(struct microscope_in){.x_m = 1e-6}));
    check_is("samples at the limit", station.n_limited, >, 100);
    check_near("z stays within, nm", station.in.z_m * 1e9, -100.0, 0.2);
}

/* ---- numbers that change on the way ---- */

/* A microscope with every loop that may stand beside the others, over a step. */
static void begin_loops(void)
{
    begin();
    number[STATION_AGC] = number[STATION_PLL] = 1.0;
    number[STATION_Z_LOOP] = 0.0;
    start_station();
    check_true("runs", run(2e-3, &(struct microscope_in){0}));
}

TEST(afm_change_of_nothing)
{
    static struct station other;
    int which;
    begin_loops();
    other = station;
    check_no_error("equal numbers", station_change(&station, &config, &which));
    for (int i = 0; i < 1000; i++)
        check_true("runs", station_run(&station, &(struct microscope_in){0}) &&
                               station_run(&other, &(struct microscope_in){0}));
    check_true("no bit of the motion changes",
               !memcmp(other.microscope.x, station.microscope.x, sizeof other.microscope.x));
    check_true("nor of the loops", !memcmp(&other.pll, &station.pll, sizeof other.pll) &&
                                       !memcmp(&other.agc, &station.agc, sizeof other.agc));
}

TEST(afm_change_without_a_jump)
{
    int which;
    begin_loops();
    double f = station.frequency_Hz, drive = station.microscope.tone[0].force_N;
    number[STATION_PLL_KI] = 0.0;
    number[STATION_PLL_KP] = 0.0;
    number[STATION_AGC_KI] = 0.0;
    check_no_error("other gains", station_change(&station, &config, &which));
    double kept = station.pll.sum, force = station.agc.sum * station.free_force;
    check_true("runs", run(1e-4, &(struct microscope_in){0}));
    check_near("without gains the frequency is the loop's integral", station.frequency_Hz, kept, 0.0);
    check_near("  which was near the frequency, Hz", kept, f, 200.0);
    check_near("  and the force is the other one's", station.microscope.tone[0].force_N, force, 0.0);
    check_near("  as it was", force, drive, 0.01 * drive);
    number[STATION_PLL] = number[STATION_AGC] = 0.0;
    number[STATION_FREQUENCY] = 69e3;
    number[STATION_DRIVE] = 10e-9;
    check_no_error("loops off", station_change(&station, &config, &which));
    check_near("the tone is the numbers' own, Hz", station.frequency_Hz, 69e3, 0.0);
    check_near("  and its force, N", station.microscope.tone[0].force_N, 10e-9 * station.free_force, 0.0);
    struct microscope_in high = {.z_m = 7e-9};
    check_true("runs", run(1e-4, &high));
    number[STATION_Z_LOOP] = 1.0;
    number[STATION_SETPOINT] = 5e-9;
    check_no_error("z loop on", station_change(&station, &config, &which));
    check_near("it begins where z is, m", station.z.sum, 7e-9, 0.0);
    number[STATION_Z_MAX] = 4e-9;
    check_no_error("a lower z_max", station_change(&station, &config, &which));
    check_near("z comes down to it, m", station.z.sum, 4e-9, 0.0);
    station.z.sum = -500e-9;
    number[STATION_Z_MIN] = -200e-9;
    check_no_error("a higher z_min", station_change(&station, &config, &which));
    check_near("z comes up to it, m", station.z.sum, -200e-9, 0.0);
    number[STATION_FREQUENCY] = 0.0;
    number[STATION_Z_LOOP] = number[STATION_DRIVE] = 0.0;
    check_no_error("no tone", station_change(&station, &config, &which));
    check_near("its frequency is the lever's own, Hz", station.frequency_Hz, lever_si[LEVER_F0], 0.0);
    check_near("its force, N", station.microscope.tone[0].force_N, 0.0, 0.0);
}

/* The bound of a crash may change, too: the tip rests in the sample with some nN. */
TEST(afm_crash_bound_changes)
{
    static const double bound_N[] = {0.0, 1e-6, 1e-10};
    struct microscope_in in = {.z_m = -110e-9};
    int which;
    begin();
    number[STATION_DRIVE] = number[STATION_Z_LOOP] = number[STATION_CRASH] = 0.0;
    start_station();
    check_true("down", run(1e-3, &in));
    for (int i = 0; i < 3; i++) {
        number[STATION_CRASH] = bound_N[i];
        check_no_error("another bound", station_change(&station, &config, &which));
        check_true("on", run(1e-4, &in));
        check_int("crashes", station.microscope.n_crashes, i == 2);
    }
}

/* A pixel shorter than a sample has one, one that is longer has pixel_s over the sample's time, rounded, and
 * at most 4e9. */
TEST(afm_pixel_samples)
{
    static const double pixel_s[] = {1e-7, 1.24e-6, 100.0};
    begin();
    config.tick_s = 1e-7 / 4.0;
    lever_si[LEVER_F0] = 350e3;
    start_station();
    for (int i = 0; i < 3; i++) {
        station.number[STATION_PIXEL] = pixel_s[i];
        station.sample_s = i == 0 ? 3e-7 : i == 1 ? 1e-7 : 1e-8;
        station_begin_scan(&station);
        check_int("samples", station.raster.samples, i == 0 ? 1 : i == 1 ? 12 : 4000000000LL);
    }
}

TEST(afm_change_refused)
{
    static const int fixed[] = {STATION_TICKS, STATION_BANDWIDTH, STATION_MAP, STATION_MAP_VISCOSITY};
    static struct station before;
    int which;
    for (unsigned i = 0; i < sizeof fixed / sizeof fixed[0]; i++) {
        begin_loops();
        before = station;
        number[fixed[i]] += 1.0;
        check_error("a number that stands", station_change(&station, &config, &which));
        check_int("  by its index", which, fixed[i]);
        check_true("  no bit of the station changes", !memcmp(&before, &station, sizeof before));
    }
    begin_loops();
    number[STATION_PLL_PHASE] = 7.0;
    check_error("out of range", station_change(&station, &config, &which));
    check_int("  by its index", which, STATION_PLL_PHASE);
}
