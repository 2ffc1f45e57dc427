/* fmu.c - an instance from instantiation to freeing, and the step between. */
#include "host_sim/fmu/fmu.h"
#include "host_sim/fmu/fmu_step.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/out/utf8.h"

enum { PATH_SIZE = 4096 };

/* Points in time are equal within this part of a tick: importers add up step sizes. */
static const double tick_part = 1e-3;

/* ---- the log ---- */

static void say(fmi3LogMessageCallback log, fmi3InstanceEnvironment environment, const char *text)
{
    if (log)
        log(environment, fmi3Error, "error", text);
}

fmi3Status fmu_fail(const struct fmu *f, const char *format, ...)
{
    char text[2 * CONTACTPLANT_TEXT];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    utf8_mend(text);
    say(f->log, f->environment, text);
    return fmi3Error;
}

static const char *mode_name(int mode)
{
    return mode == FMU_INSTANTIATED     ? "instantiated, not initialized"
           : mode == FMU_INITIALIZATION ? "in initialization mode"
           : mode == FMU_STEP           ? "in step mode"
           : mode == FMU_EVENT          ? "in event mode"
                                        : "terminated";
}

struct fmu *fmu_begin(fmi3Instance instance, const char *function, int modes)
{
    struct fmu *f = instance;
    if (!f || f->run.mode & modes)
        return f;
    (void)fmu_fail(f, "%s is not allowed now: the instance is %s", function, mode_name(f->run.mode));
    return NULL;
}

/* ---- instances ---- */

static bool take_memory(struct fmu *f)
{
    f->begin = malloc(sizeof *f->begin);
    if (!f->begin)
        (void)fmu_fail(f, "out of memory");
    return f->begin;
}

/* The scene's text out of the FMU's resources; NULL, and why. */
static char *read_scene(const char *resources, char *why, size_t size)
{
    char path[PATH_SIZE];
    size_t n = resources ? strlen(resources) : 0;
    if (n == 0) {
        snprintf(why, size, "the path of the resources is missing: this FMU reads %s there", FMU_SCENE_FILE);
        return NULL;
    }
    snprintf(path, sizeof path, "%s%s" FMU_SCENE_FILE, resources, resources[n - 1] == '/' ? "" : "/");
    FILE *file = fopen(path, "rb");
    char *text = calloc(1, SCENE_FILE_BYTES + 2);
    size_t got = file && text ? fread(text, 1, SCENE_FILE_BYTES + 1, file) : 0;
    if (file)
        (void)fclose(file);
    if (got > 0)
        return text;
    snprintf(why, size, "cannot read %s: give the path of the unpacked FMU's resources", path);
    free(text);
    return NULL;
}

/* The plant as its scene begins, the run as it is after instantiation. */
static bool open_plant(struct fmu *f)
{
    struct contactplant_error error;
    f->plant = contactplant_open(&f->memory, sizeof f->memory, f->scene, &error);
    if (!f->plant) {
        (void)fmu_fail(f, "%s", error.text);
        return false;
    }
    f->run = (struct fmu_run){.mode = FMU_INSTANTIATED};
    for (int i = 0; i < MODEL_INPUTS; i++)
        for (int k = 0; k < FMU_DRIVE_FIELDS; k++)
            f->run.drive[i][k] = fmu_drive_begin(f->plant, i, k);
    return true;
}

/* The modelDescription.xml that the importer has read is this FMU's. */
static bool is_token(const struct fmu *f, const char *given)
{
    char token[FMU_TOKEN];
    fmu_token(f->scene, token);
    if (given && !strcmp(given, token))
        return true;
    (void)fmu_fail(f,
                   "instantiationToken %.80s, but resources/" FMU_SCENE_FILE
                   " and this binary have %s: take modelDescription.xml, resources and binary from one FMU",
                   given ? given : "(NULL)", token);
    return false;
}

fmi3Instance FMI3(InstantiateCoSimulation)(fmi3String name, fmi3String token, fmi3String resources,
                                           fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean event_mode,
                                           fmi3Boolean early_return, const fmi3ValueReference intermediate[],
                                           size_t n_intermediate, fmi3InstanceEnvironment environment,
                                           fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    char why[PATH_SIZE + CONTACTPLANT_TEXT];
    struct fmu *f = calloc(1, sizeof *f);
    (void)name, (void)visible, (void)logging, (void)intermediate, (void)update;
    if (!f) {
        say(log, environment, "out of memory");
        return NULL;
    }
    f->environment = environment;
    f->log = log;
    f->event_mode = event_mode;
    f->scene = read_scene(resources, why, sizeof why);
    if (!f->scene)
        (void)fmu_fail(f, "%s", why);
    else if (n_intermediate > 0)
        (void)fmu_fail(f, "this FMU has no intermediate variables: ask for none");
    else if (is_token(f, token) && open_plant(f) && (!event_mode || !early_return || take_memory(f)))
        return f;
    FMI3(FreeInstance)(f);
    return NULL;
}

void FMI3(FreeInstance)(fmi3Instance instance)
{
    struct fmu *f = instance;
    if (f) {
        free(f->scene);
        free(f->begin);
    }
    free(f);
}

fmi3Status FMI3(Reset)(fmi3Instance instance)
{
    struct fmu *f = fmu_begin(instance, "fmi3Reset", FMU_ANY);
    return f && open_plant(f) ? fmi3OK : fmi3Error;
}

/* ---- modes ---- */

fmi3Status FMI3(EnterInitializationMode)(fmi3Instance instance, fmi3Boolean has_tolerance,
                                         fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean has_stop,
                                         fmi3Float64 stop)
{
    struct fmu *f = fmu_begin(instance, "fmi3EnterInitializationMode", FMU_INSTANTIATED);
    (void)has_tolerance, (void)tolerance; /* the scene has its own */
    if (!f)
        return fmi3Error;
    if (!isfinite(start))
        return fmu_fail(f, "the start time is not finite");
    if (has_stop && !(stop > start))
        return fmu_fail(f, "the stop time %.17g s is not behind the start time %.17g s", stop, start);
    f->run.mode = FMU_INITIALIZATION;
    f->run.start_s = f->run.last_s = start;
    f->run.stops = has_stop;
    f->run.stop_s = has_stop ? stop : 0.0;
    return fmi3OK;
}

static fmi3Status go_to(fmi3Instance instance, const char *function, int from, enum fmu_mode to)
{
    struct fmu *f = fmu_begin(instance, function, from);
    if (!f)
        return fmi3Error;
    f->run.mode = to;
    return fmi3OK;
}

fmi3Status FMI3(ExitInitializationMode)(fmi3Instance instance)
{
    const struct fmu *f = instance;
    return go_to(instance, "fmi3ExitInitializationMode", FMU_INITIALIZATION,
                 f && f->event_mode ? FMU_EVENT : FMU_STEP);
}

fmi3Status FMI3(Terminate)(fmi3Instance instance)
{
    return go_to(instance, "fmi3Terminate", FMU_RUNS, FMU_TERMINATED);
}

fmi3Status FMI3(EnterEventMode)(fmi3Instance instance)
{
    struct fmu *f = fmu_begin(instance, "fmi3EnterEventMode", FMU_STEP);
    if (!f)
        return fmi3Error;
    if (!f->event_mode)
        return fmu_fail(f, "fmi3EnterEventMode: instantiate with eventModeUsed to have an event mode");
    f->run.mode = FMU_EVENT;
    return fmi3OK;
}

fmi3Status FMI3(EnterStepMode)(fmi3Instance instance)
{
    struct fmu *f = fmu_begin(instance, "fmi3EnterStepMode", FMU_EVENT);
    if (!f)
        return fmi3Error;
    f->run.mode = FMU_STEP;
    f->run.contact = false;
    return fmi3OK;
}

fmi3Status FMI3(EvaluateDiscreteStates)(fmi3Instance instance)
{
    return fmu_begin(instance, "fmi3EvaluateDiscreteStates", FMU_EVENT) ? fmi3OK : fmi3Error;
}

/* Whatever is set acts at once: one iteration is enough. */
fmi3Status FMI3(UpdateDiscreteStates)(fmi3Instance instance, fmi3Boolean *need_update, fmi3Boolean *terminate,
                                      fmi3Boolean *nominals_changed, fmi3Boolean *values_changed,
                                      fmi3Boolean *next_event_time_defined, fmi3Float64 *next_event_time)
{
    struct fmu *f = fmu_begin(instance, "fmi3UpdateDiscreteStates", FMU_EVENT);
    if (!f)
        return fmi3Error;
    if (!need_update || !terminate || !nominals_changed || !values_changed || !next_event_time_defined ||
        !next_event_time)
        return fmu_fail(f, "fmi3UpdateDiscreteStates: an argument for results is NULL");
    *need_update = *terminate = *nominals_changed = *values_changed = *next_event_time_defined = false;
    *next_event_time = 0.0;
    f->run.contact = false; /* the clock has ticked */
    return fmi3OK;
}

/* ---- the step ---- */

/* NULL, or what is wrong with a step from `current`. */
static const char *refuse_step(const struct fmu *f, double current, double step)
{
    const struct fmu_run *r = &f->run;
    double near_s = tick_part * contactplant_tick_time(f->plant) + 4.0 * DBL_EPSILON * fabs(r->last_s);
    if (!isfinite(current) || !isfinite(step))
        return "a communication point or step that is not finite";
    if (step <= 0.0)
        return "a communication step that is not above 0";
    if (current < r->last_s - near_s)
        return "time runs backwards; fmi3SetFMUState goes back";
    if (current > r->last_s + near_s)
        return "a gap in time: a step begins where the last one has ended";
    if (r->stops && current + step > r->stop_s + near_s)
        return "the step goes beyond the stop time";
    return NULL;
}

static int advance(struct fmu *f, struct fmu_step *s)
{
    if (f->event_mode) {
        int code = fmu_step(f->plant, f->begin, s);
        f->run.contact = s->touched;
        return code;
    }
    s->reached_s = s->to_s;
    return contactplant_advance_to(f->plant, s->to_s);
}

fmi3Status FMI3(DoStep)(fmi3Instance instance, fmi3Float64 current, fmi3Float64 step,
                        fmi3Boolean no_set_state_before, fmi3Boolean *event_handling_needed,
                        fmi3Boolean *terminate, fmi3Boolean *early_return, fmi3Float64 *last_successful_time)
{
    struct fmu *f = fmu_begin(instance, "fmi3DoStep", FMU_STEP);
    (void)no_set_state_before;
    if (!f)
        return fmi3Error;
    if (!event_handling_needed || !terminate || !early_return || !last_successful_time)
        return fmu_fail(f, "fmi3DoStep: an argument for results is NULL");
    *event_handling_needed = *terminate = *early_return = false;
    *last_successful_time = f->run.last_s;
    const char *why = refuse_step(f, current, step);
    if (why)
        return fmu_fail(f, "step from %.17g s by %.17g s, the instance is at %.17g s: %s", current, step,
                        f->run.last_s, why);
    struct fmu_step s = {.to_s = current + step - f->run.start_s};
    int code = advance(f, &s);
    if (code == CONTACTPLANT_OK)
        f->run.last_s = s.reached_s < s.to_s ? f->run.start_s + s.reached_s : current + step;
    else if (code == CONTACTPLANT_DIVERGED)
        f->run.last_s = f->run.start_s + contactplant_time(f->plant);
    *last_successful_time = f->run.last_s;
    *early_return = code == CONTACTPLANT_OK && s.reached_s < s.to_s;
    *event_handling_needed = f->run.contact;
    return code == CONTACTPLANT_OK ? fmi3OK : fmu_fail(f, "%s", contactplant_error(f->plant));
}

/* ---- the state: a header and what contactplant_save gives, one block, so that the serialised form is a copy
 * ---- */

struct state_header {
    uint64_t magic;
    uint64_t check; /* covers what follows in the header; the plant's bytes have their own */
    uint64_t size;  /* the header's and the plant's */
    struct fmu_run run;
    struct harmonic drive[MODEL_INPUTS];
};

static const uint64_t state_magic = 0x3165746174736D66u;

static uint64_t state_check(const struct state_header *h)
{
    const size_t before = offsetof(struct state_header, size);
    return library_hash(LIBRARY_HASH, (const char *)h + before, sizeof *h - before);
}

static size_t state_size(struct fmu *f)
{
    return sizeof(struct state_header) + contactplant_save_size(f->plant);
}

fmi3Status FMI3(GetFMUState)(fmi3Instance instance, fmi3FMUState *state)
{
    struct fmu *f = fmu_begin(instance, "fmi3GetFMUState", FMU_ANY);
    if (!f)
        return fmi3Error;
    if (!state)
        return fmu_fail(f, "fmi3GetFMUState: the argument for the state is NULL");
    size_t size = state_size(f);
    struct state_header *h = *state ? *state : calloc(1, size);
    if (!h)
        return fmu_fail(f, "out of memory for a state of %zu bytes", size);
    *h = (struct state_header){.magic = state_magic, .size = size};
    h->run = f->run;
    memcpy(h->drive, f->plant->scene.drive, sizeof h->drive);
    h->check = state_check(h);
    (void)contactplant_save(f->plant, h + 1, size - sizeof *h); /* the size is right: it cannot fail */
    *state = h;
    return fmi3OK;
}

fmi3Status FMI3(SetFMUState)(fmi3Instance instance, fmi3FMUState state)
{
    struct fmu *f = fmu_begin(instance, "fmi3SetFMUState", FMU_ANY);
    const struct state_header *h = state;
    if (!f)
        return fmi3Error;
    if (!h || h->magic != state_magic)
        return fmu_fail(f, "fmi3SetFMUState: this is no state of an instance; fmi3GetFMUState gives one");
    if (h->run.mode == FMU_EVENT && !f->event_mode)
        return fmu_fail(f, "fmi3SetFMUState: this state is in event mode, which this instance has not");
    if (contactplant_restore(f->plant, h + 1, (size_t)h->size - sizeof *h) != CONTACTPLANT_OK)
        return fmu_fail(f, "%s", contactplant_error(f->plant));
    f->run = h->run;
    memcpy(f->plant->scene.drive, h->drive, sizeof h->drive);
    return fmi3OK;
}

fmi3Status FMI3(FreeFMUState)(fmi3Instance instance, fmi3FMUState *state)
{
    (void)instance;
    if (state) {
        free(*state);
        *state = NULL;
    }
    return fmi3OK;
}

fmi3Status FMI3(SerializedFMUStateSize)(fmi3Instance instance, fmi3FMUState state, size_t *size)
{
    struct fmu *f = fmu_begin(instance, "fmi3SerializedFMUStateSize", FMU_ANY);
    if (!f)
        return fmi3Error;
    if (!state || !size)
        return fmu_fail(f, "fmi3SerializedFMUStateSize: the state, or the argument for the size, is NULL");
    *size = state_size(f);
    return fmi3OK;
}

fmi3Status FMI3(SerializeFMUState)(fmi3Instance instance, fmi3FMUState state, fmi3Byte byte[], size_t size)
{
    struct fmu *f = fmu_begin(instance, "fmi3SerializeFMUState", FMU_ANY);
    if (!f)
        return fmi3Error;
    if (!state || !byte || size < state_size(f))
        return fmu_fail(f, "fmi3SerializeFMUState: give a state and room for its %zu bytes", state_size(f));
    memcpy(byte, state, state_size(f));
    return fmi3OK;
}

fmi3Status FMI3(DeserializeFMUState)(fmi3Instance instance, const fmi3Byte byte[], size_t size,
                                     fmi3FMUState *state)
{
    struct fmu *f = fmu_begin(instance, "fmi3DeserializeFMUState", FMU_ANY);
    struct state_header h;
    if (!f)
        return fmi3Error;
    if (!byte || !state)
        return fmu_fail(f, "fmi3DeserializeFMUState: the bytes, or the argument for the state, are NULL");
    if (size < sizeof h)
        return fmu_fail(f, "%zu bytes are no state of this FMU: it has %zu", size, state_size(f));
    memcpy(&h, byte, sizeof h);
    if (h.magic != state_magic || h.check != state_check(&h) || h.size != state_size(f) || size < h.size)
        return fmu_fail(
            f, "these %zu bytes are no state of this FMU: damaged, or of another scene or version", size);
    void *copy = *state ? *state : malloc((size_t)h.size);
    if (!copy)
        return fmu_fail(f, "out of memory for a state of %zu bytes", size);
    memcpy(copy, byte, (size_t)h.size);
    *state = copy;
    return fmi3OK;
}
