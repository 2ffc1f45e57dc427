/* exact.c - the exact solution of piecewise linear plants: error independent of the step.
 *
 * While no contact switches the state after a tick is a matrix times the state before plus the responses to the
 * inputs' phasors and samples, all tabulated at start: (n + 2) n multiply-adds for one harmonic drive. For parts of a
 * tick, growing amplitudes and unknown frequencies there is the power series of the same solution (exact_series.h).
 * A tick in which a position ends beyond a wall, or may have been there, is expanded, and the switch located on the
 * series. Nothing is carried from one tick to the next but tables that belong to frequencies. At the limit of the step
 * (2.1 rad of the fastest mode) one switch in about 500 000 of a chaotic shaft, a brief parting inside a tick, goes unseen. */
#include <float.h>
#include <math.h>
#include <string.h>
#include "firmware/exact_series.h"
#include "models/elementary.h"

enum {
    ANY_PIECES = 256 /* pieces of a tick that is run through without stopping at switches */
};

/* What every function below works on. */
struct task {
    const struct model *m;
    struct exact *w;
};

/* x - x is zero, or a NaN when x is not finite. */
ALWAYS_INLINE bool finite_state(const double *x, int n)
{
    exact_pair zero = {0.0, 0.0};
    EXACT_UNROLL for (int k = 0; k < n; k += 2) zero += exact_load(&x[k]) - exact_load(&x[k]);
    return zero[0] + zero[1] == 0.0;
}

/* Responses to c and to the inputs over a whole tick; false when the tables do not cover these waves. */
ALWAYS_INLINE bool respond(int n, const struct exact_regime *r, const struct wave *wave, unsigned active,
                           exact_pair *y)
{
    EXACT_UNROLL for (int k = 0; k < n / 2; k++) y[k] = exact_load(&r->rest[2 * k]);
    for (int i = 0; active >> i; i++) {
        const struct wave *v = &wave[i];
        if (!((active >> i) & 1u))
            continue;
        if (v->growth != 0.0 || (v->omega != r->omega[i] && v->amplitude != 0.0))
            return false;
        double c = v->amplitude * v->cosine, s = v->amplitude * v->sine;
        EXACT_UNROLL for (int k = 0; k < n / 2; k++) y[k] +=
            exact_load(&r->cosine[i][2 * k]) * c - exact_load(&r->sine[i][2 * k]) * s;
        if (v->offset == 0.0 && v->slope == 0.0)
            continue;
        EXACT_UNROLL for (int k = 0; k < n / 2; k++) y[k] +=
            exact_load(&r->offset[i][2 * k]) * v->offset + exact_load(&r->slope[i][2 * k]) * v->slope;
    }
    return true;
}

/* x1 = the state a tick after x. Three sums of a third of the terms each: shorter chains than one. False when the
 * tables do not cover these waves. */
ALWAYS_INLINE bool tick(int n, const struct exact_regime *r, const struct wave *wave, unsigned active,
                        const double *x, double *x1)
{
    exact_pair inputs[MODEL_STATES / 2];
    if (!respond(n, r, wave, active, inputs))
        return false;
    EXACT_UNROLL for (int k = 0; k < n / 2; k++)
    {
        exact_pair position = exact_load(&r->whole[0][2 * k]) * x[0];
        exact_pair velocity = exact_load(&r->whole[n / 2][2 * k]) * x[n / 2];
        EXACT_UNROLL for (int j = 1; j < n / 2; j++)
        {
            position += exact_load(&r->whole[j][2 * k]) * x[j];
            velocity += exact_load(&r->whole[n / 2 + j][2 * k]) * x[n / 2 + j];
        }
        exact_store(&x1[2 * k], exact_load(&x[2 * k]) + ((position + velocity) + inputs[k]));
    }
    return true;
}

/* The same for a size known only at run time. */
static bool tick_of(const struct model *m, const struct exact_regime *r, const struct wave *wave,
                    unsigned active, const double *x, double *x1)
{
    if (m->n_states == 6)
        return tick(6, r, wave, active, x, x1);
    if (m->n_states == 4)
        return tick(4, r, wave, active, x, x1);
    return tick(2, r, wave, active, x, x1);
}

/* x1 = the state at s = length, which may lie before the start. */
static void expand_to(const struct task *t, const struct exact_regime *r, const struct excitation *e,
                      double length, const double *x, double *x1)
{
    double dx[MODEL_STATES];
    int order = exact_order(exact_reach(r, e, t->m->n_inputs, length));
    exact_expand(t->w, r, t->m, e, length, order, x);
    exact_change(t->w, t->m->n_states, order, 1.0, dx);
    for (int k = 0; k < t->m->n_states; k++)
        x1[k] = x[k] + dx[k];
}

/* The waves as seen from s = `back`, where their offsets and amplitudes are the same. */
static void waves_from(const struct excitation *e, int n_inputs, double back, struct wave *wave)
{
    for (int i = 0; i < n_inputs; i++) {
        double c, s;
        if (!((e->active >> i) & 1u))
            continue;
        wave[i] = e->wave[i];
        cos_sin(wave[i].omega * back, &c, &s);
        wave[i].cosine = e->wave[i].cosine * c - e->wave[i].sine * s;
        wave[i].sine = e->wave[i].sine * c + e->wave[i].cosine * s;
        wave[i].offset += wave[i].slope * back;
    }
}

/* Part of a tick. A long part goes a shorter way: back to where the tick began, which the solution takes as well,
 * and then a whole tick. */
static void part(const struct task *t, const struct exact_regime *r, const struct excitation *e,
                 const double *x, double *x1)
{
    double back = e->length - t->w->h;
    struct wave wave[MODEL_INPUTS];
    double y[MODEL_STATES];
    if (-back < 0.5 * t->w->h && t->w->h <= r->reach) {
        waves_from(e, t->m->n_inputs, back, wave);
        expand_to(t, r, e, back, x, y);
        if (tick_of(t->m, r, wave, e->active, y, x1))
            return;
    }
    expand_to(t, r, e, e->length, x, x1);
}

/* Anything but a whole tick that the tables cover. */
static void advance(const struct task *t, struct exact_regime *r, const struct excitation *e, const double *x,
                    double *x1)
{
    if (e->length != t->w->h) {
        part(t, r, e, x, x1);
        return;
    }
    /* A frequency that stays gets its tables; one that has just moved may move again. */
    for (int i = 0; !e->changed && e->active >> i; i++) {
        const struct wave *v = &e->wave[i];
        if (((e->active >> i) & 1u) && v->amplitude != 0.0 && v->omega != r->omega[i])
            exact_tune(t->w, r, t->m, i, v->omega);
    }
    if (!tick_of(t->m, r, e->wave, e->active, x, x1))
        expand_to(t, r, e, e->length, x, x1);
}

/* How far beyond both ends a position can get between them: nowhere unless it turns, which it does when the rates at
 * the ends differ in sign, or when that of their Hermite cubic half-way differs from both. Then the cubic gets 4/27 of
 * the rates beyond; a quarter leaves room for what is not cubic. */
ALWAYS_INLINE double overshoot(double v0, double v1, double rise, double length)
{
    double halfway = 1.5 * rise - 0.25 * length * (v0 + v1);
    bool turns = v0 * v1 < 0.0 || v0 * halfway < 0.0;
    return turns ? 0.25 * length * (fabs(v0) + fabs(v1)) : 0.0;
}

/* The state may have left its regime between x and x1: a position is beyond a wall at the end, or may have been. */
ALWAYS_INLINE bool left(int half, const struct exact_regime *r, double length, const double *x,
                        const double *x1)
{
    bool out = false;
    EXACT_UNROLL for (int i = 0; i < half; i++)
    {
        double above = r->above[i], below = r->below[i];
        double far = overshoot(x[half + i], x1[half + i], x1[i] - x[i], length);
        out |= x1[i] >= above || x1[i] <= below;
        if (far > 0.0) {
            double low = x[i] < x1[i] ? x[i] : x1[i], high = x[i] < x1[i] ? x1[i] : x[i];
            out |= high + far > above || low - far < below;
        }
    }
    return out;
}

static struct input gap_at(const struct exact_gap *g, int half, const double *x)
{
    return (struct input){g->constant + g->slope * x[g->position], g->slope * x[half + g->position]};
}

/* Something switched, or nearly did: locate it. x is the start, x_end the state at the segment's end. */
static enum step_status locate(const struct task *t, const struct exact_regime *r, const struct excitation *e,
                               unsigned regime, double *x, const double *x_end, struct crossing *c)
{
    struct exact_root root, first = {2.0, true};
    double dx[MODEL_STATES];
    int half = t->m->n_states / 2;
    double reach = exact_reach(r, e, t->m->n_inputs, e->length);
    bool expanded = false;
    for (int i = 0; i < t->m->n_contacts; i++) {
        struct input g0 = gap_at(&t->w->gap[i], half, x), g1 = gap_at(&t->w->gap[i], half, x_end);
        bool closed = (regime >> i) & 1u;
        double sign = closed ? 1.0 : -1.0;
        double f0 = sign * g0.value, f1 = sign * g1.value;
        double far = overshoot(g0.rate, g1.rate, g1.value - g0.value, e->length);
        if (!(f1 >= 0.0 || (far > 0.0 && (f0 > f1 ? f0 : f1) + far > 0.0)))
            continue;
        if (!expanded)
            exact_expand(t->w, r, t->m, e, e->length, exact_order(reach), x);
        expanded = true;
        g1.rate *= e->length;
        if (exact_first_root(t->w, i, closed, reach, &g1, &root) && root.theta < first.theta) {
            first = root;
            c->contact = i;
        }
    }
    if (first.theta > 1.0) {
        memcpy(x, x_end, (size_t)t->m->n_states * sizeof *x);
        return STEP_END;
    }
    c->done = first.theta * e->length;
    c->residual = !first.converged;
    exact_change(t->w, t->m->n_states, exact_order(reach), first.theta, dx);
    for (int k = 0; k < t->m->n_states; k++)
        x[k] += dx[k];
    return STEP_SWITCH;
}

/* A segment within the reach of its regime. */
ALWAYS_INLINE enum step_status step_within(int n, const struct task *t, struct exact_regime *r,
                                           const struct excitation *e, unsigned regime, double *x,
                                           struct crossing *c)
{
    double x1[MODEL_STATES];
    if (e->length != t->w->h || !tick(n, r, e->wave, e->active, x, x1))
        advance(t, r, e, x, x1);
    if (!finite_state(x1, n))
        return STEP_NOT_FINITE;
    if (left(n / 2, r, e->length, x, x1))
        return locate(t, r, e, regime, x, x1, c);
    EXACT_UNROLL for (int i = 0; i < n; i += 2) exact_store(&x[i], exact_load(&x1[i]));
    return STEP_END;
}

/* The same for a size known only at run time. */
static enum step_status step_of(const struct task *t, struct exact_regime *r, const struct excitation *e,
                                unsigned regime, double *x, struct crossing *c)
{
    if (t->m->n_states == 6)
        return step_within(6, t, r, e, regime, x, c);
    if (t->m->n_states == 4)
        return step_within(4, t, r, e, regime, x, c);
    return step_within(2, t, r, e, regime, x, c);
}

/* A step that was forced past the limit, taken in pieces that are sound. */
static enum step_status step_far(const struct task *t, const struct excitation *e, unsigned regime, double *x,
                                 struct crossing *c)
{
    struct exact_regime *r = &t->w->regime[regime];
    struct excitation head;
    if (r->reach == 0.0)
        return STEP_NOT_FINITE; /* contacts that cannot be closed together */
    excitation_head(e, t->m->n_inputs, r->reach, &head);
    head.changed = true;
    enum step_status status = step_of(t, r, &head, regime, x, c);
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

/* To the end, whatever switches on the way. */
static enum step_status step_any(const struct task *t, const struct excitation *e, double *x)
{
    struct excitation rest = *e;
    unsigned regime = regime_of(t, x);
    for (int piece = 0; piece < ANY_PIECES; piece++) {
        struct crossing c = {0.0, 0, 0};
        struct exact_regime *r = &t->w->regime[regime];
        enum step_status status =
            rest.length <= r->reach ? step_of(t, r, &rest, regime, x, &c) : step_far(t, &rest, regime, x, &c);
        if (status == STEP_END || status == STEP_NOT_FINITE)
            return status;
        if (status == STEP_SWITCH)
            regime ^= 1u << c.contact;
        excitation_tail(&rest, t->m->n_inputs, c.done);
    }
    return STEP_NOT_FINITE;
}

ALWAYS_INLINE enum step_status step(int n, const struct model *m, double *work, const struct excitation *e,
                                    unsigned regime, double *x, struct crossing *c)
{
    struct task t = {m, (struct exact *)(void *)work};
    if (regime & REGIME_ANY)
        return step_any(&t, e, x);
    struct exact_regime *r = &t.w->regime[regime];
    if (!(e->length <= r->reach))
        return step_far(&t, e, regime, x, c);
    return step_within(n, &t, r, e, regime, x, c);
}

/* One instantiation a size. */
static enum step_status step_2(const struct model *m, const double *p, double *work,
                               const struct excitation *e, unsigned regime, double *x, struct crossing *c)
{
    (void)p;
    return step(2, m, work, e, regime, x, c);
}

static enum step_status step_4(const struct model *m, const double *p, double *work,
                               const struct excitation *e, unsigned regime, double *x, struct crossing *c)
{
    (void)p;
    return step(4, m, work, e, regime, x, c);
}

static enum step_status step_6(const struct model *m, const double *p, double *work,
                               const struct excitation *e, unsigned regime, double *x, struct crossing *c)
{
    (void)p;
    return step(6, m, work, e, regime, x, c);
}

static step_function *bind(const struct model *m)
{
    return m->n_states == 2 ? step_2 : m->n_states == 4 ? step_4 : step_6;
}

static size_t n_work(const struct model *m)
{
    return (sizeof(struct exact) + ((size_t)1 << m->n_contacts) * sizeof(struct exact_regime)) /
           sizeof(double);
}

STATIC_ASSERT(sizeof(struct exact) + EXACT_REGIMES * sizeof(struct exact_regime) <=
                  METHOD_WORK * sizeof(double),
              work_of_exact);

const struct method exact = {
    .name = "exact",
    .title = "exact solution of piecewise linear plants; switches located on it",
    .order = 0,
    .n_work = n_work,
    .refuse = exact_refuse,
    .prepare = exact_prepare,
    .bind = bind,
};
