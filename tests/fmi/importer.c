/* importer.c - see importer.h. */
#include "tests/fmi/importer.h"

#include <dlfcn.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "tests/unit/test.h"

enum { XML = 1 << 20 };

static void end(const char *format, ...) __attribute__((format(printf, 1, 2), noreturn));
static void end(const char *format, ...)
{
    va_list list;
    va_start(list, format);
    vprintf(format, list);
    va_end(list);
    putchar('\n');
    exit(1);
}

static const char *environment(const char *name)
{
    const char *value = getenv(name);
    if (!value)
        end("FAIL  the importer needs %s", name);
    return value;
}

static void read_text(const char *path, char *text, size_t size)
{
    FILE *f = fopen(path, "rb");
    size_t n = f ? fread(text, 1, size - 1, f) : 0;
    if (n == 0 || n == size - 1)
        end("FAIL  cannot read %s", path);
    text[n] = '\0';
    fclose(f);
}

/* ---- modelDescription.xml, as this FMU writes it: attributes in quotes, an element on a line ---- */

/* The attribute of the element that begins at `at`; false when it has none. */
static bool attribute(const char *at, const char *name, char *value, size_t size)
{
    char pattern[64];
    const char *stop = strchr(at, '>');
    snprintf(pattern, sizeof pattern, " %s=\"", name);
    const char *found = strstr(at, pattern);
    if (!found || !stop || found > stop)
        return false;
    found += strlen(pattern);
    size_t n = strcspn(found, "\"");
    if (n >= size)
        end("FAIL  %s is too long", name);
    memcpy(value, found, n);
    value[n] = '\0';
    return true;
}

static bool number(const char *at, const char *name, double *value)
{
    char text[64];
    if (!attribute(at, name, text, sizeof text))
        return false;
    *value = strtod(text, NULL);
    return true;
}

static void read_variable(struct importer *m, const char *at)
{
    struct variable *v = &m->variable[m->n_variables++];
    double reference = -1.0;
    if (m->n_variables == IMPORTER_VARIABLES)
        end("FAIL  too many variables");
    snprintf(v->type, sizeof v->type, "%.*s", (int)strcspn(at + 1, " "), at + 1);
    if (!attribute(at, "name", v->name, sizeof v->name) || !number(at, "valueReference", &reference) ||
        !attribute(at, "causality", v->causality, sizeof v->causality) ||
        !attribute(at, "variability", v->variability, sizeof v->variability))
        end("FAIL  a variable without name, reference, causality or variability: %.200s", at);
    v->reference = (fmi3ValueReference)reference;
    v->starts = number(at, "start", &v->start);
    v->has_min = number(at, "min", &v->min);
    v->has_max = number(at, "max", &v->max);
    if (!strcmp(v->causality, "output") && !strcmp(v->type, "Float64") && strcmp(v->name, "energy_residual"))
        m->output[m->n_outputs++] = v->reference;
}

static void read_description(struct importer *m, const char *folder)
{
    static char xml[XML];
    char path[512];
    snprintf(path, sizeof path, "%s/modelDescription.xml", folder);
    read_text(path, xml, sizeof xml);
    char *root = strstr(xml, "<fmiModelDescription"), *experiment = strstr(xml, "<DefaultExperiment"),
         *at = strstr(xml, "<ModelVariables>"), *stop = strstr(xml, "</ModelVariables>");
    if (!root || !attribute(root, "instantiationToken", m->token, sizeof m->token) || !experiment ||
        !number(experiment, "stepSize", &m->step_s) || !at || !stop)
        end("FAIL  %s has no token, default experiment or variables", path);
    for (at = strstr(at + 1, "<"); at < stop; at = strstr(at + 1, "<"))
        read_variable(m, at);
}

/* ---- the binary ---- */

void *importer_function(const char *name)
{
    static void *library;
    if (!library)
        library = dlopen(environment("FMU_BINARY"), RTLD_NOW | RTLD_LOCAL);
    if (!library)
        end("FAIL  %s", dlerror());
    void *function = dlsym(library, name);
    if (!function)
        end("FAIL  %s", dlerror());
    return function;
}

#define LOAD(name) m.name = (__typeof__(m.name))importer_function("fmi3" #name)

const struct importer *importer(void)
{
    static struct importer m;
    char path[512];
    if (m.n_variables)
        return &m;
    const char *folder = environment("FMU");
    snprintf(m.resources, sizeof m.resources, "%s/resources/", folder);
    snprintf(path, sizeof path, "%s/resources/scene.ini", folder);
    read_text(path, m.scene, sizeof m.scene);
    LOAD(GetVersion);
    LOAD(InstantiateCoSimulation);
    LOAD(FreeInstance);
    LOAD(EnterInitializationMode);
    LOAD(ExitInitializationMode);
    LOAD(Terminate);
    LOAD(Reset);
    LOAD(GetFloat64);
    LOAD(SetFloat64);
    LOAD(GetUInt64);
    LOAD(GetFMUState);
    LOAD(SetFMUState);
    LOAD(FreeFMUState);
    LOAD(SerializedFMUStateSize);
    LOAD(SerializeFMUState);
    LOAD(DeserializeFMUState);
    LOAD(DoStep);
    LOAD(EnterEventMode);
    LOAD(EnterStepMode);
    LOAD(UpdateDiscreteStates);
    LOAD(GetClock);
    LOAD(SetDebugLogging);
    read_description(&m, folder);
    return &m;
}

/* ---- calls ---- */

const struct variable *importer_variable(const char *name)
{
    const struct importer *m = importer();
    for (int i = 0; i < m->n_variables; i++)
        if (!strcmp(m->variable[i].name, name))
            return &m->variable[i];
    end("FAIL  modelDescription.xml has no variable %s", name);
}

static void note(fmi3InstanceEnvironment context, fmi3Status status, fmi3String category, fmi3String text)
{
    struct log *log = context;
    check_int("status in the log", status, fmi3Error);
    check_string("category", category, "error");
    log->n++;
    snprintf(log->text, sizeof log->text, "%s", text);
}

static fmi3Instance instantiate(struct log *log, bool event_mode, bool early_return)
{
    const struct importer *m = importer();
    log->n = 0;
    fmi3Instance instance = m->InstantiateCoSimulation("plant", m->token, m->resources, false, false,
                                                       event_mode, early_return, NULL, 0, log, note, NULL);
    if (!instance)
        end("FAIL  no instance: %s", log->text);
    return instance;
}

fmi3Instance importer_instantiate(struct log *log)
{
    return instantiate(log, false, false);
}

fmi3Instance importer_instantiate_events(struct log *log, bool early_return)
{
    return instantiate(log, true, early_return);
}

fmi3Instance importer_begin(struct log *log)
{
    const struct importer *m = importer();
    fmi3Instance instance = importer_instantiate(log);
    check_int("enter", m->EnterInitializationMode(instance, false, 0.0, 0.0, false, 0.0), fmi3OK);
    check_int("exit", m->ExitInitializationMode(instance), fmi3OK);
    return instance;
}

fmi3Status importer_set(fmi3Instance instance, const char *name, double value)
{
    return importer()->SetFloat64(instance, &importer_variable(name)->reference, 1, &value, 1);
}

double importer_get(fmi3Instance instance, const char *name)
{
    double value = (double)NAN;
    check_int(name, importer()->GetFloat64(instance, &importer_variable(name)->reference, 1, &value, 1),
              fmi3OK);
    return value;
}

fmi3Status importer_step(fmi3Instance instance, double current, double step)
{
    bool event = true, terminate = true, early = true;
    double last = 0.0;
    fmi3Status status = importer()->DoStep(instance, current, step, true, &event, &terminate, &early, &last);
    if (status == fmi3OK) {
        check_near("last successful time, s", last, current + step, 0.0);
        check_true("no event, no end, no early return", !event && !terminate && !early);
    }
    return status;
}

void importer_run(fmi3Instance instance, int n0, int n)
{
    double step = importer()->step_s;
    bool good = true;
    for (int i = n0; i < n0 + n; i++)
        good = importer_step(instance, i * step, step) == fmi3OK && good;
    check_true("every step", good);
}

struct contactplant *importer_plant(union contactplant_memory *memory)
{
    struct contactplant_error error;
    struct contactplant *p = contactplant_open(memory, sizeof *memory, environment("SCENE"), &error);
    if (!p)
        end("FAIL  %s", error.text);
    return p;
}

void importer_compare(const char *what, fmi3Instance instance, struct contactplant *plant)
{
    const struct importer *m = importer();
    double got[IMPORTER_OUTPUTS], wanted[IMPORTER_OUTPUTS], residual = contactplant_residual(plant);
    uint64_t switches = 0;
    size_t n = (size_t)m->n_outputs;
    check_int("outputs", m->n_outputs, contactplant_count(plant, CONTACTPLANT_OUTPUT));
    check_int("get", m->GetFloat64(instance, m->output, n, got, n), fmi3OK);
    check_int("all", contactplant_outputs(plant, wanted, m->n_outputs), CONTACTPLANT_OK);
    check_bytes(what, got, wanted, n * sizeof *got);
    check_int("get",
              m->GetUInt64(instance, &importer_variable("contact_switches")->reference, 1, &switches, 1),
              fmi3OK);
    check_int("contact switches", (int64_t)switches,
              (int64_t)contactplant_counter(plant, CONTACTPLANT_SWITCHES));
    got[0] = importer_get(instance, "energy_residual");
    check_bytes("energy residual", got, &residual, sizeof residual);
}

uint64_t importer_fingerprint(fmi3Instance instance)
{
    const struct importer *m = importer();
    fmi3FMUState state = NULL;
    size_t size = 0;
    uint64_t hash = 0xCBF29CE484222325u;
    check_int("state", m->GetFMUState(instance, &state), fmi3OK);
    check_int("size", m->SerializedFMUStateSize(instance, state, &size), fmi3OK);
    unsigned char *byte = malloc(size);
    check_int("bytes", m->SerializeFMUState(instance, state, byte, size), fmi3OK);
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ byte[i]) * 0x100000001B3u;
    free(byte);
    check_int("free", m->FreeFMUState(instance, &state), fmi3OK);
    check_true("freed", state == NULL);
    return hash;
}
