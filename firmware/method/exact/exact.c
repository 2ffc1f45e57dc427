/* exact.c - the exact solution of piecewise linear plants: its error does not depend on the step.
 *
 * While no contact switches, the state after a tick is a matrix times the state before, plus the responses to
 * the phasors and samples of the inputs. All are tabulated at the start: (n + 2) n multiply-adds for one
 * harmonic drive. Inside a tick each position is a polynomial in time, a sum of tabulated curves
 * (exact_series.h). It serves parts of a tick, and ticks in which a position is, or may have been, beyond a
 * wall; the switch is located on it. Only tables of frequencies are carried from one tick to the next.
 *
 * At the limit of the step (2.1 rad of the fastest mode) a chaotic shaft has one switch in about 500 000 that
 * is not seen: a brief parting inside a tick. A model without contacts misses nothing, and its ticks may be
 * 32 times as long.
 *
 * Cost on the shaft with one harmonic drive, in instructions by gcc -O3 for x86-64-v3:
 *     a tick                                                                             165
 *     a switch (two polynomials, the root, the state there and at the end)              2400
 *     a tick or part of it by the series itself                                 1500 to 2500 */
#include "firmware/method/exact/exact.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include "firmware/method/exact/exact_root.h"
#include "firmware/method/exact/exact_series.h"
#include "firmware/method/exact/exact_tables.h"

enum {
    ANY_PIECES = 256 /* bound on the pieces of a step that runs through its switches */
};

/* The arguments that the functions below share. */
struct task {
    const struct model *m;
    struct exact *w;
};

/* y += row * size, for a state of n components in pairs */
ALWAYS_INLINE void add_row(int n, exact_pair *y, const double *row, double size)
{
    EXACT_UNROLL for (int k = 0; k < n / 2; k++) y[k] += exact_load(&row[2 * k]) * size;
}

/* Responses to c and to the inputs over a whole tick; false when the tables do not cover these waves. */
ALWAYS_INLINE bool respond(int n, const struct exact_system *s, const struct exact_regime *r,
                           const struct segment *e, exact_pair *y)
{
    EXACT_UNROLL for (int k = 0; k < n / 2; k++) y[k] = exact_load(&r->rest[2 * k]);
    const struct wave *v = e->wave;
    const struct exact_response *q = s->input;
    for (unsigned left = e->active; left; left >>= 1, v++, q++) {
        if (!(left & 1u))
            continue;
        if (v->growth != 0.0)
            return false;
        if (v->amplitude != 0.0) {
            if (v->omega != q->omega)
                return false;
            add_row(n, y, q->cosine, v->amplitude * v->cosine);
            add_row(n, y, q->sine, -v->amplitude * v->sine);
        }
        if (v->offset != 0.0)
            add_row(n, y, q->offset, v->offset);
        if (v->slope != 0.0)
            add_row(n, y, q->slope, v->slope);
    }
    return true;
}

/* x1 becomes the state a tick after x, in pairs. Three sums of a third of the terms each make shorter chains
 * than one. False when the tables do not cover these waves. */
ALWAYS_INLINE bool tick(int n, const struct exact_system *s, const struct exact_regime *r,
                        const struct segment *e, const double *x, exact_pair *x1)
{
    exact_pair inputs[MODEL_LINEAR_STATES / 2];
    if (!respond(n, s, r, e, inputs))
        return false;
    EXACT_UNROLL for (int k = 0; k < n / 2; k++)
    {
        exact_pair position = exact_load(&s->whole[0][2 * k]) * x[0];
        exact_pair velocity = exact_load(&s->whole[n / 2][2 * k]) * x[n / 2];
        EXACT_UNROLL for (int j = 1; j < n / 2; j++)
        {
            position += exact_load(&s->whole[j][2 * k]) * x[j];
            velocity += exact_load(&s->whole[n / 2 + j][2 * k]) * x[n / 2 + j];
        }
        x1[k] = exact_load(&x[2 * k]) + ((position + velocity) + inputs[k]);
    }
    return true;
}

typedef long long exact_bits __attribute__((vector_size(16)));

ALWAYS_INLINE exact_pair magnitude(exact_pair v)
{
    const exact_bits all_but_sign = {0x7fffffffffffffff, 0x7fffffffffffffff};
    return (exact_pair)((exact_bits)v & all_but_sign);
}

/* How far a position that turns can be beyond both ends, over the sum of the rates there. Its Hermite cubic
 * reaches 4/27; a quarter leaves room for what is not cubic. */
static const double overshoot = 0.25;

/* Both ends are finite and too far from every wall for a switch in between. Only the first and the last
 * position are looked at: where others have walls, no tick is clear (struct exact_regime). */
ALWAYS_INLINE bool clear(int half, const struct exact_regime *r, double length, const double *x,
                         const exact_pair *x1)
{
    int last = half - 1;
    exact_pair from = {x[0], x[last]}, to = {x1[0][0], x1[last / 2][last % 2]};
    exact_pair v = {x[half], x[half + last]}, v1 = {x1[half / 2][half % 2], x1[last][1]};
    exact_pair far = (magnitude(v) + magnitude(v1)) * (overshoot * length);
    if (half == 3) { /* the position and velocity in between are finite, too */
        exact_pair sum = x1[0] + x1[last];
        far += sum - sum;
    }
    exact_pair above = exact_load(r->ends_above) - far, below = exact_load(r->ends_below) + far;
    exact_bits inside = (from < above) & (to < above) & (from > below) & (to > below);
    return (inside[0] & inside[1]) != 0;
}
STATIC_ASSERT(EXACT_HALF == 3, one_in_between_at_most);

static struct input gap_at(const struct exact_gap *g, int half, const double *x)
{
    int k = g->position;
    return (struct input){g->constant + g->slope * x[k], g->slope * x[half + k]};
}

/* True when a function of time rises to zero in the span, or may do so. It turns down when the rates at the
 * ends say so, or one of them together with the rate of their Hermite cubic half-way. Rates are per span. */
static bool may_rise(double f0, double d0, double f1, double d1)
{
    double halfway = 1.5 * (f1 - f0) - 0.25 * (d0 + d1);
    return f1 >= 0.0 || (d0 > 0.0 && (d1 < 0.0 || halfway < 0.0)) || (halfway > 0.0 && d1 < 0.0);
}

/* The contacts that may have switched between x and x1. */
static unsigned suspects(int half, const struct exact_regime *r, double length, const double *x,
                         const double *x1)
{
    unsigned found = 0;
    for (int i = 0; i < half; i++) {
        double v = length * x[half + i], v1 = length * x1[half + i], far = overshoot * (fabs(v) + fabs(v1));
        double above = r->above[i], below = r->below[i];
        if ((x[i] > x1[i] ? x[i] : x1[i]) + far >= above && may_rise(x[i] - above, v, x1[i] - above, v1))
            found |= 1u << r->contact_above[i];
        if ((x[i] < x1[i] ? x[i] : x1[i]) - far <= below && may_rise(below - x[i], -v, below - x1[i], -v1))
            found |= 1u << r->contact_below[i];
    }
    return found;
}

/* The state there in place of that at the start. */
static void advance(const struct exact_path *path, int n, double theta, double *x)
{
    double dx[MODEL_LINEAR_STATES];
    exact_change(path, n, theta, dx);
    for (int k = 0; k < n; k += 2)
        exact_store(&x[k], exact_load(&x[k]) + exact_load(&dx[k]));
}

/* The first switch of these contacts on the path; x moves there. */
static bool locate(const struct task *t, const struct exact_path *path, unsigned regime, unsigned contacts,
                   double length, double *x, const double *x_end, struct crossing *c)
{
    struct exact_root root, first = {DBL_MAX, true};
    int n = t->m->n_states;
    for (int i = 0; contacts >> i; i++) {
        const struct exact_gap *gap = &t->w->gap[i];
        if (!((contacts >> i) & 1u))
            continue;
        struct input last = gap_at(gap, n / 2, x_end);
        if (exact_first_root(path, gap, (regime >> i) & 1u, &last, &root) && root.theta < first.theta) {
            first = root;
            c->contact = i;
        }
    }
    if (first.theta > path->end)
        return false;
    double done = first.theta * path->unit;
    c->done = done < length ? done : length;
    c->residual = !first.converged;
    advance(path, n, first.theta, x);
    return true;
}

/* Makes the tables of a frequency that has stayed; one that has just moved may move again. This takes the
 * deepest stack of the method, so it is done while nothing else is on it. */
static void tune(const struct task *t, const struct exact_regime *r, const struct segment *e)
{
    struct exact_system *s = exact_system_of(t->w, r);
    if (e->length != r->tick || e->changed)
        return;
    for (int i = 0; e->active >> i; i++) {
        const struct wave *v = &e->wave[i];
        if (((e->active >> i) & 1u) && v->amplitude != 0.0 && v->omega != s->input[i].omega)
            exact_tune(s, t->m, t->w->h, i, v->omega);
    }
}

/* x - x is zero, or a NaN when x is not finite. */
static bool finite_state(const double *x, int n)
{
    exact_pair zero = {0.0, 0.0};
    for (int k = 0; k < n; k += 2)
        zero += exact_load(&x[k]) - exact_load(&x[k]);
    return zero[0] + zero[1] == 0.0;
}

/* From x to the first switch before x_end, or to x_end. `drawn`: path is filled already. */
static enum step_status close_in(const struct task *t, const struct exact_regime *r, const struct segment *e,
                                 unsigned regime, struct exact_path *path, bool drawn, double *x,
                                 const double *x_end, struct crossing *c)
{
    int n = t->m->n_states;
    if (!finite_state(x_end, n))
        return STEP_NOT_FINITE;
    unsigned contacts = suspects(n / 2, r, e->length, x, x_end);
    if (contacts && !drawn)
        exact_follow(t->w, r, t->m, e, x, path);
    if (contacts && locate(t, path, regime, contacts, e->length, x, x_end, c))
        return STEP_SWITCH;
    for (int k = 0; k < n; k += 2)
        exact_store(&x[k], exact_load(&x_end[k]));
    return STEP_END;
}

/* A segment within the reach of its regime. */
static enum step_status step_part(const struct task *t, const struct exact_regime *r, const struct segment *e,
                                  unsigned regime, double *x, struct crossing *c)
{
    struct exact_path path;
    double x1[MODEL_LINEAR_STATES];
    int n = t->m->n_states;
    exact_follow(t->w, r, t->m, e, x, &path);
    memcpy(x1, x, (size_t)n * sizeof *x);
    advance(&path, n, path.end, x1);
    return close_in(t, r, e, regime, &path, true, x, x1, c);
}

/* A step that was forced past the limit, in sound pieces. */
static enum step_status step_far(const struct task *t, const struct segment *e, unsigned regime, double *x,
                                 struct crossing *c)
{
    struct exact_regime *r = &t->w->regime[regime];
    struct segment head;
    if (r->reach == 0.0)
        return STEP_NOT_FINITE; /* contacts that cannot be closed together */
    segment_head(e, t->m->n_inputs, r->reach, &head);
    head.changed = true;
    enum step_status status = step_part(t, r, &head, regime, x, c);
    if (status != STEP_END)
        return status;
    c->done = r->reach;
    return STEP_BUDGET;
}

static unsigned regime_of(const struct task *t, const double *x)
{
    unsigned regime = 0;
    for (int i = 0; i < t->m->n_contacts; i++)
        regime |= (unsigned)(gap_at(&t->w->gap[i], t->m->n_states / 2, x).value < 0.0) << i;
    return regime;
}

/* Runs to the end through all switches. */
NEVER_INLINE enum step_status step_any(const struct task *t, const struct segment *e, unsigned regime,
                                       double *x)
{
    struct segment rest = *e;
    for (int piece = 0; piece < ANY_PIECES; piece++) {
        struct crossing c = {0.0, 0, 0, 0.0};
        struct exact_regime *r = &t->w->regime[regime];
        enum step_status status = rest.length <= r->reach ? step_part(t, r, &rest, regime, x, &c)
                                                          : step_far(t, &rest, regime, x, &c);
        if (status == STEP_END || status == STEP_NOT_FINITE)
            return status;
        if (status == STEP_SWITCH)
            regime ^= 1u << c.contact;
        segment_tail(&rest, t->m->n_inputs, c.done);
    }
    return STEP_NOT_FINITE;
}

/* Anything but a whole tick that the tables cover. */
NEVER_INLINE enum step_status step_other(const struct model *m, const double *p, double *scratch,
                                         const struct segment *e, unsigned regime, double *x,
                                         struct crossing *c)
{
    struct task t = {m, (struct exact *)(void *)scratch};
    bool any = (regime & REGIME_ANY) || m->n_contacts == 0;
    unsigned begin = any ? regime_of(&t, x) : regime;
    const struct exact_regime *r = &t.w->regime[begin];
    (void)p;
    tune(&t, r, e);
    if (any)
        return step_any(&t, e, begin, x);
    if (!(e->length <= r->reach))
        return step_far(&t, e, begin, x, c);
    return step_part(&t, r, e, begin, x, c);
}

/* A tick whose end is known, near a wall. */
NEVER_INLINE enum step_status step_near(const struct model *m, const double *p, double *scratch,
                                        const struct segment *e, unsigned regime, double *x,
                                        struct crossing *c)
{
    struct task t = {m, (struct exact *)(void *)scratch};
    struct exact_path path;
    (void)p;
    return close_in(&t, &t.w->regime[regime], e, regime, &path, false, x, t.w->end, c);
}

/* Rare cases are tail calls: the common tick needs no stack frame. */
ALWAYS_INLINE enum step_status step(int n, const struct model *m, const double *p, double *scratch,
                                    const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    struct exact *w = (struct exact *)(void *)scratch;
    const struct exact_regime *r = &w->regime[regime % EXACT_REGIMES];
    exact_pair to[MODEL_LINEAR_STATES / 2];
    if ((regime & REGIME_ANY) || e->length != r->tick || !tick(n, exact_system_of(w, r), r, e, x, to))
        return step_other(m, p, scratch, e, regime, x, c);
    if (!clear(n / 2, r, e->length, x, to)) {
        EXACT_UNROLL for (int k = 0; k < n / 2; k++) exact_store(&w->end[2 * k], to[k]);
        return step_near(m, p, scratch, e, regime, x, c);
    }
    EXACT_UNROLL for (int k = 0; k < n / 2; k++) exact_store(&x[2 * k], to[k]);
    return STEP_END;
}

/* One copy for each number of states. */
static enum step_status step_2(const struct model *m, const double *p, double *scratch,
                               const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    return step(2, m, p, scratch, e, regime, x, c);
}

static enum step_status step_4(const struct model *m, const double *p, double *scratch,
                               const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    return step(4, m, p, scratch, e, regime, x, c);
}

static enum step_status step_6(const struct model *m, const double *p, double *scratch,
                               const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    return step(6, m, p, scratch, e, regime, x, c);
}

static step_function *bind(const struct model *m)
{
    return m->n_states == 2 ? step_2 : m->n_states == 4 ? step_4 : step_6;
}

static size_t n_scratch(const struct model *m)
{
    size_t regimes = (size_t)1 << m->n_contacts;
    size_t systems = regimes < EXACT_SYSTEMS ? regimes : EXACT_SYSTEMS;
    return (sizeof(struct exact) + systems * sizeof(struct exact_system)) / sizeof(double);
}

STATIC_ASSERT(sizeof(struct exact) + EXACT_SYSTEMS * sizeof(struct exact_system) <=
                  METHOD_SCRATCH * sizeof(double),
              work_of_exact);

const struct method exact = {
    .name = "exact",
    .title = "exact solution of piecewise linear plants; switches located on it",
    .order = 0,
    .n_scratch = n_scratch,
    .refuse = exact_refuse,
    .prepare = exact_prepare,
    .bind = bind,
};
