/* exact.c - see exact.h. */
#include "tests/exact.h"

#include <math.h>

long double exact_angle(uint64_t turns)
{
    return EXACT_TURN * ((long double)turns / 18446744073709551616.0L);
}

uint64_t exact_phase(double turns_per_tick, uint64_t n)
{
    int exponent;
    uint64_t digits = (uint64_t)ldexp(frexp(turns_per_tick, &exponent), 53);
    unsigned __int128 product = (unsigned __int128)digits * n;
    int shift = 64 + exponent - 53;
    return (uint64_t)(shift >= 0 ? product << shift : product >> -shift);
}

long double exact_wave(const struct wave *w, long double s)
{
    long double theta = atan2l((long double)w->sine, (long double)w->cosine) + (long double)w->omega * s;
    return (long double)w->offset + (long double)w->slope * s +
           ((long double)w->amplitude + (long double)w->growth * s) * cosl(theta);
}

long double exact_wave_rate(const struct wave *w, long double s)
{
    const long double d = 1e-8L;
    return (exact_wave(w, s + d) - exact_wave(w, s - d)) / (2.0L * d);
}

void exact_worst(double *max, long double error)
{
    if (!isnan(*max) && !(fabsl(error) <= (long double)*max))
        *max = (double)fabsl(error);
}

double exact_uniform(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 9007199254740992.0;
}
