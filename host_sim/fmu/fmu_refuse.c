/* fmu_refuse.c - functions of FMI 3.0 that this FMU must have and does not offer: modelDescription.xml
 * says so, and a call is an error. */
#include "host_sim/fmu/fmu.h"

/* Each function has the arguments that the standard gives it, and looks at none but the instance. */
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

const char *FMI3(GetVersion)(void)
{
    return "3.0";
}

/* Errors are always told, and there is nothing else to tell. */
fmi3Status FMI3(SetDebugLogging)(fmi3Instance instance, fmi3Boolean on, size_t n, const fmi3String category[])
{
    return fmu_begin(instance, "fmi3SetDebugLogging", FMU_ANY) ? fmi3OK : fmi3Error;
}

static fmi3Instance no_instance(fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    if (log)
        log(environment, fmi3Error, "error",
            "this FMU is for co-simulation only: fmi3InstantiateCoSimulation");
    return NULL;
}

fmi3Instance FMI3(InstantiateModelExchange)(fmi3String name, fmi3String token, fmi3String resources,
                                            fmi3Boolean visible, fmi3Boolean logging,
                                            fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    return no_instance(environment, log);
}

fmi3Instance FMI3(InstantiateScheduledExecution)(fmi3String name, fmi3String token, fmi3String resources,
                                                 fmi3Boolean visible, fmi3Boolean logging,
                                                 fmi3InstanceEnvironment environment,
                                                 fmi3LogMessageCallback log, fmi3ClockUpdateCallback update,
                                                 fmi3LockPreemptionCallback lock,
                                                 fmi3UnlockPreemptionCallback unlock)
{
    return no_instance(environment, log);
}

/* A function with these arguments, the instance first, which is refused because of `why`. */
#define REFUSE(name, why, ...)                                                                               \
    FMI3_EXPORT fmi3Status FMI3(name)(__VA_ARGS__);                                                          \
    fmi3Status FMI3(name)(__VA_ARGS__)                                                                       \
    {                                                                                                        \
        const struct fmu *f = fmu_begin(instance, "fmi3" #name, FMU_ANY);                                    \
        return f ? fmu_fail(f, "fmi3" #name ": this FMU has " why) : fmi3Error;                              \
    }

#define INSTANCE   fmi3Instance instance
#define REFERENCES INSTANCE, const fmi3ValueReference reference[], size_t n_references

#define REFUSE_VALUES(type)                                                                                  \
    REFUSE(Get##type, "no variable of this type", REFERENCES, fmi3##type value[], size_t n_values)           \
    REFUSE(Set##type, "no variable of this type", REFERENCES, const fmi3##type value[], size_t n_values)

REFUSE_VALUES(Float32)
REFUSE_VALUES(Int8)
REFUSE_VALUES(UInt8)
REFUSE_VALUES(Int16)
REFUSE_VALUES(UInt16)
REFUSE_VALUES(Int32)
REFUSE_VALUES(UInt32)
REFUSE_VALUES(Int64)
REFUSE_VALUES(Boolean)
REFUSE_VALUES(String)
REFUSE(SetUInt64, "no variable of this type that can be set", REFERENCES, const fmi3UInt64 value[],
       size_t n_values)
REFUSE(GetBinary, "no variable of this type", REFERENCES, size_t size[], fmi3Binary value[], size_t n_values)
REFUSE(SetBinary, "no variable of this type", REFERENCES, const size_t size[], const fmi3Binary value[],
       size_t n_values)

REFUSE(SetClock, "no clock that can be set", REFERENCES, const fmi3Clock value[])
#define NO_CLOCK "no clock with an interval"
REFUSE(GetIntervalDecimal, NO_CLOCK, REFERENCES, fmi3Float64 interval[], fmi3IntervalQualifier qualifier[])
REFUSE(GetIntervalFraction, NO_CLOCK, REFERENCES, fmi3UInt64 counter[], fmi3UInt64 resolution[],
       fmi3IntervalQualifier qualifier[])
REFUSE(GetShiftDecimal, NO_CLOCK, REFERENCES, fmi3Float64 shift[])
REFUSE(GetShiftFraction, NO_CLOCK, REFERENCES, fmi3UInt64 counter[], fmi3UInt64 resolution[])
REFUSE(SetIntervalDecimal, NO_CLOCK, REFERENCES, const fmi3Float64 interval[])
REFUSE(SetIntervalFraction, NO_CLOCK, REFERENCES, const fmi3UInt64 counter[], const fmi3UInt64 resolution[])
REFUSE(SetShiftDecimal, NO_CLOCK, REFERENCES, const fmi3Float64 shift[])
REFUSE(SetShiftFraction, NO_CLOCK, REFERENCES, const fmi3UInt64 counter[], const fmi3UInt64 resolution[])
REFUSE(ActivateModelPartition, "no model partitions", INSTANCE, fmi3ValueReference clock, fmi3Float64 time)

REFUSE(EnterConfigurationMode, "no structural parameters", INSTANCE)
REFUSE(ExitConfigurationMode, "no structural parameters", INSTANCE)

#define NO_DERIVATIVES "no derivatives"
REFUSE(GetDirectionalDerivative, NO_DERIVATIVES, INSTANCE, const fmi3ValueReference unknown[],
       size_t n_unknowns, const fmi3ValueReference known[], size_t n_knowns, const fmi3Float64 seed[],
       size_t n_seeds, fmi3Float64 sensitivity[], size_t n_sensitivities)
REFUSE(GetAdjointDerivative, NO_DERIVATIVES, INSTANCE, const fmi3ValueReference unknown[], size_t n_unknowns,
       const fmi3ValueReference known[], size_t n_knowns, const fmi3Float64 seed[], size_t n_seeds,
       fmi3Float64 sensitivity[], size_t n_sensitivities)
REFUSE(GetOutputDerivatives, NO_DERIVATIVES, REFERENCES, const fmi3Int32 order[], fmi3Float64 value[],
       size_t n_values)

#define NO_DEPENDENCIES "no dependencies of elements"
REFUSE(GetNumberOfVariableDependencies, NO_DEPENDENCIES, INSTANCE, fmi3ValueReference reference, size_t *n)
REFUSE(GetVariableDependencies, NO_DEPENDENCIES, INSTANCE, fmi3ValueReference dependent,
       size_t dependent_element[], fmi3ValueReference independent[], size_t independent_element[],
       fmi3DependencyKind kind[], size_t n)

#define NO_MODEL_EXCHANGE "no model exchange"
REFUSE(EnterContinuousTimeMode, NO_MODEL_EXCHANGE, INSTANCE)
REFUSE(CompletedIntegratorStep, NO_MODEL_EXCHANGE, INSTANCE, fmi3Boolean no_set_state_before,
       fmi3Boolean *enter_event_mode, fmi3Boolean *terminate)
REFUSE(SetTime, NO_MODEL_EXCHANGE, INSTANCE, fmi3Float64 time)
REFUSE(SetContinuousStates, NO_MODEL_EXCHANGE, INSTANCE, const fmi3Float64 state[], size_t n)
REFUSE(GetContinuousStateDerivatives, NO_MODEL_EXCHANGE, INSTANCE, fmi3Float64 derivative[], size_t n)
REFUSE(GetEventIndicators, NO_MODEL_EXCHANGE, INSTANCE, fmi3Float64 indicator[], size_t n)
REFUSE(GetContinuousStates, NO_MODEL_EXCHANGE, INSTANCE, fmi3Float64 state[], size_t n)
REFUSE(GetNominalsOfContinuousStates, NO_MODEL_EXCHANGE, INSTANCE, fmi3Float64 nominal[], size_t n)
REFUSE(GetNumberOfEventIndicators, NO_MODEL_EXCHANGE, INSTANCE, size_t *n)
REFUSE(GetNumberOfContinuousStates, NO_MODEL_EXCHANGE, INSTANCE, size_t *n)

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
