/* rules_method.c - rules that know the motion between the ends of a tick: the terms of `taylor`, and the
 * closed forms of a linear regime; see rules.h. */
#include "tests/bench/ledger/rules.h"

#include <math.h>
#include <string.h>
#include "models/flows.h"
#include "models/shaft_bearing.h"

#define RULE __attribute__((noinline))

/* ---- the terms of taylor ---- */

enum { TERMS = TAYLOR_ORDER };

/* Work and loss from the begin of a series on, over the model time s from there. */
struct moved {
    double work[TERMS + 1], damping[TERMS + 1];
};

/* c becomes the integral of the product of two series, times a factor. */
ALWAYS_INLINE void integrate(const double *a, const double *b, double factor, double *c)
{
    c[0] = 0.0;
    TAYLOR_UNROLL
    for (int n = 0; n < TERMS; n++)
        c[n + 1] = factor * (1.0 / (n + 1)) * taylor_product(a, b, n);
}

/* The drive's force and the velocity as series, then their products. */
ALWAYS_INLINE void moved_of(const struct record *r, const struct series *s, double work, double damping,
                            struct moved *m)
{
    double v[TERMS], f[TERMS], w = r->omega;
    TAYLOR_UNROLL
    for (int n = 0; n < TERMS; n++)
        v[n] = (n + 1) * s->a[n + 1];
    f[0] = r->amplitude * s->cosine;
    f[1] = -w * r->amplitude * s->sine;
    TAYLOR_UNROLL
    for (int n = 2; n < TERMS; n++)
        f[n] = -(w * w) * (1.0 / (n * (n - 1))) * f[n - 2];
    integrate(f, v, work, m->work);
    integrate(v, v, damping, m->damping);
}

/* Simpson's rule for the ticks between two instants, if any: short series served them. */
static void add_between(const struct record *r, double begin, double end, struct books *b)
{
    int from = (int)lround(begin / r->h), to = (int)lround(end / r->h);
    if (from < to)
        rule_by_ledger(r, from, to, b);
}

/* Each series of the record in pieces from..to - 1; `every`: read after each tick. */
ALWAYS_INLINE void add_series(const struct record *r, int from, int to, double work, double damping,
                              bool every, struct books *b)
{
    double begin = from * r->h, end = to * r->h, covered = begin;
    struct moved m;
    for (int i = 0; i < r->n_series; i++) {
        const struct series *s = &r->series[i];
        double low = s->begin > begin ? s->begin : begin, high = s->end < end ? s->end : end;
        if (low >= high)
            continue;
        add_between(r, covered, low, b);
        covered = high;
        moved_of(r, s, work, damping, &m);
        double w = taylor_value(m.work, low - s->begin), d = taylor_value(m.damping, low - s->begin);
        int tick = (int)(low / r->h) + 1;
        for (bool last = false; !last; tick++) {
            last = !every || tick * r->h >= high || tick == to;
            double at = (last ? high : tick * r->h) - s->begin;
            double work_there = taylor_value(m.work, at), damping_there = taylor_value(m.damping, at);
            rules_book(b, work_there - w, damping_there - d);
            w = work_there;
            d = damping_there;
        }
    }
    add_between(r, covered, end, b);
}

/* The work of a force of 1 and the loss, at a velocity of 1 along eta. */
#define SERIES_OF(scene, model_flow)                                                                         \
    static void units_##scene(const struct record *r, double *work, double *damping)                         \
    {                                                                                                        \
        const double x[2] = {1.0, 1.0};                                                                      \
        struct input u[MODEL_INPUTS] = {{1.0, 0.0}};                                                         \
        struct flow f;                                                                                       \
        model_flow(r->p, u, x, &f);                                                                          \
        *work = f.work[r->input];                                                                            \
        *damping = f.damping;                                                                                \
    }                                                                                                        \
    RULE void rule_series_##scene(const struct record *r, int from, int to, struct books *b)                 \
    {                                                                                                        \
        double work, damping;                                                                                \
        units_##scene(r, &work, &damping);                                                                   \
        add_series(r, from, to, work, damping, false, b);                                                    \
    }                                                                                                        \
    RULE void rule_terms_##scene(const struct record *r, int from, int to, struct books *b)                  \
    {                                                                                                        \
        double work, damping;                                                                                \
        units_##scene(r, &work, &damping);                                                                   \
        add_series(r, from, to, work, damping, true, b);                                                     \
    }
SERIES_OF(rig, hertz_rig_flow_forced)
SERIES_OF(tip, afm_tip_flow)

/* ---- closed forms of a linear regime ---- */

/* z = (x, input, its rate over omega, 1) moves as z' = N z in a regime. So work and loss of a tick are
 * quadratic forms of z at its begin. */
enum {
    N = MODEL_LINEAR_STATES,
    INPUT = N,
    RATE,
    ONE,
    Z,
    REGIMES = 1 << MODEL_CONTACTS,
    NODES = 5,
    PARTS = 4
};

typedef double matrix[Z][Z];

struct forms {
    matrix damping;    /* upper triangle, doubled beside the diagonal */
    double work[2][Z]; /* rows of the input and its rate; what both share is in the first */
};

static struct forms table[REGIMES];

static void multiply(const matrix a, const matrix b, matrix c)
{
    matrix product = {{0.0}};
    for (int i = 0; i < Z; i++) {
        for (int k = 0; k < Z; k++) {
            for (int j = 0; j < Z; j++)
                product[i][j] += a[i][k] * b[k][j];
        }
    }
    memcpy(c, product, sizeof product);
}

/* exp(t n): a series of t n / 2^10, squared ten times. */
static void exponential_of(const matrix n, double t, matrix e)
{
    matrix term = {{0.0}}, small;
    for (int i = 0; i < Z; i++) {
        term[i][i] = 1.0;
        for (int j = 0; j < Z; j++)
            small[i][j] = n[i][j] * t / 1024.0;
    }
    memcpy(e, term, sizeof term);
    for (int k = 1; k < 12; k++) {
        multiply(term, small, term);
        for (int i = 0; i < Z * Z; i++) {
            term[i / Z][i % Z] /= k;
            e[i / Z][i % Z] += term[i / Z][i % Z];
        }
    }
    for (int k = 0; k < 10; k++)
        multiply(e, e, e);
}

static bool generator(const struct record *r, unsigned regime, matrix n)
{
    struct linear l;
    if (!r->model->linear(r->p, regime, &l))
        return false;
    memset(n, 0, sizeof(matrix));
    for (int i = 0; i < N; i++) {
        memcpy(n[i], l.a[i], sizeof l.a[i]);
        n[i][INPUT] = l.b[i][r->input];
        n[i][RATE] = l.b_rate[i][r->input] * r->omega;
        n[i][ONE] = l.c[i];
    }
    n[INPUT][RATE] = r->omega;
    n[RATE][INPUT] = -r->omega;
    return true;
}

/* Adds weight times the powers of z(t) = E z, as forms of z. */
static void add_powers(const struct record *r, const matrix e, double weight, struct forms *f)
{
    for (int i = 0; i < Z; i++) {
        for (int j = i; j < Z; j++) {
            double loss = 0.0, v = e[N / 2 + r->input][j], u = e[INPUT][j];
            for (int k = 0; k < N / 2; k++)
                loss += r->p[SHAFT_P_DAMPING + k] * e[N / 2 + k][i] * e[N / 2 + k][j];
            f->damping[i][j] += (i == j ? 1.0 : 2.0) * weight * loss;
            double both = e[INPUT][i] * v + (i == j ? 0.0 : u * e[N / 2 + r->input][i]);
            if (i == INPUT || j == INPUT)
                f->work[0][i == INPUT ? j : i] += weight * both;
            else if (i == RATE || j == RATE)
                f->work[1][i == RATE ? j : i] += weight * both;
        }
    }
}

/* By Gauss's rule, many times over: only the tables' numbers count, not what they cost. */
static bool forms_over(const struct record *r, unsigned regime, double length, struct forms *f)
{
    static const double node[NODES] = {0.0, 0.5384693101056831, -0.5384693101056831, 0.9061798459386640,
                                       -0.9061798459386640};
    static const double weight[NODES] = {0.5688888888888889, 0.4786286704993665, 0.4786286704993665,
                                         0.2369268850561891, 0.2369268850561891};
    matrix n, e;
    double part = length / PARTS;
    memset(f, 0, sizeof *f);
    if (!generator(r, regime, n))
        return false;
    for (int k = 0; k < PARTS * NODES; k++) {
        exponential_of(n, part * (k / NODES + 0.5 + 0.5 * node[k % NODES]), e);
        add_powers(r, e, 0.5 * part * weight[k % NODES], f);
    }
    return true;
}

void forms_prepare(const struct record *r)
{
    for (unsigned regime = 0; regime < REGIMES; regime++)
        (void)forms_over(r, regime, r->h, &table[regime]);
}

ALWAYS_INLINE void add_forms(const struct record *r, const struct piece *q, const struct forms *f,
                             struct books *b)
{
    double z[Z], loss = 0.0, first = 0.0, second = 0.0;
    memcpy(z, q->x0, N * sizeof *z);
    z[INPUT] = q->e.at[0][r->input].value;
    z[RATE] = q->e.at[0][r->input].rate * (1.0 / r->omega);
    z[ONE] = 1.0;
    TAYLOR_UNROLL
    for (int i = 0; i < Z; i++) {
        double row = 0.0;
        TAYLOR_UNROLL
        for (int j = i; j < Z; j++)
            row += f->damping[i][j] * z[j];
        loss += row * z[i];
        first += f->work[0][i] * z[i];
        second += f->work[1][i] * z[i];
    }
    rules_book(b, first * z[INPUT] + second * z[RATE], loss);
}

RULE void rule_forms_shaft(const struct record *r, int from, int to, struct books *b)
{
    for (int i = from, next; i < to; i = next) {
        for (next = i; next < to && r->piece[next].whole; next++)
            add_forms(r, &r->piece[next], &table[r->piece[next].regime], b);
        for (i = next; next < to && !r->piece[next].whole;)
            next++;
        if (next > i)
            rule_by_ledger(r, i, next, b);
    }
}

RULE void rule_all_forms_shaft(const struct record *r, int from, int to, struct books *b)
{
    for (int i = from; i < to; i++) {
        const struct piece *q = &r->piece[i];
        struct forms own;
        if (!q->whole)
            (void)forms_over(r, q->regime, q->e.length, &own);
        add_forms(r, q, q->whole ? &table[q->regime] : &own, b);
    }
}
