/* importer.h - a small importer of FMI 3.0: loads an unpacked FMU, reads its modelDescription.xml, calls it
 * as the standard's state machine says. The FMU is in folder $FMU, its binary $FMU_BINARY, its scene's name
 * $SCENE. */
#ifndef TESTS_IMPORTER_H
#define TESTS_IMPORTER_H

#define FMI3_OVERRIDE_FUNCTION_PREFIX
#include "host_sim/fmu/fmi3.h"
#include "host_sim/library/contactplant.h"

enum { IMPORTER_VARIABLES = 128, IMPORTER_OUTPUTS = 16, IMPORTER_TEXT = 1024, IMPORTER_SCENE = 65536 };

/* As modelDescription.xml has it. */
struct variable {
    char name[64], type[16], causality[16], variability[16];
    fmi3ValueReference reference;
    bool starts, has_min, has_max;
    double start, min, max;
};

/* The FMU's log. */
struct log {
    int n;
    char text[IMPORTER_TEXT];
};

#define FUNCTION(name) __typeof__(&FMI3(name)) name
struct importer {
    char token[64], resources[512];
    char scene[IMPORTER_SCENE]; /* the text in the resources */
    int n_variables, n_outputs;
    struct variable variable[IMPORTER_VARIABLES];
    fmi3ValueReference output[IMPORTER_OUTPUTS]; /* those of type Float64 that are outputs of the model */
    double step_s;                               /* step of the default experiment */
    FUNCTION(GetVersion);
    FUNCTION(InstantiateCoSimulation);
    FUNCTION(FreeInstance);
    FUNCTION(EnterInitializationMode);
    FUNCTION(ExitInitializationMode);
    FUNCTION(Terminate);
    FUNCTION(Reset);
    FUNCTION(GetFloat64);
    FUNCTION(SetFloat64);
    FUNCTION(GetUInt64);
    FUNCTION(GetFMUState);
    FUNCTION(SetFMUState);
    FUNCTION(FreeFMUState);
    FUNCTION(SerializedFMUStateSize);
    FUNCTION(SerializeFMUState);
    FUNCTION(DeserializeFMUState);
    FUNCTION(DoStep);
    FUNCTION(EnterEventMode);
    FUNCTION(EnterStepMode);
    FUNCTION(UpdateDiscreteStates);
    FUNCTION(GetClock);
    FUNCTION(SetDebugLogging);
};

/* The FMU, loaded at the first call; ends the program when there is none. */
const struct importer *importer(void);

/* A function by its name; ends the program when the binary has none. */
void *importer_function(const char *name);

/* The variable of this name; ends the program when there is none. */
const struct variable *importer_variable(const char *name);

/* An instance, one in event mode, and one in step mode from time 0. */
fmi3Instance importer_instantiate(struct log *log);
fmi3Instance importer_instantiate_events(struct log *log, bool early_return);
fmi3Instance importer_begin(struct log *log);

/* One value by its name. */
fmi3Status importer_set(fmi3Instance instance, const char *name, double value);
double importer_get(fmi3Instance instance, const char *name);

/* A step from `current`. */
fmi3Status importer_step(fmi3Instance instance, double current, double step);

/* n steps of the default experiment's size, the first one begins at n0 of them. */
void importer_run(fmi3Instance instance, int n0, int n);

/* The plant of the scene by its name, as the library opens it. */
struct contactplant *importer_plant(union contactplant_memory *memory);

/* The instance and the plant say the same, to the last bit: outputs, contact switches, residual. */
void importer_compare(const char *what, fmi3Instance instance, struct contactplant *plant);

/* A check of everything in the instance. */
uint64_t importer_fingerprint(fmi3Instance instance);

#endif
