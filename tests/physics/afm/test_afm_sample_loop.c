/* test_afm_sample_loop.c - a z loop over a real sample: its ultimate gain beside the averaged equations of
 * amplitude and phase. */
#include "tests/unit/test.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/afm/afm_plant.h"
#include "firmware/afm/station.h"
#include "tests/fixture/afm/averaged.h"
#include "tests/fixture/afm/plant_bus.h"
#include "tests/fixture/bus.h"
#include "tests/fixture/imaginary.h"

#define PI 3.14159265358979323846

enum { PERIOD = 16 /* samples */ };

static struct station station;
static double si[LEVER_PARAMETERS], number[STATION_NUMBERS];

/* The least gain of an integrator for which the loop stands
 * at the edge of stability. Two poles of the lock-in. */
static double ultimate_gain(const struct averaged *l, double delay, double *hz)
{
    double rate = 2.0 * PI * number[STATION_BANDWIDTH], least = (double)INFINITY, before = 0.0;
    *hz = (double)NAN;
    for (double w = 10.0; w < 2e4; w += 0.5) {
        double complex s = i_unit * w, pole = 1.0 + s / rate;
        double complex loop = averaged_response(l, s) / (pole * pole) / s * cexp(-s * delay);
        bool edge = before * cimag(loop) < 0.0 && creal(loop) < 0.0;
        before = cimag(loop);
        if (edge && 1.0 / cabs(loop) < least) {
            least = 1.0 / cabs(loop);
            *hz = w / (2.0 * PI);
        }
    }
    return least;
}

/* ---- the microscope ---- */

/* An integrator of the user's own behind a delay, from here on for n samples. Returns the largest error of
 * the last quarter over that of the second one: of means over a period, in which the lock-in's ripple is
 * none. */
static double integrate(double gain, long delay, long n, double kick)
{
    static double past[65536];
    double sum = station.in.z_m + kick, early = 0.0, late = 0.0, period = 0.0;
    for (long i = 0; i < delay; i++)
        past[i] = station.in.z_m;
    for (long i = 0; i < n; i++) {
        double error = station.lockin[0].amplitude - number[STATION_SETPOINT];
        sum -= gain * error * station.sample_s;
        past[i % delay] = sum;
        struct microscope_in in = {.z_m = past[(i + 1) % delay]};
        if (!station_run(&station, &in))
            return (double)NAN;
        period += error / PERIOD;
        if (i % PERIOD)
            continue;
        if (i > n / 4 && i <= n / 2)
            early = fmax(early, fabs(period));
        if (i > n / 4 * 3)
            late = fmax(late, fabs(period));
        period = 0.0;
    }
    return late / early;
}

static void begin_sample(double hamaker, double setpoint)
{
    for (int i = 0; i < LEVER_PARAMETERS; i++)
        si[i] = afm_lever.parameter[i].initial;
    si[LEVER_HAMAKER] = si[LEVER_HAMAKER_OUT] = hamaker;
    si[LEVER_HEIGHT] = 14e-9;
    station_defaults(number);
    number[STATION_Z_LOOP] = 0.0;
    number[STATION_SETPOINT] = setpoint;
    number[STATION_BANDWIDTH] = 20e3;
    struct station_config c = {.si = si, .tick_s = 1.0 / (64.0 * si[LEVER_F0]), .number = number};
    check_no_error("station", station_init(&station, &c));
}

static void one_delay(const struct station *engaged, const struct averaged *l, double delay_s)
{
    double hz, closed = ultimate_gain(l, delay_s, &hz), low = 0.6 * closed, high = 1.6 * closed;
    for (int i = 0; i < 8; i++) {
        double gain = sqrt(low * high);
        station = *engaged;
        double grown = integrate(gain, lround(delay_s / station.sample_s),
                                 lround(16.0 / hz / station.sample_s), 0.005e-9);
        *(grown > 1.0 ? &high : &low) = gain;
    }
    check_near(check_name("delay %g ms: ultimate gain, 1/s, at %.0f Hz by the averaged equations",
                          delay_s * 1e3, hz),
               sqrt(low * high), closed, 0.05 * closed);
}

static void over_sample(double hamaker, double setpoint, bool attractive)
{
    begin_sample(hamaker, setpoint);
    check_true("engaged", integrate(275.0, 1, lround(0.08 / station.sample_s), 0.0) < 1.5);
    struct station engaged = station;
    struct averaged l = averaged_rest(si, number[STATION_DRIVE], setpoint, attractive);
    printf("      pair at %.0f Hz, slope %.3f\n", l.pair / 2.0 / PI, -l.f_z / l.f_a);
    check_near("height of the averaged rest, nm", (si[LEVER_HEIGHT] + station.in.z_m) * 1e9, l.z * 1e9, 5e-3);
    check_near("  its lag, rad", -demodulator_phase(&station.lockin[0]), l.lag, 0.02);
    one_delay(&engaged, &l, 1e-4);
    one_delay(&engaged, &l, 5e-4);
    one_delay(&engaged, &l, 1e-3);
}

TEST(afm_z_loop_over_a_sample)
{
    over_sample(0.0, 14e-9, false);
}

TEST(afm_z_loop_over_an_attractive_sample)
{
    over_sample(6.4e-20, 14e-9, true);
}

/* ---- the same over the bus ----
 *
 * The controller hears the mean amplitude of a frame and moves z over the next one, in a straight line. Its
 * ultimate gain is that of the linear form of above, stepped through frames with the same controller. */

enum { FRAME = 1120 /* samples */, STEPS = 400, FRAMES = 160 };
static const double frame_s = 1e-3;

static void rates(const struct averaged *l, const double *x, double z, double *rate)
{
    double pole = 2.0 * PI * number[STATION_BANDWIDTH];
    rate[0] = x[1];
    rate[1] = -2.0 * x[1] / l->tau + (l->f_a - 1.0 / (l->tau * l->tau)) * x[0] + l->f_z * z;
    rate[2] = pole * (x[0] - x[2]);
    rate[3] = pole * (x[2] - x[3]);
}

static void step_linear(const struct averaged *l, double from, double to, double *x)
{
    double k[4][4], y[4], dt = frame_s / STEPS;
    const double part[4] = {0.0, 0.5, 0.5, 1.0};
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++)
            y[j] = x[j] + (i ? part[i] * dt * k[i - 1][j] : 0.0);
        rates(l, y, from + part[i] * (to - from), k[i]);
    }
    for (int j = 0; j < 4; j++)
        x[j] += dt / 6.0 * (k[0][j] + 2.0 * k[1][j] + 2.0 * k[2][j] + k[3][j]);
}

/* The largest error of the last quarter over that of the second one. */
static double growth_of(const double *error)
{
    double early = 0.0, late = 0.0;
    for (int i = FRAMES / 4; i < FRAMES / 2; i++)
        early = fmax(early, fabs(error[i]));
    for (int i = 3 * FRAMES / 4; i < FRAMES; i++)
        late = fmax(late, fabs(error[i]));
    return late / early;
}

static double linear_growth(const struct averaged *l, double gain)
{
    double x[4] = {0.0}, error[FRAMES], z = 1e-12, before = 0.0;
    for (int i = 0; i < FRAMES; i++) {
        double sum = 0.0, weight = 0.0;
        for (int k = 0; k < STEPS; k++) {
            double w = 1.0 - cos(2.0 * PI * (k + 0.5) / STEPS);
            double from = before + (z - before) * k / STEPS;
            step_linear(l, from, before + (z - before) * (k + 1) / STEPS, x);
            sum += w * x[3];
            weight += w;
        }
        error[i] = sum / weight;
        before = z;
        z -= gain * frame_s * error[i];
    }
    return growth_of(error);
}

static double edge_of(const struct averaged *l, double low, double high)
{
    for (int i = 0; i < 20; i++) {
        double gain = sqrt(low * high);
        *(linear_growth(l, gain) > 1.0 ? &high : &low) = gain;
    }
    return sqrt(low * high);
}

static struct bus bus, engaged_bus;
static double scratch[METHOD_SCRATCH], engaged_scratch[METHOD_SCRATCH];

static void start_bus(void)
{
    static double all[MODEL_PARAMETERS], setting[SETTINGS];
    plant_bus_defaults(all, setting, frame_s);
    memcpy(all, si, sizeof si);
    memcpy(all + AFM_PLANT_NUMBERS, number, sizeof number);
    const struct app_config c = plant_bus_config(all, setting, FRAME, scratch);
    bus_start_running(&bus, &c);
}

/* An integrator over the bus. Returns where it stands after n frames; error[n]. */
static double integrate_over_bus(double gain, double z, int n, double *error)
{
    for (int i = 0; i < n; i++) {
        bus_forget(&bus);
        bus_stream(&bus, AFM_PLANT_Z, bus.app.plant.now.tick / FRAME, z);
        bus_run(&bus, 1);
        for (int k = 0; k < bus.n_seen; k++)
            if (bus.seen[k].kind == WIRE_LOCKIN && bus.seen[k].value[LOCKIN_SLOT] == 0.0)
                error[i] = bus.seen[k].value[LOCKIN_AMPLITUDE] - number[STATION_SETPOINT];
        z -= gain * frame_s * error[i];
    }
    return z;
}

TEST(afm_z_loop_over_the_bus)
{
    double error[FRAMES];
    begin_sample(0.0, 14e-9);
    struct averaged l = averaged_rest(si, number[STATION_DRIVE], 14e-9, false);
    double closed = edge_of(&l, 300.0, 4000.0), low = 0.7 * closed, high = 1.4 * closed;
    start_bus();
    double z = integrate_over_bus(275.0, 0.0, FRAMES, error);
    check_near("height of the averaged rest, nm", (si[LEVER_HEIGHT] + z) * 1e9, l.z * 1e9, 5e-3);
    engaged_bus = bus;
    memcpy(engaged_scratch, scratch, sizeof scratch);
    for (int i = 0; i < 7; i++) {
        double gain = sqrt(low * high);
        bus = engaged_bus;
        memcpy(scratch, engaged_scratch, sizeof scratch);
        integrate_over_bus(gain, z + 0.005e-9, FRAMES, error);
        *(growth_of(error) > 1.0 ? &high : &low) = gain;
    }
    check_near("ultimate gain by z over the bus, 1/s", sqrt(low * high), closed, 0.03 * closed);
    double hz, pure = ultimate_gain(&l, frame_s, &hz);
    printf("      a pure delay of one frame: %.1f 1/s at %.0f Hz\n", pure, hz);
}
