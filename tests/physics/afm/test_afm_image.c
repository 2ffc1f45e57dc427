/* test_afm_image.c - images of known surfaces beside closed forms: height of plateaus, lag on a slope, length
 * of a parachute. One more has a piezo with hysteresis. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include "firmware/afm/station.h"
#include "firmware/stage/stage.h"
#include "tests/fixture/afm/averaged.h"

enum { PIXELS = 256 };

static struct station station;
static struct stage piezo;
static double si[LEVER_PARAMETERS], number[STATION_NUMBERS];
static struct station_config config;
static struct pixel line[2][PIXELS]; /* trace and retrace of the last line */

/* Tapping, 14 of 20 nm, repulsive: lines of 1 um. */
static void begin(enum surface_kind kind, double height, double pixel_s)
{
    for (int i = 0; i < LEVER_PARAMETERS; i++)
        si[i] = afm_lever.parameter[i].initial;
    si[LEVER_HAMAKER] = si[LEVER_HAMAKER_OUT] = 0.0;
    si[LEVER_HEIGHT] = 40e-9;
    station_defaults(number);
    number[STATION_SURFACE] = kind;
    number[STATION_SURFACE_HEIGHT] = height;
    number[STATION_SURFACE_EDGE] = 0.0;
    number[STATION_PIXELS] = PIXELS;
    number[STATION_LINES] = 1.0;
    number[STATION_PIXEL] = pixel_s;
    config = (struct station_config){.si = si, .tick_s = 1.0 / (64.0 * si[LEVER_F0]), .number = number};
}

/* 10 nm over 1 um. */
static void begin_slope(void)
{
    static const int16_t count[4] = {0, 32767, 0, 32767};
    static const struct surface_grid plane = {count, 2, 2, 1e-6, 1e-6, 10e-9 / 32767.0};
    begin(SURFACE_GRID, 0.0, 1e-3);
    config.grid = &plane;
}

static void run(void)
{
    static const struct microscope_in still;
    if (!station_run(&station, &still))
        check_true("finite", false);
    if (station.pixel_ready)
        line[station.pixel.back][station.pixel.column] = station.pixel;
}

static void engage(void)
{
    check_no_error("station", station_init(&station, &config));
    for (long n = lround(0.1 / station.sample_s); n > 0; n--)
        run();
    station_begin_scan(&station);
}

static void scan(void)
{
    engage();
    while (station.scanned < raster_samples(&station.raster))
        run();
}

/* ---- plateaus ---- */

static double mean_height(bool back, int from, int to)
{
    double sum = 0.0;
    for (int i = from; i < to; i++)
        sum += line[back][i].height_m / (to - from);
    return sum;
}

/* A plateau is as long as 50 times 1/(2 pi bandwidth), less the parachute: nothing is left of its step. */
TEST(afm_image_plateaus)
{
    begin(SURFACE_GRATING, 20e-9, 1e-3);
    scan();
    for (int back = 0; back < 2; back++) {
        double low = back ? mean_height(true, 64, 72) : mean_height(false, 120, 128);
        double high = back ? mean_height(true, 128, 136) : mean_height(false, 184, 192);
        check_near(check_name("%s: height of a line of 20 nm, nm", back ? "retrace" : "trace"),
                   (high - low) * 1e9, 20.0, 2e-3);
    }
    begin(SURFACE_FLAT, 0.0, 0.5e-3);
    scan();
    check_near(
        "a flat surface: bow, pm",
        (mean_height(false, 0, 8) + mean_height(false, 248, 256) - 2.0 * mean_height(false, 124, 132)) * 1e12,
        0.0, 1.0);
}

/* ---- a slope ---- */

/* An integrator follows a slope by the error rate/ki; z then lags by that over the slope of amplitude over z.
 * The retrace lags the other way. */
TEST(afm_image_slope)
{
    begin_slope();
    scan();
    double rate = 10e-9 / (PIXELS * number[STATION_PIXEL]), error = rate / number[STATION_KI];
    struct averaged rest = averaged_rest(si, number[STATION_DRIVE], number[STATION_SETPOINT], false);
    double lag = error / creal(averaged_response(&rest, 0.0));
    for (int back = 0; back < 2; back++) {
        const struct pixel *p = &line[back][back ? 40 : PIXELS - 40], *q = &line[back][PIXELS / 2];
        double sign = back ? 1.0 : -1.0;
        check_near(check_name("%s on a slope: error, pm", back ? "retrace" : "trace"), p->error_m * 1e12,
                   sign * error * 1e12, 0.1);
        check_near("  bow, pm", (p->height_m - p->surface_m - q->height_m + q->surface_m) * 1e12, 0.0, 0.1);
    }
    check_near("retrace over trace, twice the lag, pm",
               (line[1][PIXELS / 2].height_m - line[0][PIXELS / 2].height_m) * 1e12, 2e12 * lag,
               0.01 * 2e12 * lag);
}

/* ---- the parachute ----
 *
 * Off the sample the envelope goes from As e^(-i lag) to A0 e^(-i pi/2), as e^(-t/tau), sin(lag) = As/A0. An
 * error of A0 - As is the largest, so z goes down by ki (A0 - As), until the way of z and the larger
 * amplitude reach the ground. */

/* How long that takes. */
static double falling_s(double step)
{
    double A0 = number[STATION_DRIVE], As = number[STATION_SETPOINT], tau = station_ring_time(si);
    double dt = 1e-6, t = 0.0, z = 0.0, over = 0.0;
    for (; z + over < step; t += dt) {
        double left = exp(-t / tau), along = A0 - (A0 - As * As / A0) * left;
        over = hypot(along, As * sqrt(1.0 - As * As / (A0 * A0)) * left) - As;
        z += number[STATION_KI] * over * dt;
    }
    return t;
}

/* The simple form is tau + (step - A0 + As)/(ki (A0 - As)). */
static void check_parachute(double step, double ki, double pixel_s)
{
    begin(SURFACE_STEP, -step, pixel_s);
    number[STATION_KI] = ki;
    scan();
    double over = number[STATION_DRIVE] - number[STATION_SETPOINT], pixel = 1e-6 / PIXELS,
           speed = pixel / pixel_s;
    double length = speed * falling_s(step), ring = station_ring_time(si);
    int n = 1, off = 0;
    while (n < PIXELS / 2 && line[0][PIXELS / 2 + n].peak_N == 0.0)
        n++;
    check_near(check_name("parachute of %g nm, ki %g, %.3g um/s: length, nm", step * 1e9, ki, speed * 1e6),
               n * pixel * 1e9, length * 1e9, 1.5 * pixel * 1e9);
    check_near("  the simple form, share", speed * (ring + (step - over) / (ki * over)) / length, 1.0, 0.06);
    int at = PIXELS / 2 + (int)(6.0 * ring / pixel_s), to = PIXELS / 2 + n - 2;
    double slope = (line[0][at].height_m - line[0][to].height_m) / ((to - at) * pixel);
    check_near("  its slope, ki (A0 - As)/speed", slope, ki * over / speed, 0.005 * ki * over / speed);
    double deep = mean_height(false, 0, 8) - mean_height(false, PIXELS - 8, PIXELS);
    check_near("  depth of the step, nm", deep * 1e9, step * 1e9, 2e-3);
    for (int i = 0; i < PIXELS; i++)
        off += line[1][i].peak_N == 0.0;
    printf("      retrace, up the step: off the surface in %d pixels\n", off);
}

TEST(afm_image_parachute)
{
    check_parachute(50e-9, 275.0, 0.5e-3);
    check_parachute(50e-9, 275.0, 1e-3);
    check_parachute(30e-9, 275.0, 0.5e-3);
    check_parachute(50e-9, 500.0, 0.5e-3);
}

/* ---- hysteresis of the piezo ---- */

static void run_piezo(void *who, double *value, uint32_t n)
{
    stage_run_many(who, value, n);
}

/* From a turn on, play operator i of 7 moves behind 2 i/16 of the range: the true way of z over the
 * command's. */
static double play(double command, double range, double share)
{
    double z = (1.0 - share) * command;
    for (int i = 1; i <= 7; i++)
        z += share / 7.0 * fmax(0.0, command - 2.0 * i * range / 16.0);
    return z;
}

/* The height is that of the z sensor: there hysteresis bows the lag alone. The command has it all. */
TEST(afm_image_hysteresis)
{
    const struct stage_part part = {STAGE_HYSTERESIS, 20e-9, 0.15};
    begin_slope();
    number[STATION_LINES] = 2.0;
    check_no_error("piezo", stage_init(&piezo, config.tick_s, 0, &part, 1));
    config.piezo = (struct microscope_stage){run_piezo, &piezo};
    engage();
    double turn[2] = {0.0}, worst = 0.0, way = 0.0;
    bool up = false;
    while (station.scanned < raster_samples(&station.raster)) {
        run();
        bool second = station.pixel.line == 0 && station.pixel.back;
        if (!second && station.pixel.line == 0)
            continue;
        if (!up && (turn[0] == 0.0 || station.in.z_m < turn[0])) {
            turn[0] = station.in.z_m;
            turn[1] = station.out.z_m;
        }
        up = station.pixel.line == 1;
        if (!up || station.pixel.back)
            continue;
        way = fmax(way, station.in.z_m - turn[0]);
        worst = fmax(worst, fabs(station.out.z_m - turn[1] - play(station.in.z_m - turn[0], 20e-9, 0.15)));
    }
    check_near("z beside the play operators, largest distance, pm", worst * 1e12, 0.0, 2.0);
    check_is("  which are no straight line: its share at half of the way",
             play(0.5 * way, 20e-9, 0.15) / play(way, 20e-9, 0.15), <, 0.49);
}
