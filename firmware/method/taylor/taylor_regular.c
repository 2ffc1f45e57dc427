/* taylor_regular.c - the contact as a series in regularised variables.
 *
 * eta = y^2, dt = 2 y ds, w = eta':
 *   y' = w,  t' = 2 y,  p' = 2 omega y q,  q' = -2 omega y p  (each tone),
 *   w' = 2 y (g - k y^3 - stiffness y^2) - damping (y^2)',
 * a polynomial system: no division, no root, and nothing singular at y = 0. */
#include "firmware/method/taylor/taylor_load.h"
#include "firmware/method/taylor/taylor_regular.h"

enum { STEADY_TONES = 2 };

/* Four doubles, for two tones at once. */
typedef double quad __attribute__((vector_size(32), aligned(16)));

/* sum_{j=1..n-1} y_j z_{n-j} for n > 1 known to the compiler: from the middle outwards, newest coefficients
 * last. */
#define INNER_PRODUCT(name, vector)                                                                          \
    ALWAYS_INLINE void name(const vector *y, const vector *z, int n, vector *sum)                            \
    {                                                                                                        \
        int middle = n / 2;                                                                                  \
        vector low = y[middle] * z[n - middle];                                                              \
        TAYLOR_UNROLL                                                                                        \
        for (int j = middle - 1; j >= 1; j--)                                                                \
            low += y[j] * z[n - j];                                                                          \
        if (middle + 1 < n) {                                                                                \
            vector high = y[middle + 1] * z[n - middle - 1];                                                 \
            TAYLOR_UNROLL                                                                                    \
            for (int j = middle + 2; j < n; j++)                                                             \
                high += y[j] * z[n - j];                                                                     \
            low += high;                                                                                     \
        }                                                                                                    \
        *sum = low;                                                                                          \
    }
INNER_PRODUCT(inner_product, taylor_pair)
INNER_PRODUCT(inner_product_of_two, quad)

/* (a a)_n without 2 a_0 a_n, n > 1. */
ALWAYS_INLINE taylor_pair inner_square(const taylor_pair *a, int n)
{
    int middle = n / 2;
    taylor_pair sum = a[middle] * a[n - middle];
    if (n % 2 == 0)
        sum *= taylor_both(0.5);
    TAYLOR_UNROLL
    for (int j = middle - 1; j >= 1; j--)
        sum += a[j] * a[n - j];
    return sum + sum;
}

/* (a b)_n, the newest coefficients last. */
ALWAYS_INLINE taylor_pair pair_product(const taylor_pair *a, const taylor_pair *b, int n)
{
    taylor_pair low = a[n / 2] * b[n - n / 2], high = {0.0, 0.0};
    TAYLOR_UNROLL
    for (int j = n / 2 - 1; j >= 0; j--)
        low += a[j] * b[n - j];
    TAYLOR_UNROLL
    for (int j = n / 2 + 1; j <= n; j++)
        high += a[j] * b[n - j];
    return low + high;
}

/* z_{n+1} = 2/(n+1) omega (y q, -y p)_n; returns what (y p)_n adds to the force beyond y_n p_0. */
ALWAYS_INLINE double next_of_one(double y_n, taylor_pair *y, taylor_pair *z, taylor_pair omega, int n)
{
    taylor_pair inner = {0.0, 0.0};
    y[n] = taylor_both(y_n);
    if (n > 1)
        inner_product(y, z, n, &inner);
    taylor_pair newest = y[0] * z[n], all = n > 0 ? (y[n] * z[0] + inner) + newest : newest;
    z[n + 1] = (taylor_pair){all[1], all[0]} * ((2.0 / (n + 1)) * omega);
    return n > 0 ? inner[0] + newest[0] : 0.0;
}

/* next_of_one for two tones; the first n_force of them are in the force. */
ALWAYS_INLINE double next_of_two(double y_n, quad *y, quad *z, const quad *omega, int n, int n_force)
{
    quad inner = {0.0, 0.0, 0.0, 0.0};
    y[n] = (quad){y_n, y_n, y_n, y_n};
    if (n > 1)
        inner_product_of_two(y, z, n, &inner);
    quad newest = y[0] * z[n], all = n > 0 ? (y[n] * z[0] + inner) + newest : newest;
    z[n + 1] = (quad){all[1], all[0], all[3], all[2]} * ((2.0 / (n + 1)) * *omega);
    if (n == 0)
        return 0.0;
    return n_force == 2 ? (inner[0] + inner[2]) + (newest[0] + newest[2]) : inner[0] + newest[0];
}

/* The series for n_force steady tones in lane 0; y p serves the force and the tone itself. `stiff` adds a
 * stiffness, `modulated` one more tone, the last, in lane 1. The chain behind the newest coefficient is kept
 * short: y^4 from y^2, y^2 from y. */
ALWAYS_INLINE void steady(const struct taylor_load *load, const struct taylor_tone *tone, int n_force,
                          bool stiff, bool modulated, double y0, double w0, double *restrict y,
                          double *restrict w, double *restrict t)
{
    taylor_pair z[TAYLOR_TERMS]; /* p, q of the only tone */
    quad zz[TAYLOR_TERMS];       /* p, q of the first, and of the second */
    taylor_pair y2[TAYLOR_TERMS];
    quad y4[TAYLOR_TERMS];
    taylor_pair d[TAYLOR_TERMS]; /* y, y^2 */
    taylor_pair square_fourth[TAYLOR_TERMS], y_k[TAYLOR_TERMS];
    double square[TAYLOR_TERMS];
    double g0 = load->constant[0], k0 = load->constant[1];
    double damping = load->damping, stiffness = load->stiffness;
    double y0_twice = 2.0 * y0, damping_y0 = damping * y0_twice, square_twice = 2.0 * (y0 * y0),
           fourth = (y0 * y0) * (y0 * y0);
    bool two = n_force + modulated == 2;
    taylor_pair omega = {tone[0].omega, -tone[0].omega};
    quad omegas = {tone[0].omega, -tone[0].omega, tone[1].omega, -tone[1].omega};
    y[0] = y0;
    w[0] = w0;
    t[0] = 0.0;
    square[0] = y0 * y0;
    d[0] = (taylor_pair){y0, square[0]};
    z[0] = (taylor_pair){tone[0].p, tone[0].q};
    zz[0] = (quad){tone[0].p, tone[0].q, tone[1].p, tone[1].q};
    g0 += tone[0].p;
    *(modulated ? &k0 : &g0) += two ? tone[1].p : 0.0;
    TAYLOR_UNROLL
    for (int n = 0; n < TAYLOR_ORDER; n++) {
        double f = 1.0 / (n + 1), twice = 2.0 / (n + 1), force = g0 * y[n];
        if (two)
            force += next_of_two(y[n], y4, zz, &omegas, n, n_force);
        else
            force += next_of_one(y[n], y2, z, omega, n);
        if (modulated) {
            square_fourth[n] = (taylor_pair){square[n], fourth};
            y_k[n] = (taylor_pair){y[n], n == 0 ? k0 : zz[n][2]};
            taylor_pair pull = pair_product(square_fourth, y_k, n);
            force -= (stiff ? stiffness * pull[0] : 0.0) + pull[1];
        } else {
            force -= (stiff ? stiffness * taylor_product(square, y, n) : 0.0) + k0 * fourth;
        }
        y[n + 1] = w[n] * f;
        t[n + 1] = y[n] * twice;
        /* y^4 of the next order without 2 y_0^2 (y^2)_{n+1}, and the damping's 2 y y', go into w by
         * themselves. So the chain from one w to the next is short. */
        taylor_pair inner = n > 0 ? inner_square(d, n + 1) : taylor_both(0.0);
        double pulled = modulated || n == 0 ? 0.0 : (k0 * square_twice * twice) * square[n];
        w[n + 1] = ((force * twice - damping * inner[0]) - pulled) - (damping_y0 * f) * w[n];
        square[n + 1] = inner[0] + y0_twice * y[n + 1];
        fourth = modulated ? inner[1] + square_twice * square[n + 1] : inner[1];
        d[n + 1] = (taylor_pair){y[n + 1], square[n + 1]};
    }
}

/* One copy for each kind of load. */
#define STEADY(name, n_force, stiff, modulated)                                                              \
    static __attribute__((noinline)) void name(const struct taylor_load *load,                               \
                                               const struct taylor_tone *tone, double y0, double w0,         \
                                               double *y, double *w, double *t)                              \
    {                                                                                                        \
        steady(load, tone, n_force, stiff, modulated, y0, w0, y, w, t);                                      \
    }
STEADY(steady_one, 1, false, false)
STEADY(steady_two, 2, false, false)
STEADY(steady_stiff, 1, true, false)
STEADY(steady_modulated, 1, false, true)
STEADY(steady_full, 1, true, true)

/* (a b)_n, a plain loop. */
static double product(const double *a, const double *b, int n)
{
    double sum = 0.0;
    for (int j = 0; j <= n; j++)
        sum += a[j] * b[n - j];
    return sum;
}

/* The tones of a load as series in s: p = p_0 C + q_0 S with C, S = cosine and sine of omega t. */
struct waves {
    double c[2 * MODEL_INPUTS][TAYLOR_TERMS], s[2 * MODEL_INPUTS][TAYLOR_TERMS];
};

/* Lane l, order n; the time and the waves up to order n are there. */
static double lane(const struct taylor_load *load, int l, int n, const double *t, const struct waves *v)
{
    double sum = (n == 0 ? load->constant[l] : 0.0) + load->slope[l] * t[n];
    for (int i = 0; i < load->n_tones; i++) {
        const struct taylor_tone *o = &load->tone[i];
        if (o->lane != l)
            continue;
        sum += o->p * v->c[i][n] + o->q * v->s[i][n];
        if (o->tp != 0.0 || o->tq != 0.0)
            sum += o->tp * product(t, v->c[i], n) + o->tq * product(t, v->s[i], n);
    }
    return sum;
}

/* Any load: ramps, any number of tones. */
static void general(const struct taylor_load *load, double y0, double w0, double *y, double *w, double *t)
{
    struct waves v;
    double k[TAYLOR_TERMS], square[TAYLOR_TERMS], cube[TAYLOR_TERMS], pull[TAYLOR_TERMS];
    y[0] = y0;
    w[0] = w0;
    t[0] = 0.0;
    for (int i = 0; i < load->n_tones; i++) {
        v.c[i][0] = 1.0;
        v.s[i][0] = 0.0;
    }
    for (int n = 0; n < TAYLOR_ORDER; n++) {
        double twice = 2.0 / (n + 1);
        k[n] = lane(load, 1, n, t, &v);
        square[n] = product(y, y, n);
        cube[n] = product(square, y, n);
        pull[n] = (lane(load, 0, n, t, &v) - product(k, cube, n)) -
                  (load->stiffness * square[n] + load->damping * w[n]);
        for (int i = 0; i < load->n_tones; i++) {
            double turn = load->tone[i].omega * twice;
            v.c[i][n + 1] = -turn * product(y, v.s[i], n);
            v.s[i][n + 1] = turn * product(y, v.c[i], n);
        }
        y[n + 1] = w[n] * (1.0 / (n + 1));
        t[n + 1] = y[n] * twice;
        w[n + 1] = product(y, pull, n) * twice;
    }
}

void taylor_regular(const struct taylor_load *load, double y0, double w0, double *y, double *w, double *t)
{
    struct taylor_tone tone[STEADY_TONES] = {{0}};
    bool stiff = load->stiffness != 0.0, modulated = (load->varies & 2u) != 0, fits = !load->ramping;
    int n_force = 0, n_modulation = 0;
    for (int i = 0; i < load->n_tones && fits; i++) {
        bool force = load->tone[i].lane == 0;
        fits = force ? n_force < (stiff || modulated ? 1 : STEADY_TONES) : n_modulation == 0;
        if (fits)
            tone[force ? n_force : 1] = load->tone[i];
        n_force += force;
        n_modulation += !force;
    }
    if (!fits)
        general(load, y0, w0, y, w, t);
    else if (modulated)
        (stiff ? steady_full : steady_modulated)(load, tone, y0, w0, y, w, t);
    else if (stiff)
        steady_stiff(load, tone, y0, w0, y, w, t);
    else
        (n_force == 2 ? steady_two : steady_one)(load, tone, y0, w0, y, w, t);
}
