/* lanes.h - one number for each of several ticks side by side.
 *
 * Texts that serve one tick and several (models/flows_text.h, firmware/plant/ledger_middle.h) are written
 * with `real`, and with names in REAL(). They are included twice: with real as double, and as `real_lanes`.
 * All operations go lane by lane, so a lane has the bits of a double. TICK_LANES is 1 where the processor has
 * no such registers: then there is no second copy. */
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

typedef double real_lanes __attribute__((vector_size(16)));
typedef double lanes_in_memory
    __attribute__((vector_size(16), aligned(8), may_alias)); /* two doubles in a row */
typedef long long lanes_mask __attribute__((vector_size(16)));

ALWAYS_INLINE real_lanes real_positive_lanes(real_lanes x)
{
    return (real_lanes)((lanes_mask)x & (x > 0.0));
}

ALWAYS_INLINE real_lanes real_negative_lanes(real_lanes x)
{
    return (real_lanes)((lanes_mask)x & (x < 0.0));
}

ALWAYS_INLINE real_lanes real_larger_lanes(real_lanes a, real_lanes b)
{
    lanes_mask more = a > b;
    return (real_lanes)(((lanes_mask)a & more) | ((lanes_mask)b & ~more));
}

ALWAYS_INLINE real_lanes sqrt_lanes(real_lanes x)
{
    return __builtin_ia32_sqrtpd(x);
}

ALWAYS_INLINE real_lanes fabs_lanes(real_lanes x)
{
    return (real_lanes)((lanes_mask)x & ~(lanes_mask)(real_lanes){-0.0, -0.0});
}

/* As struct input and struct flow. */
struct input_lanes {
    real_lanes value, rate;
};

struct flow_lanes {
    real_lanes x_dot[MODEL_STATES], work[MODEL_INPUTS], damping, force;
};
#else
#define TICK_LANES 1
#endif

#endif
