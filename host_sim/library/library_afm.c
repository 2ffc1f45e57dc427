/* library_afm.c - a microscope in codes of its converters: the station for a caller's own controller. */
#include "host_sim/library/library_afm.h"

#include "host_sim/cli/options_nearest.h"

#include <math.h>
#include <string.h>
#include "host_sim/cli/options.h"

STATIC_ASSERT(sizeof(struct contactplant_afm) <= CONTACTPLANT_AFM_SIZE, afm_fits_its_promised_size);

static const uint64_t afm_magic = 0x6D6661746E616C70u;
enum { NUMBERS = STATION_NUMBERS + CODES_NUMBERS };

size_t contactplant_afm_size(void)
{
    return sizeof(struct contactplant_afm);
}

bool library_is_afm(const struct contactplant_afm *a)
{
    return a && (uintptr_t)a % CONTACTPLANT_ALIGN == 0 && a->magic == afm_magic;
}

const char *contactplant_afm_error(const struct contactplant_afm *a)
{
    return library_is_afm(a) ? a->error.text
                             : "not a microscope: give what contactplant_afm_open has returned";
}

static const struct parameter *entry(int index)
{
    return index < STATION_NUMBERS ? &station_number[index] : &codes_number[index - STATION_NUMBERS];
}

static int open_afm(struct contactplant_afm *a, const char *text, struct contactplant_error *e)
{
    struct scene scene;
    struct harmonic unused[MODEL_INPUTS];
    enum scene_origin origin;
    char why[SCENE_REASON];
    memset(a, 0, sizeof *a);
    if (!library_read_scene(text, &scene, &origin, why))
        return library_fail(e, CONTACTPLANT_BAD_SCENE, "%s", why);
    if (!scene.model->modal_form)
        return library_fail(e, CONTACTPLANT_BAD_SCENE,
                            "this scene is no AFM lever; give soft, tapping, stiff or a text of afm_lever");
    const char *refused = scene_refuses_stages(&scene);
    if (refused)
        return library_fail(e, CONTACTPLANT_BAD_SCENE, "this scene: %s", refused);
    scenes_resolve(&scene, a->si, unused);
    a->tick_s = scene.frame_s / scene.substeps / scene.dilation;
    for (int i = 0; i < NUMBERS; i++)
        a->number[i] = entry(i)->initial;
    a->number[STATION_DRIVE] = a->number[STATION_Z_LOOP] = 0.0;
    a->magic = afm_magic;
    return CONTACTPLANT_OK;
}

struct contactplant_afm *contactplant_afm_open(void *memory, size_t size, const char *scene,
                                               struct contactplant_error *error)
{
    if (error)
        *error = (struct contactplant_error){.code = CONTACTPLANT_OK};
    if (!library_memory_fits(memory, size, sizeof(struct contactplant_afm), error))
        return NULL;
    if (!scene) {
        (void)library_fail(error, CONTACTPLANT_BAD_SCENE,
                           "the scene is NULL; give tapping, soft, stiff or a text");
        return NULL;
    }
    return open_afm(memory, scene, error) == CONTACTPLANT_OK ? memory : NULL;
}

/* ---- numbers ---- */

int contactplant_afm_find(struct contactplant_afm *a, const char *name)
{
    const char *names[NUMBERS];
    if (!library_is_afm(a))
        return -1;
    for (int i = 0; i < NUMBERS; i++) {
        names[i] = entry(i)->name;
        if (name && !strcmp(name, names[i]))
            return i;
    }
    name = name ? name : "(NULL)";
    (void)library_fail(&a->error, CONTACTPLANT_BAD_NAME, "no number of the microscope is called \"%.80s\"%s",
                       name, options_advise(name, strlen(name), names, NUMBERS, NULL));
    return -1;
}

static int check_number(struct contactplant_afm *a, int index)
{
    return index >= 0 && index < NUMBERS
               ? CONTACTPLANT_OK
               : library_fail(&a->error, CONTACTPLANT_BAD_INDEX, "no number %d; there are 0 to %d", index,
                              NUMBERS - 1);
}

int contactplant_afm_describe(struct contactplant_afm *a, int index, struct contactplant_number *number)
{
    if (!library_is_afm(a))
        return CONTACTPLANT_BAD_HANDLE;
    if (check_number(a, index) != CONTACTPLANT_OK)
        return CONTACTPLANT_BAD_INDEX;
    if (!number)
        return library_fail(&a->error, CONTACTPLANT_BAD_VALUE, "contactplant_afm_describe: number is NULL");
    const struct parameter *q = entry(index);
    *number = (struct contactplant_number){q->name, q->unit, q->meaning, q->min, q->max, q->initial};
    return CONTACTPLANT_OK;
}

int contactplant_afm_set(struct contactplant_afm *a, int index, double value)
{
    if (!library_is_afm(a))
        return CONTACTPLANT_BAD_HANDLE;
    if (check_number(a, index) != CONTACTPLANT_OK)
        return CONTACTPLANT_BAD_INDEX;
    const struct parameter *q = entry(index);
    if (a->runs)
        return library_fail(&a->error, CONTACTPLANT_BAD_ORDER,
                            "%s: numbers are set before the first sample; open the microscope again",
                            q->name);
    if (!(value >= q->min && value <= q->max))
        return library_fail(&a->error, CONTACTPLANT_BAD_VALUE, "%s: %g %s is out of range; give %g to %g",
                            q->name, value, q->unit, q->min, q->max);
    a->number[index] = value;
    return CONTACTPLANT_OK;
}

/* ---- samples ---- */

int library_start_afm(struct contactplant_afm *a)
{
    struct station_config c = {.si = a->si, .tick_s = a->tick_s, .number = a->number};
    int which;
    const char *why = station_check(&c, &which);
    if (why)
        return library_fail(&a->error, CONTACTPLANT_BAD_VALUE, "%s %s", entry(which)->name, why);
    why = station_init(&a->station, &c);
    if (why)
        return library_fail(&a->error, CONTACTPLANT_BAD_VALUE, "this microscope cannot run: %s", why);
    a->dither_N_per_V = a->number[STATION_NUMBERS + CODES_DITHER] * a->station.free_force;
    a->runs = true;
    return CONTACTPLANT_OK;
}

int contactplant_afm_sample(struct contactplant_afm *a, const int32_t dac[CONTACTPLANT_AFM_DACS],
                            int32_t adc[CONTACTPLANT_AFM_ADCS])
{
    if (!library_is_afm(a))
        return CONTACTPLANT_BAD_HANDLE;
    if (!dac || !adc)
        return library_fail(&a->error, CONTACTPLANT_BAD_VALUE, "contactplant_afm_sample: the codes are NULL");
    if (!a->runs && library_start_afm(a) != CONTACTPLANT_OK)
        return a->error.code;
    const double *gain = a->number + STATION_NUMBERS;
    struct microscope_in in = {
        .force_N = a->dither_N_per_V * codes_to_volt(dac[CONTACTPLANT_AFM_DITHER], &a->clipped),
        .z_m = gain[CODES_Z] * codes_to_volt(dac[CONTACTPLANT_AFM_Z], &a->clipped),
        .x_m = gain[CODES_XY] * codes_to_volt(dac[CONTACTPLANT_AFM_X], &a->clipped),
        .y_m = gain[CODES_XY] * codes_to_volt(dac[CONTACTPLANT_AFM_Y], &a->clipped),
    };
    if (!station_run(&a->station, &in))
        return library_fail(&a->error, CONTACTPLANT_DIVERGED,
                            "the motion of the lever left the finite numbers");
    adc[CONTACTPLANT_AFM_DEFLECTION] =
        codes_of_volt(a->station.out.deflection_m / gain[CODES_DEFLECTION], &a->clipped);
    adc[CONTACTPLANT_AFM_Z_SENSOR] = codes_of_volt(a->station.out.z_m / gain[CODES_Z], &a->clipped);
    return CONTACTPLANT_OK;
}

double contactplant_afm_sample_time(struct contactplant_afm *a)
{
    return library_is_afm(a) ? a->tick_s * a->number[STATION_TICKS] : (double)NAN;
}

double contactplant_afm_truth(struct contactplant_afm *a, enum contactplant_afm_truth which)
{
    if (!library_is_afm(a))
        return (double)NAN;
    const struct station *s = &a->station;
    switch (which) {
    case CONTACTPLANT_AFM_TRUE_DEFLECTION:
        return s->out.truth_m;
    case CONTACTPLANT_AFM_TRUE_Z:
        return s->out.z_m;
    case CONTACTPLANT_AFM_TRUE_SURFACE:
        return s->out.surface_m;
    case CONTACTPLANT_AFM_PEAK_FORCE:
        return s->out.peak_N;
    case CONTACTPLANT_AFM_AMPLITUDE:
        return s->lockin[0].amplitude;
    case CONTACTPLANT_AFM_FREQUENCY:
        return s->frequency_Hz;
    case CONTACTPLANT_AFM_CRASHES:
        return s->microscope.n_crashes;
    case CONTACTPLANT_AFM_CRASH_FORCE:
        return s->microscope.crash.peak_N;
    case CONTACTPLANT_AFM_CLIPPED:
        return a->clipped;
    case CONTACTPLANT_AFM_CYCLE_FORCE:
        return s->swing.cycle.peak_N;
    case CONTACTPLANT_AFM_ADHESION:
        return s->swing.cycle.adhesion_N;
    case CONTACTPLANT_AFM_MODULUS:
        return s->swing.cycle.modulus_Pa;
    case CONTACTPLANT_AFM_DEFORMATION:
        return s->swing.cycle.deformation_m;
    case CONTACTPLANT_AFM_DISSIPATION:
        return s->swing.cycle.work_J;
    case CONTACTPLANT_AFM_SNAP_IN:
        return s->swing.cycle.snap_in_N;
    case CONTACTPLANT_AFM_BASELINE:
        return s->swing.cycle.baseline_N;
    default:
        (void)library_fail(&a->error, CONTACTPLANT_BAD_VALUE, "no such number: %d", (int)which);
        return (double)NAN;
    }
}
