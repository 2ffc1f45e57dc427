/* test_afm_closed.c - the AFM's closed loops beside linear theory: frequency response, bandwidth, phase
 * margin, step and stability limit, from the transfer functions of lever, lock-in, piezo and controller. */
#include "tests/unit/test.h"

#include <complex.h>
#include <math.h>
#include <string.h>
#include "firmware/afm/station.h"
#include "firmware/stage/stage.h"
#include "tests/fixture/afm/averaged.h"
#include "tests/fixture/imaginary.h"

#define PI 3.14159265358979323846

/* A station with its piezo, and both as they have settled. */
static struct station station, settled;
static struct stage piezo, settled_piezo;
static double si[LEVER_PARAMETERS], number[STATION_NUMBERS];
static struct station_config config;

/* Numbers of the theory; the gain is a factor on those of the controller. */
static struct {
    double gain;
    struct averaged rest;
    double tau, slope, pole, zeta;
} known;

static void begin(double f0, double quality, double height)
{
    for (int i = 0; i < LEVER_PARAMETERS; i++)
        si[i] = afm_lever.parameter[i].initial;
    si[LEVER_F0] = f0;
    si[LEVER_Q] = quality;
    si[LEVER_HEIGHT] = height;
    station_defaults(number);
    memset(&known, 0, sizeof known);
    known.gain = 1.0;
    known.tau = station_ring_time(si);
    config = (struct station_config){.si = si, .tick_s = 1.0 / (64.0 * f0), .number = number};
}

/* ---- parts of the theory ----
 *
 * A sample of dt is e^-s dt. A number that is held over a sample, or led in a line over it, has one or two
 * factors (1 - e^-s dt)/(s dt). */

static double complex late(double complex s)
{
    return cexp(-s * station.sample_s);
}

static double complex held(double complex s, double seconds)
{
    return (1.0 - cexp(-s * seconds)) / (s * seconds);
}

static double complex lines(double complex s, double seconds)
{
    return held(s, seconds) * held(s, seconds);
}

static double complex integral(double complex s)
{
    return known.gain * station.sample_s / (1.0 - late(s));
}

/* The two poles of the lock-in. */
static double complex low_pass(double complex s)
{
    double keep = exp(-2.0 * PI * number[STATION_BANDWIDTH] * station.sample_s);
    double complex pole = (1.0 - keep) / (1.0 - keep * late(s));
    return pole * pole;
}

/* A piezo has the end of each tick as the command of the whole tick; pole 0: none. */
static double complex resonance(double complex s)
{
    double complex u = known.pole > 0.0 ? s / (2.0 * PI * known.pole) : 0.0;
    return (known.pole > 0.0 ? cexp(s * config.tick_s) * held(s, config.tick_s) : 1.0) /
           (1.0 + 2.0 * known.zeta * u + u * u);
}

/* ---- z loops: z follows a height ---- */

static const int16_t plane_count[4] = {-16384, 16384, -16384, 16384};
/* 1 nm over 1 um, 0 in the middle: any height by x. It moves no mass. */
static const struct surface_grid plane = {plane_count, 2, 2, 1e-6, 1e-6, 1e-9 / 32768.0};

static void run_piezo(void *who, double *value, uint32_t n)
{
    stage_run_many(who, value, n);
}

static void use_piezo(double hz, double zeta)
{
    const struct stage_part part = {STAGE_RESONANCE, hz, zeta};
    check_no_error("piezo", stage_init(&piezo, config.tick_s, 0, &part, 1));
    config.piezo = (struct microscope_stage){run_piezo, &piezo};
    known.pole = hz;
    known.zeta = zeta;
}

static void use_plane(void)
{
    number[STATION_SURFACE] = SURFACE_GRID;
    config.grid = &plane;
}

static struct microscope_in at_height(double height)
{
    return (struct microscope_in){.x_m = 0.5e-6 + 1e3 * height};
}

static double true_z(void)
{
    return station.out.z_m;
}

/* From one height of the surface to the next it is a line of so many ticks, which begins a line late. */
static double complex height_path(double complex s)
{
    return lines(s, MICROSCOPE_PATCH * config.tick_s);
}

/* Tapping, 14 of 20 nm, repulsive. */
static void begin_tapping(void)
{
    begin(70e3, 400.0, 14e-9);
    si[LEVER_HAMAKER] = si[LEVER_HAMAKER_OUT] = 0.0;
    number[STATION_BANDWIDTH] = 20e3;
    use_plane();
    known.rest = averaged_rest(si, number[STATION_DRIVE], number[STATION_SETPOINT], false);
}

static void begin_slow_piezo(void)
{
    begin_tapping();
    number[STATION_KI] = 550.0; /* two thirds of what it bears */
    use_piezo(1500.0, 0.05);
}

static double complex tapping_loop(double complex s)
{
    return number[STATION_KI] * integral(s) * lines(s, station.sample_s) * resonance(s) * low_pass(s) *
           averaged_response(&known.rest, s);
}

/* Contact: the deflection follows at once what the sample does, by the share k_ts/(k + k_ts). */
static void begin_contact(void)
{
    begin(70e3, 100.0, 14e-9);
    si[LEVER_HAMAKER] = si[LEVER_HAMAKER_OUT] = 0.0;
    number[STATION_Z_LOOP] = Z_DEFLECTION;
    number[STATION_SETPOINT] = 5e-9;
    number[STATION_KI] = 800.0;
    number[STATION_DRIVE] = 0.0;
    use_plane();
    use_piezo(5e3, 0.05);
    double load = 5e-9 * si[LEVER_K], law = 4.0 / 3.0 * si[LEVER_MODULUS] * sqrt(si[LEVER_RADIUS]);
    double tip = 1.5 * law * cbrt(load / law);
    known.slope = tip / (si[LEVER_K] + tip);
}

static double complex contact_loop(double complex s)
{
    return number[STATION_KI] * integral(s) * lines(s, station.sample_s) * resonance(s) * known.slope;
}

/* Peak force: the lowest point of z moves once a cycle, by ki T times the share k_ts/(k + k_ts) of the error.
 */
static void begin_peak(void)
{
    begin(70e3, 20.0, 14e-9);
    si[LEVER_HAMAKER] = si[LEVER_HAMAKER_OUT] = 0.0;
    si[LEVER_VISCOSITY] = 100.0;
    number[STATION_TICKS] = 2.0;
    number[STATION_PEAK_FORCE] = 5e-9;
    number[STATION_KI] = 800.0;
    use_plane();
    double law = 4.0 / 3.0 * si[LEVER_MODULUS] * sqrt(si[LEVER_RADIUS]), tip = 1.5 * law * cbrt(5e-9 / law);
    known.slope = tip / (si[LEVER_K] + tip);
}

static double cycle_s(void)
{
    return station.swing.samples * station.sample_s;
}

static double complex peak_loop(double complex s)
{
    return known.gain * number[STATION_KI] * cycle_s() * known.slope / (cexp(s * cycle_s()) - 1.0);
}

static double lowest(void)
{
    return station.swing.cycle.low_m;
}

/* A cycle is told a quarter of it after its lowest point. */
static double complex peak_path(double complex s)
{
    return height_path(s) * cexp(-s * 0.25 * cycle_s());
}

/* ---- AGC: the amplitude of a free lever follows a set point, by its one pole ---- */

static void begin_agc(void)
{
    begin(70e3, 400.0, 1e-6);
    number[STATION_Z_LOOP] = 0.0;
    number[STATION_AGC] = 1.0;
}

static double complex agc_loop(double complex s)
{
    return number[STATION_AGC_KI] * integral(s) * held(s, station.sample_s) * low_pass(s) /
           (1.0 + s * known.tau);
}

static double amplitude(void)
{
    return station.lockin[0].amplitude;
}

/* ---- PLL and DART: the frequency follows the resonance ----
 *
 * The attraction F = -H R/(6 d^2) shifts the resonance by -f0 H R/(6 k d^3), so the surface moves it. The
 * lever is bent by F, and d moves by k/(k - H R/(3 d^3)) of the height. */

static void use_attraction(void)
{
    double k = si[LEVER_K], pull = si[LEVER_HAMAKER] * si[LEVER_RADIUS], d = si[LEVER_HEIGHT];
    for (int i = 0; i < 50; i++)
        d = si[LEVER_HEIGHT] - pull / (6.0 * d * d * k);
    known.slope = si[LEVER_F0] * pull / (2.0 * k * d * d * d * d) / (1.0 - pull / (3.0 * d * d * d * k));
    number[STATION_Z_LOOP] = 0.0;
    number[STATION_DRIVE] = 50e-12;
    use_plane();
}

static double frequency(void)
{
    return station.frequency_Hz;
}

/* The output is the number that is held over the next sample. */
static double complex attraction_path(double complex s)
{
    return -known.slope * height_path(s) / held(s, station.sample_s);
}

static void begin_pll(void)
{
    begin(70e3, 400.0, 4e-9);
    use_attraction();
    number[STATION_PLL] = 1.0;
    number[STATION_PLL_KP] = 600.0;
    number[STATION_PLL_KI] = 400e3;
}

/* The phase lags the detuning by the lever's pole: 2 pi tau/(1 + s tau). */
static double complex pll_loop(double complex s)
{
    double complex controller = known.gain * number[STATION_PLL_KP] + number[STATION_PLL_KI] * integral(s);
    return controller * held(s, station.sample_s) * 2.0 * PI * known.tau / (1.0 + s * known.tau) *
           low_pass(s);
}

static void begin_dart(void)
{
    begin(350e3, 120.0, 4e-9);
    use_attraction();
    number[STATION_DART] = 1.0;
    number[STATION_DART_KI] = 2e6;
    number[STATION_BANDWIDTH] = 500.0;
}

/* The envelope of a tone at the distance d has its pole at -1/tau +- i d. So a small shift x of the resonance
 * moves both amplitudes by the share x d/((s + 1/tau)^2 + d^2), one up and one down. */
static double complex dart_loop(double complex s)
{
    double complex free = s + 1.0 / known.tau;
    double d = PI * number[STATION_DART_DISTANCE];
    return number[STATION_DART_KI] * integral(s) * held(s, station.sample_s) * low_pass(s) * 2.0 * PI * d /
           (free * free + d * d);
}

/* ---- the loops ---- */

struct loop_case {
    const char *name;
    void (*begin)(void);
    double complex (*loop)(double complex s);
    double complex (*path)(double complex s); /* from the height to the output, beside the loop */
    double (*output)(void);
    double moved;                /* the height, m */
    double step_s, most_Hz;      /* how long a step is seen; above all crossings of the phase */
    double share, degrees, step; /* allowed */
    double tone[6];
};

/* Not in the theory: ripple of the lock-in, harmonics of a tapping tip, DART's beat. A peak force is the
 * largest sample of its cycle, in which the lever rings a little. */
/* clang-format off */
static const struct loop_case z_case[] = {
    {"z, tapping", begin_tapping, tapping_loop, height_path, true_z, 2e-12, 30e-3, 5e3, 0.005, 0.15, 0.003,
     {20, 50, 100, 300, 700, 900}},
    {"z, tapping, a piezo of 1.5 kHz", begin_slow_piezo, tapping_loop, height_path, true_z, 2e-12, 30e-3, 5e3, 0.005, 0.15, 0.003,
     {20, 50, 100, 300, 700, 900}},
    {"z, contact, a piezo of 5 kHz", begin_contact, contact_loop, height_path, true_z, 10e-12, 10e-3, 2e4, 0.002, 0.15, 0.003,
     {20, 60, 200, 1000, 4000, 5000}}
}, other_case[] = {
    {"peak force", begin_peak, peak_loop, peak_path, lowest, 100e-12, 10e-3, 5e3, 0.02, 1.0, 0.015,
     {10, 30, 100, 200, 400, 700}},
    {"AGC", begin_agc, agc_loop, late, amplitude, 1e-9, 20e-3, 2e4, 0.003, 0.15, 0.003,
     {20, 50, 100, 200, 300, 600}},
    {"PLL", begin_pll, pll_loop, attraction_path, frequency, 10e-12, 10e-3, 2e4, 0.003, 0.15, 0.015,
     {50, 100, 300, 600, 1000, 2000}},
    {"DART", begin_dart, dart_loop, attraction_path, frequency, 10e-12, 20e-3, 1e4, 0.003, 0.15, 0.03,
     {20, 50, 100, 150, 300, 600}}
};
/* clang-format on */

static double complex closed(const struct loop_case *c, double hz)
{
    double complex s = 2.0 * PI * i_unit * hz, loop = c->loop(s);
    return c->path(s) * loop / (1.0 + loop);
}

/* ---- measured ---- */

/* A step takes so many periods of the lever, which it does not excite then. */
enum { RAMP = 10 };

static double ramp_s(void)
{
    return RAMP / si[LEVER_F0];
}

static double ramped(long i)
{
    return fmin(1.0, (double)i * station.sample_s / ramp_s());
}

/* The height below the tip moves, and the set point of the AGC. */
static bool sample(double moved)
{
    struct microscope_in in = at_height(moved);
    station.number[STATION_AGC_SETPOINT] = number[STATION_AGC_SETPOINT] + moved;
    return station_run(&station, &in);
}

/* Its output is new in this sample. */
static bool told(void)
{
    return !station_swings(number) || station.cycle_ready;
}

/* Samples of a mean in which the lock-in's ripple is none: a period of the tone, or a beat of two. A cycle of
 * peak force has none. */
static long mean_samples(void)
{
    double dart_s = 1.0 / number[STATION_DART_DISTANCE], tone_s = 1.0 / si[LEVER_F0];
    double one_s = station_swings(number) ? station.sample_s : number[STATION_DART] > 0.0 ? dart_s : tone_s;
    return lround(one_s / station.sample_s);
}

static double settled_output; /* its mean */

static void settle(const struct loop_case *c)
{
    c->begin();
    config.at = at_height(0.0);
    check_no_error("station", station_init(&station, &config));
    long mean = mean_samples(), n = lround(0.15 / station.sample_s) / mean * mean;
    settled_output = 0.0;
    for (; n > 0 || !told(); n--) {
        if (!sample(0.0))
            check_true("finite", false);
        settled_output += n > 0 && n <= mean ? c->output() / (double)mean : 0.0;
    }
    settled = station;
    settled_piezo = piezo;
}

static void from_settled(double gain)
{
    station = settled;
    piezo = settled_piezo;
    known.gain = gain;
    station.z.ki *= gain;
    station.agc.ki *= gain;
    station.dart.ki *= gain;
    station.pll.ki *= gain;
    station.pll.kp *= gain;
}

/* Output over a small cosine: by a window of Hann over whole periods, after as long a wait. */
static double complex respond(const struct loop_case *c, double hz)
{
    from_settled(1.0);
    double complex sum = 0.0;
    double weight = 0.0, first = c->output(), periods = ceil(0.05 * hz) + 4.0;
    long n = lround(periods / hz / station.sample_s);
    for (long i = 0; i < 2 * n; i++) {
        double turn = 2.0 * PI * hz * station.sample_s, hann = 1.0 - cos(2.0 * PI * (double)i / (double)n);
        if (!sample(c->moved * cos(turn * (double)i)))
            return (double)NAN;
        if (i < n || !told())
            continue;
        weight += hann;
        sum += hann * (c->output() - first) * cexp(-i_unit * turn * (double)(i + 1));
    }
    return 2.0 * sum / weight / c->moved;
}

static void check_tones(const struct loop_case *c)
{
    for (int i = 0; i < 6; i++) {
        double complex got = respond(c, c->tone[i]), theory = closed(c, c->tone[i]);
        check_near(check_name("%s at %g Hz: share of the amplitude by theory, %.4g", c->name, c->tone[i],
                              cabs(theory)),
                   cabs(got / theory), 1.0, c->share);
        check_near("  phase off theory, degrees", carg(got / theory) * 180.0 / PI, 0.0, c->degrees);
    }
}

/* The first frequency at which a magnitude falls to a value. */
static double falls(const struct loop_case *c, double complex (*of)(const struct loop_case *c, double hz),
                    double to)
{
    double hz = 5.0;
    while (hz < 1e4 && cabs(of(c, hz)) > to)
        hz *= 1.0002;
    return hz;
}

static double complex opened(const struct loop_case *c, double hz)
{
    return c->loop(2.0 * PI * i_unit * hz);
}

/* The loop gain from the closed loop that is measured. */
static double complex measured_open(const struct loop_case *c, double hz)
{
    double complex t = respond(c, hz) / c->path(2.0 * PI * i_unit * hz);
    return t / (1.0 - t);
}

/* Where a measured magnitude falls to a value, near to a frequency: in a line of logarithms. */
static double cross(double complex low, double complex high, double near, double to)
{
    double at = log(cabs(low) / to) / log(cabs(low) / cabs(high));
    return 0.95 * near * pow(1.05 / 0.95, at);
}

static void check_margin(const struct loop_case *c)
{
    double flat = cabs(closed(c, 1e-3)), band = falls(c, closed, flat * sqrt(0.5)),
           unity = falls(c, opened, 1.0);
    double got = cross(respond(c, 0.95 * band), respond(c, 1.05 * band), band, flat * sqrt(0.5));
    check_near(check_name("%s: bandwidth, Hz", c->name), got, band, c->share * band);
    double complex low = measured_open(c, 0.95 * unity), high = measured_open(c, 1.05 * unity);
    got = cross(low, high, unity, 1.0);
    check_near("  its loop gain is 1 at, Hz", got, unity, c->share * unity);
    double part = (got / unity - 0.95) / 0.1, margin = carg(low) + part * (carg(high) - carg(low));
    check_near("  phase margin, degrees", 180.0 + margin * 180.0 / PI,
               180.0 + carg(opened(c, unity)) * 180.0 / PI, c->degrees);
}

/* ---- a step ---- */

enum { STEP_POINTS = 400, LINES = 8000 };
static double complex line[LINES];

/* Response to a unit step: (2/pi) integral of Re T sin(w t)/w dw, of lines 2.5 Hz apart. */
static double step_theory(double t)
{
    double sum = 0.0;
    for (int i = 0; i < LINES; i++)
        sum += creal(line[i]) * sin(2.0 * PI * 2.5 * (i + 0.5) * t) / (i + 0.5);
    return 2.0 / PI * sum;
}

/* Overshoot and settling to 5 % of a step, point by point. */
struct step {
    double overshoot, settled_s, last;
};

static void step_point(struct step *s, double t, double value)
{
    s->overshoot = fmax(s->overshoot, value - 1.0);
    if ((fabs(value - 1.0) > 0.05) != (fabs(s->last - 1.0) > 0.05) || t == 0.0)
        s->settled_s = t;
    s->last = value;
}

/* The part of a step that is there after t; with a peak force after n cycles, of which the first one is told
 * before z moves. */
static double step_now(double t, int n)
{
    double left = 1.0 - number[STATION_KI] * cycle_s() * known.slope;
    return !station_swings(number) ? step_theory(t) : n > 1 ? 1.0 - pow(left, n - 1) : 0.0;
}

static void check_step(const struct loop_case *c)
{
    double worst = 0.0, flat = creal(closed(c, 1e-3));
    struct step got = {.last = 0.0}, theory = {.last = 0.0};
    from_settled(1.0);
    long mean = mean_samples(),
         each = lround(c->step_s / STEP_POINTS / station.sample_s / (double)mean) * mean;
    each = each > 0 ? each : mean;
    for (int i = 0; i < LINES; i++) {
        double complex s = 2.0 * PI * i_unit * 2.5 * (i + 0.5);
        line[i] =
            closed(c, 2.5 * (i + 0.5)) / flat * held(s, ramp_s()) * held(s, (double)mean * station.sample_s);
    }
    double first = settled_output, sum = 0.0;
    int cycles = 0;
    for (long i = 1; i <= lround(c->step_s / station.sample_s); i++) {
        if (!sample(c->moved * ramped(i - 1)))
            check_true("finite", false);
        cycles += told();
        sum += i % each == 0 || each - i % each < mean ? c->output() / (double)mean : 0.0;
        if (i % each)
            continue;
        double t = (double)i * station.sample_s, value = (sum - first) / (c->moved * flat);
        double closed_form = step_now(t, cycles);
        sum = 0.0;
        worst = fmax(worst, fabs(value - closed_form));
        step_point(&got, t, value);
        step_point(&theory, t, closed_form);
    }
    check_near(check_name("%s: a step, largest distance from theory", c->name), worst, 0.0, c->step);
    check_near("  overshoot", got.overshoot, theory.overshoot, c->step);
    check_near("  settled to 5 % after, ms", got.settled_s * 1e3, theory.settled_s * 1e3,
               2e3 * (double)each * station.sample_s);
}

/* ---- stability ---- */

/* The least factor on all gains with which the loop gain passes -1, and the frequency. */
static double edge(const struct loop_case *c, double *hz)
{
    double least = (double)INFINITY, before = 0.0;
    known.gain = 1.0;
    for (double f = 5.0; f < c->most_Hz; f *= 1.0001) {
        double complex loop = opened(c, f);
        if (before * cimag(loop) < 0.0 && creal(loop) < 0.0 && -1.0 / creal(loop) < least) {
            least = -1.0 / creal(loop);
            *hz = f;
        }
        before = cimag(loop);
    }
    return least;
}

/* After a small step: the largest swing of the last quarter over that of the second one. The output is a mean
 * over a beat of two tones, or over a period of the tone. */
static double grown(const struct loop_case *c, double gain, double seconds)
{
    from_settled(gain);
    double low[2] = {1e30, 1e30}, high[2] = {-1e30, -1e30}, sum = 0.0;
    long mean = mean_samples();
    long n = lround(seconds / station.sample_s) / mean * mean;
    for (long i = 0; i < n; i++) {
        if (!sample(c->moved * ramped(i)))
            return (double)NAN;
        sum += c->output() / (double)mean;
        if ((i + 1) % mean)
            continue;
        int late_part = i >= n / 4 * 3;
        if (late_part || (i >= n / 4 && i < n / 2)) {
            low[late_part] = fmin(low[late_part], sum);
            high[late_part] = fmax(high[late_part], sum);
        }
        sum = 0.0;
    }
    return (high[1] - low[1]) / (high[0] - low[0]);
}

static void check_edge(const struct loop_case *c)
{
    double hz = 1.0, limit = edge(c, &hz), low = 0.95 * limit, high = 1.05 * limit;
    for (int i = 0; i < 4; i++) {
        double gain = sqrt(low * high);
        *(grown(c, gain, 50.0 / hz) > 1.0 ? &high : &low) = gain;
    }
    check_near(check_name("%s: limit of its gains over what they are, at %.0f Hz", c->name, hz),
               sqrt(low * high), limit, 0.015 * limit);
}

static void check_loops(const struct loop_case *c, int n)
{
    for (const struct loop_case *end = c + n; c < end; c++) {
        settle(c);
        check_tones(c);
        check_margin(c);
        check_step(c);
        check_edge(c);
    }
}

TEST(afm_closed_z)
{
    check_loops(z_case, 3);
}

TEST(afm_closed_peak_agc_pll_dart)
{
    check_loops(other_case, 4);
}
