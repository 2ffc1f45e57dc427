/* fmu.h - an instance of an FMU: a plant alone, behind the functions of FMI 3.0 for co-simulation. It needs a
 * heap and reads one file, its scene. */
#ifndef HOST_SIM_FMU_H
#define HOST_SIM_FMU_H

#include "host_sim/fmu/fmi3.h"
#include "host_sim/fmu/fmu_variables.h"

/* The states of the standard's machine that this FMU has; a set of them is a mask. */
enum fmu_mode {
    FMU_INSTANTIATED = 1,
    FMU_INITIALIZATION = 2,
    FMU_STEP = 4,
    FMU_TERMINATED = 8,
    FMU_EVENT = 16,
    FMU_BEFORE = FMU_INSTANTIATED | FMU_INITIALIZATION,
    FMU_RUNS = FMU_STEP | FMU_EVENT,
    FMU_ANY = FMU_BEFORE | FMU_RUNS | FMU_TERMINATED
};

/* An instance knows this beside its plant. */
struct fmu_run {
    int32_t mode;
    int16_t stops;   /* stop_s counts */
    int16_t contact; /* the clock of this name ticks now */
    double start_s;  /* the importer's time where plant time is 0 */
    double stop_s, last_s;
    double sample[MODEL_INPUTS]; /* as they were set */
    double drive[MODEL_INPUTS][FMU_DRIVE_FIELDS];
};

struct fmu {
    struct contactplant *plant;
    struct fmu_run run;
    char *scene; /* its text */
    bool event_mode;
    struct contactplant *begin; /* a copy of the plant where a step began; NULL: no step ends early */
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
    union contactplant_memory memory;
};

/* The instance, where `function` is allowed in its mode; NULL, and the reason in the log, where not. */
struct fmu *fmu_begin(fmi3Instance instance, const char *function, int modes);

/* Says why in the log; fmi3Error. */
fmi3Status fmu_fail(const struct fmu *f, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
