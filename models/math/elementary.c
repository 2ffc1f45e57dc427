/* elementary.c - elementary functions from + - * / sqrt and integers; see elementary.h.
 *
 * All polynomial coefficients are near-minimax: interpolation at Chebyshev nodes of the reduced range,
 * computed with 50 digits and rounded to double. Constants that a multiple is subtracted of are split, so
 * that the product is exact. */
#include "models/math/elementary.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include "models/check.h"

static const double RADIANS_PER_PHASE = 0x1.921fb54442d18p-62; /* 2 pi / 2^64 */
static const double TWO_OVER_PI = 0.6366197723675814;
static const double HALF_PI[2] = {0x1.921fb544p+0, 0x1.0b4611a626331p-34};         /* 33 + 53 bits */
static const double QUARTER_PI[2] = {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}; /* 50 + 53 bits */
static const double LN2[2] = {0x1.62e42feep-1, 0x1.a39ef35793c76p-33};             /* 32 + 53 bits */
static const double TWO_64 = 0x1p64;

/* Coefficients from the constant upwards. */
static double polynomial(double x, const double *c, int n)
{
    double y = c[n - 1];
    UNROLL
    for (int i = n - 2; i >= 0; i--)
        y = y * x + c[i];
    return y;
}

static uint64_t bits_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static double of_bits(uint64_t bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Cosine and sine of quadrant * pi/2 + r, |r| <= pi/4. */
static void cos_sin_reduced(unsigned quadrant, double r, double *cosine, double *sine)
{
    static const double S[6] = {-0.16666666666666666,   0.008333333333330948,    -0.00019841269836756774,
                                2.7557316101617874e-06, -2.5051131650235181e-08, 1.5918115263265974e-10};
    static const double C[6] = {0.041666666666666664,    -0.0013888888888887398, 2.4801587298764561e-05,
                                -2.7557317271145144e-07, 2.087614614655861e-09,  -1.1382623647474604e-11};
    double u = r * r;
    double s = r + r * (u * polynomial(u, S, 6));
    double c = 1.0 - (0.5 * u - u * u * polynomial(u, C, 6));
    double a = quadrant & 1 ? -s : c; /* one quarter turn: (c, s) becomes (-s, c) */
    double b = quadrant & 1 ? c : s;
    *cosine = quadrant & 2 ? -a : a;
    *sine = quadrant & 2 ? -b : b;
}

void cos_sin_turns(uint64_t turns, double *cosine, double *sine)
{
    uint64_t quadrant = (turns + (UINT64_C(1) << 61)) >> 62; /* nearest quarter turn, 0..3 */
    int64_t rest = (int64_t)(turns - (quadrant << 62));      /* [-2^61, 2^61) */
    cos_sin_reduced((unsigned)quadrant, (double)rest * RADIANS_PER_PHASE, cosine, sine);
}

void cos_sin(double radians, double *cosine, double *sine)
{
    if (!(fabs(radians) <= 1e5))
        radians = 0.0;
    double quarters = radians * TWO_OVER_PI;
    int32_t quadrant = (int32_t)(quarters < 0.0 ? quarters - 0.5 : quarters + 0.5);
    double k = quadrant; /* 17 bits: the product with 33 bits is exact */
    double r = (radians - k * HALF_PI[0]) - k * HALF_PI[1];
    cos_sin_reduced((unsigned)quadrant, r, cosine, sine);
}

uint64_t turns_of(double turns)
{
    if (!(fabs(turns) < 0x1p52))
        return 0;                                           /* a whole number, or not finite */
    double fraction = fabs(turns - (double)(int64_t)turns); /* exact, [0, 1 - 2^-53] */
    uint64_t phase = (uint64_t)(fraction * TWO_64);         /* < 2^64 */
    return turns < 0.0 ? 0 - phase : phase;
}

double turns_to_double(uint64_t turns)
{
    double x = (double)(int64_t)turns / TWO_64;
    return x < 0.5 ? x : -0.5; /* just below half a turn rounds up to it */
}

/* atan(s) for |s| <= tan(pi/8) */
static double arc_tangent_reduced(double s)
{
    static const double A[11] = {-0.33333333333333331,  0.1999999999999548,    -0.14285714284657894,
                                 0.11111111014561013,   -0.090909045498846111, 0.076921825351166484,
                                 -0.066645022156714473, 0.058580687568615106,  -0.050850304928109408,
                                 0.039219552532551293,  -0.019162068915902573};
    double u = s * s;
    return s + s * (u * polynomial(u, A, 11));
}

double arc_tangent(double y, double x)
{
    double a = fabs(y), b = fabs(x);
    if (!(a <= DBL_MAX && b <= DBL_MAX) || a + b == 0.0)
        return 0.0;
    if (a + b > DBL_MAX)
        a *= 0.5, b *= 0.5;
    /* angle = k pi/4 + atan(s) with the nearest of the rays k = 0, 1, 2 */
    double s = a < b ? a / b : -b / a;
    int k = a < b ? 0 : 2;
    if (fabs(s) > 0.41421356237309503) /* tan(pi/8) */
        k = 1, s = (a - b) / (a + b);
    if (x < 0.0)
        k = 4 - k, s = -s;
    double angle = k * QUARTER_PI[0] + (arc_tangent_reduced(s) + k * QUARTER_PI[1]);
    return y < 0.0 ? -angle : angle;
}

/* 2^k (1 + r + r^2 P(r)), x = k ln 2 + r, |r| <= ln(2)/2 */
double exponential(double x)
{
    static const double E[10] = {0.50000000000000011,    0.16666666666666669,    0.041666666666624129,
                                 0.0083333333333300615,  0.0013888888917213717,  0.00019841269863053618,
                                 2.4801521295954376e-05, 2.7557268459997064e-06, 2.7620088445409746e-07,
                                 2.510038549551032e-08};
    if (!(x >= -700.0))
        return 0.0;
    if (x > 700.0)
        return DBL_MAX;
    double octaves = x / 0.6931471805599453;
    int32_t k = (int32_t)(octaves < 0.0 ? octaves - 0.5 : octaves + 0.5);
    double high = x - k * LN2[0], low = k * LN2[1]; /* the first product has 11 + 32 bits: exact */
    double r = high - low;
    double y = 1.0 + (high + (r * r * polynomial(r, E, 10) - low));
    return y * of_bits((uint64_t)(1023 + k) << 52);
}

/* x = 2^k (1 + f) in [sqrt(1/2), sqrt(2)]:  log(1 + f) = 2 atanh(s), s = f / (2 + f), which is
 * f - f^2/2 + s (f^2/2 + R(s^2)) with 2 atanh(s) = s (2 + R): the large part f has no rounding error. */
double logarithm(double x)
{
    static const double L[7] = {0.66666666666666696, 0.39999999999898889, 0.28571428626253836,
                                0.22222211089379496, 0.18182892432536871, 0.15331611722055008,
                                0.14617807153417325};
    if (!(x >= DBL_MIN))
        return -DBL_MAX;
    uint64_t bits = bits_of(x);
    int32_t k = (int32_t)(bits >> 52) - 1023;
    double m = of_bits((bits & 0xfffffffffffff) | 0x3ff0000000000000);
    if (m > 1.4142135623730951)
        m *= 0.5, k++;
    double f = m - 1.0, s = f / (2.0 + f), z = s * s;
    double half = 0.5 * f * f, rest = z * polynomial(z, L, 7);
    return k * LN2[0] - ((half - (s * (half + rest) + k * LN2[1])) - f);
}

/* A third of the exponent, then three times Halley's iteration y <- y + y (r - y) / (2 y + r), r = x / y^2:
 * its relative error goes from 3e-2 through 2e-5 and 6e-15 to rounding. */
double cube_root(double x)
{
    double a = fabs(x);
    if (!(a >= DBL_MIN && a <= DBL_MAX))
        return 0.0;
    double y = of_bits((uint64_t)((uint32_t)(bits_of(a) >> 32) / 3 + 0x2a9f7893) << 32);
    for (int i = 0; i < 3; i++) {
        double r = a / (y * y);
        y += y * ((r - y) / (y + y + r));
    }
    return x < 0.0 ? -y : y;
}
