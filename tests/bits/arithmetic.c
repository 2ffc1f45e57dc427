/* arithmetic.c - the double arithmetic that the core asks for; see arithmetic.h. */
#include "tests/bits/arithmetic.h"

#include <math.h>

enum { DIGITS = 52, KINDS = 4 };
static const uint64_t FNV_PRIME = 1099511628211u, ONE = UINT64_C(1023) << DIGITS;

union binary64 {
    uint64_t bits;
    double x;
};

static uint64_t next_random(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return *state ^ (*state >> 29);
}

static double operand(uint64_t *random, uint64_t kind)
{
    uint64_t bits = next_random(random), sign = bits >> 63 << 63;
    switch (kind) {
    case 0:
        return (union binary64){bits}.x;
    case 1: /* 1 to 16, few digits or many */
        return (union binary64){sign | (ONE + ((bits >> 10) & ~((UINT64_C(1) << bits % DIGITS) - 1)))}.x;
    case 2: /* subnormal */
        return (union binary64){sign | bits % (UINT64_C(1) << DIGITS) >> (bits >> 58) % DIGITS}.x;
    default:
        return (double)((int64_t)(bits % 2049) - 1024);
    }
}

static uint64_t mix(uint64_t hash, uint64_t word)
{
    return (hash ^ word) * FNV_PRIME;
}

static uint64_t number(uint64_t hash, double x)
{
    return mix(hash, x == x ? (union binary64){.x = x}.bits : 1);
}

/* Between integers of every width that the core uses, and float. */
static uint64_t convert(uint64_t hash, uint64_t word, double a)
{
    hash = number(hash, (double)(float)a);
    hash = number(hash, (double)word);
    hash = number(hash, (double)(int64_t)word);
    hash = number(hash, (double)(uint32_t)word);
    hash = number(hash, (double)(int32_t)(uint32_t)word);
    if (fabs(a) < 0x1p62)
        hash = mix(hash, (uint64_t)(int64_t)a);
    if (a >= 0.0 && a < 0x1p63)
        hash = mix(hash, (uint64_t)a);
    return fabs(a) < 0x1p30 ? mix(hash, (uint32_t)(int32_t)a) : hash;
}

uint64_t arithmetic_hash(uint64_t *random, int rounds, uint64_t hash)
{
    for (int i = 0; i < rounds; i++) {
        uint64_t word = next_random(random);
        double a = operand(random, word >> 60 & (KINDS - 1)), b = operand(random, word >> 62);
        hash = number(hash, a + b);
        hash = number(hash, a - b);
        hash = number(hash, a * b);
        hash = number(hash, a / b);
        hash = number(hash, sqrt(a));
        hash = mix(hash, (unsigned)((a < b) | (a <= b) << 1 | (a == b) << 2 | (a > b) << 3 | (a >= b) << 4 |
                                    (a != b) << 5));
        hash = convert(hash, word, a);
    }
    return hash;
}
