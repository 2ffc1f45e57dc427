/* ledger.c - see ledger.h. */
#include "firmware/plant/ledger.h"

#include <math.h>
#include <stddef.h>
#include "models/check.h"
#include "firmware/method/instances.h"

typedef void flow_function(const double *p, const struct input *u, const double *x, struct flow *flow);
#if TICK_LANES > 1
typedef void lanes_function(const double *p, const struct input_lanes *u, const real_lanes *x,
                            struct flow_lanes *flow);
#endif

/* The model as compile-time constants of one instantiation. */
struct booked {
    int n, n_inputs; /* states, and inputs that may be active */
    flow_function *flow;
#if TICK_LANES > 1
    lanes_function *lanes; /* NULL: each tick by itself */
#else
    flow_function *lanes;
#endif
};

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

#define number       double
#define NUMBER(name) name
#define real         double
#define REAL(name)   name
#define EACH
#include "firmware/plant/ledger_middle.h"
#include "firmware/plant/ledger_piece.h"
#undef real
#undef REAL
#undef EACH

#if TICK_LANES > 1
#define real       real_lanes
#define REAL(name) name##_lanes
#define EACH       UNROLL
#include "firmware/plant/ledger_middle.h"
#undef real
#undef REAL
#undef EACH
#endif
#undef number
#undef NUMBER

void sum_add(struct sum *s, double x)
{
    add(s, x);
}

double sum_of(const struct sum *s)
{
    return s->value + s->carry;
}

#if TICK_LANES > 1
/* From the values at the ends of both ticks those at their begins; *last: the end of the tick before, and
 * then of these. */
ALWAYS_INLINE real_lanes step_back(double *last, real_lanes end)
{
    real_lanes begin = {*last, end[0]};
    *last = end[1];
    return begin;
}

/* An input and states of TICK_LANES ticks side by side. */
ALWAYS_INLINE struct input_lanes inputs_of(const struct input *a, const struct input *b)
{
    return (struct input_lanes){{a->value, b->value}, {a->rate, b->rate}};
}

/* The flow at the begin of TICK_LANES pieces, where the inputs of the middle hold. */
ALWAYS_INLINE void find_begins(struct booked m, const double *p, const struct input (*at)[MODEL_INPUTS],
                               const double *x0, const double *x1, struct flow_lanes *begin)
{
    struct input_lanes u[MODEL_INPUTS];
    real_lanes from[MODEL_STATES];
    UNROLL
    for (int i = 0; i < m.n_inputs; i++)
        u[i] = inputs_of(&at[0][i], &at[2][i]);
    UNROLL
    for (int k = 0; k < m.n; k++)
        from[k] = (real_lanes){x0[k], x1[k]};
    m.lanes(p, u, from, begin);
}

/* TICK_LANES pieces as by one_piece, to equal bits. found: NULL, or the flow at the begin of each, found
 * anew. */
ALWAYS_INLINE double side_by_side(struct booked m, struct ledger *l, const double *p,
                                  const struct input (*at)[MODEL_INPUTS], const double *x0, const double *x1,
                                  const struct flow_lanes *found)
{
    struct flow *last = &l->flow;
    struct input_lanes u[2][MODEL_INPUTS];
    struct flow_lanes begin, middle, end;
    real_lanes from[MODEL_STATES], to[MODEL_STATES], x[MODEL_STATES], work[MODEL_INPUTS];
    double sixth = l->rule.sixth, force = last->force;
    UNROLL
    for (int i = 0; i < m.n_inputs; i++) {
        UNROLL
        for (int k = 0; k < 2; k++)
            u[k][i] = inputs_of(&at[k][i], &at[2 + k][i]);
    }
    UNROLL
    for (int k = 0; k < m.n; k++) {
        from[k] = (real_lanes){x0[k], x1[k]};
        to[k] = (real_lanes){x1[k], x1[MODEL_STATES + k]};
    }
    m.lanes(p, u[1], to, &end);
    UNROLL
    for (int k = m.n / 2; k < m.n; k++)
        begin.x_dot[k] = step_back(&last->x_dot[k], end.x_dot[k]);
    UNROLL
    for (int i = 0; i < m.n_inputs; i++)
        begin.work[i] = step_back(&last->work[i], end.work[i]);
    begin.damping = step_back(&last->damping, end.damping);
    if (found) {
        UNROLL
        for (int k = m.n / 2; k < m.n; k++)
            begin.x_dot[k] = found->x_dot[k];
        UNROLL
        for (int i = 0; i < m.n_inputs; i++)
            begin.work[i] = found->work[i];
        begin.damping = found->damping;
        force = real_larger(found->force[0], found->force[1]);
    }
    middle_of_lanes(m.n, &l->rule, begin.x_dot, end.x_dot, from, to, x);
    m.lanes(p, u[0], x, &middle);
    UNROLL
    for (int i = 0; i < m.n_inputs; i++)
        work[i] = simpson_lanes(sixth, begin.work[i], middle.work[i], end.work[i]);
    real_lanes damping = simpson_lanes(sixth, begin.damping, middle.damping, end.damping);
    UNROLL
    for (int k = 0; k < TICK_LANES; k++) {
        double of_tick[MODEL_INPUTS];
        UNROLL
        for (int i = 0; i < m.n_inputs; i++)
            of_tick[i] = work[i][k];
        book(m.n_inputs, l, of_tick, damping[k]);
        force = real_larger(force, real_larger(middle.force[k], end.force[k]));
    }
    last->force = end.force[1];
    return force;
}
#endif

/* Any model, through its pointer: the same bits as an instantiation. */
static struct booked through_pointers(const struct model *m)
{
    return (struct booked){m->n_states, m->n_inputs, m->flow, NULL};
}

static double piece_general(struct ledger *l, const double *p, const struct input (*at)[MODEL_INPUTS],
                            const double *x0, const double *x1)
{
    return one_piece(through_pointers(l->model), l, p, at, x0, x1);
}

#if TICK_LANES > 1
ALWAYS_INLINE double one_by_one(ledger_function *one, struct ledger *l, const double *p,
                                const struct input (*at)[MODEL_INPUTS], const double (*x)[MODEL_STATES],
                                uint32_t n, bool anew)
{
    double force = 0.0;
    for (uint32_t k = 0; k < n; k++) {
        if (anew)
            l->model->flow(p, at[2 * k + 1], x[k], &l->flow);
        force = real_larger(force, one(l, p, &at[2 * k + 1], x[k], x[k + 1]));
    }
    return force;
}

static double ticks_alone(struct ledger *l, const double *p, const struct input (*at)[MODEL_INPUTS],
                          const double (*x)[MODEL_STATES], uint32_t n, bool anew)
{
    return one_by_one(l->piece, l, p, at, x, n, anew);
}

typedef void begins_function(const double *p, const struct input (*at)[MODEL_INPUTS], const double *x0,
                             const double *x1, struct flow_lanes *begin);

/* Ticks of a block. One alone is rare. */
ALWAYS_INLINE double ticks(struct booked m, ledger_function *one, begins_function *begins, struct ledger *l,
                           const double *p, const struct input (*at)[MODEL_INPUTS],
                           const double (*x)[MODEL_STATES], uint32_t n, bool anew)
{
    struct flow_lanes found;
    if (!m.lanes)
        return one_by_one(one, l, p, at, x, n, anew);
    if (n != TICK_LANES)
        return ticks_alone(l, p, at, x, n, anew);
    if (anew)
        begins(p, at + 1, x[0], x[1], &found);
    return side_by_side(m, l, p, at + 1, x[0], x[1], anew ? &found : NULL);
}
#endif

#define DECLARE(name, ...) static ledger_function piece_##name;
INSTANCES(DECLARE)

#define JUMP(row, when)                                                                                      \
    if (when)                                                                                                \
        return piece_##row(l, p, at, x0, x1);

#define ONE(name, for_models, jumps, states, contacts, n_inputs, rhs, gap, ...)                              \
    ALWAYS_INLINE double one_##name(struct ledger *l, const double *p,                                       \
                                    const struct input(*at)[MODEL_INPUTS], const double *x0,                 \
                                    const double *x1)                                                        \
    {                                                                                                        \
        return one_piece((struct booked){states, n_inputs, FLOW_AND_LANES(__VA_ARGS__, NULL, NULL)}, l, p,   \
                         at, x0, x1);                                                                        \
    }
INSTANCES(ONE)

/* One function per row. A jump to another one costs no more than that: the arguments stay in their places. */
#define PIECE(name, for_models, jumps, ...)                                                                  \
    CALLED_FROM_ANYWHERE double piece_##name(struct ledger *l, const double *p,                              \
                                             const struct input(*at)[MODEL_INPUTS], const double *x0,        \
                                             const double *x1)                                               \
    {                                                                                                        \
        unsigned active = l->active;                                                                         \
        (void)active;                                                                                        \
        jumps;                                                                                               \
        return one_##name(l, p, at, x0, x1);                                                                 \
    }
INSTANCES(PIECE)

#if TICK_LANES > 1
#define DECLARE_TICKS(name, ...) static ledger_ticks_function ticks_##name;
INSTANCES(DECLARE_TICKS)

#undef JUMP
#define JUMP(row, when)                                                                                      \
    if (when)                                                                                                \
        return ticks_##row(l, p, at, x, n, anew);

#define TICKS(name, for_models, jumps, states, contacts, n_inputs, rhs, gap, ...)                            \
    NEVER_INLINE void begins_##name(const double *p, const struct input(*at)[MODEL_INPUTS],                  \
                                    const double *x0, const double *x1, struct flow_lanes *begin)            \
    {                                                                                                        \
        const struct booked m = {states, n_inputs, FLOW_AND_LANES(__VA_ARGS__, NULL, NULL)};                 \
        if (m.lanes)                                                                                         \
            find_begins(m, p, at, x0, x1, begin);                                                            \
    }                                                                                                        \
    CALLED_FROM_ANYWHERE double ticks_##name(struct ledger *l, const double *p,                              \
                                             const struct input(*at)[MODEL_INPUTS],                          \
                                             const double(*x)[MODEL_STATES], uint32_t n, bool anew)          \
    {                                                                                                        \
        unsigned active = l->active;                                                                         \
        (void)active;                                                                                        \
        jumps;                                                                                               \
        return ticks((struct booked){states, n_inputs, FLOW_AND_LANES(__VA_ARGS__, NULL, NULL)}, one_##name, \
                     begins_##name, l, p, at, x, n, anew);                                                   \
    }
INSTANCES(TICKS)

ledger_ticks_function *ledger_bind_ticks(const struct model *m)
{
#define BIND_TICKS(name, for_models, ...)                                                                    \
    if (for_models)                                                                                          \
        return ticks_##name;
    INSTANCES(BIND_TICKS)
    return ticks_alone;
}
#endif

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
    l->open.goes_on = false;
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

double ledger_take_ticks(struct ledger *l, unsigned active, const struct method_books *b, uint32_t n)
{
    struct sum damping = l->damping;
    double gross = l->gross, force = 0.0;
    for (uint32_t k = 0; k < n; k++) {
        gross += b[k].damping;
        add(&damping, b[k].damping);
        force = real_larger(force, b[k].force);
        for (int i = 0; active >> i != 0; i++) {
            if (!((active >> i) & 1u))
                continue;
            gross += fabs(b[k].work[i]);
            add(&l->work[i], b[k].work[i]);
        }
    }
    l->damping = damping;
    l->gross = gross;
    return force;
}

/* The sums of the books begin at the ledger's, unless they go on. */
NEVER_INLINE void open_sums(struct ledger *l, const struct method_share *begin)
{
    struct ledger_open *o = &l->open;
    for (int i = 0; i < MODEL_INPUTS; i++) {
        o->work[i] = l->work[i];
        add(&o->work[i], begin->work[i]);
    }
    o->damping = l->damping;
    add(&o->damping, begin->damping);
}

ALWAYS_INLINE void close_sum(const struct sum *open, double share, struct sum *to)
{
    *to = *open;
    add(to, -share);
}

void ledger_take_ends(struct ledger *l, unsigned active, const struct method_books *b,
                      const struct method_ends *ends, uint32_t n)
{
    struct ledger_open *o = &l->open;
    double gross = l->gross;
    if (!o->goes_on || ends->anew)
        open_sums(l, &ends->begin);
    o->end = ends->end;
    o->goes_on = true;
    for (uint32_t k = 0; k < n; k++) {
        gross += b[k].damping;
        add(&o->damping, b[k].damping);
        for (int i = 0; active >> i != 0; i++) {
            if (!((active >> i) & 1u))
                continue;
            gross += fabs(b[k].work[i]);
            add(&o->work[i], b[k].work[i]);
        }
    }
    l->gross = gross;
    close_sum(&o->damping, o->end.damping, &l->damping);
    for (int i = 0; active >> i != 0; i++)
        close_sum(&o->work[i], o->end.work[i], &l->work[i]);
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
    l->open.goes_on = false;
    l->gross *= factor;
    l->most *= factor;
    /* Rounding of large sums: put back. */
    sum_add(&l->start, ledger_residual(l, MODEL_INPUTS, 0.0) - balance);
    sum_add(&l->change, change);
    l->flow_valid = false;
}
