/* afm_loop.c - a z loop of your own on a virtual AFM, in codes of its converters: engage, then meet two
 * steps.
 *
 *   cc afm_loop.c $(pkg-config --cflags --libs contactplant) -lm && ./a.out
 *
 * Dither: a cosine of 16 samples a period. Amplitude: two sums over a period. z: an integrator. */
#include <contactplant.h>
#include <math.h>
#include <stdio.h>

enum { PERIOD = 16, MILLISECOND = 70 /* periods */ };
static const double volt = 20.0 / 65536.0;         /* a code */
static const double free_nm = 20.0, set_nm = 14.0; /* amplitudes */
static const double step = 275.0 / 70e3;           /* integral gain Ki = 275 1/s, times a period */

static union contactplant_afm_memory memory;
static struct contactplant_afm *afm;
static int32_t dac[CONTACTPLANT_AFM_DACS], adc[CONTACTPLANT_AFM_ADCS];
static double cosine[PERIOD], sine[PERIOD], z_nm, amplitude_nm;

static int fail(void)
{
    fprintf(stderr, "%s\n", contactplant_afm_error(afm));
    return 0;
}

static int set(const char *name, double value)
{
    return contactplant_afm_set(afm, contactplant_afm_find(afm, name), value) == CONTACTPLANT_OK || fail();
}

/* One period of the lever, after which the controller moves z. */
static int turn(void)
{
    double re = 0.0, im = 0.0;
    for (int i = 0; i < PERIOD; i++) {
        dac[CONTACTPLANT_AFM_DITHER] = (int32_t)(free_nm / 10.0 / volt * cosine[i]); /* 10 nm/V */
        dac[CONTACTPLANT_AFM_Z] = (int32_t)(z_nm / 100.0 / volt);                    /* 100 nm/V */
        if (contactplant_afm_sample(afm, dac, adc) != CONTACTPLANT_OK)
            return fail();
        re += adc[CONTACTPLANT_AFM_DEFLECTION] * cosine[i];
        im += adc[CONTACTPLANT_AFM_DEFLECTION] * sine[i];
    }
    amplitude_nm = sqrt(re * re + im * im) * 2.0 / PERIOD * volt * 50.0; /* 50 nm/V */
    z_nm -= step * (amplitude_nm - set_nm);
    return 1;
}

/* Runs, and says when the amplitude is within 0.5 nm of the set point for good. */
static int settle(const char *what, int milliseconds)
{
    int last = 0;
    double most_nN = 0.0;
    for (int i = 1; i <= milliseconds * MILLISECOND; i++) {
        if (!turn())
            return 0;
        double force = contactplant_afm_truth(afm, CONTACTPLANT_AFM_PEAK_FORCE) * 1e9;
        most_nN = force > most_nN ? force : most_nN;
        if (fabs(amplitude_nm - set_nm) > 0.5)
            last = i;
    }
    printf("%-10s settled after %4.1f ms, amplitude %5.2f nm, z %7.2f nm, largest force %.1f nN\n", what,
           (double)last / MILLISECOND, amplitude_nm, z_nm, most_nN);
    return 1;
}

int main(void)
{
    struct contactplant_error error;
    afm = contactplant_afm_open(&memory, sizeof memory, "tapping", &error);
    if (!afm) {
        fprintf(stderr, "%s\n", error.text);
        return 1;
    }
    for (int i = 0; i < PERIOD; i++) {
        cosine[i] = cos(6.283185307179586 * i / PERIOD);
        sine[i] = sin(6.283185307179586 * i / PERIOD);
    }
    /* A step of 20 nm at x = 500 nm: the scanner has 1 um/V.
     * The lever begins 14 nm above the sample, at rest. */
    if (!set("surface", 1.0) || !set("surface_height_m", 20e-9) || !set("surface_pitch_m", 500e-9))
        return 1;
    int good = settle("engage", 60);
    dac[CONTACTPLANT_AFM_X] = (int32_t)(1.0 / volt);
    good = good && settle("step up", 40);
    dac[CONTACTPLANT_AFM_X] = 0;
    good = good && settle("step down", 40);
    double crashes = contactplant_afm_truth(afm, CONTACTPLANT_AFM_CRASHES);
    printf("crashes: %.0f, contact forces above 100 nN\n", crashes);
    if (crashes > 0.0)
        printf("The step up is one on purpose: x jumps over the flank, the sample rises by 20 nm in one "
               "period,\n"
               "and the amplitude tells it to the loop after 2 Q/w0 = 1.8 ms only. Move x in small steps.\n");
    return !good;
}
