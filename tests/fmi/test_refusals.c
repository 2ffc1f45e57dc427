/* test_refusals.c - an FMU of hertz_rig in wrong hands: each
 * call is an error with one text, and the instance is as it was. */
#include "tests/fmi/importer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "tests/unit/test.h"

/* A call that must be refused: its status, the instance before and after, and a part of the text. */
#define REFUSED(instance, log, call, part)                                                                   \
    do {                                                                                                     \
        uint64_t before_ = importer_fingerprint(instance);                                                   \
        int texts_ = (log).n;                                                                                \
        check_int(#call, call, fmi3Error);                                                                   \
        check_int("texts in the log", (log).n, texts_ + 1);                                                  \
        check_contains("text", (log).text, part);                                                            \
        check_hex("nothing has changed", importer_fingerprint(instance), before_);                           \
    } while (0)

static fmi3Status get(fmi3Instance instance, fmi3ValueReference reference)
{
    double value;
    return importer()->GetFloat64(instance, &reference, 1, &value, 1);
}

static fmi3Status set(fmi3Instance instance, fmi3ValueReference reference, double value)
{
    return importer()->SetFloat64(instance, &reference, 1, &value, 1);
}

TEST(rig_values_refused)
{
    const struct importer *m = importer();
    struct log log;
    double value[2] = {1.0, (double)NAN};
    fmi3Instance instance = importer_begin(&log);
    importer_run(instance, 0, 20);
    REFUSED(instance, log, importer_set(instance, "force", (double)NAN), "force: the value is not finite");
    REFUSED(instance, log, importer_set(instance, "force", (double)INFINITY), "not finite");
    REFUSED(instance, log, importer_set(instance, "force", 1e300), "out of range");
    REFUSED(instance, log, importer_set(instance, "mass_kg", (double)NAN), "not finite");
    REFUSED(instance, log, importer_set(instance, "mass_kg", 0.0),
            "mass_kg=0 is out of range; give 1e-09 to");
    REFUSED(instance, log, importer_set(instance, "drive.force.amplitude", 1e300), "out of range");
    REFUSED(instance, log, importer_set(instance, "drive.force.frequency", -1.0), "out of range");
    REFUSED(instance, log, importer_set(instance, "drive.force.frequency", 1e6), "out of range");
    REFUSED(instance, log, importer_set(instance, "drive.force.phase", 1e7), "out of range");
    REFUSED(instance, log, importer_set(instance, "drive.force.ramp", -1.0), "out of range");
    REFUSED(instance, log, importer_set(instance, "penetration", 0.0), "computed and cannot be set");
    REFUSED(instance, log, importer_set(instance, "time", 0.0), "computed and cannot be set");
    REFUSED(instance, log, importer_set(instance, "contact_switches", 0.0), "computed and cannot be set");
    REFUSED(instance, log, set(instance, 77777, 0.0), "no variable has the value reference 77777");
    REFUSED(instance, log, set(instance, UINT32_MAX, 0.0), "no variable has the value reference");
    REFUSED(instance, log, get(instance, 255), "no variable has the value reference 255");
    REFUSED(instance, log, get(instance, importer_variable("contact_switches")->reference), "fmi3GetUInt64");
    /* all of a call or nothing */
    fmi3ValueReference two[2] = {importer_variable("force")->reference, importer_variable("base")->reference};
    REFUSED(instance, log, m->SetFloat64(instance, two, 2, value, 2), "base: the value is not finite");
    value[1] = 1e300;
    REFUSED(instance, log, m->SetFloat64(instance, two, 2, value, 2), "out of range");
    two[0] = importer_variable("mass_kg")->reference;
    two[1] = importer_variable("drive.force.amplitude")->reference;
    value[0] = 7.0;
    REFUSED(instance, log, m->SetFloat64(instance, two, 2, value, 2), "out of range");
    REFUSED(instance, log, m->SetFloat64(instance, two, 2, value, 1), "2 references with 1 values");
    REFUSED(instance, log, m->SetFloat64(instance, NULL, 1, value, 1), "NULL");
    REFUSED(instance, log, m->GetFloat64(instance, two, 1, NULL, 1), "NULL");
    m->FreeInstance(instance);
    /* before the first step numbers are checked the same way */
    instance = importer_instantiate(&log);
    REFUSED(instance, log, importer_set(instance, "mass_kg", -1.0), "out of range");
    REFUSED(instance, log, importer_set(instance, "drive.force.amplitude", 1e300), "out of range");
    REFUSED(instance, log, importer_set(instance, "base", 1e300), "out of range");
    REFUSED(instance, log, m->SetFloat64(instance, two, 2, value, 2), "out of range");
    two[0] = importer_variable("drive.force.amplitude")->reference;
    two[1] = importer_variable("base")->reference;
    REFUSED(instance, log, m->SetFloat64(instance, two, 2, value, 2), "out of range");
    m->FreeInstance(instance);
}

TEST(rig_time_refused)
{
    const struct importer *m = importer();
    struct log log;
    bool flag;
    fmi3Instance instance = importer_begin(&log);
    double t = 20 * m->step_s, nan = (double)NAN;
    importer_run(instance, 0, 20);
    REFUSED(instance, log, importer_step(instance, t - m->step_s, m->step_s), "time runs backwards");
    REFUSED(instance, log, importer_step(instance, 0.0, 2 * t), "time runs backwards");
    REFUSED(instance, log, importer_step(instance, t + m->step_s, m->step_s), "a gap in time");
    REFUSED(instance, log, importer_step(instance, t, 0.0), "not above 0");
    REFUSED(instance, log, importer_step(instance, t, -m->step_s), "not above 0");
    REFUSED(instance, log, importer_step(instance, nan, m->step_s), "not finite");
    REFUSED(instance, log, importer_step(instance, t, nan), "not finite");
    REFUSED(instance, log, importer_step(instance, t, (double)INFINITY), "not finite");
    REFUSED(instance, log, importer_step(instance, t, 1e300), "out of range");
    REFUSED(instance, log, m->DoStep(instance, t, m->step_s, true, &flag, &flag, &flag, NULL), "NULL");
    importer_run(instance, 20, 1);
    m->FreeInstance(instance);
    instance = importer_instantiate(&log);
    REFUSED(instance, log, m->EnterInitializationMode(instance, false, 0.0, nan, false, 0.0), "not finite");
    REFUSED(instance, log, m->EnterInitializationMode(instance, false, 0.0, 1.0, true, 1.0), "stop time");
    REFUSED(instance, log, m->EnterInitializationMode(instance, false, 0.0, 1.0, true, nan), "stop time");
    check_int("enter", m->EnterInitializationMode(instance, false, 0.0, 0.0, true, t), fmi3OK);
    check_int("exit", m->ExitInitializationMode(instance), fmi3OK);
    importer_run(instance, 0, 20);
    REFUSED(instance, log, importer_step(instance, t, m->step_s), "beyond the stop time");
    m->FreeInstance(instance);
}

TEST(rig_order_refused)
{
    const struct importer *m = importer();
    struct log log;
    fmi3Instance instance = importer_instantiate(&log);
    REFUSED(instance, log, importer_step(instance, 0.0, 1e-3),
            "fmi3DoStep is not allowed now: the instance is instantiated");
    REFUSED(instance, log, m->ExitInitializationMode(instance), "fmi3ExitInitializationMode is not allowed");
    REFUSED(instance, log, m->Terminate(instance), "fmi3Terminate is not allowed");
    check_int("enter", m->EnterInitializationMode(instance, false, 0.0, 0.0, false, 0.0), fmi3OK);
    REFUSED(instance, log, m->EnterInitializationMode(instance, false, 0.0, 0.0, false, 0.0),
            "in initialization");
    REFUSED(instance, log, importer_step(instance, 0.0, 1e-3), "in initialization mode");
    check_int("exit", m->ExitInitializationMode(instance), fmi3OK);
    REFUSED(instance, log, m->ExitInitializationMode(instance), "in step mode");
    check_int("end", m->Terminate(instance), fmi3OK);
    REFUSED(instance, log, importer_step(instance, 0.0, 1e-3), "terminated");
    REFUSED(instance, log, importer_set(instance, "force", 1.0), "terminated");
    REFUSED(instance, log, m->Terminate(instance), "terminated");
    check_int("reset", m->Reset(instance), fmi3OK);
    m->FreeInstance(instance);
    m->FreeInstance(NULL);
    check_int("no instance", m->Terminate(NULL), fmi3Error);
    check_int("no instance", importer_step(NULL, 0.0, 1e-3), fmi3Error);
    check_int("no instance", importer_set(NULL, "force", 0.0), fmi3Error);
}

static void note(fmi3InstanceEnvironment context, fmi3Status status, fmi3String category, fmi3String text)
{
    struct log *log = context;
    (void)status, (void)category;
    log->n++;
    snprintf(log->text, sizeof log->text, "%s", text);
}

/* No instance, and the reason. */
static void refuse_instance(const char *token, const char *resources, bool event_mode, size_t n,
                            const char *part)
{
    const struct importer *m = importer();
    struct log log = {.n = 0};
    fmi3ValueReference first = 512;
    check_true("no instance", !m->InstantiateCoSimulation("plant", token, resources, false, true, event_mode,
                                                          false, &first, n, &log, note, NULL));
    check_int("texts in the log", log.n, 1);
    check_contains("text", log.text, part);
    check_true("no log, no instance",
               !m->InstantiateCoSimulation("plant", token, resources, false, true, event_mode, false, &first,
                                           n, NULL, NULL, NULL));
}

TEST(rig_instance_refused)
{
    const struct importer *m = importer();
    struct log log = {.n = 0};
    refuse_instance("{wrong}", m->resources, false, 0, "instantiationToken {wrong}, but");
    refuse_instance("", m->resources, false, 0, "take modelDescription.xml");
    refuse_instance(NULL, m->resources, false, 0, "instantiationToken (NULL)");
    refuse_instance(m->token, "/nowhere/", false, 0, "cannot read /nowhere/scene.ini");
    refuse_instance(m->token, "", false, 0, "path of the resources is missing");
    refuse_instance(m->token, NULL, false, 0, "path of the resources is missing");
    refuse_instance(m->token, m->resources, true, 1, "no intermediate variables");
    refuse_instance(m->token, m->resources, false, 1, "no intermediate variables");
    __typeof__(&FMI3(InstantiateModelExchange)) exchange =
        (__typeof__(exchange))importer_function("fmi3InstantiateModelExchange");
    __typeof__(&FMI3(InstantiateScheduledExecution)) scheduled =
        (__typeof__(scheduled))importer_function("fmi3InstantiateScheduledExecution");
    check_true("none", !exchange("plant", m->token, m->resources, false, false, &log, note));
    check_contains("text", log.text, "for co-simulation only");
    check_true("none",
               !scheduled("plant", m->token, m->resources, false, false, &log, note, NULL, NULL, NULL));
    check_int("texts in the log", log.n, 2);
}

TEST(rig_state_refused)
{
    const struct importer *m = importer();
    struct log log;
    fmi3Instance instance = importer_begin(&log);
    fmi3FMUState state = NULL, other = NULL;
    size_t size = 0;
    importer_run(instance, 0, 10);
    check_int("get", m->GetFMUState(instance, &state), fmi3OK);
    check_int("size", m->SerializedFMUStateSize(instance, state, &size), fmi3OK);
    uint8_t *byte = malloc(size);
    check_int("bytes", m->SerializeFMUState(instance, state, byte, size), fmi3OK);
    REFUSED(instance, log, m->SetFMUState(instance, NULL), "no state of an instance");
    REFUSED(instance, log, m->GetFMUState(instance, NULL), "NULL");
    REFUSED(instance, log, m->SerializedFMUStateSize(instance, NULL, &size), "NULL");
    REFUSED(instance, log, m->SerializeFMUState(instance, state, byte, size - 1), "room for its");
    REFUSED(instance, log, m->DeserializeFMUState(instance, NULL, size, &other), "NULL");
    REFUSED(instance, log, m->DeserializeFMUState(instance, byte, 3, &other), "3 bytes are no state");
    REFUSED(instance, log, m->DeserializeFMUState(instance, byte, size - 1, &other), "no state of this FMU");
    for (size_t i = 0; i < size; i += i < 256 ? 1 : 4099) { /* each byte of the header, some of the plant */
        fmi3Status status;
        int texts = log.n;
        byte[i] ^= 0x40;
        status = m->DeserializeFMUState(instance, byte, size, &other);
        if (status == fmi3OK)
            status = m->SetFMUState(instance, other);
        check_int("a damaged byte", status, fmi3Error);
        check_int("texts in the log", log.n, texts + 1);
        check_int("free", m->FreeFMUState(instance, &other), fmi3OK);
        byte[i] ^= 0x40;
    }
    check_int("the bytes are good", m->DeserializeFMUState(instance, byte, size, &other), fmi3OK);
    check_int("the state is good", m->SetFMUState(instance, other), fmi3OK);
    check_int("free", m->FreeFMUState(instance, &other), fmi3OK);
    check_int("free", m->FreeFMUState(instance, &state), fmi3OK);
    check_int("free nothing", m->FreeFMUState(instance, &state), fmi3OK);
    free(byte);
    m->FreeInstance(instance);
}

/* Functions that this FMU does not offer. */
TEST(rig_functions_refused)
{
    static const char *const name[] = {"EnterEventMode",         "EnterStepMode",
                                       "EnterConfigurationMode", "ExitConfigurationMode",
                                       "EvaluateDiscreteStates", "EnterContinuousTimeMode"};
    static const char *const type[] = {"Float32", "Int8",   "UInt8", "Int16",   "UInt16",
                                       "Int32",   "UInt32", "Int64", "Boolean", "String"};
    struct log log;
    char function[64];
    uint64_t value = 0;
    fmi3ValueReference reference = 512;
    fmi3Instance instance = importer_begin(&log);
    for (size_t i = 0; i < sizeof name / sizeof name[0]; i++) {
        snprintf(function, sizeof function, "fmi3%s", name[i]);
        __typeof__(&FMI3(Terminate)) call = (__typeof__(call))importer_function(function);
        REFUSED(instance, log, call(instance), function);
    }
    for (size_t i = 0; i < 2 * sizeof type / sizeof type[0]; i++) {
        snprintf(function, sizeof function, "fmi3%s%s", i % 2 ? "Set" : "Get", type[i / 2]);
        __typeof__(&FMI3(GetUInt64)) call = (__typeof__(call))importer_function(function);
        REFUSED(instance, log, call(instance, &reference, 1, &value, 1),
                "this FMU has no variable of this type");
    }
    importer()->FreeInstance(instance);
}

/* ---- any call with any value ---- */

static uint64_t dice(uint64_t *seed)
{
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    return *seed;
}

/* A number of the ordinary, the extreme or none at all. */
static double any_number(uint64_t *seed)
{
    static const double table[] = {0.0, 1.0, -1.0, 1e-9, 1e-3,  0.5,    20.0,
                                   1e3, 1e9, 1e18, -1e6, 1e300, -1e300, 5e-324};
    uint64_t n = dice(seed) % 18;
    return n < 14    ? table[n]
           : n == 14 ? (double)NAN
           : n == 15 ? -(double)INFINITY
                     : (double)(dice(seed) % 2000000) * 1e-3 - 1e3;
}

static void any_call(fmi3Instance instance, fmi3FMUState *state, double *time, uint64_t *seed)
{
    const struct importer *m = importer();
    fmi3ValueReference reference[3];
    double value[3];
    bool flag, clock[3];
    size_t n = 1 + dice(seed) % 3;
    for (int i = 0; i < 3; i++) {
        uint64_t k = dice(seed) % (uint64_t)(m->n_variables + 2);
        reference[i] =
            k < (uint64_t)m->n_variables ? m->variable[k].reference : (fmi3ValueReference)dice(seed);
        value[i] = any_number(seed);
    }
    switch (dice(seed) % 16) {
    case 0:
        (void)m->Reset(instance);
        *time = 0.0;
        break;
    case 1:
        (void)m->EnterInitializationMode(instance, false, 0.0, dice(seed) % 2 ? 0.0 : value[0], false, 0.0);
        break;
    case 2:
    case 3:
        (void)m->ExitInitializationMode(instance);
        break;
    case 4:
        (void)m->GetFMUState(instance, state);
        break;
    case 5:
        (void)(*state && m->SetFMUState(instance, *state));
        break;
    case 6:
        (void)m->GetFloat64(instance, reference, n, value, n);
        break;
    case 7:
        (void)m->DoStep(instance, value[0], value[1] < 1.0 ? value[1] : 0.01, true, &flag, &flag, &flag,
                        &value[2]);
        break;
    case 8:
        (void)m->EnterEventMode(instance);
        break;
    case 9:
        (void)m->EnterStepMode(instance);
        (void)m->GetClock(instance, reference, n, clock);
        break;
    case 10:
        (void)m->UpdateDiscreteStates(instance, &flag, &flag, &flag, &flag, &flag, value);
        break;
    case 11:
    case 12:
    case 13:
        (void)m->DoStep(instance, importer_get(instance, "time"), 1e-5 * (double)(1 + dice(seed) % 400), true,
                        &flag, &flag, &flag, time);
        break;
    default:
        (void)m->SetFloat64(instance, reference, n, value, n);
        break;
    }
}

/* No NaN and no crash comes of it, and a reset leaves nothing of it. */
static void any_calls(bool event_mode, bool early_return)
{
    const struct importer *m = importer();
    struct log log = {.n = 0};
    uint64_t seed = 0x9E3779B97F4A7C15u;
    double time = 0.0, value[IMPORTER_OUTPUTS];
    fmi3FMUState state = NULL;
    fmi3Instance instance = m->InstantiateCoSimulation("plant", m->token, m->resources, false, false,
                                                       event_mode, early_return, NULL, 0, &log, note, NULL);
    check_true("an instance", instance != NULL);
    uint64_t fresh = importer_fingerprint(instance);
    bool finite = true;
    for (int i = 0; i < 4000; i++) {
        any_call(instance, &state, &time, &seed);
        size_t n = (size_t)m->n_outputs;
        finite = m->GetFloat64(instance, m->output, n, value, n) == fmi3OK && finite;
        for (size_t k = 0; k < n; k++)
            finite = finite && isfinite(value[k]);
    }
    check_true("outputs are finite", finite);
    check_above("calls that were refused", log.n, 500.0);
    check_int("reset", m->Reset(instance), fmi3OK);
    check_hex("as if new", importer_fingerprint(instance), fresh);
    check_int("free", m->FreeFMUState(instance, &state), fmi3OK);
    m->FreeInstance(instance);
}

TEST(rig_any_call)
{
    any_calls(false, false);
    any_calls(true, false);
    any_calls(true, true);
}
