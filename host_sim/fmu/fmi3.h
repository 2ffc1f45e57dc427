/* fmi3.h - types and functions of FMI 3.0 (fmi-standard.org), declared for this project: an importer finds
 * them by these names and calls them with these arguments. The standard says what each one does. Functions
 * that are refused whatever their arguments are in fmu_refuse.c alone.
 *
 * In a shared library the names are the standard's. In sources they begin with FMI3_FUNCTION_PREFIX, so
 * that FMUs of several models can be linked together, unless the compiler's flags define
 * FMI3_OVERRIDE_FUNCTION_PREFIX; then with FMI3_ACTUAL_FUNCTION_PREFIX or nothing. */
#ifndef HOST_SIM_FMI3_H
#define HOST_SIM_FMI3_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if !defined(FMI3_OVERRIDE_FUNCTION_PREFIX)
#define FMI3_ACTUAL_FUNCTION_PREFIX contactplant_
#endif
#if defined(FMI3_ACTUAL_FUNCTION_PREFIX)
#define FMI3_PASTE(a, b) a##b
#define FMI3_JOIN(a, b)  FMI3_PASTE(a, b)
#define FMI3(name)       FMI3_JOIN(FMI3_ACTUAL_FUNCTION_PREFIX, fmi3##name)
#else
#define FMI3(name) fmi3##name
#endif
#if defined(__GNUC__)
#define FMI3_EXPORT __attribute__((visibility("default")))
#else
#define FMI3_EXPORT
#endif

/* ---- types ---- */

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef bool fmi3Clock;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const uint8_t *fmi3Binary;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;

typedef enum {
    fmi3Independent,
    fmi3Constant,
    fmi3Fixed,
    fmi3Tunable,
    fmi3Discrete,
    fmi3Dependent
} fmi3DependencyKind;

typedef enum { fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged } fmi3IntervalQualifier;

typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String category,
                                       fmi3String message);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, fmi3Float64 time,
                                               fmi3Boolean set_requested, fmi3Boolean get_allowed,
                                               fmi3Boolean step_finished, fmi3Boolean can_return_early,
                                               fmi3Boolean *early_return_requested,
                                               fmi3Float64 *early_return_time);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);

/* ---- instances and modes ---- */

FMI3_EXPORT const char *FMI3(GetVersion)(void);
FMI3_EXPORT fmi3Status FMI3(SetDebugLogging)(fmi3Instance instance, fmi3Boolean on, size_t n,
                                             const fmi3String category[]);
FMI3_EXPORT fmi3Instance FMI3(InstantiateModelExchange)(fmi3String name, fmi3String token,
                                                        fmi3String resources, fmi3Boolean visible,
                                                        fmi3Boolean logging,
                                                        fmi3InstanceEnvironment environment,
                                                        fmi3LogMessageCallback log);
FMI3_EXPORT fmi3Instance FMI3(InstantiateCoSimulation)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3Boolean event_mode, fmi3Boolean early_return, const fmi3ValueReference intermediate[],
    size_t n_intermediate, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update);
FMI3_EXPORT fmi3Instance FMI3(InstantiateScheduledExecution)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback update,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock);
FMI3_EXPORT void FMI3(FreeInstance)(fmi3Instance instance);
FMI3_EXPORT fmi3Status FMI3(EnterInitializationMode)(fmi3Instance instance, fmi3Boolean has_tolerance,
                                                     fmi3Float64 tolerance, fmi3Float64 start,
                                                     fmi3Boolean has_stop, fmi3Float64 stop);
FMI3_EXPORT fmi3Status FMI3(ExitInitializationMode)(fmi3Instance instance);
FMI3_EXPORT fmi3Status FMI3(Terminate)(fmi3Instance instance);
FMI3_EXPORT fmi3Status FMI3(Reset)(fmi3Instance instance);

/* ---- values ---- */

FMI3_EXPORT fmi3Status FMI3(GetFloat64)(fmi3Instance instance, const fmi3ValueReference reference[],
                                        size_t n_references, fmi3Float64 value[], size_t n_values);
FMI3_EXPORT fmi3Status FMI3(SetFloat64)(fmi3Instance instance, const fmi3ValueReference reference[],
                                        size_t n_references, const fmi3Float64 value[], size_t n_values);
FMI3_EXPORT fmi3Status FMI3(GetUInt64)(fmi3Instance instance, const fmi3ValueReference reference[],
                                       size_t n_references, fmi3UInt64 value[], size_t n_values);

/* ---- the state of an instance ---- */

FMI3_EXPORT fmi3Status FMI3(GetFMUState)(fmi3Instance instance, fmi3FMUState *state);
FMI3_EXPORT fmi3Status FMI3(SetFMUState)(fmi3Instance instance, fmi3FMUState state);
FMI3_EXPORT fmi3Status FMI3(FreeFMUState)(fmi3Instance instance, fmi3FMUState *state);
FMI3_EXPORT fmi3Status FMI3(SerializedFMUStateSize)(fmi3Instance instance, fmi3FMUState state, size_t *size);
FMI3_EXPORT fmi3Status FMI3(SerializeFMUState)(fmi3Instance instance, fmi3FMUState state, fmi3Byte byte[],
                                               size_t size);
FMI3_EXPORT fmi3Status FMI3(DeserializeFMUState)(fmi3Instance instance, const fmi3Byte byte[], size_t size,
                                                 fmi3FMUState *state);

/* ---- co-simulation ---- */

FMI3_EXPORT fmi3Status FMI3(DoStep)(fmi3Instance instance, fmi3Float64 current, fmi3Float64 step,
                                    fmi3Boolean no_set_state_before, fmi3Boolean *event_handling_needed,
                                    fmi3Boolean *terminate, fmi3Boolean *early_return,
                                    fmi3Float64 *last_successful_time);

/* ---- event mode ---- */

FMI3_EXPORT fmi3Status FMI3(EnterEventMode)(fmi3Instance instance);
FMI3_EXPORT fmi3Status FMI3(EnterStepMode)(fmi3Instance instance);
FMI3_EXPORT fmi3Status FMI3(EvaluateDiscreteStates)(fmi3Instance instance);
FMI3_EXPORT fmi3Status FMI3(UpdateDiscreteStates)(fmi3Instance instance, fmi3Boolean *need_update,
                                                  fmi3Boolean *terminate, fmi3Boolean *nominals_changed,
                                                  fmi3Boolean *values_changed,
                                                  fmi3Boolean *next_event_time_defined,
                                                  fmi3Float64 *next_event_time);
FMI3_EXPORT fmi3Status FMI3(GetClock)(fmi3Instance instance, const fmi3ValueReference reference[],
                                      size_t n_references, fmi3Clock value[]);

#endif
