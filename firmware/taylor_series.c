/* taylor_series.c - expansions in time, and evaluation; see taylor_series.h. */
#include "firmware/taylor_series.h"

#include <math.h>

/* (5/2) j/n - 1: a constant where the loops are unrolled. */
#define HALF(j, n) ((5.0 * (j)-2.0 * (n)) / (2.0 * (n)))

enum { LAST = TAYLOR_ORDER - 2 }; /* of a force: the coordinate has two orders more */

/* A steady tone: p_{n+1} = omega q_n/(n+1), q_{n+1} = -omega p_n/(n+1). */
ALWAYS_INLINE void add_steady(const struct taylor_tone *t, double *out)
{
    double p = t->p, q = t->q, omega = t->omega;
    TAYLOR_UNROLL
    for (int n = 0; n <= LAST; n++) {
        double before = p, w = omega * (1.0 / (n + 1));
        out[n] += p;
        p = w * q;
        q = -w * before;
    }
}

/* What grows: t tp(t). */
static void add_growing(const struct taylor_tone *t, double *out)
{
    double p = t->tp, q = t->tq;
    for (int n = 0; n < LAST; n++) {
        double before = p, w = t->omega * (1.0 / (n + 1));
        out[n + 1] += p;
        p = w * q;
        q = -w * before;
    }
}

/* Lane l as a series in time, 0..LAST. */
static void lane_series(const struct taylor_load *load, int l, double *out)
{
    TAYLOR_UNROLL
    for (int n = 0; n <= LAST; n++)
        out[n] = 0.0;
    out[0] = load->constant[l];
    out[1] = load->slope[l];
    for (int i = 0; i < load->n_tones; i++) {
        const struct taylor_tone *t = &load->tone[i];
        if (t->lane != l)
            continue;
        add_steady(t, out);
        if (t->tp != 0.0 || t->tq != 0.0)
            add_growing(t, out);
    }
}

void taylor_flight(const struct taylor_load *load, double x0, double v0, double *x)
{
    double g[TAYLOR_TERMS];
    double damping = load->damping, stiffness = load->stiffness;
    lane_series(load, 0, g);
    x[0] = x0;
    x[1] = v0;
    TAYLOR_UNROLL
    for (int n = 0; n <= LAST; n++) {
        double drag = damping * (n + 1);
        x[n + 2] = ((g[n] - stiffness * x[n]) - drag * x[n + 1]) * (1.0 / ((n + 1) * (n + 2)));
    }
}

/* F = eta^{3/2}: eta F' = (3/2) eta' F, so F_n = (1/eta_0) sum_{j=1..n} ((5/2) j/n - 1) eta_j F_{n-j}. The sum runs from
 * its middle outwards: the terms that hold the newest coefficients come last, the rest is done while those are on their
 * way. */
ALWAYS_INLINE double force_coefficient(const double *e, const double *f, int n, double inverse)
{
    double low = 0.0, high = 0.0;
    if (n == 1)
        return ((HALF(1, 1) * e[1]) * f[0]) * inverse;
    TAYLOR_UNROLL
    for (int j = (n + 1) / 2; j >= 2; j--)
        low += (HALF(j, n) * e[j]) * f[n - j];
    TAYLOR_UNROLL
    for (int j = (n + 1) / 2 < 2 ? 2 : (n + 1) / 2 + 1; j < n; j++)
        high += (HALF(j, n) * f[n - j]) * e[j];
    double newest = n > 2 || (n + 1) / 2 < 2 ? (HALF(n, n) * f[0]) * e[n] : 0.0;
    return (((low + high) + newest) + (HALF(1, n) * e[1]) * f[n - 1]) * inverse;
}

ALWAYS_INLINE void contact(const struct taylor_load *load, bool modulated, double eta0, double v0,
                           double *eta, double *force)
{
    double e[TAYLOR_TERMS], f[TAYLOR_TERMS], g[TAYLOR_TERMS], k[TAYLOR_TERMS];
    double damping = load->damping, stiffness = load->stiffness, k0 = load->constant[1];
    double inverse = 1.0 / eta0;
    lane_series(load, 0, g);
    if (modulated)
        lane_series(load, 1, k);
    e[0] = eta0;
    e[1] = v0;
    f[0] = eta0 * sqrt(eta0);
    TAYLOR_UNROLL
    for (int n = 0; n <= LAST; n++) {
        double scale = 1.0 / ((n + 1) * (n + 2)), older = 0.0, k_scale = (modulated ? k[0] : k0) * scale;
        if (n > 0)
            f[n] = force_coefficient(e, f, n, inverse);
        if (modulated) {
            TAYLOR_UNROLL
            for (int j = n; j >= 1; j--)
                older += k[j] * f[n - j];
        }
        double rest = ((g[n] - stiffness * e[n]) - older) - (damping * (n + 1)) * e[n + 1];
        e[n + 2] = rest * scale - k_scale * f[n];
    }
    TAYLOR_UNROLL
    for (int n = 0; n <= LAST; n++)
        force[n] = f[n];
    TAYLOR_UNROLL
    for (int n = 0; n <= TAYLOR_ORDER; n++)
        eta[n] = e[n];
}

void taylor_contact(const struct taylor_load *load, double eta0, double v0, double *eta, double *force)
{
    if (load->varies & 2u)
        contact(load, true, eta0, v0, eta, force);
    else
        contact(load, false, eta0, v0, eta, force);
}

/* x^2 and x^3 by one convolution each, three more where the lanes vary. */
ALWAYS_INLINE void cubic(const struct taylor_load *load, bool modulated, double x0, double v0, double *out)
{
    double a[TAYLOR_LANES][TAYLOR_TERMS], x[TAYLOR_TERMS], x2[TAYLOR_TERMS], x3[TAYLOR_TERMS];
    double damping = load->damping, a1 = load->constant[1], a2 = load->constant[2], a3 = load->constant[3];
    lane_series(load, 0, a[0]);
    for (int l = 1; modulated && l < TAYLOR_LANES; l++)
        lane_series(load, l, a[l]);
    x[0] = x0;
    x[1] = v0;
    TAYLOR_UNROLL
    for (int n = 0; n <= LAST; n++) {
        double sum = a[0][n] - (damping * (n + 1)) * x[n + 1];
        x2[n] = taylor_product(x, x, n);
        x3[n] = taylor_product(x2, x, n);
        if (modulated)
            sum += (taylor_product(a[1], x, n) + taylor_product(a[2], x2, n)) + taylor_product(a[3], x3, n);
        else
            sum += (a1 * x[n] + a2 * x2[n]) + a3 * x3[n];
        x[n + 2] = sum * (1.0 / ((n + 1) * (n + 2)));
    }
    TAYLOR_UNROLL
    for (int n = 0; n <= TAYLOR_ORDER; n++)
        out[n] = x[n];
}

void taylor_polynomial(const struct taylor_load *load, double x0, double v0, double *x)
{
    if (load->varies & ~1u)
        cubic(load, true, x0, v0, x);
    else
        cubic(load, false, x0, v0, x);
}

double taylor_value(const double *c, double x)
{
    double square = x * x, even = c[TAYLOR_ORDER], odd = c[TAYLOR_ORDER - 1];
    TAYLOR_UNROLL
    for (int n = TAYLOR_ORDER - 2; n >= 2; n -= 2) {
        even = even * square + c[n];
        odd = odd * square + c[n - 1];
    }
    return (even * square + c[0]) + odd * x;
}

double taylor_slope(const double *c, double x)
{
    double square = x * x, even = TAYLOR_ORDER * c[TAYLOR_ORDER],
           odd = (TAYLOR_ORDER - 1) * c[TAYLOR_ORDER - 1];
    TAYLOR_UNROLL
    for (int n = TAYLOR_ORDER - 2; n >= 2; n -= 2) {
        even = even * square + n * c[n];
        odd = odd * square + (n - 1) * c[n - 1];
    }
    return odd + even * x;
}
