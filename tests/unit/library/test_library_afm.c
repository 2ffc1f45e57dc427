/* test_library_afm.c - the microscope of the public header: codes, gains, delays, mistakes. */
#include "host_sim/library/contactplant.h"

#include <math.h>
#include "firmware/afm/codes.h"
#include "tests/unit/test.h"

static union contactplant_afm_memory afm_memory;
static struct contactplant_error error;
static struct contactplant_afm *afm;

static const char afm_scene[] = "[plant]\nmodel = afm_lever\nmethod = modal\nheight = 200 nm\n"
                                "[deadline]\nframe = 1 ms\nsubsteps = 64\ndilation = 70\n";

static void afm_begin(void)
{
    afm = contactplant_afm_open(&afm_memory, sizeof afm_memory, afm_scene, &error);
    check_string("open", error.text, "");
}

static int set(const char *name, double value)
{
    return contactplant_afm_set(afm, contactplant_afm_find(afm, name), value);
}

TEST(afm_codes)
{
    uint32_t clipped = 0;
    check_near("a code, V", codes_to_volt(1, &clipped), 3.051758e-4, 1e-10);
    check_near("most, V", codes_to_volt(32767, &clipped), 10.0 - CODES_VOLT, 0.0);
    check_near("least, V", codes_to_volt(-32768, &clipped), -10.0, 0.0);
    check_int("nothing held", clipped, 0);
    check_near("beyond", codes_to_volt(40000, &clipped), 10.0 - CODES_VOLT, 0.0);
    check_near("below", codes_to_volt(INT32_MIN, &clipped), -10.0, 0.0);
    check_int("both are counted", clipped, 2);
    for (int32_t code = -32768; code <= 32767; code += 97)
        if (codes_of_volt(codes_to_volt(code, &clipped), &clipped) != code)
            check_int("round trip", code, 0);
    check_int("rounds to the nearest", codes_of_volt(2.4 * CODES_VOLT, &clipped), 2);
    check_int("and away from zero", codes_of_volt(-2.6 * CODES_VOLT, &clipped), -3);
    check_int("still two", clipped, 2);
    check_int("largest", codes_of_volt(1e300, &clipped), 32767);
    check_int("smallest", codes_of_volt(-10.1, &clipped), -32768);
    check_int("four", clipped, 4);
}

/* A still lever follows a base through the sensors; z is there at the end of the sample. */
TEST(library_afm_gains)
{
    int32_t dac[CONTACTPLANT_AFM_DACS] = {0, 3277, 0, 0}, adc[CONTACTPLANT_AFM_ADCS];
    afm_begin();
    check_near("a sample, s", contactplant_afm_sample_time(afm), 4.0 / (64.0 * 70e3), 1e-20);
    check_int("one sample", contactplant_afm_sample(afm, dac, adc), CONTACTPLANT_OK);
    check_int("z sensor", adc[CONTACTPLANT_AFM_Z_SENSOR], 3277);
    check_near("z, m", contactplant_afm_truth(afm, CONTACTPLANT_AFM_TRUE_Z), 3277 * CODES_VOLT * 100e-9,
               1e-18);
    double truth = contactplant_afm_truth(afm, CONTACTPLANT_AFM_TRUE_DEFLECTION);
    check_near("deflection", adc[CONTACTPLANT_AFM_DEFLECTION], truth / 50e-9 / CODES_VOLT, 0.5);
    check_int("surface below", contactplant_afm_truth(afm, CONTACTPLANT_AFM_TRUE_SURFACE) == 0.0, 1);
    dac[CONTACTPLANT_AFM_X] = 99999;
    check_int("another one", contactplant_afm_sample(afm, dac, adc), CONTACTPLANT_OK);
    check_near("a code was held", contactplant_afm_truth(afm, CONTACTPLANT_AFM_CLIPPED), 1.0, 0.0);
}

/* A held cosine of 16 samples: its first harmonic is sinc(pi/16) of the tone, half a sample late. */
TEST(library_afm_dither)
{
    int32_t dac[CONTACTPLANT_AFM_DACS] = {0}, adc[CONTACTPLANT_AFM_ADCS];
    double re = 0.0, im = 0.0;
    afm_begin();
    for (int i = 0; i < 16 * 6000; i++) {
        dac[CONTACTPLANT_AFM_DITHER] = (int32_t)lround(6553.6 * cos(0.39269908169872414 * (i % 16)));
        (void)contactplant_afm_sample(afm, dac, adc);
        if (i >= 16 * 5000) {
            re += adc[0] * cos(0.39269908169872414 * (i + 1)) / 8000.0;
            im -= adc[0] * sin(0.39269908169872414 * (i + 1)) / 8000.0;
        }
    }
    double x = 0.19634954084936207; /* pi/16; the kicks of a tick are at its ends, by half each */
    check_near("amplitude for 2 V, nm", hypot(re, im) * CODES_VOLT * 50.0,
               20.0 * sin(x) / (4.0 * tan(x / 4.0)), 0.02);
    check_near("phase, degrees", atan2(im, re) * 57.29577951308232, -90.0 - 11.25, 0.05);
}

TEST(library_afm_loops)
{
    int32_t dac[CONTACTPLANT_AFM_DACS] = {0}, adc[CONTACTPLANT_AFM_ADCS];
    afm = contactplant_afm_open(&afm_memory, sizeof afm_memory, "tapping", NULL);
    check_int("drive", set("drive_m", 20e-9), CONTACTPLANT_OK);
    check_int("z loop", set("z_loop", 1.0), CONTACTPLANT_OK);
    dac[CONTACTPLANT_AFM_Z] = 12345;
    for (int i = 0; i < 16 * 70 * 40; i++)
        (void)contactplant_afm_sample(afm, dac, adc);
    check_near("the amplitude is held, nm", contactplant_afm_truth(afm, CONTACTPLANT_AFM_AMPLITUDE) * 1e9,
               14.0, 0.3);
    check_near("the tone, Hz", contactplant_afm_truth(afm, CONTACTPLANT_AFM_FREQUENCY), 70e3, 1e-9);
    check_is("z is the loop's, not the DAC's", fabs(contactplant_afm_truth(afm, CONTACTPLANT_AFM_TRUE_Z)), <,
             10e-9);
    check_is("peak force", contactplant_afm_truth(afm, CONTACTPLANT_AFM_PEAK_FORCE), >=, 0.0);
    check_near("crashes", contactplant_afm_truth(afm, CONTACTPLANT_AFM_CRASHES), 0.0, 0.0);
    check_near("their force", contactplant_afm_truth(afm, CONTACTPLANT_AFM_CRASH_FORCE), 0.0, 0.0);
}

/* A cycle of peak force by the law of the tip: 1 GPa, H R/(6 a0^2) = 3.918 nN. */
TEST(library_afm_peak_force)
{
    int32_t dac[CONTACTPLANT_AFM_DACS] = {0}, adc[CONTACTPLANT_AFM_ADCS];
    afm = contactplant_afm_open(&afm_memory, sizeof afm_memory, "tapping", NULL);
    check_int("peak force", set("peak_force_N", 5e-9), CONTACTPLANT_OK);
    check_int("ticks", set("ticks", 1.0), CONTACTPLANT_OK);
    check_int("swing", set("drive_m", 20e-9), CONTACTPLANT_OK);
    check_int("z loop", set("z_loop", 1.0), CONTACTPLANT_OK);
    for (int i = 0; i < 64 * 70 * 200; i++)
        (void)contactplant_afm_sample(afm, dac, adc);
    check_near("cycle, nN", contactplant_afm_truth(afm, CONTACTPLANT_AFM_CYCLE_FORCE) * 1e9, 5.0, 1.5);
    check_near("adhesion, nN", contactplant_afm_truth(afm, CONTACTPLANT_AFM_ADHESION) * 1e9, 3.918, 0.1);
    check_near("modulus, GPa", contactplant_afm_truth(afm, CONTACTPLANT_AFM_MODULUS) * 1e-9, 1.0, 0.05);
    check_near("deformation, nm", contactplant_afm_truth(afm, CONTACTPLANT_AFM_DEFORMATION) * 1e9, 0.7, 0.2);
    check_near("dissipation, aJ", contactplant_afm_truth(afm, CONTACTPLANT_AFM_DISSIPATION) * 1e18, 0.0, 0.3);
    check_near("snap-in, nN", contactplant_afm_truth(afm, CONTACTPLANT_AFM_SNAP_IN) * 1e9, 3.918, 0.4);
    check_near("baseline, nN", contactplant_afm_truth(afm, CONTACTPLANT_AFM_BASELINE) * 1e9, 0.0, 0.1);
}

/* ---- saved and restored ---- */

static void open_hot(struct contactplant_afm **to, union contactplant_afm_memory *where)
{
    *to = contactplant_afm_open(where, sizeof *where, "tapping", &error);
    check_string("open", error.text, "");
    check_int("drive", contactplant_afm_set(*to, contactplant_afm_find(*to, "drive_m"), 20e-9),
              CONTACTPLANT_OK);
    check_int("rough", contactplant_afm_set(*to, contactplant_afm_find(*to, "surface"), 4.0),
              CONTACTPLANT_OK);
}

/* A sum of all readings of n samples over the sample below x. */
static uint64_t readings(struct contactplant_afm *from, int n)
{
    int32_t dac[CONTACTPLANT_AFM_DACS] = {0}, adc[CONTACTPLANT_AFM_ADCS];
    uint64_t sum = 0;
    for (int i = 0; i < n; i++) {
        dac[CONTACTPLANT_AFM_X] = i % 2000;
        dac[CONTACTPLANT_AFM_Z] = -i % 1000;
        check_is("a sample", contactplant_afm_sample(from, dac, adc), ==, CONTACTPLANT_OK);
        sum = sum * 31u + (uint32_t)adc[CONTACTPLANT_AFM_DEFLECTION];
    }
    return sum;
}

TEST(library_afm_saved)
{
    static union contactplant_afm_memory second;
    static unsigned char bytes[CONTACTPLANT_AFM_SIZE];
    struct contactplant_afm *other;
    open_hot(&afm, &afm_memory);
    size_t size = contactplant_afm_save_size(afm);
    check_is("bytes", size, <=, sizeof bytes);
    (void)readings(afm, 500);
    check_int("save", contactplant_afm_save(afm, bytes, size), CONTACTPLANT_OK);
    uint64_t first = readings(afm, 700);
    open_hot(&other, &second);
    (void)readings(other, 33);
    check_int("into one that has gone another way", contactplant_afm_restore(other, bytes, size),
              CONTACTPLANT_OK);
    check_hex("it goes on alike", readings(other, 700), first);
    other = contactplant_afm_open(&second, sizeof second, "tapping", &error);
    check_int("into one that has not begun", contactplant_afm_restore(other, bytes, size), CONTACTPLANT_OK);
    check_hex("alike, with its numbers", readings(other, 700), first);
    check_int("back in time", contactplant_afm_restore(afm, bytes, size), CONTACTPLANT_OK);
    check_hex("alike once more", readings(afm, 700), first);
    bytes[size / 2] ^= 1;
    check_int("a bit of damage", contactplant_afm_restore(afm, bytes, size), CONTACTPLANT_BAD_BYTES);
    check_contains("is told", contactplant_afm_error(afm), "they are damaged");
    bytes[size / 2] ^= 1;
    check_int("a byte too few", contactplant_afm_restore(afm, bytes, size - 1), CONTACTPLANT_BAD_BYTES);
    check_int("nothing", contactplant_afm_restore(afm, NULL, size), CONTACTPLANT_BAD_BYTES);
    check_int("room for a byte too few", contactplant_afm_save(afm, bytes, size - 1),
              CONTACTPLANT_BAD_MEMORY);
    other = contactplant_afm_open(&second, sizeof second, "soft", &error);
    check_int("another lever", contactplant_afm_restore(other, bytes, size), CONTACTPLANT_BAD_BYTES);
    check_contains("is told", contactplant_afm_error(other), "of another scene");
    check_int("no microscope: save", contactplant_afm_save(NULL, bytes, size), CONTACTPLANT_BAD_HANDLE);
    check_int("restore", contactplant_afm_restore(NULL, bytes, size), CONTACTPLANT_BAD_HANDLE);
    check_int("bytes", (int64_t)contactplant_afm_save_size(NULL), 0);
}

/* ---- mistakes ---- */

static void check_afm_open(const char *name, void *where, size_t size, const char *text, const char *part)
{
    check_true(name, !contactplant_afm_open(where, size, text, &error));
    check_contains(name, error.text, part);
    check_true(name, !contactplant_afm_open(where, size, text, NULL));
}

TEST(library_afm_refuses_to_open)
{
    check_afm_open("no memory", NULL, sizeof afm_memory, "tapping", "NULL");
    check_afm_open("too small", &afm_memory, contactplant_afm_size() - 1, "tapping", "too few");
    check_afm_open("misaligned", afm_memory.bytes + 4, sizeof afm_memory - 4, "tapping", "aligned");
    check_afm_open("no scene", &afm_memory, sizeof afm_memory, NULL, "NULL");
    check_afm_open("unknown", &afm_memory, sizeof afm_memory, "taping", "tapping");
    check_afm_open("no lever", &afm_memory, sizeof afm_memory, "rig", "no AFM lever");
    check_afm_open("a text's line", &afm_memory, sizeof afm_memory,
                   "[plant]\nmodel = afm_lever\nqality = 3\n", "scene:3");
    check_true("what it needs will do",
               contactplant_afm_open(&afm_memory, contactplant_afm_size(), "soft", NULL) != NULL);
}

TEST(library_afm_refusals)
{
    struct contactplant_number number;
    int32_t dac[CONTACTPLANT_AFM_DACS] = {0}, adc[CONTACTPLANT_AFM_ADCS];
    afm_begin();
    check_int("name", contactplant_afm_find(afm, "kj"), -1);
    check_contains("nearest", contactplant_afm_error(afm), "did you mean k");
    check_int("no name", contactplant_afm_find(afm, NULL), -1);
    check_int("far from any", contactplant_afm_find(afm, "zzzzzzzzzz"), -1);
    check_int("describe", contactplant_afm_describe(afm, contactplant_afm_find(afm, "z_m_per_V"), &number),
              CONTACTPLANT_OK);
    check_string("unit", number.unit, "m/V");
    check_int("index", contactplant_afm_describe(afm, 1000, &number), CONTACTPLANT_BAD_INDEX);
    check_int("no number", contactplant_afm_describe(afm, 0, NULL), CONTACTPLANT_BAD_VALUE);
    check_int("set", contactplant_afm_set(afm, -1, 0.0), CONTACTPLANT_BAD_INDEX);
    check_int("range", set("ki", -1.0), CONTACTPLANT_BAD_VALUE);
    check_int("NaN", set("ki", (double)NAN), CONTACTPLANT_BAD_VALUE);
    check_contains("  text", contactplant_afm_error(afm), "ki: ");
    check_int("codes", contactplant_afm_sample(afm, NULL, adc), CONTACTPLANT_BAD_VALUE);
    check_int("codes", contactplant_afm_sample(afm, dac, NULL), CONTACTPLANT_BAD_VALUE);
    check_int("z loop alone", set("z_loop", 1.0), CONTACTPLANT_OK);
    check_int("  is told", contactplant_afm_sample(afm, dac, adc), CONTACTPLANT_BAD_VALUE);
    check_contains("  so", contactplant_afm_error(afm), "drive_m the lock-in would listen to a silent tone");
    check_int("z loop off", set("z_loop", 0.0), CONTACTPLANT_OK);
    check_int("a high surface", set("surface", 2.0) | set("surface_height_m", 5e-6), CONTACTPLANT_OK);
    check_int("  is told", contactplant_afm_sample(afm, dac, adc), CONTACTPLANT_BAD_VALUE);
    check_contains("  so", contactplant_afm_error(afm), "inside the surface");
    check_int("flat", set("surface", 0.0), CONTACTPLANT_OK);
    check_int("runs", contactplant_afm_sample(afm, dac, adc), CONTACTPLANT_OK);
    check_int("too late", set("ki", 1.0), CONTACTPLANT_BAD_ORDER);
    check_nan("no such truth", contactplant_afm_truth(afm, (enum contactplant_afm_truth)99));
    afm = NULL;
    check_int("find", contactplant_afm_find(afm, "ki"), -1);
    check_int("describe", contactplant_afm_describe(afm, 0, &number), CONTACTPLANT_BAD_HANDLE);
    check_int("set", contactplant_afm_set(afm, 0, 1.0), CONTACTPLANT_BAD_HANDLE);
    check_int("sample", contactplant_afm_sample(afm, dac, adc), CONTACTPLANT_BAD_HANDLE);
    check_nan("time", contactplant_afm_sample_time(afm));
    check_nan("truth", contactplant_afm_truth(afm, CONTACTPLANT_AFM_TRUE_Z));
    check_contains("text", contactplant_afm_error(afm), "contactplant_afm_open");
}
