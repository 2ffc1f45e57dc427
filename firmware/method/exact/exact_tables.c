/* exact_tables.c - method exact at the start: refusals, the systems of the regimes, responses over a tick and
 * inside it. */
#include "firmware/method/exact/exact_tables.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include "models/math/elementary.h"
#include "firmware/method/exact/exact_books.h"
#include "firmware/method/exact/exact_series.h"

enum { SQUARINGS = 12 };

struct square {
    double m[MODEL_LINEAR_STATES][MODEL_LINEAR_STATES];
};

/* The largest |entry|; a NaN is kept. */
static double norm(const struct square *a, int n)
{
    double max = 0.0;
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n; k++) {
            if (!(fabs(a->m[i][k]) <= max))
                max = fabs(a->m[i][k]);
        }
    }
    return max;
}

static void square_of(const struct square *a, int n, struct square *b)
{
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n; k++) {
            b->m[i][k] = 0.0;
            for (int j = 0; j < n; j++)
                b->m[i][k] += a->m[i][j] * a->m[j][k];
        }
    }
}

/* The largest |eigenvalue| as norm(A^N)^(1/N) with N = 2^12 (Gelfand): from above, 0.3 % at most for the
 * plants here, and no eigenvalue problem that could fail. Each power is scaled to norm 1; the logarithms add
 * up. */
static double spectral_radius(const struct square *a, int n)
{
    struct square b, c = *a;
    double log = 0.0, weight = 1.0;
    for (int s = 0;; s++) {
        double size = norm(&c, n);
        if (!(size > 0.0))
            return size; /* nilpotent, or NaN */
        log += weight * logarithm(size);
        if (s == SQUARINGS)
            break;
        for (int i = 0; i < n; i++)
            for (int k = 0; k < n; k++)
                b.m[i][k] = c.m[i][k] / size;
        square_of(&b, n, &c);
        weight *= 0.5;
    }
    return exponential(log + weight * logarithm((double)n));
}

/* Velocities in units that make the matrix balanced: v = unit w, position' = unit w, w' = (a x)/unit + ... */
static double rate_of(const struct linear *l, int n)
{
    struct square a;
    double stiffest = 0.0;
    int half = n / 2;
    for (int i = half; i < n; i++)
        for (int k = 0; k < half; k++)
            stiffest = fabs(l->a[i][k]) > stiffest ? fabs(l->a[i][k]) : stiffest;
    double unit = stiffest > 0.0 ? sqrt(stiffest) : 1.0;
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n; k++) {
            double up = i < half && k >= half ? unit : 1.0;
            double down = i >= half && k < half ? unit : 1.0;
            a.m[i][k] = l->a[i][k] * up / down;
        }
    }
    return spectral_radius(&a, n);
}

/* position' = velocity and nothing else */
static bool second_order(const struct model *m, const struct linear *l)
{
    int half = m->n_states / 2;
    double other = 0.0;
    for (int i = 0; i < half; i++) {
        for (int k = 0; k < 2 * half; k++)
            other += fabs(l->a[i][k] - (k == half + i ? 1.0 : 0.0));
        for (int k = 0; k < m->n_inputs; k++)
            other += fabs(l->b[i][k]) + fabs(l->b_rate[i][k]);
        other += fabs(l->c[i]);
    }
    return other == 0.0;
}

/* Rates at unit velocities are the gaps' coefficients, without rounding. False when a gap follows anything
 * but one position. */
static bool find_gaps(const struct model *m, const double *p, struct exact_gap *gap)
{
    struct input u[MODEL_INPUTS] = {{0.0, 0.0}}, g[MODEL_CONTACTS];
    double x[MODEL_LINEAR_STATES] = {0.0}, other = 0.0;
    int half = m->n_states / 2, found = 0;
    m->gap(p, u, x, g);
    for (int c = 0; c < m->n_contacts; c++)
        gap[c] = (struct exact_gap){g[c].value, 0.0, 0};
    for (int k = 0; k < half; k++) {
        x[half + k] = 1.0;
        m->gap(p, u, x, g);
        x[half + k] = 0.0;
        for (int c = 0; c < m->n_contacts; c++) {
            if (g[c].rate != 0.0)
                gap[c] = (struct exact_gap){gap[c].constant, g[c].rate, k}, found++;
        }
    }
    for (int i = 0; i < m->n_inputs; i++) {
        u[i] = (struct input){1.0, 1.0};
        m->gap(p, u, x, g);
        u[i] = (struct input){0.0, 0.0};
        for (int c = 0; c < m->n_contacts; c++)
            other += fabs(g[c].value - gap[c].constant) + fabs(g[c].rate);
    }
    return found == m->n_contacts && other == 0.0;
}

/* The linear system of a regime; false where there is none. */
static bool linear_of(const struct model *m, const double *p, unsigned regime, struct linear *l)
{
    memset(l, 0, sizeof *l);
    return m->linear(p, regime, l);
}

/* Differ in c at most. */
static bool alike(const struct model *m, const struct linear *l, const struct linear *k)
{
    double other = 0.0;
    for (int i = 0; i < m->n_states; i++) {
        for (int j = 0; j < m->n_states; j++)
            other += fabs(l->a[i][j] - k->a[i][j]);
        for (int j = 0; j < m->n_inputs; j++)
            other += fabs(l->b[i][j] - k->b[i][j]) + fabs(l->b_rate[i][j] - k->b_rate[i][j]);
    }
    return other == 0.0;
}

/* The first regime that has this one's system. */
static unsigned first_alike(const struct model *m, const double *p, unsigned regime, const struct linear *l)
{
    struct linear other;
    for (unsigned i = 0; i < regime; i++) {
        if (linear_of(m, p, i, &other) && alike(m, l, &other))
            return i;
    }
    return regime;
}

const char *exact_refuse(const struct model *m, const double *p, double h, double tol)
{
    struct linear l;
    struct exact_gap gap[MODEL_CONTACTS];
    int systems = 0;
    (void)tol;
    if (!m->linear)
        return "exact is for piecewise linear models: this one is not";
    if (m->n_states % 2 != 0)
        return "exact needs a model in second-order form";
    if (m->n_contacts > 0 && !find_gaps(m, p, gap))
        return "exact needs gaps that follow one position each";
    for (unsigned regime = 0; regime < 1u << m->n_contacts; regime++) {
        if (!linear_of(m, p, regime, &l))
            continue;
        systems += first_alike(m, p, regime, &l) == regime;
        if (!second_order(m, &l))
            return "exact needs a model in second-order form";
        double angle = h * rate_of(&l, m->n_states);
        if (m->n_contacts == 0 && !(angle <= EXACT_PIECES * EXACT_LIMIT))
            return "step too coarse for exact: the fastest mode times step is above 67 rad; use a step below "
                   "ten of that mode's periods";
        if (m->n_contacts > 0 && !(angle <= EXACT_LIMIT))
            return "step too coarse for exact: the fastest mode of some contact regime times step is above "
                   "2.1 "
                   "rad, and a contact could close and open unseen; use a step below a third of that mode's "
                   "period";
    }
    if (systems > EXACT_SYSTEMS)
        return "exact has tables for four different linear systems: this model's contact regimes have more";
    return NULL;
}

static void take_equation(const struct model *m, const struct linear *l, struct exact_equation *q)
{
    int half = m->n_states / 2;
    for (int i = 0; i < half; i++) {
        for (int k = 0; k < 2 * half; k++)
            q->a[k][i] = l->a[half + i][k];
        for (int k = 0; k < m->n_inputs; k++) {
            q->b[k][i] = l->b[half + i][k];
            q->b_rate[k][i] = l->b_rate[half + i][k];
            q->follows_rate[k] |= q->b_rate[k][i] != 0.0;
        }
    }
    q->rate = rate_of(l, m->n_states);
}

/* The region of its positions: an open contact has a gap above zero, a closed one below. */
static void find_walls(const struct model *m, const struct exact_gap *gap, unsigned regime,
                       struct exact_regime *r)
{
    for (int k = 0; k < EXACT_LANES; k++)
        r->below[k] = -DBL_MAX, r->above[k] = DBL_MAX;
    for (int c = 0; c < m->n_contacts; c++) {
        double wall = -gap[c].constant / gap[c].slope;
        bool closed = (regime >> c) & 1u;
        int k = gap[c].position;
        if ((gap[c].slope > 0.0) == closed && wall < r->above[k])
            r->above[k] = wall, r->contact_above[k] = c;
        if ((gap[c].slope > 0.0) != closed && wall > r->below[k])
            r->below[k] = wall, r->contact_below[k] = c;
    }
    for (int i = 0, last = m->n_states / 2 - 1; i < 2; i++) {
        bool others = last == 2 && (r->below[1] > -DBL_MAX || r->above[1] < DBL_MAX);
        r->ends_below[i] = others ? DBL_MAX : r->below[i * last];
        r->ends_above[i] = others ? -DBL_MAX : r->above[i * last];
    }
}

/* Replaces the terms beyond EXACT_CURVE. On [0, 1] x^n is a polynomial of lower degree to within 2^(1 - 2n),
 * which is the size of the Chebyshev polynomial with leading coefficient 1. Its coefficients have the ratios
 * a_k/a_{k+1} below. */
static void economise(double *g, int n_terms)
{
    for (int n = n_terms - 1; n >= EXACT_CURVE; n--) {
        double a = g[n];
        for (int k = n - 1; k >= 0; k--) {
            a *= -(double)((2 * k + 1) * (2 * k + 2)) / (double)(4 * (n + k) * (n - k));
            g[k] -= a;
        }
    }
}

/* One cause alone, over a tick: curves and responses are made of these. */
struct cause {
    const struct model *m;
    double h;
    const struct exact_equation *equation;
    double c[EXACT_LANES], x[MODEL_LINEAR_STATES];
    struct segment e;
};

static void no_cause(struct cause *q, const struct model *m, double h, const struct exact_equation *equation)
{
    memset(q, 0, sizeof *q);
    q->m = m;
    q->h = h;
    q->equation = equation;
    q->e.length = h;
}

/* The change of the state over a tick that one series does not reach over. */
static void respond_far(const struct cause *q, double *change)
{
    struct segment part;
    struct exact_path path;
    double x[MODEL_LINEAR_STATES], dx[MODEL_LINEAR_STATES];
    int n = q->m->n_states, parts = (int)(q->h * q->equation->rate / EXACT_LIMIT) + 1;
    double length = q->h / parts;
    memcpy(x, q->x, sizeof x);
    for (int i = 0; i < parts; i++) {
        part = q->e;
        segment_tail(&part, q->m->n_inputs, i * length);
        segment_head(&part, q->m->n_inputs, length, &part);
        exact_expand(q->equation, q->c, q->m, &part, length, x, &path);
        exact_change(&path, n, 1.0, dx);
        for (int k = 0; k < n; k++)
            x[k] += dx[k];
    }
    for (int k = 0; k < n; k++)
        change[k] = x[k] - q->x[k];
}

/* A row of changes from the path over a tick. */
static void change_row(const struct exact_path *path, int n, double *row)
{
    double half_way[MODEL_LINEAR_STATES];
    exact_change(path, n, 1.0, row);
    exact_change(path, n, 0.5, half_way);
    for (int k = n / 4 * 2, i = n; k < n; k++, i++)
        row[i] = half_way[k];
}

/* The row of changes (NULL: not wanted), and the positions in between (NULL: not wanted). */
static void respond(const struct cause *q, double *change, double (*curve)[EXACT_CURVE])
{
    struct exact_path path;
    if (q->h * q->equation->rate > EXACT_LIMIT) {
        if (change)
            respond_far(q, change);
        return;
    }
    memset(&path, 0, sizeof path);
    exact_expand(q->equation, q->c, q->m, &q->e, q->h, q->x, &path);
    if (change)
        change_row(&path, q->m->n_states, change);
    for (int k = 0; curve && k < q->m->n_states / 2; k++) {
        economise(&path.c[k][2], path.n_terms - 2);
        memcpy(curve[k], &path.c[k][2], sizeof curve[k]);
    }
}

static void respond_to_wave(const struct exact_equation *equation, const struct model *m, double h, int i,
                            const struct wave *wave, double *change, double (*curve)[EXACT_CURVE])
{
    struct cause q;
    no_cause(&q, m, h, equation);
    q.e.active = 1u << i;
    q.e.wave[i] = *wave;
    respond(&q, change, curve);
}

void exact_tune(struct exact_system *s, const struct model *m, double h, int i, double omega)
{
    respond_to_wave(&s->equation, m, h, i, &(struct wave){.amplitude = 1.0, .cosine = 1.0, .omega = omega},
                    s->input[i].cosine, s->curve[CURVE_COSINE + i]);
    respond_to_wave(&s->equation, m, h, i, &(struct wave){.amplitude = 1.0, .sine = -1.0, .omega = omega},
                    s->input[i].sine, s->curve[CURVE_SINE + i]);
    s->input[i].omega = omega;
}

/* Accelerations of one velocity: 1, and s / h as an input that nothing else feels. */
NEVER_INLINE void fill_accelerations(struct exact_system *s, const struct model *m, double h)
{
    struct exact_equation single = s->equation;
    struct cause q;
    no_cause(&q, m, h, &single);
    q.e.wave[0].slope = 1.0 / h;
    single.follows_rate[0] = false;
    memset(single.b[0], 0, sizeof single.b[0]);
    for (int k = 0; k < m->n_states / 2; k++) {
        q.c[k] = single.b[0][k] = 1.0;
        q.e.active = 0;
        respond(&q, NULL, s->curve[CURVE_CONSTANT + k]);
        q.c[k] = 0.0;
        q.e.active = 1;
        respond(&q, NULL, s->curve[CURVE_SLOPE + k]);
        single.b[0][k] = 0.0;
    }
}

NEVER_INLINE void fill_states(struct exact_system *s, const struct model *m, double h)
{
    struct cause q;
    no_cause(&q, m, h, &s->equation);
    for (int k = 0; k < m->n_states; k++) {
        q.x[k] = 1.0;
        respond(&q, s->whole[k], s->curve[CURVE_STATE + k]);
        q.x[k] = 0.0;
    }
}

/* In turns, so that the stack holds the cause of one. */
static void fill_system(struct exact_system *s, const struct model *m, double h)
{
    fill_states(s, m, h);
    fill_accelerations(s, m, h);
    for (int i = 0; i < m->n_inputs; i++) {
        respond_to_wave(&s->equation, m, h, i, &(struct wave){.offset = 1.0}, s->input[i].offset, NULL);
        respond_to_wave(&s->equation, m, h, i, &(struct wave){.slope = 1.0}, s->input[i].slope, NULL);
        exact_tune(s, m, h, i, 0.0);
    }
}

NEVER_INLINE void fill_rest(const struct exact *w, const struct exact_system *s, const struct model *m,
                            struct exact_regime *r)
{
    struct cause q;
    no_cause(&q, m, w->h, &s->equation);
    memcpy(q.c, r->c, sizeof q.c);
    respond(&q, r->rest, NULL);
}

/* The system of a regime, which may be that of an earlier one, and its c. False where there is none, or where
 * too many regimes have their own: forced past the refusal, that regime stops the plant. */
NEVER_INLINE bool take_regime(struct exact *w, const struct model *m, const double *p, unsigned regime,
                              int *systems)
{
    struct linear l;
    struct exact_regime *r = &w->regime[regime];
    if (!linear_of(m, p, regime, &l))
        return false;
    unsigned first = first_alike(m, p, regime, &l);
    if (first == regime ? *systems == EXACT_SYSTEMS : w->regime[first].reach == 0.0)
        return false;
    r->system = first < regime ? w->regime[first].system : (*systems)++;
    if (first == regime) {
        struct exact_system *s = exact_system_of(w, r);
        memset(s, 0, sizeof *s);
        take_equation(m, &l, &s->equation);
    }
    for (int i = 0; i < m->n_states / 2; i++)
        r->c[i] = l.c[m->n_states / 2 + i];
    return true;
}

void exact_prepare(const struct model *m, const double *p, double h, double tol, double *scratch)
{
    struct exact *w = (struct exact *)(void *)scratch;
    int systems = 0;
    (void)tol;
    memset(w, 0, sizeof *w);
    w->h = h;
    if (m->n_contacts > 0)
        (void)find_gaps(m, p, w->gap);
    for (int regime = 0; regime < EXACT_REGIMES; regime++)
        w->regime[regime].tick = -1.0;
    for (unsigned regime = 0; regime < 1u << m->n_contacts; regime++) {
        struct exact_regime *r = &w->regime[regime];
        int before = systems;
        if (!take_regime(w, m, p, regime, &systems))
            continue;
        struct exact_system *s = exact_system_of(w, r);
        r->reach = s->equation.rate > 0.0 ? EXACT_LIMIT / s->equation.rate : DBL_MAX;
        r->unit = h <= r->reach ? h : r->reach;
        r->tick = h <= r->reach || m->n_contacts == 0 ? h : -1.0;
        find_walls(m, w->gap, regime, r);
        if (r->tick == h) {
            if (systems > before)
                fill_system(s, m, h);
            fill_rest(w, s, m, r);
        }
    }
    exact_find_powers(m, p, w);
}
