/* rules.c - rules that see the powers at the ends of ticks; see rules.h. */
#include "tests/bench/ledger/rules.h"

#include "models/flows.h"
#include "models/shaft_bearing.h"

#define RULE __attribute__((noinline))

typedef void flow_function(const double *p, const struct input *u, const double *x, struct flow *f);

/* ---- Simpson's rule, the product's ---- */

void rule_by_ledger(const struct record *r, int from, int to, struct books *b)
{
    static struct ledger l; /* too large for a stack */
    ledger_start(&l, r->model, r->p, r->piece[from].e.at[0], r->piece[from].x0);
    for (int i = from; i < to; i++) {
        const struct piece *q = &r->piece[i];
        double force = ledger_piece(&l, r->p, &q->e, q->x0, q->x1);
        b->force = force > b->force ? force : b->force;
    }
    rules_book(b, sum_of(&l.work[r->input]), sum_of(&l.damping));
}

/* ---- rules over ticks of one regime ---- */

/* In a group of ticks the powers at their ends have these weights, times the length of a tick. End terms are
 * `slope` h^2 times the difference of the powers' rates; those of neighbours cancel. */
struct weights {
    int group;
    double at[5];
    double slope;
};

static const struct weights trapezoid = {1, {1.0 / 2, 1.0 / 2}, 0.0};
static const struct weights with_ends = {1, {1.0 / 2, 1.0 / 2}, 1.0 / 12};
static const struct weights hermite = {2, {7.0 / 15, 16.0 / 15, 7.0 / 15}, 1.0 / 15};
static const struct weights boole = {4, {14.0 / 45, 64.0 / 45, 24.0 / 45, 64.0 / 45, 14.0 / 45}, 0.0};

/* Rates of the powers, by a difference along the motion. */
ALWAYS_INLINE void add_slope(flow_function *flow, const struct record *r, const struct input *u,
                             const double *x, double factor, struct books *b)
{
    double eps = 1e-4 * r->h, y[2][MODEL_STATES];
    struct input v[2][MODEL_INPUTS] = {{{0.0, 0.0}}};
    struct flow f, g[2];
    flow(r->p, u, x, &f);
    for (int s = 0; s < 2; s++) {
        double step = s ? eps : -eps;
        v[s][r->input] = (struct input){u[r->input].value + step * u[r->input].rate, u[r->input].rate};
        for (int i = 0; i < r->model->n_states; i++)
            y[s][i] = x[i] + step * f.x_dot[i];
        flow(r->p, v[s], y[s], &g[s]);
    }
    factor /= 2.0 * eps;
    rules_add(&b->work, factor * (g[1].work[r->input] - g[0].work[r->input]));
    rules_add(&b->damping, factor * (g[1].damping - g[0].damping));
}

/* The powers at the end of a piece, with their weight. */
ALWAYS_INLINE void add_end(flow_function *flow, const struct record *r, const struct input *u,
                           const double *x, double weight, struct books *b)
{
    struct flow f;
    flow(r->p, u, x, &f);
    rules_book(b, weight * f.work[r->input], weight * f.damping);
    b->force = f.force > b->force ? f.force : b->force;
}

/* Pieces from..to - 1, all of one length and regime. */
ALWAYS_INLINE void add_run(flow_function *flow, const struct weights *w, const struct record *r, int from,
                           int to, struct books *b)
{
    const struct piece *q = &r->piece[from], *last = &r->piece[to - 1];
    double h = q->e.length, inner[4];
    for (int k = 0; k < w->group; k++)
        inner[k] = h * (k == 0 ? w->at[0] + w->at[w->group] : w->at[k]);
    add_end(flow, r, q->e.at[0], q->x0, h * w->at[0], b);
    for (int k = 1 % w->group; q < last; q++, k = k + 1 == w->group ? 0 : k + 1)
        add_end(flow, r, q->e.at[2], q->x1, inner[k], b);
    add_end(flow, r, q->e.at[2], q->x1, h * w->at[w->group], b);
    if (w->slope == 0.0)
        return;
    add_slope(flow, r, r->piece[from].e.at[0], r->piece[from].x0, w->slope * h * h, b);
    add_slope(flow, r, last->e.at[2], last->x1, -w->slope * h * h, b);
}

/* Ends of runs that fill no group go to Simpson's rule. */
ALWAYS_INLINE void add_all(flow_function *flow, const struct weights *w, const struct record *r, int from,
                           int to, struct books *b)
{
    for (int i = from, next; i < to; i = next) {
        const struct piece *q = &r->piece[i];
        for (next = i + 1;
             q->whole && next < to && r->piece[next].whole && r->piece[next].regime == q->regime;)
            next++;
        int grouped = i + (next - i) / w->group * w->group;
        if (grouped > i)
            add_run(flow, w, r, i, grouped, b);
        if (grouped < next)
            rule_by_ledger(r, grouped, next, b);
    }
}

#define OVER_TICKS(rule, scene, flow)                                                                        \
    RULE static void rule_##rule##_##scene(const struct record *r, int from, int to, struct books *b)        \
    {                                                                                                        \
        add_all(flow, &rule, r, from, to, b);                                                                \
    }
#define RULES_OF(scene, flow)                                                                                \
    RULE static void rule_simpson_##scene(const struct record *r, int from, int to, struct books *b)         \
    {                                                                                                        \
        rule_by_ledger(r, from, to, b);                                                                      \
    }                                                                                                        \
    OVER_TICKS(trapezoid, scene, flow)                                                                       \
    OVER_TICKS(with_ends, scene, flow)                                                                       \
    OVER_TICKS(hermite, scene, flow)                                                                         \
    OVER_TICKS(boole, scene, flow)
RULES_OF(rig, hertz_rig_flow_forced)
RULES_OF(tip, afm_tip_flow)
RULES_OF(shaft, shaft_bearing_flow)

/* ---- the table ---- */

#define ROW(rule)                                                                                            \
    {                                                                                                        \
#rule, {rule_##rule##_rig, rule_##rule##_rig, rule_##rule##_tip, rule_##rule##_shaft }, false        \
    }
const struct rule rule_table[RULES] = {
    ROW(simpson),
    ROW(trapezoid),
    ROW(with_ends),
    ROW(hermite),
    ROW(boole),
    {"terms", {NULL, rule_terms_rig, rule_terms_tip, NULL}, false},
    {"series", {NULL, rule_series_rig, rule_series_tip, NULL}, false},
    {"forms", {NULL, NULL, NULL, rule_forms_shaft}, false},
    {"all_forms", {NULL, NULL, NULL, rule_all_forms_shaft}, true},
};

void rules_prepare(const struct record *r)
{
    if (r->model == &shaft_bearing)
        forms_prepare(r);
}
