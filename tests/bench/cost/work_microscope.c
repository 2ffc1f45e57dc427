/* work_microscope.c - see work_microscope.h. */
#include "tests/bench/cost/work_microscope.h"

#include "firmware/afm/station.h"
#include "firmware/stage/stage.h"
#include "models/scenes/scenes.h"

enum { TICKS_A_PERIOD = 128, READY = 40000 /* samples */ };

static struct station station;
static struct stage piezo;
static struct microscope_in in;
static enum work_place place;
static double tick_s;
static bool good;

static void run_piezo(void *who, double *value, uint32_t n)
{
    stage_run_many(who, value, n);
}

/* Far: the base is 100 nm up. The z loop is as fast as its lever. */
static void choose(double *si, double *number)
{
    bool taps = place == WORK_TAPPING, two = place == WORK_FAR_TWO_TONES;
    station_defaults(number);
    si[LEVER_HEIGHT] = taps ? 20e-9 : 100e-9;
    number[STATION_Z_LOOP] = taps ? Z_AMPLITUDE : Z_OFF;
    number[STATION_KI] *= si[LEVER_F0] / 70e3;
    number[STATION_DART] = two;
    number[STATION_DART_DISTANCE] = 400.0;
    number[STATION_DART_KI] = 100.0;
}

const char *work_microscope_start(const char *lever, int modes, enum work_place where)
{
    static const struct stage_part part[] = {{STAGE_GAIN, 1.0, 0.0}, {STAGE_RESONANCE, 5e3, 0.05}};
    const struct preset *preset = scenes_find(lever);
    struct harmonic unused[MODEL_INPUTS];
    double si[MODEL_PARAMETERS], number[STATION_NUMBERS];
    place = where;
    scenes_resolve(&preset->scene, si, unused);
    si[LEVER_MODES] = modes;
    choose(si, number);
    tick_s = 1.0 / (si[LEVER_F0] * TICKS_A_PERIOD);
    const char *why = stage_init(&piezo, tick_s, 0, part, 2);
    const struct station_config c = {
        .si = si, .tick_s = tick_s, .number = number, .piezo = {run_piezo, &piezo}};
    why = why ? why : station_init(&station, &c);
    good = !why;
    in = (struct microscope_in){.z_m = 3e-9};
    for (int i = 0; i < READY && good; i++)
        work_microscope_run();
    return why;
}

void work_microscope_run(void)
{
    in.z_m = in.z_m > 3e-9 ? 2.999e-9 : 3.001e-9;
    good &= station_run(&station, &in);
}

double work_microscope_rate(void)
{
    return 1.0 / tick_s;
}

/* The tip is where the work's name says. */
const char *work_microscope_fault(void)
{
    double a = station.lockin[0].amplitude, set = station.number[STATION_SETPOINT];
    bool touches = a < 1.2 * set && a > 0.8 * set;
    if (!good)
        return "a finite motion of the microscope";
    return place == WORK_TAPPING && !touches ? "the z loop holds the amplitude" : NULL;
}

#define WORK __attribute__((noinline)) static void

static void setup_microscope_far(void)
{
    (void)work_microscope_start("tapping", MODEL_MODES, WORK_FAR);
}

WORK once_microscope_far(void)
{
    work_microscope_run();
}

static void setup_microscope_two_tones(void)
{
    (void)work_microscope_start("tapping", MODEL_MODES, WORK_FAR_TWO_TONES);
}

WORK once_microscope_two_tones(void)
{
    work_microscope_run();
}

static void setup_microscope_tapping(void)
{
    (void)work_microscope_start("tapping", MODEL_MODES, WORK_TAPPING);
}

WORK once_microscope_tapping(void)
{
    work_microscope_run();
}

const struct work_piece work_microscope[WORK_MICROSCOPES] = {
    {"microscope_far", setup_microscope_far, once_microscope_far},
    {"microscope_two_tones", setup_microscope_two_tones, once_microscope_two_tones},
    {"microscope_tapping", setup_microscope_tapping, once_microscope_tapping},
};
