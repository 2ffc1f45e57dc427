/* ledger.c - see ledger.h. */
#include "firmware/plant/ledger.h"

#include <math.h>
#include "models/check.h"
#include "firmware/method/instances.h"

/* Knuth's exact sum: value is rounded, what rounding lost goes into carry. No branch. */
static inline void add(struct sum *s, double x)
{
    double t = s->value + x, part = t - s->value;
    s->carry += (s->value - (t - part)) + (x - part);
    s->value = t;
}

void sum_add(struct sum *s, double x)
{
    add(s, x);
}

double sum_of(const struct sum *s)
{
    return s->value + s->carry;
}

static double larger(double a, double b)
{
    return a > b ? a : b;
}

typedef void flow_function(const double *p, const struct input *u, const double *x, struct flow *flow);

/* The model as compile-time constants of one instantiation. */
struct inlined {
    flow_function *flow;
    int n, n_inputs; /* states, and inputs that may be active */
};

/* Simpson's rule over the powers at both ends and in the middle. */
ALWAYS_INLINE void book(struct inlined m, struct ledger *l, unsigned active, double sixth,
                        const struct flow *begin, const struct flow *middle, const struct flow *end)
{
    double gross = l->gross;
    UNROLL
    for (int i = 0; i < m.n_inputs; i++) {
        if (!((active >> i) & 1u))
            continue;
        double work = sixth * ((begin->work[i] + end->work[i]) + 4.0 * middle->work[i]);
        add(&l->work[i], work);
        gross += fabs(work);
    }
    double damping = sixth * ((begin->damping + end->damping) + 4.0 * middle->damping);
    add(&l->damping, damping);
    l->gross = gross + damping;
}

/* Hands the end of this piece to the next one. It copies field by field, so that fields which an
 * instantiation does not set cost nothing. Velocities stand in the state. */
ALWAYS_INLINE void keep(struct inlined m, struct flow *begin, const struct flow *end)
{
    for (int k = m.n / 2; k < m.n; k++)
        begin->x_dot[k] = end->x_dot[k];
    UNROLL
    for (int i = 0; i < m.n_inputs; i++)
        begin->work[i] = end->work[i];
    begin->damping = end->damping;
    begin->force = end->force;
}

/* A shorter piece (model time) takes its mean velocity for the secant, which rounding would spoil. */
#define SECANT_MIN 1e-6

void ledger_weigh(struct ledger *l, double length)
{
    bool apart = length >= SECANT_MIN;
    l->rule = (struct ledger_rule){.length = length,
                                   .sixth = length * (1.0 / 6.0),
                                   .a = (5.0 / 32.0) * length,
                                   .b = (1.0 / 64.0) * (length * length),
                                   .c = (1.0 / 32.0) * length,
                                   .inverse = apart ? 1.0 / length : 0.0,
                                   .mean = apart ? -0.875 : 1.0};
}

/* The state in the middle of a piece from positions q, velocities v and accelerations a at its ends: of the
 * quintic Hermite polynomial
 *
 *   q = (q0 + q1)/2 + 5 h (v0 - v1)/32 + h^2 (a0 + a1)/64
 *
 *   v = 15/8 (q1 - q0)/h - 7 (v0 + v1)/16 + h (a1 - a0)/32 */
ALWAYS_INLINE void middle_of(int n, const struct ledger_rule *r, const struct flow *begin,
                             const struct flow *end, const double *x0, const double *x1, double *x)
{
    for (int i = 0, k = n / 2; k < n; i++, k++) {
        double mean = 0.5 * (x0[k] + x1[k]), secant = (x1[i] - x0[i]) * r->inverse;
        x[i] = (0.5 * (x0[i] + x1[i]) + r->a * (x0[k] - x1[k])) + r->b * (begin->x_dot[k] + end->x_dot[k]);
        x[k] = (1.875 * secant + r->mean * mean) + r->c * (end->x_dot[k] - begin->x_dot[k]);
    }
}

ALWAYS_INLINE double piece(struct inlined m, struct ledger *l, const double *p, const struct segment *e,
                           const double *x0, const double *x1)
{
    struct flow *begin = &l->flow, end, middle;
    double x[MODEL_STATES];
    m.flow(p, e->at[2], x1, &end);
    middle_of(m.n, &l->rule, begin, &end, x0, x1, x);
    m.flow(p, e->at[1], x, &middle);
    book(m, l, e->active, l->rule.sixth, begin, &middle, &end);
    double force = larger(begin->force, larger(middle.force, end.force));
    keep(m, begin, &end);
    return force;
}

/* Any model, through its pointer: the same bits as an instantiation. */
static double piece_general(struct ledger *l, const double *p, const struct segment *e, const double *x0,
                            const double *x1)
{
    return piece((struct inlined){l->model->flow, l->model->n_states, l->model->n_inputs}, l, p, e, x0, x1);
}

#define DECLARE(name, ...) static ledger_function piece_##name;
INSTANCES(DECLARE)

#define JUMP(row, when)                                                                                      \
    if (when)                                                                                                \
        return piece_##row(l, p, e, x0, x1);

/* One function per row. A jump to another one costs no more than that: the arguments stay in their places. */
#define PIECE(name, for_models, jumps, states, contacts, n_inputs, rhs, gap, flow)                           \
    CALLED_FROM_ANYWHERE double piece_##name(struct ledger *l, const double *p, const struct segment *e,     \
                                             const double *x0, const double *x1)                             \
    {                                                                                                        \
        unsigned active = e->active;                                                                         \
        (void)active;                                                                                        \
        jumps;                                                                                               \
        return piece((struct inlined){flow, states, n_inputs}, l, p, e, x0, x1);                             \
    }
INSTANCES(PIECE)

static ledger_function *bind(const struct model *m)
{
#define BIND(name, for_models, ...)                                                                          \
    if (for_models)                                                                                          \
        return piece_##name;
    INSTANCES(BIND)
    return piece_general;
}

void ledger_bind(struct ledger *l, const struct model *m)
{
    l->model = m;
    l->piece = bind(m);
    l->flow_valid = false;
}

void ledger_start(struct ledger *l, const struct model *m, const double *p, const struct input *u,
                  const double *x)
{
    *l = (struct ledger){.model = m, .piece = bind(m), .start.value = m->energy(p, u, x), .rule.mean = 1.0};
}

double ledger_take(struct ledger *l, const struct method_books *b)
{
    double gross = l->gross + b->damping + fabs(b->heat);
    for (int i = 0; i < l->model->n_inputs; i++) {
        if (b->work[i] != 0.0) { /* most inputs are silent, and a sum of 0 is no change */
            add(&l->work[i], b->work[i]);
            gross += fabs(b->work[i]);
        }
    }
    add(&l->damping, b->damping);
    add(&l->heat, b->heat);
    l->gross = gross;
    return b->force;
}

/* s and sign times t, exactly but for the rounding of the carries. */
NEVER_INLINE void add_sum(struct sum *s, const struct sum *t, double sign)
{
    add(s, sign * t->value);
    add(s, sign * t->carry);
}

/* Sums that are large and cancel leave no rounding of theirs behind. */
double ledger_residual(const struct ledger *l, int n_inputs, double stored)
{
    struct sum balance = {stored, 0.0};
    add_sum(&balance, &l->start, -1.0);
    add_sum(&balance, &l->damping, 1.0);
    add_sum(&balance, &l->change, -1.0);
    add_sum(&balance, &l->heat, -1.0);
    for (int i = 0; i < n_inputs; i++)
        add_sum(&balance, &l->work[i], -1.0);
    return sum_of(&balance);
}

static void sum_scale(struct sum *s, double factor)
{
    s->value *= factor;
    s->carry *= factor;
}

void ledger_rescale(struct ledger *l, double factor, double change)
{
    double balance = factor * ledger_residual(l, MODEL_INPUTS, 0.0);
    for (int i = 0; i < MODEL_INPUTS; i++)
        sum_scale(&l->work[i], factor);
    sum_scale(&l->damping, factor);
    sum_scale(&l->heat, factor);
    sum_scale(&l->change, factor);
    sum_scale(&l->start, factor);
    l->gross *= factor;
    l->most *= factor;
    /* Rounding of large sums: put back. */
    sum_add(&l->start, ledger_residual(l, MODEL_INPUTS, 0.0) - balance);
    sum_add(&l->change, change);
    l->flow_valid = false;
}
