/* ledger_piece.h - one piece of the energy ledger with the model inlined, for ledger.c and block.c; see ledger.h. */
#ifndef FIRMWARE_LEDGER_PIECE_H
#define FIRMWARE_LEDGER_PIECE_H

#include <math.h>
#include "firmware/plant/ledger.h"
#include "models/check.h"

/* Knuth's exact sum: value is rounded, what rounding lost goes into carry. No branch. */
ALWAYS_INLINE void ledger_sum(struct sum *s, double x)
{
    double t = s->value + x, part = t - s->value;
    s->carry += (s->value - (t - part)) + (x - part);
    s->value = t;
}

ALWAYS_INLINE double ledger_larger(double a, double b)
{
    return a > b ? a : b;
}

typedef void flow_function(const double *p, const struct input *u, const double *x, struct flow *flow);

/* The model as compile-time constants of one instantiation. */
struct ledger_model {
    flow_function *flow;
    int n, n_inputs; /* states, and inputs that may be active */
};

/* Simpson's rule over the powers at both ends and in the middle. */
ALWAYS_INLINE void ledger_book(struct ledger_model m, struct ledger *l, unsigned active, double sixth,
                               const struct flow *begin, const struct flow *middle, const struct flow *end)
{
    double gross = l->gross;
    UNROLL
    for (int i = 0; i < m.n_inputs; i++) {
        if (!((active >> i) & 1u))
            continue;
        double work = sixth * ((begin->work[i] + end->work[i]) + 4.0 * middle->work[i]);
        ledger_sum(&l->work[i], work);
        gross += fabs(work);
    }
    double damping = sixth * ((begin->damping + end->damping) + 4.0 * middle->damping);
    ledger_sum(&l->damping, damping);
    l->gross = gross + damping;
}

/* What the next piece begins with: field by field, so that those an instantiation does not set cost nothing. */
ALWAYS_INLINE void ledger_keep(struct ledger_model m, struct flow *begin, const struct flow *end)
{
    for (int i = 0; i < m.n; i++)
        begin->x_dot[i] = end->x_dot[i];
    UNROLL
    for (int i = 0; i < m.n_inputs; i++)
        begin->work[i] = end->work[i];
    begin->damping = end->damping;
    begin->force = end->force;
}

/* A shorter piece (model time) takes its mean velocity for the secant, which rounding would spoil. */
#define SECANT_MIN 1e-6

/* The state in the middle of a piece from positions q, velocities v and accelerations a at its ends (quintic Hermite polynomial):
 *   q = (q0 + q1)/2 + 5 h (v0 - v1)/32 + h^2 (a0 + a1)/64,  v = 15/8 (q1 - q0)/h - 7 (v0 + v1)/16 + h (a1 - a0)/32. */
ALWAYS_INLINE void ledger_middle(int n, double h, const struct flow *begin, const struct flow *end,
                                 const double *x0, const double *x1, double *x)
{
    bool apart = h >= SECANT_MIN;
    double a = (5.0 / 32.0) * h, b = (1.0 / 64.0) * (h * h), c = (1.0 / 32.0) * h, inverse = 1.0 / h;
    for (int i = 0, k = n / 2; k < n; i++, k++) {
        double mean = 0.5 * (x0[k] + x1[k]), secant = apart ? (x1[i] - x0[i]) * inverse : mean;
        x[i] = (0.5 * (x0[i] + x1[i]) + a * (x0[k] - x1[k])) + b * (begin->x_dot[k] + end->x_dot[k]);
        x[k] = (1.875 * secant - 0.875 * mean) + c * (end->x_dot[k] - begin->x_dot[k]);
    }
}

/* Books the piece of length h from x0 to x1 with the inputs in its middle and at its end; *l holds the flow at its begin. Returns the
 * largest contact force of the three instants. */
ALWAYS_INLINE double ledger_piece_inlined(struct ledger_model m, struct ledger *l, const double *p,
                                          unsigned active, double h, const struct input *mid,
                                          const struct input *end_input, const double *x0, const double *x1)
{
    struct flow *begin = &l->flow, end, middle;
    double x[MODEL_STATES], sixth = h * (1.0 / 6.0);
    m.flow(p, end_input, x1, &end);
    ledger_middle(m.n, h, begin, &end, x0, x1, x);
    m.flow(p, mid, x, &middle);
    ledger_book(m, l, active, sixth, begin, &middle, &end);
    double force = ledger_larger(begin->force, ledger_larger(middle.force, end.force));
    ledger_keep(m, begin, &end);
    return force;
}

#endif
