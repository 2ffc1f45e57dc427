/* batch_lanes.h - four trajectories side by side in one GNU vector, operation by operation.
 *
 * It has elementwise operations only. So a lane's bits depend neither on its neighbours nor on the width of
 * the machine: gcc and clang take a quad apart without AVX. Conditions are integer masks, all ones or
 * zero. */
#ifndef HOST_SIM_BATCH_LANES_H
#define HOST_SIM_BATCH_LANES_H

#include <math.h>
#include <stdbool.h>
#include <string.h>
#include "models/check.h"

enum { QUAD = 4 };

typedef double quad __attribute__((vector_size(32)));
typedef long long mask __attribute__((vector_size(32)));
typedef unsigned long long bits __attribute__((vector_size(32)));

/* Quads are handed over by value between functions that are always inlined only: there is no ABI to warn
 * of. */
#pragma GCC diagnostic ignored "-Wpsabi"
#if defined(__clang__)
#if __has_feature(address_sanitizer)
#define BATCH_UNROLL /* with a check at each access it takes minutes to compile */
#else
#define BATCH_UNROLL _Pragma("clang loop unroll(full)")
#endif
#pragma clang diagnostic ignored "-Wpass-failed" /* at low levels loops stay loops */
#else
#define BATCH_UNROLL _Pragma("GCC unroll 32")
#endif
/* The copy for x86-64 without AVX2, which next to no processor lacks: loops stay loops, so that it
 * compiles in a tenth of the time. */
#if defined(__x86_64__) && !defined(__AVX__)
#undef BATCH_UNROLL
#define BATCH_UNROLL
#endif

ALWAYS_INLINE quad all_lanes(double x)
{
    return (quad){x, x, x, x};
}

/* The values of the trajectories at[0..3]. */
ALWAYS_INLINE quad gather(const double *x, const int *at)
{
    return (quad){x[at[0]], x[at[1]], x[at[2]], x[at[3]]};
}

ALWAYS_INLINE quad where(mask m, quad yes, quad no)
{
    return (quad)((m & (mask)yes) | (~m & (mask)no));
}

ALWAYS_INLINE bool any_lane(mask m)
{
    return ((m[0] | m[1]) | (m[2] | m[3])) != 0;
}

ALWAYS_INLINE quad magnitude(quad x)
{
    return (quad)((bits)x & ~(bits)all_lanes(-0.0));
}

/* The lesser, the greater of two; b where one is not a number. Square roots of x >= 0. No vector operator
 * has them: gcc joins four calls into one instruction only with the vectoriser that contracts, and takes
 * four more to choose. The results are the same either way. */
ALWAYS_INLINE quad lesser(quad a, quad b)
{
#ifdef __AVX__
    return __builtin_ia32_minpd256(a, b);
#else
    return where(a < b, a, b);
#endif
}

ALWAYS_INLINE quad greater(quad a, quad b)
{
#ifdef __AVX__
    return __builtin_ia32_maxpd256(a, b);
#else
    return where(a > b, a, b);
#endif
}

ALWAYS_INLINE quad root(quad x)
{
#ifdef __AVX__
    return __builtin_ia32_sqrtpd256(x);
#else
    return (quad){sqrt(x[0]), sqrt(x[1]), sqrt(x[2]), sqrt(x[3])};
#endif
}

/* eta_+^{3/2} without a branch. */
ALWAYS_INLINE quad contact_force(quad eta)
{
    quad closed = greater(eta, all_lanes(0.0));
    return closed * root(closed);
}

/* Coefficients from the constant upwards. */
ALWAYS_INLINE quad horner(quad x, const double *c, int n)
{
    quad y = all_lanes(c[n - 1]);
    BATCH_UNROLL
    for (int i = n - 2; i >= 0; i--)
        y = y * x + c[i];
    return y;
}

/* Cosine and sine of |turns| <= 1e6, as cos_sin_turns of models/math/elementary.h: error <= 4e-16 and that
 * of `turns`. */
ALWAYS_INLINE void cos_sin_of(quad turns, quad *cosine, quad *sine)
{
    static const double S[6] = {-0.16666666666666666,   0.008333333333330948,    -0.00019841269836756774,
                                2.7557316101617874e-06, -2.5051131650235181e-08, 1.5918115263265974e-10};
    static const double C[6] = {0.041666666666666664,    -0.0013888888888887398, 2.4801587298764561e-05,
                                -2.7557317271145144e-07, 2.087614614655861e-09,  -1.1382623647474604e-11};
    const double rounds = 0x1.8p52; /* adding it rounds to whole numbers and leaves them in the lowest bits */
    quad quarters = turns * 4.0 + rounds;
    quad r = (turns - (quarters - rounds) * 0.25) * 6.283185307179586477, u = r * r;
    quad s = r + r * (u * horner(u, S, 6)), c = 1.0 - (0.5 * u - u * u * horner(u, C, 6));
    bits quadrant = (bits)quarters;
    mask odd = -(mask)(quadrant & 1);
    *cosine = (quad)((bits)where(odd, s, c) ^ (((quadrant + 1) & 2) << 62));
    *sine = (quad)((bits)where(odd, c, s) ^ ((quadrant & 2) << 62));
}

#endif
