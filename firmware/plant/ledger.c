/* ledger.c - see ledger.h. */
#include "firmware/plant/ledger.h"

#include "firmware/method/instances.h"
#include "firmware/plant/ledger_piece.h"

void sum_add(struct sum *s, double x)
{
    ledger_sum(s, x);
}

double sum_of(const struct sum *s)
{
    return s->value + s->carry;
}

ALWAYS_INLINE double piece(struct ledger_model m, struct ledger *l, const double *p, const struct segment *e,
                           const double *x0, const double *x1)
{
    return ledger_piece_inlined(m, l, p, e->active, e->length, e->at[1], e->at[2], x0, x1);
}

/* Any model, through its pointer: the same bits as an instantiation. */
static double piece_general(struct ledger *l, const double *p, const struct segment *e, const double *x0,
                            const double *x1)
{
    return piece((struct ledger_model){l->model->flow, l->model->n_states, l->model->n_inputs}, l, p, e, x0,
                 x1);
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
        return piece((struct ledger_model){flow, states, n_inputs}, l, p, e, x0, x1);                        \
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
    *l = (struct ledger){.model = m, .piece = bind(m), .start = m->energy(p, u, x)};
}

double ledger_residual(const struct ledger *l, int n_inputs, double stored)
{
    double balance = (stored - l->start) + sum_of(&l->damping) - sum_of(&l->change);
    for (int i = 0; i < n_inputs; i++)
        balance -= sum_of(&l->work[i]);
    return balance;
}

static void sum_scale(struct sum *s, double factor)
{
    s->value *= factor;
    s->carry *= factor;
}

void ledger_rescale(struct ledger *l, double factor, double change)
{
    for (int i = 0; i < MODEL_INPUTS; i++)
        sum_scale(&l->work[i], factor);
    sum_scale(&l->damping, factor);
    sum_scale(&l->change, factor);
    l->start *= factor;
    l->gross *= factor;
    sum_add(&l->change, change);
    l->flow_valid = false;
}
