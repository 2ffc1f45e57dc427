/* lanes.h - one number for each of several ticks, or of several plants, side by side.
 *
 * Texts that serve one and several (models/flows_text.h, firmware/method/rk4_text.h) are written with `real`,
 * and with names in REAL(). They are included with real as double, as `real_lanes` for TICK_LANES ticks of
 * one plant, and as `real_beside` for PLANT_LANES plants. `number` is what belongs to a plant: double, but
 * for several plants `real_beside`; NUMBER() goes with it. All operations go lane by lane, so a lane has the
 * bits of a double. TICK_LANES is 1 where the processor has no such registers: then there is one copy. */
#ifndef MODELS_LANES_H
#define MODELS_LANES_H

#include "models/check.h"
#include "models/model.h"

/* 0 where x is not positive, or not negative; the larger of two. */
ALWAYS_INLINE double real_positive(double x)
{
    return x > 0.0 ? x : 0.0;
}

ALWAYS_INLINE double real_negative(double x)
{
    return x < 0.0 ? x : 0.0;
}

ALWAYS_INLINE double real_larger(double a, double b)
{
    return a > b ? a : b;
}

#if defined(__SSE2__) && !defined(__FRAMAC__)
#define TICK_LANES 2
#ifdef __AVX2__
#define PLANT_LANES       4
#define BESIDE_BUILTIN(f) __builtin_ia32_##f##256
#define OF_EACH(a, field) ((real_beside){(a)[0].field, (a)[1].field, (a)[2].field, (a)[3].field})
#else
#define PLANT_LANES       2
#define BESIDE_BUILTIN(f) __builtin_ia32_##f
#define OF_EACH(a, field)                                                                                    \
    ((real_beside){(a)[0].field, (a)[1].field}) /* a field of each of PLANT_LANES structs */
#endif

typedef double lanes_in_memory
    __attribute__((vector_size(16), aligned(8), may_alias)); /* two doubles in a row */

/* Types and operations for n numbers, with this name behind theirs; input and flow as those of model.h. */
#define LANES(name, n, builtin)                                                                              \
    typedef double real_##name __attribute__((vector_size(8 * (n))));                                        \
    typedef long long mask_##name __attribute__((vector_size(8 * (n))));                                     \
    struct input_##name {                                                                                    \
        real_##name value, rate;                                                                             \
    };                                                                                                       \
    struct flow_##name {                                                                                     \
        real_##name x_dot[MODEL_STATES], work[MODEL_INPUTS], damping, force;                                 \
    };                                                                                                       \
    ALWAYS_INLINE real_##name real_positive_##name(real_##name x)                                            \
    {                                                                                                        \
        return builtin(maxpd)(x, (real_##name){0.0});                                                        \
    }                                                                                                        \
    ALWAYS_INLINE real_##name real_negative_##name(real_##name x)                                            \
    {                                                                                                        \
        return builtin(minpd)(x, (real_##name){0.0});                                                        \
    }                                                                                                        \
    ALWAYS_INLINE real_##name real_larger_##name(real_##name a, real_##name b)                               \
    {                                                                                                        \
        return builtin(maxpd)(a, b); /* b where one is no number */                                          \
    }                                                                                                        \
    ALWAYS_INLINE real_##name sqrt_##name(real_##name x)                                                     \
    {                                                                                                        \
        return builtin(sqrtpd)(x);                                                                           \
    }                                                                                                        \
    ALWAYS_INLINE real_##name fabs_##name(real_##name x)                                                     \
    {                                                                                                        \
        return (real_##name)((mask_##name)x & INT64_MAX);                                                    \
    }                                                                                                        \
    ALWAYS_INLINE unsigned which_##name(mask_##name m) /* bit i: lane i */                                   \
    {                                                                                                        \
        return (unsigned)builtin(movmskpd)((real_##name)m);                                                  \
    }                                                                                                        \
    ALWAYS_INLINE bool any_##name(mask_##name m)                                                             \
    {                                                                                                        \
        return which_##name(m) != 0;                                                                         \
    }

#define TICK_BUILTIN(f) __builtin_ia32_##f
LANES(lanes, TICK_LANES, TICK_BUILTIN)
LANES(beside, PLANT_LANES, BESIDE_BUILTIN)
#else
#define TICK_LANES 1
#endif

#endif
