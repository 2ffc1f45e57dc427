/* taylor_regular.c - the contact as a series in regularised variables; see taylor_series.h.
 *
 * eta = y^2, dt = 2 y ds, w = eta':
 *   y' = w,  t' = 2 y,  p' = 2 omega y q,  q' = -2 omega y p  (each tone),
 *   w' = 2 y (g - k y^3 - stiffness y^2) - damping (y^2)',
 * a polynomial system: no division, no root, and nothing singular at y = 0. */
#include "firmware/taylor_series.h"

enum { STEADY_TONES = 2 };

/* Two convolutions side by side: half the instructions where the machine has such registers, and the same bits where the
 * compiler takes them apart, because each half is computed by itself. */
typedef double pair __attribute__((vector_size(16)));

ALWAYS_INLINE pair both(double x)
{
    return (pair){x, x};
}

/* (y z)_n without y_n z_0, n > 0 and known to the compiler; the newest coefficient last. */
ALWAYS_INLINE pair inner_product(const pair *y, const pair *z, int n)
{
    int middle = n / 2;
    pair low = y[middle] * z[n - middle], high = y[n - 1] * z[1];
    TAYLOR_UNROLL
    for (int j = middle - 1; j >= 0; j--)
        low += y[j] * z[n - j];
    if (middle == n - 1)
        return low;
    TAYLOR_UNROLL
    for (int j = n - 2; j > middle; j--)
        high += y[j] * z[n - j];
    return high + low;
}

/* (a a)_n without 2 a_0 a_n, n > 1. */
ALWAYS_INLINE pair inner_square(const pair *a, int n)
{
    int middle = n / 2;
    pair sum = a[middle] * a[n - middle];
    if (n % 2 == 0)
        sum *= both(0.5);
    TAYLOR_UNROLL
    for (int j = middle - 1; j >= 1; j--)
        sum += a[j] * a[n - j];
    return sum + sum;
}

/* n_force steady tones in lane 0: y p serves both the force and the tone itself; with `full` also a stiffness and one
 * tone, the last, in lane 1. What waits for the newest coefficient is kept short: y^4 from y^2, y^2 from y. */
ALWAYS_INLINE void steady(const struct taylor_load *load, const struct taylor_tone *tone, int n_force,
                          bool full, double y0, double w0, double *y_out, double *w_out, double *t_out)
{
    double y[TAYLOR_TERMS], w[TAYLOR_TERMS], t[TAYLOR_TERMS];
    pair yy[TAYLOR_TERMS];              /* y, y */
    pair z[STEADY_TONES][TAYLOR_TERMS]; /* p, q of each tone */
    pair d[TAYLOR_TERMS];               /* y, y^2 */
    double fourth[TAYLOR_TERMS], square[TAYLOR_TERMS], k[TAYLOR_TERMS];
    double g0 = load->constant[0], k0 = load->constant[1];
    double damping = load->damping, stiffness = load->stiffness;
    double y0_twice = 2.0 * y0, square_twice = 2.0 * (y0 * y0);
    int n_tones = n_force + full;
    y[0] = y0;
    w[0] = w0;
    t[0] = 0.0;
    square[0] = y0 * y0;
    d[0] = (pair){y0, square[0]};
    yy[0] = both(y0);
    fourth[0] = square[0] * square[0];
    for (int i = 0; i < n_tones; i++) {
        z[i][0] = (pair){tone[i].p, tone[i].q};
        if (i < n_force)
            g0 += tone[i].p;
    }
    TAYLOR_UNROLL
    for (int n = 0; n < TAYLOR_ORDER; n++) {
        double f = 1.0 / (n + 1), twice = 2.0 / (n + 1), force = g0 * y[n];
        for (int i = 0; i < n_tones; i++) {
            pair older = n > 0 ? inner_product(yy, z[i], n) : both(0.0), all = yy[n] * z[i][0] + older;
            double turn = tone[i].omega * twice;
            if (i < n_force && n > 0)
                force += older[0];
            z[i][n + 1] = (pair){all[1], all[0]} * (pair){turn, -turn};
        }
        y[n + 1] = w[n] * f;
        yy[n + 1] = both(y[n + 1]);
        t[n + 1] = y[n] * twice;
        pair inner = n > 0 ? inner_square(d, n + 1) : both(0.0);
        square[n + 1] = inner[0] + y0_twice * y[n + 1];
        fourth[n + 1] = inner[1] + square_twice * square[n + 1];
        if (full) {
            k[n] = n == 0 ? k0 + z[n_force][0][0] : z[n_force][n][0];
            force -= stiffness * taylor_product(square, y, n) + taylor_product(k, fourth, n);
        } else {
            force -= k0 * fourth[n];
        }
        w[n + 1] = force * twice - damping * square[n + 1];
        d[n + 1] = (pair){y[n + 1], square[n + 1]};
    }
    TAYLOR_UNROLL
    for (int n = 0; n <= TAYLOR_ORDER; n++) {
        y_out[n] = y[n];
        w_out[n] = w[n];
        t_out[n] = t[n];
    }
}

static __attribute__((noinline)) void steady_one(const struct taylor_load *load,
                                                 const struct taylor_tone *tone, double y0, double w0,
                                                 double *y, double *w, double *t)
{
    steady(load, tone, 1, false, y0, w0, y, w, t);
}

static __attribute__((noinline)) void steady_two(const struct taylor_load *load,
                                                 const struct taylor_tone *tone, double y0, double w0,
                                                 double *y, double *w, double *t)
{
    steady(load, tone, 2, false, y0, w0, y, w, t);
}

static __attribute__((noinline)) void steady_full(const struct taylor_load *load,
                                                  const struct taylor_tone *tone, double y0, double w0,
                                                  double *y, double *w, double *t)
{
    steady(load, tone, 1, true, y0, w0, y, w, t);
}

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
    bool full = load->stiffness != 0.0 || (load->varies & 2u);
    int n_lane[2] = {0, 0};
    if (load->n_tones <= STEADY_TONES) {
        for (int i = 0; i < load->n_tones; i++) {
            int l = load->tone[i].lane;
            tone[l == 1 ? 1 : n_lane[0]] = load->tone[i];
            n_lane[l]++;
        }
    }
    if (load->ramping || load->n_tones > STEADY_TONES || n_lane[1] > 1 || (full && n_lane[0] > 1))
        general(load, y0, w0, y, w, t);
    else if (full)
        steady_full(load, tone, y0, w0, y, w, t);
    else if (load->n_tones == 2)
        steady_two(load, tone, y0, w0, y, w, t);
    else
        steady_one(load, tone, y0, w0, y, w, t);
}
