/* test_afm_plant.c - a whole AFM as a plant on a bus. It equals the microscope in a program and keeps closed
 * forms; then refusals, stop, time-out, reset, raster and approach. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/afm/afm_plant.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "host_sim/library/library.h"
#include "host_sim/library/library_afm.h"
#include "tests/fixture/afm/plant_bus.h"
#include "tests/fixture/bus.h"

#define TWO_PI 6.283185307179586

enum { SAMPLES = 1120 /* in a frame of 1 ms, at 64 ticks of the lever a period */ };

static struct bus bus;
static double scratch[METHOD_SCRATCH], si[MODEL_PARAMETERS], setting[SETTINGS];

static int plant_number(int i)
{
    return AFM_PLANT_NUMBERS + i;
}

/* The defaults: lever `tapping`, cold, 100 nm over the sample, the z loop on. */
static void plant_defaults(void)
{
    plant_bus_defaults(si, setting, 1e-3);
}

static void start_at(uint32_t substeps, double dilation)
{
    struct app_config c = plant_bus_config(si, setting, substeps, scratch);
    c.dilation = dilation;
    bus_start_running(&bus, &c);
}

static void start_usual(void)
{
    start_at(SAMPLES, 1.0);
}

static const struct station *plant_station(void)
{
    return afm_plant_station(scratch);
}

static double reading(int i)
{
    double value[MODEL_OUTPUTS];
    plant_output(&bus.app.plant, value);
    return value[i];
}

/* The mean of amplitude, phase, height or shift over the last frame, as the bus says it; sent as size and
 * sign. */
static double heard_mean(int slot)
{
    double mean = (double)NAN;
    for (int i = 0; i < bus.n_seen; i++) {
        const struct message *m = &bus.seen[i];
        if (m->kind == WIRE_LOCKIN && m->value[LOCKIN_SLOT] == slot)
            mean = m->value[LOCKIN_AMPLITUDE] * cos(m->value[LOCKIN_PHASE]);
    }
    return mean;
}

/* ---- equal to the microscope in a program ---- */

/* A length unit of 2^-25 m makes the way of a number over the bus exact, as a float and as a model unit. */
static const double range_m = 30.0 / 33554432.0, z_gain = 1.0 / 8388608.0;

static union contactplant_afm_memory memory;

static struct contactplant_afm *open_alone(void)
{
    static const char scene[] =
        "[plant]\nmodel = afm_lever\nmethod = modal\ntemperature = 295 K\nheight = 40 nm\n"
        "range = 8.94069671630859375e-07 m\n"
        "[deadline]\nframe = 1 ms\nsubsteps = 1120\ndilation = 4\n";
    static const char *const name[] = {"z_loop", "drive_m", "pll", "z_m_per_V", "setpoint_m"};
    static const double value[] = {0.0, 20e-9, 1.0, 0.0, 14e-9};
    struct contactplant_error error;
    struct contactplant_afm *a = contactplant_afm_open(&memory, sizeof memory, scene, &error);
    check_string("open", error.text, "");
    for (int i = 0; i < 5; i++)
        check_int(name[i],
                  contactplant_afm_set(a, contactplant_afm_find(a, name[i]), i == 3 ? z_gain : value[i]),
                  CONTACTPLANT_OK);
    return a;
}

/* The code of z in frame i: down to the sample, and there to and fro. */
static int32_t code_of(int i)
{
    return i < 20 ? -40 * i : -800 + (i * 37) % 100;
}

/* Their plant, and its z is a code's, held. */
static void start_as_alone(uint32_t substeps, double dilation)
{
    plant_defaults();
    si[LEVER_TEMPERATURE] = 295.0;
    si[LEVER_HEIGHT] = 40e-9;
    si[LEVER_RANGE] = range_m;
    si[plant_number(STATION_Z_LOOP)] = 0.0;
    si[plant_number(STATION_PLL)] = 1.0;
    setting[SET_STREAM_LINEAR + AFM_PLANT_Z] = 0.0;
    start_at(substeps, dilation);
}

TEST(afm_plant_equals_the_microscope_in_a_program)
{
    struct contactplant_afm *a = open_alone();
    int32_t dac[CONTACTPLANT_AFM_DACS] = {0}, adc[CONTACTPLANT_AFM_ADCS];
    uint32_t clipped = 0;
    bool good = true;
    start_as_alone(SAMPLES, 1.0);
    for (int i = 0; i < 60 && good; i++) {
        double z = z_gain * codes_to_volt(code_of(i), &clipped);
        bus_stream(&bus, AFM_PLANT_Z, (uint64_t)i, z);
        bus_run(&bus, 1);
        bus_forget(&bus);
        dac[CONTACTPLANT_AFM_Z] = code_of(i);
        for (int k = 0; k < SAMPLES && good; k++)
            good = contactplant_afm_sample(a, dac, adc) == CONTACTPLANT_OK;
    }
    check_true("samples", good);
    check_int("ticks of the lever", (int)plant_station()->microscope.tick, 60 * SAMPLES * 4);
    check_true("the tip has touched",
               plant_station()->out.z_m < -25e-9 && reading(AFM_PLANT_CONTACT_FORCE) > 0.0);
    check_hex("hash of the station", station_hash(plant_station(), 1), station_hash(&a->station, 1));
}

/* CONTACT's force is the largest of this period of the lever and the one before, here from the forces of each
 * sample on the way to the sample and back. */
TEST(afm_plant_contact_force)
{
    enum { N = 4000 };
    static double peak[2 * N];
    int off = 0, pressed = 0;
    start_as_alone(1, SAMPLES);
    const struct station *s = plant_station();
    int period = 1 + (int)(1.0 / si[LEVER_F0] / s->sample_s);
    for (int i = 0; i < N; i++) {
        double largest = 0.0;
        bus_stream(&bus, AFM_PLANT_Z, (uint64_t)i,
                   i % 2000 < 1000 ? i % 2000 * -60e-12 : (i % 2000 - 2000) * 60e-12);
        bus_run(&bus, 1);
        bus_forget(&bus);
        int at = (int)(s->microscope.tick / 4) - 1;
        peak[at] = s->out.peak_N;
        for (int k = at - at % period - period; k <= at; k++)
            largest = k >= 0 && peak[k] > largest ? peak[k] : largest;
        off += fabs(reading(AFM_PLANT_CONTACT_FORCE) - largest) > 1e-12 * largest;
        pressed += peak[at] > 0.0;
    }
    check_above("samples in contact", pressed, 10);
    check_above("samples apart", N - pressed, 1000);
    check_int("samples with another force", off, 0);
}

/* In slow motion a bus frame is one sample: 1 ms of the bus for 0.893 us of the lever. */
TEST(afm_plant_sample_by_sample)
{
    struct contactplant_afm *a = open_alone();
    int32_t dac[CONTACTPLANT_AFM_DACS] = {0}, adc[CONTACTPLANT_AFM_ADCS];
    uint32_t clipped = 0;
    bool good = true;
    double off = 0.0, z;
    start_as_alone(1, SAMPLES);
    for (int i = 0; i < 3000; i++) {
        dac[CONTACTPLANT_AFM_Z] = i % 1600 < 800 ? -(i % 800) : i % 800 - 800; /* steps that no line rounds */
        z = z_gain * codes_to_volt(dac[CONTACTPLANT_AFM_Z], &clipped);
        bus_stream(&bus, AFM_PLANT_Z, (uint64_t)i, z);
        bus_run(&bus, 1);
        good = good && contactplant_afm_sample(a, dac, adc) == CONTACTPLANT_OK;
        double truth = contactplant_afm_truth(a, CONTACTPLANT_AFM_TRUE_DEFLECTION);
        off = fmax(off, fabs(bus_value(&bus, WIRE_MOTION, MOTION_DISPLACEMENT) - truth));
        bus_forget(&bus);
    }
    check_true("samples", good);
    check_hex("hash of the station", station_hash(plant_station(), 1), station_hash(&a->station, 1));
    check_below("deflection in each frame's MOTION, parts of its unit", off / bus.scene.lsb[0], 0.501);
}

/* ---- closed forms ---- */

/* A free lever: amplitude and phase of an oscillator, over the bus. */
TEST(afm_plant_free_lever)
{
    static const double off_Hz[] = {0.0, 40.0, -100.0};
    for (int i = 0; i < 3; i++) {
        plant_defaults();
        si[plant_number(STATION_Z_LOOP)] = 0.0;
        si[LEVER_HEIGHT] = 1e-6;
        si[plant_number(STATION_FREQUENCY)] = si[LEVER_F0] + off_Hz[i];
        start_usual();
        bus_run(&bus, 40);
        double r = 1.0 + off_Hz[i] / si[LEVER_F0], Q = si[LEVER_Q];
        double re = 1.0 - r * r, im = r / Q;
        check_near("amplitude, nm", heard_mean(0) * 1e9, 20.0 / Q / hypot(re, im), 1e-3);
        check_near("phase, degrees", heard_mean(1), -atan2(im, re) * 360.0 / TWO_PI, 0.1);
        check_near("height, nm", heard_mean(2) * 1e9, 0.0, 1e-9);
        check_near("frequency shift, Hz", heard_mean(3), off_Hz[i], 1e-3);
        check_int("no ledger's fault", bus.app.faults, 0);
        bus_forget(&bus);
    }
}

/* The mean of exp(-s/tau) over a frame, weighted as the lock-in weights it. */
static double hann_mean(double tau, double frame)
{
    double sum = 0.0, weight = 0.0;
    for (int k = 0; k < SAMPLES; k++) {
        double w = 1.0 - cos(TWO_PI * (k + 0.5) / SAMPLES);
        sum += w * exp(-(k + 1.0) / SAMPLES * frame / tau);
        weight += w;
    }
    return sum / weight;
}

/* An integrator of the controller's own sets the free amplitude from the mean amplitude of the frame before.
 * With a and u of lever and drive at the begin of a frame, q = exp(-T/tau), h the mean of exp(-s/tau) and g =
 * Ki T:
 *
 *   a' = q a + (1 - q) u,  u' = u - g m,  m = h a + (1 - h) u
 *
 * So m'' = t m' - d m with t = 1 + q - g (1 - h) and d = q + g (h - q): the edge of stability is d = 1. The
 * lock-in's delay makes h larger by exp(delay/tau). */
TEST(afm_plant_ultimate_gain_over_the_bus)
{
    const double T = 1e-3, gain = 1500.0;
    double m[60], xx = 0.0, xy = 0.0, yy = 0.0, xz = 0.0, yz = 0.0, drive = 20e-9;
    plant_defaults();
    si[plant_number(STATION_Z_LOOP)] = 0.0;
    si[LEVER_HEIGHT] = 1e-6;
    si[plant_number(STATION_BANDWIDTH)] = 20e3;
    start_usual();
    bus_run(&bus, 40);
    for (int i = 0; i < 60; i++) {
        m[i] = heard_mean(0) - 14e-9;
        drive -= gain * T * m[i];
        bus_set(&bus, (unsigned)plant_number(STATION_DRIVE), drive);
        bus_forget(&bus);
        bus_run(&bus, 1);
    }
    for (int i = 2; i < 60; i++) { /* least squares of m'' over m' and -m */
        double x = m[i - 1], y = -m[i - 2];
        xx += x * x, xy += x * y, yy += y * y, xz += x * m[i], yz += y * m[i];
    }
    double trace = (xz * yy - yz * xy) / (xx * yy - xy * xy), det = (yz * xx - xz * xy) / (xx * yy - xy * xy);
    double tau = station_ring_time(si), q = exp(-T / tau), delay = 1.0 / (0.5 * TWO_PI * 20e3);
    double h = hann_mean(tau, T) * exp(delay / tau), g = gain * T;
    check_near("trace", trace, 1.0 + q - g * (1.0 - h), 5e-3);
    check_near("determinant", det, q + g * (h - q), 5e-3);
    double measured = gain * (1.0 - q) / (det - q), closed = (1.0 - q) / (h - q) / T;
    check_near("ultimate gain, 1/s", measured, closed, 0.02 * closed);
}

/* ---- commands ---- */

TEST(afm_plant_takes_and_refuses_numbers)
{
    plant_defaults();
    start_usual();
    bus_run(&bus, 2);
    bus_set_now(&bus, (unsigned)plant_number(STATION_SETPOINT), 30e-9);
    check_int("set point above the free amplitude", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_RANGE);
    check_near("  nothing has changed, nm", plant_station()->number[STATION_SETPOINT] * 1e9, 14.0, 1e-9);
    bus_set_now(&bus, (unsigned)plant_number(STATION_SETPOINT), 13e-9);
    check_int("one below", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_OK);
    check_near("  nm", plant_station()->number[STATION_SETPOINT] * 1e9, 13.0, 1e-6);
    bus_set_now(&bus, (unsigned)plant_number(STATION_FREQUENCY), 400e3);
    check_int("a sample longer than a quarter of a period", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_RANGE);
    bus_set_now(&bus, AFM_PLANT_SCAN, 0.5);
    check_int("half an image", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_RANGE);
    bus_set_now(&bus, SETTING_FIRST + SET_STAGE + STAGE_AT, 1.0);
    check_int("a stage before the force", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_RANGE);
    uint64_t tick = plant_station()->microscope.tick;
    bus_run(&bus, 1);
    check_is("the microscope has run on", plant_station()->microscope.tick, ==, tick + SAMPLES * 4);
    bus_set_now(&bus, LEVER_Q, 200.0);
    check_int("another lever", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_OK);
    check_int("  begins anew", (int)plant_station()->microscope.tick, SAMPLES * 4);
}

/* Two tones up to 246 kHz have 4 samples a period at 984 kHz. Lever and station round that otherwise. */
TEST(afm_plant_exactly_four_samples)
{
    plant_defaults();
    start_at(984, 1.0);
    bus_run(&bus, 2);
    bus_set_now(&bus, (unsigned)plant_number(STATION_FREQUENCY), 242e3);
    check_int("exactly 4", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_OK);
    check_near("the tone, Hz", plant_station()->frequency_Hz, 242e3, 0.0);
    bus_set_now(&bus, (unsigned)plant_number(STATION_FREQUENCY), 242001.0);
    check_int("fewer", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_RANGE);
}

/* Settings that no stage reads put no other instrument in. */
TEST(afm_plant_runs_on_without_stages)
{
    plant_defaults();
    start_usual();
    bus_run(&bus, 2);
    bus_set_now(&bus, SETTING_FIRST + SET_SENSOR_SEED, 7.0);
    bus_set_now(&bus, SETTING_FIRST + SET_STAGE + STAGE_SET_GAIN, 2.0);
    check_int("ticks", (int)plant_station()->microscope.tick, 4 * SAMPLES * 4);
    bus_set_now(&bus, SETTING_FIRST + SET_STAGE + STAGE_AT, 1.0 + AFM_PLANT_Z);
    check_int("a stage: anew", (int)plant_station()->microscope.tick, SAMPLES * 4);
    bus_set_now(&bus, SETTING_FIRST + SET_SENSOR_SEED, 8.0);
    check_int("its seed: anew", (int)plant_station()->microscope.tick, SAMPLES * 4);
    bus_set(&bus, SETTING_FIRST + SET_STAGE + STAGE_AT, 0.0);
    bus_run(&bus, 2);
    bus_stream(&bus, AFM_PLANT_Z, bus.app.frame + 1, -50e-9);
    check_true("without a stage again", plant_station()->microscope.piezo.run == NULL);
}

/* A slow lever in much faster samples has more of them in a period than 32 bits count. A stage at ticks that
 * are too short for it is refused. */
TEST(afm_plant_very_short_samples)
{
    plant_defaults();
    si[plant_number(STATION_Z_LOOP)] = si[plant_number(STATION_DRIVE)] = 0.0;
    si[plant_number(STATION_TICKS)] = 4096.0;
    si[LEVER_F0] = 10.0;
    start_at(1, 1e8);
    bus_run(&bus, 3);
    check_int("it runs", bus.app.faults, 0);
    bus_set_now(&bus, SETTING_FIRST + SET_STAGE + STAGE_AT, 1.0 + AFM_PLANT_Z);
    check_int("a stage at its ticks", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_OK);
    check_int("  and on", bus.app.faults, 0);
    start_at(4, 1e9);
    bus_run(&bus, 3);
    check_int("it runs", bus.app.faults, 0);
    bus_set_now(&bus, SETTING_FIRST + SET_STAGE + STAGE_AT, 1.0 + AFM_PLANT_Z);
    check_int("a stage at samples of 2.5e-13 s", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_RANGE);
    check_int("  and on", bus.app.faults, 0);
}

/* Bandwidth and stages are of the instrument, too; a gain of a loop is not. */
TEST(afm_plant_begins_anew)
{
    static const struct {
        const char *what;
        int parameter;
        double value;
        int ticks;
    } set[] = {{"a gain", LEVER_PARAMETERS + STATION_KI, 200.0, 3},
               {"a bandwidth", LEVER_PARAMETERS + STATION_BANDWIDTH, 4e3, 1},
               {"a stage", SETTING_FIRST + SET_STAGE + STAGE_SET_GAIN, 0.5, 1}};
    for (int i = 0; i < 3; i++) {
        plant_defaults();
        setting[SET_STAGE + STAGE_AT] = 1.0 + AFM_PLANT_Z;
        start_usual();
        bus_run(&bus, 2);
        uint64_t before = plant_station()->microscope.tick;
        bus_set_now(&bus, (unsigned)set[i].parameter, set[i].value);
        check_int(set[i].what, bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_OK);
        check_int("  ticks of the lever since the begin", (int)plant_station()->microscope.tick,
                  (set[i].ticks > 1 ? (int)before : 0) + SAMPLES * 4);
    }
}

/* The lever is another one, and the base stands where it stood: nothing rings. A contact bends both levers
 * alike, also by more than indentation_max_m. */
TEST(afm_plant_keeps_z_over_a_change)
{
    static const struct {
        const char *what;
        double z_m, share; /* the true z, in parts of it */
    } at[] = {{"free, above", 50e-9, 1.0},
              {"free, below", -50e-9, 1.0},
              {"  behind a piezo of half the gain", -50e-9, 0.5},
              {"in contact", -105e-9, 1.0},
              {"  deep in it", -400e-9, 1.0}};
    for (int i = 0; i < 5; i++) {
        plant_defaults();
        si[LEVER_Q] = 20.0;
        si[LEVER_HAMAKER] = si[LEVER_HAMAKER_OUT] = 0.0;
        si[plant_number(STATION_Z_LOOP)] = si[plant_number(STATION_DRIVE)] = 0.0;
        setting[SET_STAGE + STAGE_AT] = at[i].share < 1.0 ? 1.0 + AFM_PLANT_Z : 0.0;
        setting[SET_STAGE + STAGE_SET_GAIN] = at[i].share;
        start_usual();
        bus_stream(&bus, AFM_PLANT_Z, 0, at[i].z_m);
        bus_run(&bus, 10);
        double bent = reading(AFM_PLANT_DISPLACEMENT);
        check_near(at[i].what, reading(AFM_PLANT_HEIGHT) * 1e9, at[i].share * at[i].z_m * 1e9, 1e-5);
        bus_set(&bus, LEVER_Q, 400.0);
        for (int k = 0; k < 3; k++) {
            bus_run(&bus, 1);
            check_near("z stands, nm", reading(AFM_PLANT_HEIGHT) * 1e9, at[i].share * at[i].z_m * 1e9, 1e-5);
            check_near("  so does the bent lever, nm", (reading(AFM_PLANT_DISPLACEMENT) - bent) * 1e9, 0.0,
                       1e-4);
        }
    }
}

/* A z loop goes on from its z, and the sample from the place that lies below the tip. */
TEST(afm_plant_keeps_the_place_over_a_change)
{
    plant_defaults();
    si[plant_number(STATION_SURFACE)] = SURFACE_STEP;
    start_usual();
    bus_stream(&bus, AFM_PLANT_X, 0, 2e-6);
    bus_run(&bus, 60);
    double before = reading(AFM_PLANT_HEIGHT);
    check_near("the loop is down on the step, nm", before * 1e9, -65.8, 1.0);
    bus_set_now(&bus, LEVER_Q, 390.0);
    check_near("it goes on there, nm", (reading(AFM_PLANT_HEIGHT) - before) * 1e9, 0.0, 4.0);
    check_near("on the step, nm", plant_station()->out.surface_m * 1e9, 20.0, 1e-6);
    check_int("no crash", (int)reading(AFM_PLANT_CRASHES), 0);
}

/* The lever must bear both materials, over the height that the surface has where it begins. */
TEST(afm_plant_checks_the_sample)
{
    int which;
    plant_defaults();
    check_no_error("the defaults", afm_plant_check(si, &which));
    si[plant_number(STATION_SURFACE)] = SURFACE_GRATING;
    si[plant_number(STATION_SURFACE_EDGE)] = 0.0;
    si[plant_number(STATION_SURFACE_HEIGHT)] = 99e-9;
    check_no_error("a line of the grating just below the tip", afm_plant_check(si, &which));
    si[plant_number(STATION_SURFACE_HEIGHT)] = 5e-6;
    check_contains("far above it", afm_plant_check(si, &which), "inside the surface");
    check_int("  by the lever's height", which, LEVER_HEIGHT);
    plant_defaults();
    si[plant_number(STATION_MAP)] = 2.0;
    check_no_error("a second material", afm_plant_check(si, &which));
    si[plant_number(STATION_MAP_HAMAKER_OUT)] = 1e-21;
    check_contains("which would make energy", afm_plant_check(si, &which), "make energy");
    check_int("  by the map", which, plant_number(STATION_MAP));
    plant_defaults();
    si[LEVER_HAMAKER_OUT] = 1e-21;
    check_contains("a first one that would", afm_plant_check(si, &which), "make energy");
    check_int("  by no number alone", which, -1);
    plant_defaults();
    si[plant_number(STATION_DRIVE)] = 0.0;
    check_contains("a silent tone", afm_plant_check(si, &which), "silent");
    check_int("  by its amplitude", which, plant_number(STATION_DRIVE));
}

/* The step must bear the stiffer material: the numbers are those of a lever over that one alone. */
TEST(afm_plant_prepares_the_stiffer_material)
{
    static const double modulus_Pa[] = {1e8, 20e9};
    double p[3][MODEL_DERIVED];
    struct scale scale;
    for (int i = 0; i < 2; i++) {
        plant_defaults();
        memset(p, 0, sizeof p);
        afm_plant.prepare(si, p[0], &scale);
        si[plant_number(STATION_MAP)] = 1.0;
        si[plant_number(STATION_MAP_MODULUS)] = modulus_Pa[i];
        si[plant_number(STATION_MAP_VISCOSITY)] = si[LEVER_VISCOSITY];
        afm_plant.prepare(si, p[1], &scale);
        si[plant_number(STATION_MAP)] = 0.0;
        si[LEVER_MODULUS] = modulus_Pa[i];
        afm_plant.prepare(si, p[2], &scale);
        check_true("that of the map, where it is the stiffer one",
                   !memcmp(p[1], p[i == 0 ? 0 : 2], sizeof p[0]));
        check_true("  and not the other", memcmp(p[1], p[i == 0 ? 2 : 0], sizeof p[0]) != 0);
    }
}

/* A sample is a whole tick: what ends inside one only waits. */
TEST(afm_plant_parts_of_a_tick)
{
    uint64_t hash[2];
    for (int parts = 1; parts <= 4; parts += 3) {
        struct plant *pl = &bus.app.plant;
        plant_defaults();
        start_usual();
        for (uint64_t i = 1; i <= 100U * (unsigned)parts; i++) {
            uint64_t tick = plant_station()->microscope.tick;
            struct instant end = {i / (unsigned)parts,
                                  (uint32_t)(i % (unsigned)parts * TICK_FRACTIONS / (unsigned)parts)};
            check_true("on", plant_advance(pl, end));
            if (plant_station()->microscope.tick != tick + (end.fraction == 0 ? 4 : 0))
                check_int("ticks of the lever", (int)(plant_station()->microscope.tick - tick), 4);
        }
        hash[parts > 1] = station_hash(plant_station(), 1);
    }
    check_hex("the station after 100 samples", hash[1], hash[0]);
}

/* A state that is no number ends the run. So does a tone that its samples do not show, where a plant takes
 * any step. */
TEST(afm_plant_fails)
{
    struct plant *pl = &bus.app.plant;
    struct plant_config c = {.model = &afm_plant,
                             .method = &afm_plant_method,
                             .tick_s = 1e-6,
                             .dilation = 1.0,
                             .si = si,
                             .scratch = scratch,
                             .stage_calls = &afm_plant_calls,
                             .stages = (struct stages *)(void *)scratch};
    plant_defaults();
    si[LEVER_INDENTATION_MAX] = 1e-9;
    check_no_error("a plant", plant_init(pl, &c));
    afm_plant_calls.change(c.stages, pl, setting);
    check_true("runs", plant_run(pl, 3));
    ((struct station *)(void *)scratch)->microscope.x[0] = (double)NAN;
    check_true("and not on from a state that is no number", !plant_run(pl, 3));
    si[plant_number(STATION_FREQUENCY)] = 400e3;
    check_contains("a fast tone", plant_init(pl, &c), "4 samples");
    c.force = true;
    check_no_error("by force", plant_init(pl, &c));
    afm_plant_calls.change(c.stages, pl, setting);
    check_true("does not run", !plant_run(pl, 1));
    check_contains("another model", afm_plant_method.refuse(&afm_lever, pl->p, pl->h, 0.0), "own");
}

/* The switch is told at the end of its sample, and not to a step that runs through switches. */
TEST(afm_plant_runs_through)
{
    static const struct {
        unsigned regime;
        enum step_status status;
    } as[] = {{0, STEP_END}, {1, STEP_SWITCH}, {1 | REGIME_ANY, STEP_END}, {REGIME_ANY, STEP_END}};
    struct plant *pl = &bus.app.plant;
    plant_defaults();
    start_usual();
    check_true("a sample", plant_run(pl, 1));
    for (int i = 0; i < 4; i++) {
        struct segment e = pl->segment;
        struct crossing c = {.done = -1.0};
        e.instant = 0;
        e.length = pl->h;
        check_int("status", pl->step(pl->model, pl->p, pl->scratch, &e, as[i].regime, pl->x, &c),
                  as[i].status);
        check_near("  where it switched", c.done, as[i].status == STEP_SWITCH ? pl->h : -1.0, 0.0);
    }
}

/* A sensor with a gain of 2 doubles the reading of a free lever, and what the lock-in makes of it. */
TEST(afm_plant_stage_of_the_sensor)
{
    plant_defaults();
    si[plant_number(STATION_Z_LOOP)] = 0.0;
    si[LEVER_HEIGHT] = 1e-6;
    setting[SET_STAGE + STAGE_AT] = 1.0 + MODEL_INPUTS + AFM_PLANT_DISPLACEMENT;
    setting[SET_STAGE + STAGE_SET_GAIN] = 2.0;
    start_usual();
    bus_run(&bus, 40);
    check_near("amplitude, nm", heard_mean(0) * 1e9, 40.0, 2e-3);
    bus_set_now(&bus, SETTING_FIRST + SET_STAGE + STAGE_AT, 1.0 + MODEL_INPUTS + AFM_PLANT_VELOCITY);
    check_int("none behind the velocity", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_RANGE);
}

TEST(afm_plant_stage_of_z)
{
    plant_defaults();
    si[plant_number(STATION_Z_LOOP)] = 0.0;
    setting[SET_STAGE + STAGE_AT] = 1.0 + AFM_PLANT_Z;
    setting[SET_STAGE + STAGE_SET_GAIN] = 0.5;
    start_usual();
    bus_stream(&bus, AFM_PLANT_Z, 0, -50e-9);
    bus_run(&bus, 3);
    check_near("half of z, nm", reading(AFM_PLANT_HEIGHT) * 1e9, -25.0, 1e-5);
    check_near("  by the lock-in's mean, nm", heard_mean(2) * 1e9, -25.0, 1e-5);
}

TEST(afm_plant_time_out_and_stop)
{
    plant_defaults();
    si[plant_number(STATION_Z_LOOP)] = 0.0;
    setting[SET_TIMEOUT_FRAMES] = 10.0;
    setting[SET_REACTION_RAMP_S] = 0.02;
    start_usual();
    bus_stream(&bus, AFM_PLANT_Z, 1, -60e-9);
    bus_run(&bus, 4);
    check_near("z, nm", reading(AFM_PLANT_HEIGHT) * 1e9, -60.0, 1e-5);
    bus_silent(&bus, 12);
    check_int("a time-out", bus.app.faults, FAULT_TIMEOUT);
    bus_stream(&bus, AFM_PLANT_Z, 20, -90e-9);
    bus_silent(&bus, 30);
    check_near("the tip is back, nm", reading(AFM_PLANT_HEIGHT) * 1e9, 0.0, 1e-9);
    check_int("no command without a session", bus_cause(&bus, WIRE_STREAM + AFM_PLANT_Z), CAUSE_SESSION);
    start_usual();
    bus_run(&bus, 3);
    bus_order_now(&bus, CONTROL_STOP);
    check_int("stopped", bus.app.state, STATE_STOPPED);
    uint64_t tick = plant_station()->microscope.tick;
    bus_silent(&bus, 5);
    check_is("  time stands", plant_station()->microscope.tick, ==, tick);
}

/* After a reset the instrument is a new one: equal commands give equal bits. */
TEST(afm_plant_reset)
{
    uint64_t hash[2];
    plant_defaults();
    si[LEVER_TEMPERATURE] = 295.0;
    si[LEVER_HEIGHT] = 30e-9;
    si[plant_number(STATION_Z_LOOP)] = 0.0;
    start_usual();
    for (int i = 0; i < 2; i++) {
        bus_stream(&bus, AFM_PLANT_Z, bus.app.plant.now.tick / SAMPLES + 2, -10e-9);
        bus_run(&bus, 10);
        hash[i] = station_hash(plant_station(), 1);
        bus_order_now(&bus, CONTROL_STOP);
        bus_next_session(&bus);
        bus_run(&bus, 1);
        bus_order_now(&bus, CONTROL_RESET);
        check_near("at its start, nm", reading(AFM_PLANT_HEIGHT), 0.0, 0.0);
        bus_order(&bus, CONTROL_START);
    }
    check_hex("the second run", hash[1], hash[0]);
}

/* The memory may be moved: the rest of a run is the same. */
TEST(afm_plant_moves)
{
    static struct bus copy;
    static double elsewhere[METHOD_SCRATCH];
    plant_defaults();
    si[LEVER_TEMPERATURE] = 295.0;
    setting[SET_STAGE + STAGE_AT] = 1.0 + AFM_PLANT_Z;
    setting[SET_STAGE + STAGE_SET_RESONANCE] = 5e3;
    start_usual();
    bus_run(&bus, 3);
    memcpy(elsewhere, scratch, sizeof scratch);
    copy = bus;
    copy.app.plant.scratch = elsewhere;
    check_true("on", plant_run(&bus.app.plant, 5000));
    uint64_t hash = station_hash(plant_station(), 1);
    copy.app.plant.stages = (struct stages *)(void *)elsewhere;
    memset(&scratch, 0, sizeof scratch);
    check_true("the copy on", plant_run(&copy.app.plant, 5000));
    check_hex("both", station_hash(afm_plant_station(elsewhere), 1), hash);
}

/* ---- raster and approach ---- */

TEST(afm_plant_scans)
{
    plant_defaults();
    si[plant_number(STATION_Z_LOOP)] = 0.0;
    si[plant_number(STATION_SCAN_WIDTH)] = 1e-6;
    si[plant_number(STATION_PIXELS)] = 10.0;
    si[plant_number(STATION_LINES)] = 1.0;
    start_usual();
    bus_stream(&bus, AFM_PLANT_X, 0, 3e-7);
    bus_run(&bus, 3);
    check_near("x as commanded, nm", plant_station()->in.x_m * 1e9, 300.0, 1e-4);
    bus_set(&bus, AFM_PLANT_SCAN, 1.0);
    bus_run(&bus, 5);
    check_near("half a trace, nm", plant_station()->in.x_m * 1e9, 500.0, 1e-6);
    bus_set_now(&bus, AFM_PLANT_SCAN, 0.0);
    check_near("its end: as commanded, nm", plant_station()->in.x_m * 1e9, 300.0, 1e-4);
}

/* Another speed on the way down acts from its frame on: 1 um/s, then 3. */
TEST(afm_plant_approach_speed)
{
    plant_defaults();
    si[LEVER_HEIGHT] = 1e-6;
    si[plant_number(STATION_DRIVE)] = si[plant_number(STATION_Z_LOOP)] = 0.0;
    si[plant_number(STATION_SETPOINT)] = 2e-9;
    start_usual();
    for (int i = 1; i <= 3; i += 2) {
        bus_run(&bus, 2);
        bus_set(&bus, AFM_PLANT_RAMP_SPEED, i * 1e-6);
        bus_run(&bus, 3);
        double before = reading(AFM_PLANT_HEIGHT);
        bus_run(&bus, 5);
        check_near("down in 5 frames, nm", (before - reading(AFM_PLANT_HEIGHT)) * 1e9, 5.0 * i, 1e-6);
    }
}

/* Contact without a tone: down until the lever bends by 2 nm, which is 4 nN and indents the sample by 0.965
 * nm; a wait, and back. The base has then gone 30 + 2 + 0.965 - 0.165 nm. */
TEST(afm_plant_approaches)
{
    double lowest = 0.0;
    plant_defaults();
    si[LEVER_HEIGHT] = 30e-9;
    si[LEVER_HAMAKER] = si[LEVER_HAMAKER_OUT] = 0.0;
    si[plant_number(STATION_DRIVE)] = si[plant_number(STATION_Z_LOOP)] = 0.0;
    si[plant_number(STATION_SETPOINT)] = 2e-9;
    start_usual();
    bus_run(&bus, 2);
    bus_set_now(&bus, AFM_PLANT_RAMP_DWELL, 2e-3);
    bus_set(&bus, AFM_PLANT_RAMP_SPEED, 2e-6);
    for (int i = 0; i < 60; i++) {
        bus_run(&bus, 1);
        lowest = fmin(lowest, reading(AFM_PLANT_HEIGHT));
    }
    check_int("touchdown and lift-off", bus_count(&bus, WIRE_EVENT_TIME), 2);
    check_near("turns where the lever has bent, nm", lowest * 1e9, -32.80, 0.02);
    check_near("and comes back, nm", reading(AFM_PLANT_HEIGHT) * 1e9, 0.0, 1e-9);
    check_int("no crash", (int)reading(AFM_PLANT_CRASHES), 0);
    bus_set_now(&bus, AFM_PLANT_RAMP_SPEED, 0.0);
    bus_set(&bus, AFM_PLANT_RAMP_SPEED, 1e-6);
    bus_run(&bus, 10);
    bus_set_now(&bus, AFM_PLANT_RAMP_SPEED, 0.0);
    check_near("turned back on the way down, nm", reading(AFM_PLANT_HEIGHT) * 1e9, -9.0, 2e-3);
}

/* Speed and dwell count from the next sample on, in an approach, too. */
TEST(afm_plant_changes_its_approach)
{
    plant_defaults();
    si[plant_number(STATION_DRIVE)] = si[plant_number(STATION_Z_LOOP)] = 0.0;
    si[plant_number(STATION_Z_MIN)] = -10e-9;
    si[AFM_PLANT_RAMP_DWELL] = 1000.0;
    start_usual();
    bus_run(&bus, 2);
    bus_set(&bus, AFM_PLANT_RAMP_SPEED, 1e-6);
    bus_run(&bus, 5);
    check_near("half way, nm", reading(AFM_PLANT_HEIGHT) * 1e9, -5.0, 2e-3);
    bus_set(&bus, AFM_PLANT_RAMP_SPEED, 2.5e-6);
    bus_run(&bus, 5);
    check_near("it waits there, nm", reading(AFM_PLANT_HEIGHT) * 1e9, -10.0, 4e-3);
    bus_set(&bus, AFM_PLANT_RAMP_DWELL, 1e-3);
    bus_run(&bus, 3);
    check_near("another dwell: it is on its way back, nm", reading(AFM_PLANT_HEIGHT) * 1e9, -2.5, 0.1);
}
