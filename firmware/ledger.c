/* ledger.c - see ledger.h. */
#include "firmware/ledger.h"

#include <math.h>

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

void ledger_start(struct ledger *l, const struct model *m, const double *p, const struct input *u,
                  const double *x)
{
    *l = (struct ledger){.start = m->energy(p, u, x)};
}

void ledger_piece(struct ledger *l, const struct model *m, const double *p, const struct excitation *e,
                  const double *x0, const double *x1, double *force)
{
    struct flow *begin = &l->flow[l->end], *end = &l->flow[1 - l->end];
    struct flow middle;
    double x[MODEL_STATES], eighth = 0.125 * e->length, sixth = e->length * (1.0 / 6.0);
    int n = m->n_states;
    if (!l->flow_valid)
        m->flow(p, e->at[0], x0, begin);
    m->flow(p, e->at[2], x1, end);
    /* Hermite: (x0 + x1)/2 + h (x0' - x1')/8. */
    for (int i = 0; i < n; i++)
        x[i] = 0.5 * (x0[i] + x1[i]) + eighth * (begin->x_dot[i] - end->x_dot[i]);
    m->flow(p, e->at[1], x, &middle);
    unsigned left = e->active;
    for (int i = 0; left != 0; i++, left >>= 1) {
        if (!(left & 1u))
            continue;
        double work = sixth * ((begin->work[i] + end->work[i]) + 4.0 * middle.work[i]);
        add(&l->work[i], work);
        l->gross += fabs(work);
    }
    double damping = sixth * ((begin->damping + end->damping) + 4.0 * middle.damping);
    add(&l->damping, damping);
    l->gross += damping;
    l->end = 1 - l->end;
    l->flow_valid = true;
    *force = larger(begin->force, larger(middle.force, end->force));
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
