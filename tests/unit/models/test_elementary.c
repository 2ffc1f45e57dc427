/* test_elementary.c - elementary functions against long double libm and identities. */
#include "tests/unit/test.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include "models/math/elementary.h"

#define INFINITE  ((double)INFINITY)
#define NO_NUMBER ((double)NAN)

enum { N_RANDOM = 200000 };

/* The reference must have more digits than what it judges. */
typedef char long_double_has_64_bits[LDBL_MANT_DIG >= 64 ? 1 : -1];

static const long double PI_L = 3.14159265358979323846264338327950288L;

static uint64_t next_random(uint64_t *state)
{
    *state += 0x9e3779b97f4a7c15u; /* splitmix64 */
    uint64_t z = *state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* [-1, 1) */
static double next_unit(uint64_t *state)
{
    return (double)(int64_t)next_random(state) / 9223372036854775808.0;
}

/* Any normal positive number, uniform in the logarithm. */
static double next_normal(uint64_t *state)
{
    int exponent = (int)(next_random(state) % 2045) - 1022;
    return ldexp(1.5 + 0.499 * next_unit(state), exponent);
}

static double worse(double worst, double error)
{
    return error <= worst ? worst : error; /* a NaN stays */
}

static double distance(double got, long double expected)
{
    return (double)fabsl((long double)got - expected);
}

static double relative(double got, long double expected)
{
    return (double)fabsl(((long double)got - expected) / expected);
}

static double turns_error(uint64_t turns)
{
    double c, s;
    cos_sin_turns(turns, &c, &s);
    long double angle = (long double)(int64_t)turns * (PI_L / 9223372036854775808.0L);
    return worse(distance(c, cosl(angle)), distance(s, sinl(angle)));
}

TEST(elementary_turns)
{
    uint64_t state = 1;
    double worst = 0.0;
    for (uint64_t i = 0; i < 100000; i++)
        worst = worse(worst, turns_error(i * (UINT64_MAX / 100000)));
    for (int i = 0; i < N_RANDOM; i++)
        worst = worse(worst, turns_error(next_random(&state)));
    for (uint64_t octant = 0; octant < 16; octant++)
        for (uint64_t near = 0; near < 2000; near++)
            worst = worse(worst, turns_error((octant << 60) + (near - 1000) * (near % 3 ? 1 : 1000003)));
    for (int shift = 0; shift < 64; shift++)
        worst =
            worse(worse(worst, turns_error(UINT64_C(1) << shift)), turns_error(0 - (UINT64_C(1) << shift)));
    check_below("cos_sin_turns: largest error, long double libm", worst, 3e-16);

    static const double QUARTER[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    int exact = 0;
    for (uint64_t i = 0; i < 4; i++) {
        double c, s;
        cos_sin_turns(i << 62, &c, &s);
        exact += c == QUARTER[i][0] && s == QUARTER[i][1];
    }
    check_int("cos_sin_turns: quarter turns exact", exact, 4);
}

static double angle_error(double angle)
{
    double c, s;
    cos_sin(angle, &c, &s);
    return worse(distance(c, cosl((long double)angle)), distance(s, sinl((long double)angle)));
}

TEST(elementary_cos_sin)
{
    static const double SIZE[] = {1e-300, 1e-12, 1e-3, 0.8, 7.0, 100.0, 1e4, 1e5};
    uint64_t state = 2;
    double worst = worse(angle_error(0.0), angle_error(-1e5));
    for (int i = 0; i < N_RANDOM; i++)
        worst = worse(worst, angle_error(next_unit(&state) * SIZE[i % 8]));
    for (int k = -63661; k <= 63661; k++) {
        double boundary = k * 1.5707963267948966;
        worst = worse(worse(worst, angle_error(boundary)), angle_error(boundary + 0.7853981633974483));
    }
    check_below("cos_sin: largest error, long double libm", worst, 3e-16);

    static const double OUTSIDE[] = {1.0001e5, -1e300, INFINITE, -INFINITE, NO_NUMBER};
    int documented = 0;
    for (int i = 0; i < 5; i++) {
        double c, s;
        cos_sin(OUTSIDE[i], &c, &s);
        documented += c == 1.0 && s == 0.0;
    }
    check_int("cos_sin: outside the domain, 1 and 0", documented, 5);
}

/* The fraction by libm, exact for a double: x - floor(x) in long double, then an integer. */
static uint64_t phase_by_floor(double x)
{
    long double fraction = (long double)x - floorl((long double)x);
    return fraction >= 1.0L ? 0 : (uint64_t)(fraction * 18446744073709551616.0L);
}

TEST(elementary_phase)
{
    check_hex("turns_of(0.25)", turns_of(0.25), UINT64_C(1) << 62);
    check_hex("turns_of(-0.25)", turns_of(-0.25), UINT64_C(3) << 62);
    check_hex("turns_of(-0.0)", turns_of(-0.0), 0);
    check_hex("turns_of(1 - 2^-53)", turns_of(1.0 - 0x1p-53), 0 - (UINT64_C(1) << 11));
    check_hex("turns_of(2^51 + 0.5)", turns_of(0x1p51 + 0.5), UINT64_C(1) << 63);
    check_hex("turns_of(2^-64)", turns_of(0x1p-64), 1);
    check_hex("turns_of(-2^-64)", turns_of(-0x1p-64), UINT64_MAX);
    static const double WHOLE[] = {1.0,    -3.0,     4503599627370496.0, -4503599627370497.0, 1e300,
                                   -1e300, INFINITE, -INFINITE,          NO_NUMBER,           5e-324};
    int zeros = 0;
    for (int i = 0; i < 10; i++)
        zeros += turns_of(WHOLE[i]) == 0;
    check_int("turns_of: whole, huge, not finite and smallest numbers give 0", zeros, 10);

    uint64_t state = 3;
    int64_t largest = 0;
    for (int i = 0; i < N_RANDOM; i++) {
        double x = ldexp(next_unit(&state), i % 60 - 8);
        int64_t off = (int64_t)(turns_of(x) - phase_by_floor(x));
        largest = llabs(off) > largest ? llabs(off) : largest;
    }
    check_below("turns_of against floorl: largest difference in 2^-64 turns", (double)largest, 1.0);

    check_near("turns_to_double(3/4 turn)", turns_to_double(UINT64_C(3) << 62), -0.25, 0.0);
    check_near("turns_to_double(1/2 turn)", turns_to_double(UINT64_C(1) << 63), -0.5, 0.0);
    check_near("turns_to_double(just below 1/2) is the same angle", turns_to_double(INT64_MAX), -0.5, 0.0);
    check_near("turns_to_double(-2^-64)", turns_to_double(UINT64_MAX), -0x1p-64, 0.0);

    /* 0.123456789 as a double is a whole number of 2^-56: 1e9 turns of it are known exactly, modulo 2^56 */
    uint64_t number = (uint64_t)ldexp(0.123456789, 56), rest = (number * 1000000000u) & (UINT64_MAX >> 8);
    uint64_t phase = turns_of(0.123456789) * 1000000000u;
    check_hex("phase after 1e9 increments of 0.123456789 turns", phase, rest << 8);
    double c, s;
    cos_sin_turns(phase, &c, &s);
    check_near("... and its sine", s, (double)sinl(2.0L * PI_L * (long double)rest / 72057594037927936.0L),
               3e-16);
}

static double arc_error(double y, double x)
{
    return distance(arc_tangent(y, x), atan2l((long double)y, (long double)x));
}

TEST(elementary_arc_tangent)
{
    uint64_t state = 4;
    double worst = 0.0;
    for (int i = 0; i < N_RANDOM; i++) {
        long double angle = PI_L * (long double)next_unit(&state);
        double size = next_normal(&state) * 0.25;
        worst = worse(worst, arc_error(size * (double)sinl(angle), size * (double)cosl(angle)));
        double x = next_unit(&state), other = next_normal(&state);
        worst = worse(worst, arc_error(next_unit(&state), x));
        worst = worse(worst, arc_error(next_normal(&state), other));
    }
    static const double EDGE[] = {0.0,
                                  5e-324,
                                  DBL_MIN,
                                  1e-9,
                                  0.41421356237309503,
                                  0.41421356237309509,
                                  1.0,
                                  1.0 - 1e-16,
                                  2.4142135623730949,
                                  2.4142135623730954,
                                  1e9,
                                  DBL_MAX / 2,
                                  DBL_MAX};
    for (int i = 0; i < 13; i++)
        for (int j = 0; j < 13; j++)
            for (int sign = 0; sign < 4; sign++) {
                double y = sign & 1 ? -EDGE[i] : EDGE[i];
                worst = worse(worst, arc_error(y == 0.0 ? 0.0 : y, (sign & 2 ? -EDGE[j] : EDGE[j]) + 0.0));
            }
    check_below("arc_tangent: largest error, long double libm", worst, 4e-16);
    check_near("arc_tangent(0, 0)", arc_tangent(0.0, 0.0), 0.0, 0.0);
    check_near("arc_tangent(-0, -1) is +pi", arc_tangent(-0.0, -1.0), 3.141592653589793, 0.0);
    check_near("arc_tangent(inf, 1)", arc_tangent(INFINITE, 1.0), 0.0, 0.0);
    check_near("arc_tangent(1, NaN)", arc_tangent(1.0, NO_NUMBER), 0.0, 0.0);
}

static double exponential_error(double x)
{
    return relative(exponential(x), expl((long double)x));
}

TEST(elementary_exponential)
{
    uint64_t state = 5;
    double worst = worse(exponential_error(700.0), exponential_error(-700.0));
    for (int i = 0; i < N_RANDOM; i++) {
        worst = worse(worst, exponential_error(700.0 * next_unit(&state)));
        worst = worse(worst, exponential_error(next_unit(&state)));
        worst = worse(worst, exponential_error(ldexp(next_unit(&state), -(i % 1000))));
    }
    for (int k = -2019; k <= 2019; k += 2) /* the ends of the reduced range */
        for (int d = -1; d <= 1; d++)
            worst = worse(worst, exponential_error(0.5 * k * 0.6931471805599453 * (1.0 + d * 3e-16)));
    check_below("exponential: largest relative error, long double libm", worst, 4e-16);
    check_near("exponential(0)", exponential(0.0), 1.0, 0.0);
    check_near("exponential(-701)", exponential(-701.0), 0.0, 0.0);
    check_near("exponential(701)", exponential(701.0), DBL_MAX, 0.0);
    check_near("exponential(-inf)", exponential(-INFINITE), 0.0, 0.0);
    check_near("exponential(inf)", exponential(INFINITE), DBL_MAX, 0.0);
    check_near("exponential(NaN)", exponential(NO_NUMBER), 0.0, 0.0);
}

static double logarithm_error(double x)
{
    long double l = logl((long double)x);
    return fabsl(l) > 1.0L ? relative(logarithm(x), l) : distance(logarithm(x), l);
}

TEST(elementary_logarithm)
{
    uint64_t state = 6;
    double worst = worse(logarithm_error(DBL_MIN), logarithm_error(DBL_MAX));
    for (int i = 0; i < N_RANDOM; i++) {
        worst = worse(worst, logarithm_error(next_normal(&state)));
        worst = worse(worst, logarithm_error(1.5 + next_unit(&state)));
        worst = worse(worst, logarithm_error(1.0 + ldexp(next_unit(&state), -(i % 53))));
    }
    for (int k = -1021; k <= 1022; k++)
        for (int d = -2; d <= 2; d++)
            worst = worse(worst, logarithm_error(ldexp(1.4142135623730951 * (1.0 + d * 3e-16), k)));
    check_below("logarithm: largest error, long double libm", worst, 4e-16);
    check_near("logarithm(1)", logarithm(1.0), 0.0, 0.0);
    static const double REFUSED[] = {0.0, -0.0, -1.0, 1e-310, -INFINITE, NO_NUMBER};
    int documented = 0;
    for (int i = 0; i < 6; i++)
        documented += logarithm(REFUSED[i]) == -DBL_MAX;
    check_int("logarithm: no normal positive number, -DBL_MAX", documented, 6);
    check_near("logarithm(inf)", logarithm(INFINITE), 1024.0 * 0.6931471805599453, 1e-12);
}

static double cube_root_error(double x)
{
    return relative(cube_root(x), cbrtl((long double)x));
}

TEST(elementary_cube_root)
{
    uint64_t state = 7;
    double worst = worse(cube_root_error(DBL_MIN), cube_root_error(-DBL_MAX));
    for (int i = 0; i < N_RANDOM; i++) {
        worst = worse(worst, cube_root_error(next_normal(&state)));
        worst = worse(worst, cube_root_error(-next_normal(&state)));
        worst = worse(worst, cube_root_error(4.5 + 3.5 * next_unit(&state)));
    }
    check_below("cube_root: largest relative error, long double libm", worst, 3e-16);
    int exact = 0;
    for (int k = 1; k <= 1000; k++)
        exact += cube_root((double)k * k * k) == k;
    check_int("cube_root: cubes of 1..1000 exact", exact, 1000);
    static const double OTHER[] = {0.0, -0.0, 1e-310, INFINITE, -INFINITE, NO_NUMBER};
    int zeros = 0;
    for (int i = 0; i < 6; i++)
        zeros += cube_root(OTHER[i]) == 0.0;
    check_int("cube_root: no normal number, 0", zeros, 6);
}
