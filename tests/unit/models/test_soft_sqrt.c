/* test_soft_sqrt.c - the square root of boards without a
 * double FPU against the host's instruction, bit for bit. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdint.h>
#include "linker/soft_sqrt.h"

enum { N_OPERANDS = 2000000, N_ROOTS = 300000, EXPONENTS = 2047, AROUND = 40, DIGITS = 52 };

union binary64 {
    double x;
    uint64_t bits;
};

static uint64_t next_bits(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return *state ^ (*state >> 29);
}

/* 1 where it is not the instruction's; any NaN is as good as another. */
static int differs(uint64_t bits)
{
    union binary64 operand = {.bits = bits}, got = {soft_sqrt(operand.x)}, expected = {sqrt(operand.x)};
    return isnan(expected.x) ? !isnan(got.x) : got.bits != expected.bits;
}

static int64_t differing_around(uint64_t bits, int n)
{
    int64_t differing = 0;
    for (int i = -n; i <= n; i++)
        differing += differs(bits + (uint64_t)(int64_t)i);
    return differing;
}

TEST(soft_sqrt_special)
{
    const double infinite = (double)INFINITY;
    check_hex("sqrt(0)", (union binary64){soft_sqrt(0.0)}.bits, 0);
    check_hex("sqrt(-0) is -0", (union binary64){soft_sqrt(-0.0)}.bits, UINT64_C(1) << 63);
    check_is("sqrt(infinity)", soft_sqrt(infinite), ==, infinite);
    check_nan("sqrt(-infinity) is NaN", soft_sqrt(-infinite));
    check_nan("sqrt(NaN) is NaN", soft_sqrt((double)NAN));
    check_nan("sqrt(NaN) is NaN", soft_sqrt(-(double)NAN));
    check_nan("sqrt(-1) is NaN", soft_sqrt(-1.0));
    check_nan("sqrt(-smallest) is NaN", soft_sqrt(-0x1p-1074));
    check_near("sqrt(smallest) = 2^-537", soft_sqrt(0x1p-1074), 0x1p-537, 0.0);
    check_near("sqrt(largest)", soft_sqrt(0x1.fffffffffffffp1023), 0x1.fffffffffffffp511, 0.0);
    check_near("sqrt below 1", soft_sqrt(0x1.fffffffffffffp-1), 0x1.fffffffffffffp-1, 0.0);
    check_near("sqrt above 1", soft_sqrt(0x1.0000000000001p0), 1.0, 0.0);
    check_near("sqrt(0.1)", soft_sqrt(0.1), 0.31622776601683794, 0.0);
}

/* Both sides of every power of two, and the middle between; subnormals at exponent 0. */
TEST(soft_sqrt_exponents)
{
    int64_t differing = 0;
    for (uint64_t e = 0; e <= EXPONENTS; e++) {
        differing += differing_around(e << DIGITS, AROUND);
        differing += differing_around((e << DIGITS) + (UINT64_C(1) << (DIGITS - 1)), AROUND);
    }
    for (int digit = 0; digit < DIGITS; digit++)
        differing += differing_around(UINT64_C(1) << digit, AROUND);
    check_int("differing from the instruction around powers of two", differing, 0);
}

TEST(soft_sqrt_random)
{
    uint64_t random = 1;
    int64_t differing = 0, subnormal = 0;
    for (int i = 0; i < N_OPERANDS; i++) {
        uint64_t bits = next_bits(&random);
        differing += differs(bits >> 1);
        subnormal += differs(bits >> 1 >> (11 + bits % DIGITS));
    }
    check_int("differing from the instruction at random positive patterns", differing, 0);
    check_int("at random subnormals", subnormal, 0);
}

/* Roots that lie as near as can be to a double, or to the middle of two: k^2 and (k + 1/2)^2 = k^2 + k + 1/4,
 * rounded, and the neighbours of both. */
TEST(soft_sqrt_halfway)
{
    uint64_t random = 2;
    int64_t squares = 0, half = 0, rest = 0;
    for (int i = 0; i < N_ROOTS; i++) {
        uint64_t bits = next_bits(&random);
        double k = (double)(bits >> 11 | UINT64_C(1) << DIGITS), small = (double)(bits >> 38);
        squares += differing_around((union binary64){k * k}.bits, 3);
        half += differing_around((union binary64){k * k + k}.bits, 3);
        rest += soft_sqrt(small * small) != small;
    }
    check_int("differing next to squares", squares, 0);
    check_int("next to halves", half, 0);
    check_int("roots of squares that are not exact", rest, 0);
}
