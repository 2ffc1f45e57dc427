/* taylor_series.h - the power series of method taylor: expansions, and values.
 *
 * Two kinds of plant, both of one degree of freedom (models/model.h):
 *   hertz_form       eta'' = g(t) - damping eta' - stiffness eta - k(t) eta_+^{3/2}
 *   polynomial_form  x''   = a_0(t) + a_1(t) x + a_2(t) x^2 + a_3(t) x^3 - damping x'
 * Their functions of time are `lanes`: 0 is g or a_0, 1 is k or a_1, and so on. A series is TAYLOR_TERMS
 * coefficients, constant first. */
#ifndef FIRMWARE_TAYLOR_SERIES_H
#define FIRMWARE_TAYLOR_SERIES_H

#include <stdbool.h>
#include "firmware/method/taylor/taylor_load.h"

/* The order is the cheapest for tolerances from 1e-5 to 1e-12; order 12 costs 1.1 to 2 times as much there.
 * It is a multiple of four, because polynomials are evaluated in four chains. */
enum { TAYLOR_ORDER = 16, TAYLOR_TERMS = TAYLOR_ORDER + 1 };

/* Loops over the terms of a series have constant bounds; unrolled, each coefficient is a register or a
 * constant. The order of the operations, and so the bits, are those of the loop. */
#if defined(__clang__)
#pragma clang diagnostic ignored "-Wpass-failed" /* clang warns at low levels, where loops stay loops */
#define TAYLOR_UNROLL _Pragma("clang loop unroll(full)")
#else
#define TAYLOR_UNROLL _Pragma("GCC unroll 32")
#endif

/* Two doubles side by side: half the instructions where the machine has such registers. The bits are the same
 * where it has none, because each half is computed by itself. */
typedef double taylor_pair __attribute__((vector_size(16)));
typedef double taylor_unaligned __attribute__((vector_size(16), aligned(8), may_alias));

ALWAYS_INLINE taylor_pair taylor_both(double x)
{
    return (taylor_pair){x, x};
}

ALWAYS_INLINE taylor_pair taylor_pair_at(const double *a)
{
#if defined(__SSE2__)
    return *(const taylor_unaligned *)(const void *)a;
#else /* as a block it would pass through integer registers */
    return (taylor_pair){a[0], a[1]};
#endif
}

ALWAYS_INLINE void taylor_pair_put(double *a, taylor_pair x)
{
#if defined(__SSE2__)
    *(taylor_unaligned *)(void *)a = x;
#else
    a[0] = x[0];
    a[1] = x[1];
#endif
}

/* Coefficient n of the product of two series, n known to the compiler. The sum goes from the middle outwards,
 * so that it waits for the newest coefficients only at the end. */
ALWAYS_INLINE double taylor_product(const double *a, const double *b, int n)
{
    double low = 0.0, high = 0.0;
    TAYLOR_UNROLL
    for (int j = n / 2; j >= 0; j--)
        low += a[j] * b[n - j];
    TAYLOR_UNROLL
    for (int j = n / 2 + 1; j <= n; j++)
        high += a[j] * b[n - j];
    return low + high;
}

/* A cubic in x with coefficients c as one in z = x - x_0. z has no constant term, so z^2 begins at order 2
 * and z^3 at order 3: half the products. */
ALWAYS_INLINE void taylor_shift(const double *c, double x0, double *b)
{
    double c3x = c[3] * x0;
    b[0] = c[0] + ((c3x + c[2]) * x0 + c[1]) * x0;
    b[1] = (3.0 * c3x + 2.0 * c[2]) * x0 + c[1];
    b[2] = 3.0 * c3x + c[2];
    b[3] = c[3];
}

/* Coefficient n > 1 of z^2: pairs of equal products. */
ALWAYS_INLINE double taylor_square(const double *z, int n)
{
    double sum = n % 2 == 0 ? 0.5 * z[n / 2] * z[n / 2] : 0.0;
    TAYLOR_UNROLL
    for (int j = (n - 1) / 2; j >= 1; j--)
        sum += z[j] * z[n - j];
    return 2.0 * sum;
}

/* Coefficient n > 2 of z^3. */
ALWAYS_INLINE double taylor_cube(const double *z, const double *z2, int n)
{
    double low = 0.0, high = 0.0;
    TAYLOR_UNROLL
    for (int j = n / 2; j >= 2; j--)
        low += z2[j] * z[n - j];
    TAYLOR_UNROLL
    for (int j = n / 2 + 1; j < n; j++)
        high += z2[j] * z[n - j];
    return low + high;
}

/* Series in time of the coordinate from (x0, v0).
 * taylor_flight: hertz_form without its contact.
 * taylor_contact: eta0 > 0; force[0..ORDER-2] becomes the series of eta^{3/2}.
 * taylor_polynomial: polynomial_form. */
void taylor_flight(const struct taylor_load *load, double x0, double v0, double *x);
void taylor_contact(const struct taylor_load *load, double eta0, double v0, double *eta, double *force);
void taylor_polynomial(const struct taylor_load *load, double x0, double v0, double *x);

/* Value of a series at x; value and slope. */
double taylor_value(const double *c, double x);
struct taylor_jet {
    double value, slope;
};
struct taylor_jet taylor_jet_at(const double *c, double x);

#endif
