/* taylor_series.c - expansions in time, and evaluation; see taylor_series.h. */
#include "firmware/method/taylor/taylor_series.h"

#include <math.h>
#include <string.h>
#include "firmware/method/taylor/taylor_load.h"

/* (5/2) j/n - 1: a constant where the loops are unrolled. */
#define HALF(j, n) ((5.0 * (j)-2.0 * (n)) / (2.0 * (n)))

enum { LAST = TAYLOR_ORDER - 2 }; /* last order of a force: the coordinate has two orders more */

/* A steady tone: p_{n+1} = omega q_n/(n+1), q_{n+1} = -omega p_n/(n+1); `first`: nothing is there to add
 * to. */
ALWAYS_INLINE void add_steady(const struct taylor_tone *t, bool first, double *out)
{
    double p = t->p, q = t->q, omega = t->omega;
    TAYLOR_UNROLL
    for (int n = 0; n <= LAST; n++) {
        double before = p, w = omega * (1.0 / (n + 1));
        out[n] = first ? p : out[n] + p;
        p = w * q;
        q = -w * before;
    }
}

/* Adds the growing part of a tone, t tp(t). */
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
    bool first = true;
    for (int i = 0; i < load->n_tones; i++) {
        const struct taylor_tone *t = &load->tone[i];
        if (t->lane != l)
            continue;
        if (first)
            add_steady(t, true, out);
        else
            add_steady(t, false, out);
        first = false;
        if (t->tp != 0.0 || t->tq != 0.0)
            add_growing(t, out);
    }
    if (first)
        memset(out, 0, TAYLOR_TERMS * sizeof *out);
    out[0] += load->constant[l];
    out[1] += load->slope[l];
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
        double scale = 1.0 / ((n + 1) * (n + 2)), drag = damping * (1.0 / (n + 2));
        x[n + 2] = (g[n] - stiffness * x[n]) * scale - drag * x[n + 1];
    }
}

/* sum_{j=2..n-1} weight(j) a_j f_{n-j}; weight: (5/2) j/n - 1, or 1. a is in pairs (a_j, a_{j+1}) with j
 * even, f in pairs (f_j, f_{j-1}). The sum goes from the middle outwards, so that it waits for the newest
 * coefficients only at the end. */
ALWAYS_INLINE double inner(const taylor_pair *a, const taylor_pair *f, int n, bool weighted)
{
    taylor_pair low = {0.0, 0.0}, high = {0.0, 0.0};
    int pairs = (n - 2) / 2, middle = (pairs + 1) / 2; /* pair i: j = 2 i, 1 <= i <= pairs */
    TAYLOR_UNROLL
    for (int i = middle; i >= 1; i--)
        low += (weighted ? (taylor_pair){HALF(2 * i, n), HALF(2 * i + 1, n)} * a[i] : a[i]) * f[n - 2 * i];
    TAYLOR_UNROLL
    for (int i = middle + 1; i <= pairs; i++)
        high += (weighted ? (taylor_pair){HALF(2 * i, n), HALF(2 * i + 1, n)} * a[i] : a[i]) * f[n - 2 * i];
    low += high;
    double sum = low[0] + low[1];
    if (n % 2 == 1 && n > 2)
        sum += (weighted ? HALF(n - 1, n) : 1.0) * a[(n - 1) / 2][0] * f[1][0];
    return sum;
}

/* F = eta^{3/2}: eta F' = (3/2) eta' F, so F_n = (1/eta_0) sum_{j=1..n} ((5/2) j/n - 1) eta_j F_{n-j}. */
ALWAYS_INLINE void contact(const struct taylor_load *load, bool modulated, double eta0, double v0,
                           double *restrict e, double *restrict f)
{
    double g[TAYLOR_TERMS], k[TAYLOR_TERMS];
    taylor_pair e_pair[TAYLOR_TERMS], k_pair[TAYLOR_TERMS], f_pair[TAYLOR_TERMS];
    double damping = load->damping, stiffness = load->stiffness, k0 = load->constant[1];
    double inverse = 1.0 / eta0, e1_inverse = v0 * inverse, root = sqrt(eta0);
    lane_series(load, 0, g);
    if (modulated)
        lane_series(load, 1, k);
    for (int n = 2; modulated && n < TAYLOR_TERMS - 1; n += 2)
        k_pair[n / 2] = (taylor_pair){k[n], k[n + 1]};
    e[0] = eta0;
    e[1] = v0;
    f[0] = eta0 * root;
    TAYLOR_UNROLL
    for (int n = 0; n <= LAST; n++) {
        double scale = 1.0 / ((n + 1) * (n + 2)), older = 0.0, k_scale = (modulated ? k[0] : k0) * scale;
        if (n > 0) {
            f[n] = (HALF(1, n) * e1_inverse) * f[n - 1];
            if (n > 1)
                f[n] += inner(e_pair, f_pair, n, true) * inverse + (HALF(n, n) * root) * e[n];
            f_pair[n] = (taylor_pair){f[n], f[n - 1]};
        }
        if (modulated && n > 0)
            older = (inner(k_pair, f_pair, n, false) + (n > 1 ? k[n] * f[0] : 0.0)) + k[1] * f[n - 1];
        double rest = ((g[n] - stiffness * e[n]) - older) * scale;
        e[n + 2] = (rest - (damping * (1.0 / (n + 2))) * e[n + 1]) - k_scale * f[n];
        if (n % 2 == 1)
            e_pair[(n + 1) / 2] = (taylor_pair){e[n + 1], e[n + 2]};
    }
}

void taylor_contact(const struct taylor_load *load, double eta0, double v0, double *eta, double *force)
{
    if (load->varies & 2u)
        contact(load, true, eta0, v0, eta, force);
    else
        contact(load, false, eta0, v0, eta, force);
}

/* In the deviation z from the start, whose powers begin late. */
static void cubic(const struct taylor_load *load, double x0, double v0, double *z)
{
    double g[TAYLOR_TERMS], z2[TAYLOR_TERMS], z3[TAYLOR_TERMS], b[TAYLOR_LANES];
    double damping = load->damping;
    lane_series(load, 0, g);
    taylor_shift(load->constant, x0, b);
    g[0] += b[0] - load->constant[0];
    z[1] = v0;
    TAYLOR_UNROLL
    for (int n = 0; n <= LAST; n++) {
        double sum = g[n];
        if (n > 0)
            sum += b[1] * z[n];
        if (n > 1) {
            z2[n] = taylor_square(z, n);
            sum += b[2] * z2[n];
        }
        if (n > 2) {
            z3[n] = taylor_cube(z, z2, n);
            sum += b[3] * z3[n];
        }
        z[n + 2] = sum * (1.0 / ((n + 1) * (n + 2))) - (damping * (1.0 / (n + 2))) * z[n + 1];
    }
    z[0] = x0;
}

/* x^2 and x^3 by one convolution each, three more for the lanes. */
static void cubic_modulated(const struct taylor_load *load, double x0, double v0, double *out)
{
    double a[TAYLOR_LANES][TAYLOR_TERMS], x[TAYLOR_TERMS], x2[TAYLOR_TERMS], x3[TAYLOR_TERMS];
    double damping = load->damping;
    for (int l = 0; l < TAYLOR_LANES; l++)
        lane_series(load, l, a[l]);
    x[0] = x0;
    x[1] = v0;
    TAYLOR_UNROLL
    for (int n = 0; n <= LAST; n++) {
        double sum = a[0][n];
        x2[n] = taylor_product(x, x, n);
        x3[n] = taylor_product(x2, x, n);
        sum += (taylor_product(a[1], x, n) + taylor_product(a[2], x2, n)) + taylor_product(a[3], x3, n);
        x[n + 2] = sum * (1.0 / ((n + 1) * (n + 2))) - (damping * (1.0 / (n + 2))) * x[n + 1];
    }
    TAYLOR_UNROLL
    for (int n = 0; n <= TAYLOR_ORDER; n++)
        out[n] = x[n];
}

void taylor_polynomial(const struct taylor_load *load, double x0, double v0, double *x)
{
    if (load->varies & ~1u)
        cubic_modulated(load, x0, v0, x);
    else
        cubic(load, x0, v0, x);
}

/* Horner's rule in w = x^4, in chains of a quarter of the order: even and odd powers side by side, and every
 * other pair of them in a chain of its own. The pair of x^0, x^1 is in chain a; the value is a + x^2 b. */
double taylor_value(const double *c, double x)
{
    double z = x * x;
    taylor_pair w = taylor_both(z * z), a = {c[TAYLOR_ORDER], 0.0}, b = taylor_pair_at(&c[TAYLOR_ORDER - 2]);
    TAYLOR_UNROLL
    for (int n = TAYLOR_ORDER - 4; n >= 0; n -= 4) {
        a = a * w + taylor_pair_at(&c[n]);
        if (n >= 2)
            b = b * w + taylor_pair_at(&c[n - 2]);
    }
    taylor_pair sum = a + b * taylor_both(z);
    return sum[0] + sum[1] * x;
}

/* With S = P(w) + z Q(w), z = x^2: dS/dz = Q + 2 (z P' + w Q'); and the value S[0] + x S[1] has the slope
 * S[1] + 2 (x dS/dz[0] + z dS/dz[1]). */
struct taylor_jet taylor_jet_at(const double *c, double x)
{
    double z = x * x;
    taylor_pair square = taylor_both(z), w = taylor_both(z * z);
    taylor_pair a = {c[TAYLOR_ORDER], 0.0}, b = taylor_pair_at(&c[TAYLOR_ORDER - 2]);
    taylor_pair a_slope = {0.0, 0.0}, b_slope = {0.0, 0.0};
    TAYLOR_UNROLL
    for (int n = TAYLOR_ORDER - 4; n >= 0; n -= 4) {
        a_slope = a_slope * w + a;
        a = a * w + taylor_pair_at(&c[n]);
        if (n >= 2) {
            b_slope = b_slope * w + b;
            b = b * w + taylor_pair_at(&c[n - 2]);
        }
    }
    taylor_pair sum = a + b * square;
    taylor_pair slope = b + taylor_both(2.0) * (a_slope * square + b_slope * w);
    return (struct taylor_jet){sum[0] + sum[1] * x, sum[1] + 2.0 * (x * slope[0] + z * slope[1])};
}
