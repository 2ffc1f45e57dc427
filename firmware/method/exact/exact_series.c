/* exact_series.c - the power series of a regime's solution, expanded or added up from tables. */
#include "firmware/method/exact/exact_series.h"

#include <math.h>

/* The order that a series needs for this reach. */
static int order_of(double reach)
{
    /* Smallest n with r^(n + 1) / (n + 1)! <= 2^-56 for r = 1/8, 2/8, ...; velocities are one order
     * behind. */
    static const unsigned char order[27] = {10, 12, 13, 15, 16, 17, 18, 18, 19, 20, 21, 21, 22, 23,
                                            23, 24, 24, 25, 26, 26, 27, 27, 28, 28, 29, 29, 30};
    int i = reach < EXACT_REACH ? (int)(8.0 * reach) : 26;
    return order[i] + 1;
}

/* Fastest exponent or phase over the span of this segment. */
static double reach_of(const struct exact_equation *q, const struct segment *e, int n_inputs)
{
    double rate = q->rate;
    for (int i = 0; i < n_inputs; i++) {
        if (((e->active >> i) & 1u) && fabs(e->wave[i].omega) > rate)
            rate = fabs(e->wave[i].omega);
    }
    return rate * e->length;
}

static const double RECIPROCAL[EXACT_TERMS] = {
    0.0,      1.0,      1.0 / 2,  1.0 / 3,  1.0 / 4,  1.0 / 5,  1.0 / 6,  1.0 / 7,
    1.0 / 8,  1.0 / 9,  1.0 / 10, 1.0 / 11, 1.0 / 12, 1.0 / 13, 1.0 / 14, 1.0 / 15,
    1.0 / 16, 1.0 / 17, 1.0 / 18, 1.0 / 19, 1.0 / 20, 1.0 / 21, 1.0 / 22, 1.0 / 23,
    1.0 / 24, 1.0 / 25, 1.0 / 26, 1.0 / 27, 1.0 / 28, 1.0 / 29, 1.0 / 30, 1.0 / 31};

/* Series of what drives the velocities. */
struct load {
    double c[EXACT_TERMS][EXACT_LANES];
};

ALWAYS_INLINE void add_scaled(int half, double *load, const double *b, double value)
{
    EXACT_UNROLL for (int k = 0; k < half; k += 2)
        exact_store(&load[k], exact_load(&load[k]) + exact_load(&b[k]) * value);
}

/* Adds input i to the load. With C_n, S_n the series of cos and sin of theta + omega s over s / l:
 *   u_n = [offset, slope l] + amplitude C_n + growth l C_{n-1},
 *   u'_n = [slope] + growth C_n - omega (amplitude S_n + growth l S_{n-1}). */
ALWAYS_INLINE void add_load(int half, struct load *load, const struct exact_equation *q, const struct wave *v,
                            int i, double l, int order)
{
    double turn = v->omega * l, growth = v->growth * l;
    bool follows_rate = q->follows_rate[i];
    double c = v->cosine, s = v->sine, c_before = 0.0, s_before = 0.0;
    for (int n = 0; n < order; n++) {
        double value = v->amplitude * c + growth * c_before;
        if (n == 0)
            value += v->offset;
        if (n == 1)
            value += v->slope * l;
        add_scaled(half, load->c[n], q->b[i], value);
        if (follows_rate) {
            double rate = v->growth * c - v->omega * (v->amplitude * s + growth * s_before);
            if (n == 0)
                rate += v->slope;
            add_scaled(half, load->c[n], q->b_rate[i], rate);
        }
        double t = turn * RECIPROCAL[n + 1];
        c_before = c, s_before = s;
        c = -t * s_before;
        s = t * c_before;
    }
}

/* The terms one after the other: position_{n+1} = l/(n+1) velocity_n, velocity_{n+1} = l/(n+1) (a x_n +
 * load_n). */
ALWAYS_INLINE void add_terms(int half, const struct exact_equation *q, const struct load *load, double l,
                             int order, const double *x, struct exact_path *path)
{
    double position[EXACT_LANES] = {0.0}, velocity[EXACT_LANES] = {0.0};
    for (int k = 0; k < half; k++) {
        position[k] = x[k];
        velocity[k] = x[half + k];
    }
    for (int n = 0; n < order; n++) {
        double scale = l * RECIPROCAL[n + 1];
        exact_pair next[EXACT_LANES / 2];
        EXACT_UNROLL for (int i = 0; i < half; i += 2)
        {
            exact_pair spring = exact_load(&load->c[n][i]), damper = {0.0, 0.0};
            EXACT_UNROLL for (int k = 0; k < half; k++)
            {
                spring += exact_load(&q->a[k][i]) * position[k];
                damper += exact_load(&q->a[half + k][i]) * velocity[k];
            }
            next[i / 2] = (spring + damper) * scale;
        }
        EXACT_UNROLL for (int k = 0; k < half; k++) path->c[k][n] = position[k];
        EXACT_UNROLL for (int i = 0; i < half; i += 2)
        {
            exact_store(&position[i], exact_load(&velocity[i]) * scale);
            exact_store(&velocity[i], next[i / 2]);
        }
    }
    for (int k = 0; k < half; k++) {
        path->c[k][order] = position[k];
        path->c[k][path->n_terms - 1] = path->n_terms > order + 1 ? 0.0 : position[k];
    }
}

ALWAYS_INLINE void expand(int half, const struct exact_equation *q, const double *c, int n_inputs,
                          const struct segment *e, int order, const double *x, struct exact_path *path)
{
    struct load load;
    memset(&load, 0, (size_t)order * sizeof load.c[0]);
    memcpy(load.c[0], c, sizeof load.c[0]);
    for (int i = 0; i < n_inputs; i++) {
        if ((e->active >> i) & 1u)
            add_load(half, &load, q, &e->wave[i], i, path->unit, order);
    }
    add_terms(half, q, &load, path->unit, order, x, path);
}

/* One copy for each number of states. */
void exact_expand(const struct exact_equation *q, const double *c, const struct model *m,
                  const struct segment *e, double unit, const double *x, struct exact_path *path)
{
    int order = order_of(reach_of(q, e, m->n_inputs));
    path->unit = unit;
    path->end = e->length / unit;
    path->n_terms = order + 1 + (order + 1) % 2;
    if (m->n_states == 6)
        expand(3, q, c, m->n_inputs, e, order, x, path);
    else if (m->n_states == 4)
        expand(2, q, c, m->n_inputs, e, order, x, path);
    else
        expand(1, q, c, m->n_inputs, e, order, x, path);
}

/* Curves of c and of inputs, and how much of each. */
struct mix {
    int n;
    const double *curve[EXACT_COLUMNS];
    double size[EXACT_COLUMNS];
};

ALWAYS_INLINE void add_curve(struct mix *mix, const struct exact_system *s, int column, double size)
{
    mix->curve[mix->n] = s->curve[column][0];
    mix->size[mix->n++] = size;
}

/* Constant and sloping parts of the inputs act as accelerations: base + (s / h) * slope. */
struct accelerations {
    double base[EXACT_LANES], slope[EXACT_LANES];
};

static void add_acceleration(struct accelerations *a, const struct exact_equation *q, int i,
                             const struct wave *v, double unit)
{
    add_scaled(EXACT_LANES, a->base, q->b[i], v->offset);
    add_scaled(EXACT_LANES, a->base, q->b_rate[i], v->slope);
    add_scaled(EXACT_LANES, a->slope, q->b[i], v->slope * unit);
}

/* Curves of c, and of inputs that are constant or slope. */
NEVER_INLINE void add_accelerations(struct mix *mix, const struct exact_system *s,
                                    const struct exact_regime *r, const struct segment *e, int half)
{
    struct accelerations a = {{0.0}, {0.0}};
    memcpy(a.base, r->c, sizeof a.base);
    for (int i = 0; e->active >> i; i++) {
        const struct wave *v = &e->wave[i];
        if (((e->active >> i) & 1u) && (v->offset != 0.0 || v->slope != 0.0))
            add_acceleration(&a, &s->equation, i, v, r->unit);
    }
    for (int k = 0; k < half; k++) {
        if (a.base[k] != 0.0)
            add_curve(mix, s, CURVE_CONSTANT + k, a.base[k]);
        if (a.slope[k] != 0.0)
            add_curve(mix, s, CURVE_SLOPE + k, a.slope[k]);
    }
}

/* False when the tables do not cover these waves. */
static bool mix_up(const struct exact_system *s, const struct exact_regime *r, const struct segment *e,
                   int half, struct mix *mix)
{
    const struct wave *v = e->wave;
    bool phasors_alone = true;
    mix->n = 0;
    for (int i = 0; e->active >> i; i++, v++) {
        if (!((e->active >> i) & 1u))
            continue;
        if (v->growth != 0.0 || (v->omega != s->input[i].omega && v->amplitude != 0.0))
            return false;
        if (v->amplitude != 0.0) {
            add_curve(mix, s, CURVE_COSINE + i, v->amplitude * v->cosine);
            add_curve(mix, s, CURVE_SINE + i, -v->amplitude * v->sine);
        }
        phasors_alone = phasors_alone && v->offset == 0.0 && v->slope == 0.0;
    }
    if (!phasors_alone)
        add_accelerations(mix, s, r, e, half);
    for (int k = 0; phasors_alone && k < half; k++) {
        if (r->c[k] != 0.0)
            add_curve(mix, s, CURVE_CONSTANT + k, r->c[k]);
    }
    return true;
}

/* As many doubles as a register of the target holds. They are read in place: as values of functions they
 * would be an ABI of their own. A block has as many sums as there are registers for. */
#if defined(__AVX__)
typedef double wide __attribute__((vector_size(32), aligned(8), may_alias));
enum { BLOCK = 12 };
#elif defined(__SSE2__)
typedef double wide __attribute__((vector_size(16), aligned(8), may_alias));
enum { BLOCK = 6 };
#else
typedef double wide;
enum { BLOCK = 12 };
#endif
enum { WIDE = sizeof(wide) / sizeof(double), BLOCKS = EXACT_HALF * EXACT_CURVE / WIDE / BLOCK };
STATIC_ASSERT(BLOCKS *BLOCK *WIDE == EXACT_HALF * EXACT_CURVE, whole_blocks);
#if defined(__clang__)
#define UNROLL_BLOCK
#else
#define UNROLL_BLOCK _Pragma("GCC unroll 12")
#endif

ALWAYS_INLINE void add_up(const struct exact_system *s, int n, const double *x, const struct mix *mix,
                          int block, struct exact_path *path)
{
    wide sum[BLOCK];
    const wide *curve = (const wide *)s->curve[CURVE_STATE][0] + block * BLOCK;
    UNROLL_BLOCK for (int j = 0; j < BLOCK; j++) sum[j] = curve[j] * x[0];
    for (int k = 1; k < n; k++) {
        curve = (const wide *)s->curve[CURVE_STATE + k][0] + block * BLOCK;
        UNROLL_BLOCK for (int j = 0; j < BLOCK; j++) sum[j] += curve[j] * x[k];
    }
    for (int k = 0; k < mix->n; k++) {
        curve = (const wide *)mix->curve[k] + block * BLOCK;
        UNROLL_BLOCK for (int j = 0; j < BLOCK; j++) sum[j] += curve[j] * mix->size[k];
    }
    UNROLL_BLOCK for (int j = 0; j < BLOCK; j++)
    {
        int i = (block * BLOCK + j) * WIDE;
        *(wide *)&path->c[i / EXACT_CURVE][2 + i % EXACT_CURVE] = sum[j];
    }
}

void exact_follow(struct exact *w, const struct exact_regime *r, const struct model *m,
                  const struct segment *e, const double *x, struct exact_path *path)
{
    const struct exact_system *s = exact_system_of(w, r);
    struct mix mix;
    int half = m->n_states / 2;
    if (!(e->length <= r->tick && r->tick == r->unit) || !mix_up(s, r, e, half, &mix)) {
        exact_expand(&s->equation, r->c, m, e, r->unit, x, path);
        return;
    }
    path->unit = r->unit;
    path->end = e->length / r->unit;
    path->n_terms = 2 + EXACT_CURVE;
    for (int k = 0; k < half; k++) {
        path->c[k][0] = x[k];
        path->c[k][1] = x[half + k] * r->unit;
    }
    EXACT_UNROLL for (int k = 0; k < BLOCKS; k++) add_up(s, m->n_states, x, &mix, k, path);
}

/* The sum without the terms of the start: even and odd terms side by side, and their derivatives by
 * theta^2. */
ALWAYS_INLINE void change(int half, int n_terms, const struct exact_path *path, double theta, double *dx)
{
    double square = theta * theta, per_unit = 1.0 / path->unit;
    for (int k = 0; k < half; k++) {
        const double *c = path->c[k];
        exact_pair f = exact_load(&c[n_terms - 2]), d = {0.0, 0.0};
        EXACT_UNROLL for (int n = n_terms - 4; n > 0; n -= 2)
        {
            d = d * square + f;
            f = f * square + exact_load(&c[n]);
        }
        d = d * square + f;
        f = f * square;
        dx[k] = f[0] + theta * (f[1] + c[1]);
        dx[half + k] = (f[1] + 2.0 * theta * (d[0] + theta * d[1])) * per_unit;
    }
}

void exact_change(const struct exact_path *path, int n_states, double theta, double *dx)
{
    if (path->n_terms == 2 + EXACT_CURVE)
        change(n_states / 2, 2 + EXACT_CURVE, path, theta, dx);
    else
        change(n_states / 2, path->n_terms, path, theta, dx);
}
