/* exact_series.c - see exact_series.h. */
#include "firmware/exact_series.h"

#include <math.h>

int exact_order(double reach)
{
    /* Smallest n with r^(n + 1) / (n + 1)! <= 2^-56 for r = 1/8, 2/8, ... */
    static const unsigned char order[27] = {10, 12, 13, 15, 16, 17, 18, 18, 19, 20, 21, 21, 22, 23,
                                            23, 24, 24, 25, 26, 26, 27, 27, 28, 28, 29, 29, 30};
    int i = reach < EXACT_REACH ? (int)(8.0 * reach) : 26;
    return order[i];
}

double exact_reach(const struct exact_regime *r, const struct excitation *e, int n_inputs, double l)
{
    double rate = r->rate;
    for (int i = 0; i < n_inputs; i++) {
        if (((e->active >> i) & 1u) && fabs(e->wave[i].omega) > rate)
            rate = fabs(e->wave[i].omega);
    }
    return rate * fabs(l);
}

static const double RECIPROCAL[EXACT_TERMS + 1] = {
    0.0,      1.0,      1.0 / 2,  1.0 / 3,  1.0 / 4,  1.0 / 5,  1.0 / 6,  1.0 / 7,
    1.0 / 8,  1.0 / 9,  1.0 / 10, 1.0 / 11, 1.0 / 12, 1.0 / 13, 1.0 / 14, 1.0 / 15,
    1.0 / 16, 1.0 / 17, 1.0 / 18, 1.0 / 19, 1.0 / 20, 1.0 / 21, 1.0 / 22, 1.0 / 23,
    1.0 / 24, 1.0 / 25, 1.0 / 26, 1.0 / 27, 1.0 / 28, 1.0 / 29, 1.0 / 30, 1.0 / 31};

/* Adds input i to the load. With C_n, S_n the series of cos and sin of theta + omega s over s / l:
 *   u_n = [offset, slope l] + amplitude C_n + growth l C_{n-1},
 *   u'_n = [slope] + growth C_n - omega (amplitude S_n + growth l S_{n-1}). */
ALWAYS_INLINE void add_load(int pairs, struct exact *w, const struct exact_regime *r, const struct wave *v,
                            int i, double l, int order)
{
    double turn = v->omega * l, growth = v->growth * l;
    bool follows_rate = r->follows_rate[i] != 0.0;
    double c = v->cosine, s = v->sine, c_before = 0.0, s_before = 0.0;
    for (int n = 0; n < order; n++) {
        double value = v->amplitude * c + growth * c_before;
        if (n == 0)
            value += v->offset;
        if (n == 1)
            value += v->slope * l;
        EXACT_UNROLL for (int k = 0; k < 2 * pairs; k += 2)
            exact_store(&w->load[n][k], exact_load(&w->load[n][k]) + exact_load(&r->b[i][k]) * value);
        if (follows_rate) {
            double rate = v->growth * c - v->omega * (v->amplitude * s + growth * s_before);
            if (n == 0)
                rate += v->slope;
            EXACT_UNROLL for (int k = 0; k < 2 * pairs; k += 2)
                exact_store(&w->load[n][k], exact_load(&w->load[n][k]) + exact_load(&r->b_rate[i][k]) * rate);
        }
        double t = turn * RECIPROCAL[n + 1];
        c_before = c, s_before = s;
        c = -t * s_before;
        s = t * c_before;
    }
}

/* The terms one after the other: position_{n+1} = l/(n+1) velocity_n, velocity_{n+1} = l/(n+1) (a x_n + load_n). */
ALWAYS_INLINE void add_terms(int half, int pairs, struct exact *w, const struct exact_regime *r, double l,
                             int order)
{
    for (int n = 0; n < order; n++) {
        const double *position = w->term[n], *velocity = w->term[n] + EXACT_LANES;
        double *next = w->term[n + 1], scale = l * RECIPROCAL[n + 1];
        EXACT_UNROLL for (int i = 0; i < 2 * pairs; i += 2)
        {
            exact_pair spring = exact_load(&w->load[n][i]), damper = {0.0, 0.0};
            EXACT_UNROLL for (int k = 0; k < half; k++)
            {
                spring += exact_load(&r->a[k][i]) * position[k];
                damper += exact_load(&r->a[half + k][i]) * velocity[k];
            }
            exact_store(&next[i], exact_load(&velocity[i]) * scale);
            exact_store(&next[EXACT_LANES + i], (spring + damper) * scale);
        }
    }
}

ALWAYS_INLINE void expand(int half, struct exact *w, const struct exact_regime *r, int n_inputs,
                          const struct excitation *e, double l, int order, const double *x)
{
    int pairs = (half + 1) / 2;
    memcpy(w->load[0], r->c, sizeof r->c);
    memset(w->load[1], 0, (size_t)(order - 1) * sizeof w->load[0]);
    for (int i = 0; i < n_inputs; i++) {
        if ((e->active >> i) & 1u)
            add_load(pairs, w, r, &e->wave[i], i, l, order);
    }
    memset(w->term[0], 0, sizeof w->term[0]);
    for (int k = 0; k < half; k++) {
        w->term[0][k] = x[k];
        w->term[0][EXACT_LANES + k] = x[half + k];
    }
    add_terms(half, pairs, w, r, l, order);
}

/* One instantiation a size. */
void exact_expand(struct exact *w, const struct exact_regime *r, const struct model *m,
                  const struct excitation *e, double l, int order, const double *x)
{
    if (m->n_states == 6)
        expand(3, w, r, m->n_inputs, e, l, order, x);
    else if (m->n_states == 4)
        expand(2, w, r, m->n_inputs, e, l, order, x);
    else
        expand(1, w, r, m->n_inputs, e, l, order, x);
}

ALWAYS_INLINE void change(int half, const struct exact *w, int order, double theta, double *dx)
{
    int pairs = (half + 1) / 2;
    exact_pair y[EXACT_LANES] = {{0.0, 0.0}};
    for (int n = order; n > 0; n--) {
        EXACT_UNROLL for (int i = 0; i < pairs; i++)
        {
            y[i] = (y[i] + exact_load(&w->term[n][2 * i])) * theta;
            y[pairs + i] = (y[pairs + i] + exact_load(&w->term[n][EXACT_LANES + 2 * i])) * theta;
        }
    }
    EXACT_UNROLL for (int k = 0; k < half; k++)
    {
        dx[k] = y[k / 2][k % 2];
        dx[half + k] = y[pairs + k / 2][k % 2];
    }
}

void exact_change(const struct exact *w, int n_states, int order, double theta, double *dx)
{
    if (n_states == 6)
        change(3, w, order, theta, dx);
    else if (n_states == 4)
        change(2, w, order, theta, dx);
    else
        change(1, w, order, theta, dx);
}
