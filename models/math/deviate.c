/* deviate.c - see deviate.h. */
#include "models/math/deviate.h"

#include <math.h>
#include "models/math/elementary.h"

enum { DEVIATE_BITS = 35, DEGREE = 7 };

/* Coefficients of numerator and denominator, from the constant upwards. */
static double ratio(const double c[DEGREE + 1][2], double x)
{
    double a = c[DEGREE][0], b = c[DEGREE][1];
    for (int i = DEGREE - 1; i >= 0; i--) {
        a = a * x + c[i][0];
        b = b * x + c[i][1];
    }
    return a / b;
}

/* AS 241's third range, tails below e^-25, is never
 * reached: the smallest tail of 35 bits is 2^-36 > e^-25. */
double noise_deviate(uint64_t word)
{
    static const double middle[DEGREE + 1][2] = {
        {3.3871328727963666080e0, 1.0},
        {1.3314166789178437745e+2, 4.2313330701600911252e+1},
        {1.9715909503065514427e+3, 6.8718700749205790830e+2},
        {1.3731693765509461125e+4, 5.3941960214247511077e+3},
        {4.5921953931549871457e+4, 2.1213794301586595867e+4},
        {6.7265770927008700853e+4, 3.9307895800092710610e+4},
        {3.3430575583588128105e+4, 2.8729085735721942674e+4},
        {2.5090809287301226727e+3, 5.2264952788528545610e+3},
    };
    static const double tail[DEGREE + 1][2] = {
        {1.42343711074968357734e0, 1.0},
        {4.63033784615654529590e0, 2.05319162663775882187e0},
        {5.76949722146069140550e0, 1.67638483018380384940e0},
        {3.64784832476320460504e0, 6.89767334985100004550e-1},
        {1.27045825245236838258e0, 1.48103976427480074590e-1},
        {2.41780725177450611770e-1, 1.51986665636164571966e-2},
        {2.27238449892691845833e-2, 5.47593808499534494600e-4},
        {7.74545014278341407640e-4, 1.05075007164441684324e-9},
    };
    int64_t n = (int64_t)(word >> (64 - DEVIATE_BITS)) - (INT64_C(1) << (DEVIATE_BITS - 1));
    double q = ((double)n + 0.5) * 0x1p-35; /* exact, as is the tail's 0.5 - |q| */
    if (fabs(q) <= 0.425)
        return q * ratio(middle, 0.180625 - q * q);
    double x = ratio(tail, sqrt(-logarithm(0.5 - fabs(q))) - 1.6);
    return q < 0.0 ? -x : x;
}
