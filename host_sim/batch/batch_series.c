/* batch_series.c - see batch_series.h. */
#include "host_sim/batch/batch_series.h"

/* (a b)_n; the newest coefficients come last, the rest is done while they are on their way. */
ALWAYS_INLINE quad product(const quad *a, const quad *b, int n)
{
    if (n == 0)
        return a[0] * b[0];
    quad low = a[n / 2] * b[n - n / 2], high = all_lanes(0.0);
    BATCH_UNROLL
    for (int j = n / 2 - 1; j >= 0; j--)
        low += a[j] * b[n - j];
    if (n / 2 + 1 <= n)
        high = a[n / 2 + 1] * b[n - n / 2 - 1];
    BATCH_UNROLL
    for (int j = n / 2 + 2; j <= n; j++)
        high += a[j] * b[n - j];
    return low + high;
}

/* (a a)_n, n > 0. */
ALWAYS_INLINE quad square_of(const quad *a, int n)
{
    quad newest = (2.0 * a[0]) * a[n], half = all_lanes(0.0);
    if (n == 1)
        return newest;
    if (n % 2 == 0)
        half = (0.5 * a[n / 2]) * a[n / 2];
    else
        half = a[n / 2] * a[n / 2 + 1];
    BATCH_UNROLL
    for (int j = n / 2 - 1; j >= 1; j--)
        half += a[j] * a[n - j];
    return (half + half) + newest;
}

/* Scratch memory of one expansion in s. */
struct regular {
    quad p[BATCH_TONES][BATCH_TERMS], q[BATCH_TONES][BATCH_TERMS];
    quad square[BATCH_TERMS], fourth[BATCH_TERMS];
};

/* From the coefficients up to n those of n + 1:
 *   y' = w,  t' = 2 y,  p' = 2 omega y q,  q' = -2 omega y p,
 *   w' = 2 y (force - hertz y^3 - stiffness y^2) - damping (y^2)'. */
ALWAYS_INLINE void regular_order(const struct batch_load *load, int n_force, bool full, int n,
                                 struct regular *r, struct batch_series *s)
{
    quad *y = s->a, *w = s->b;
    double f = 1.0 / (n + 1), twice = 2.0 / (n + 1);
    quad force = load->constant * y[n] - load->hertz * r->fourth[n];
    BATCH_UNROLL
    for (int i = 0; i < BATCH_TONES; i++) {
        bool stiffness = i == BATCH_STIFFNESS_TONE;
        if (stiffness ? !full : i >= n_force)
            continue;
        quad yp = product(y, r->p[i], n), turn = load->tone[i].omega * twice;
        r->p[i][n + 1] = turn * product(y, r->q[i], n);
        r->q[i][n + 1] = -turn * yp;
        force += stiffness ? -product(r->fourth, r->p[i], n) : yp;
    }
    if (full)
        force -= load->stiffness * product(r->square, y, n);
    y[n + 1] = w[n] * f;
    s->time[n + 1] = y[n] * twice;
    r->square[n + 1] = square_of(y, n + 1);
    r->fourth[n + 1] = square_of(r->square, n + 1);
    w[n + 1] = force * twice - load->damping * r->square[n + 1];
}

ALWAYS_INLINE void regular(const struct batch_load *load, int n_force, bool full, const quad *y,
                           const quad *w, struct batch_series *s)
{
    struct regular r[BATCH_WIDE];
    for (int v = 0; v < BATCH_WIDE; v++) {
        s[v].a[0] = y[v];
        s[v].b[0] = w[v];
        s[v].time[0] = all_lanes(0.0);
        r[v].square[0] = y[v] * y[v];
        r[v].fourth[0] = r[v].square[0] * r[v].square[0];
        for (int i = 0; i < BATCH_TONES; i++) {
            if (i == BATCH_STIFFNESS_TONE ? !full : i >= n_force)
                continue;
            r[v].p[i][0] = load[v].tone[i].p;
            r[v].q[i][0] = load[v].tone[i].q;
        }
    }
    BATCH_UNROLL
    for (int n = 0; n < BATCH_ORDER; n++) {
        BATCH_UNROLL
        for (int v = 0; v < BATCH_WIDE; v++)
            regular_order(&load[v], n_force, full, n, &r[v], &s[v]);
    }
}

void batch_series_regular(const struct batch_load *load, int n_tones, const quad *y, const quad *w,
                          struct batch_series *s)
{
    if (n_tones == BATCH_TONES)
        regular(load, BATCH_STIFFNESS_TONE, true, y, w, s);
    else if (n_tones == 2)
        regular(load, 2, false, y, w, s);
    else
        regular(load, 1, false, y, w, s);
}

/* The tones of one expansion in time, at the order that is next. */
struct now {
    quad p[BATCH_TONES], q[BATCH_TONES];
};

ALWAYS_INLINE void begin_tones(struct now *now, const struct batch_load *load, int n_force, bool full)
{
    for (int i = 0; i < BATCH_TONES; i++) {
        if (i == BATCH_STIFFNESS_TONE ? !full : i >= n_force)
            continue;
        now->p[i] = load->tone[i].p;
        now->q[i] = load->tone[i].q;
    }
}

/* Order n of tone i, and on to the next. */
ALWAYS_INLINE quad tone_order(struct now *now, const struct batch_load *load, int i, int n)
{
    quad p = now->p[i], turn = load->tone[i].omega * (1.0 / (n + 1));
    now->p[i] = turn * now->q[i];
    now->q[i] = -turn * p;
    return p;
}

/* Order n of the force without the contact's. */
ALWAYS_INLINE quad force_order(struct now *now, const struct batch_load *load, int n_force, bool stiff, int n,
                               const struct batch_series *s)
{
    quad force = n == 0 ? load->constant : all_lanes(0.0);
    BATCH_UNROLL
    for (int i = 0; i < n_force; i++)
        force += tone_order(now, load, i, n);
    if (stiff)
        force -= load->stiffness * s->a[n];
    return force - load->damping * s->b[n];
}

ALWAYS_INLINE void flight(const struct batch_load *load, int n_force, bool stiff, const quad *eta,
                          const quad *rate, struct batch_series *s)
{
    for (int v = 0; v < BATCH_WIDE; v++) {
        struct now now;
        begin_tones(&now, &load[v], n_force, false);
        s[v].a[0] = eta[v];
        s[v].b[0] = rate[v];
        BATCH_UNROLL
        for (int n = 0; n < BATCH_ORDER; n++) {
            s[v].a[n + 1] = s[v].b[n] * (1.0 / (n + 1));
            s[v].b[n + 1] = force_order(&now, &load[v], n_force, stiff, n, &s[v]) * (1.0 / (n + 1));
        }
    }
}

void batch_series_flight(const struct batch_load *load, int n_tones, const quad *eta, const quad *rate,
                         struct batch_series *s)
{
    if (n_tones == BATCH_TONES)
        flight(load, BATCH_STIFFNESS_TONE, true, eta, rate, s);
    else if (n_tones == 2)
        flight(load, 2, false, eta, rate, s);
    else
        flight(load, 1, false, eta, rate, s);
}

/* F = eta^{3/2}: eta F' = (3/2) eta' F, so F_n = (1/eta_0) sum_{j=1..n} ((5/2) j/n - 1) eta_j F_{n-j}; the
 * newest coefficient comes last. */
ALWAYS_INLINE quad force_coefficient(const quad *eta, const quad *force, int n, quad inverse)
{
    quad low = all_lanes(0.0), high = low;
    if (n == 1)
        return (1.5 * eta[1]) * force[0] * inverse;
    BATCH_UNROLL
    for (int j = n / 2; j >= 2; j--)
        low += ((2.5 * j / n - 1.0) * eta[j]) * force[n - j];
    BATCH_UNROLL
    for (int j = n / 2 + 1; j < n; j++)
        high += ((2.5 * j / n - 1.0) * force[n - j]) * eta[j];
    return (((low + high) + (1.5 * force[0]) * eta[n]) + ((2.5 / n - 1.0) * eta[1]) * force[n - 1]) * inverse;
}

ALWAYS_INLINE void contact(const struct batch_load *load, int n_force, bool full, const quad *eta,
                           const quad *rate, struct batch_series *s)
{
    struct now now[BATCH_WIDE];
    quad inverse[BATCH_WIDE], modulation[BATCH_WIDE][BATCH_TERMS];
    for (int v = 0; v < BATCH_WIDE; v++) {
        begin_tones(&now[v], &load[v], n_force, full);
        s[v].a[0] = eta[v];
        s[v].b[0] = rate[v];
        s[v].force[0] = contact_force(eta[v]);
        s[v].force[BATCH_ORDER] = all_lanes(0.0);
        inverse[v] = 1.0 / eta[v];
    }
    BATCH_UNROLL
    for (int n = 0; n < BATCH_ORDER; n++) {
        BATCH_UNROLL
        for (int v = 0; v < BATCH_WIDE; v++) {
            quad *force = s[v].force, rest = force_order(&now[v], &load[v], n_force, full, n, &s[v]);
            if (n > 0)
                force[n] = force_coefficient(s[v].a, force, n, inverse[v]);
            if (full) {
                modulation[v][n] = tone_order(&now[v], &load[v], BATCH_STIFFNESS_TONE, n);
                rest -= product(modulation[v], force, n);
            }
            s[v].a[n + 1] = s[v].b[n] * (1.0 / (n + 1));
            s[v].b[n + 1] = (rest - load[v].hertz * force[n]) * (1.0 / (n + 1));
        }
    }
}

void batch_series_contact(const struct batch_load *load, int n_tones, const quad *eta, const quad *rate,
                          struct batch_series *s)
{
    if (n_tones == BATCH_TONES)
        contact(load, BATCH_STIFFNESS_TONE, true, eta, rate, s);
    else if (n_tones == 2)
        contact(load, 2, false, eta, rate, s);
    else
        contact(load, 1, false, eta, rate, s);
}
