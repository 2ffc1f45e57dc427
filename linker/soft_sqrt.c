/* soft_sqrt.c - a float square root, two corrections by exact remainders, and the last digit by the sign
 * of a third.
 *
 * x = m 4^e with m in [1, 4). Fixed point: wanted is q = floor(sqrt(m) 2^53), one digit more than the
 * result has. No root of a double ends in just that digit (its square would have too many), so q says how
 * to round: up if it is odd. These are the bounds, in units of q. The float root is off by less than 1.75
 * * 2^29: half a digit of its own, and half a digit of m. After a correction by remainder / (2 root) in
 * float it is off by less than 157: 2^-23 of that, and its square / 2^54. Less MARGIN this is below the
 * root for certain. After another correction it is off by one at most, and the remainder tells which way.
 * Remainders are exact modulo 2^64, and smaller. */
#include "linker/soft_sqrt.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { MARGIN = 256, DIGITS = 52, BIAS = 1023, EXPONENT_MAX = 2047 };

/* floor(sqrt(m) 2^53) of m 2^52 in [2^52, 2^54). */
static uint64_t root(uint64_t m)
{
    float f = sqrtf((float)(uint32_t)(m >> 22)); /* sqrt(m) 2^15 */
    uint64_t q = (uint32_t)(f * 0x1p8f);         /* 23 digits after the point, exact */
    int64_t rest = (int64_t)((m << 10) - (q * q << 16));
    q = (q << 30) + (uint64_t)(int32_t)((float)(int32_t)(rest >> 12) * 0x1p17f / f) - MARGIN;
    q += (uint32_t)((float)(uint32_t)(((m << 54) - q * q) >> 32) * 0x1p-7f / f);
    rest = (int64_t)((m << 54) - q * q);
    if (rest < 0)
        return q - 1;
    return rest > (int64_t)(2 * q) ? q + 1 : q;
}

/* x = m 4^e: m 2^52, and e + BIAS - 1. */
static uint64_t split(uint64_t bits, int *exponent)
{
    int biased = (int)(bits >> DIGITS);
    if (biased == 0) {
        int shift = __builtin_clzll(bits) - (63 - DIGITS);
        bits <<= shift;
        biased = 1 - shift;
    }
    int odd = (biased - BIAS) & 1;
    *exponent = (biased - BIAS - odd) / 2 + BIAS - 1;
    uint64_t one = UINT64_C(1) << DIGITS;
    return ((bits & (one - 1)) | one) << odd;
}

double soft_sqrt(double x)
{
    uint64_t bits, infinity = (uint64_t)EXPONENT_MAX << DIGITS;
    memcpy(&bits, &x, sizeof bits);
    if (bits << 1 == 0 || bits == infinity)
        return x;
    if (bits > infinity) /* a NaN, or a sign */
        return (double)NAN;
    int exponent;
    uint64_t m = split(bits, &exponent);
    bits = ((uint64_t)exponent << DIGITS) + ((root(m) + 1) >> 1); /* its first digit counts the exponent up */
    memcpy(&x, &bits, sizeof x);
    return x;
}
