/* ledger_piece.h - the books of one piece; a text for ledger.c and host_sim/beside/ledger_beside.h, see
 * models/lanes.h. */

/* Knuth's exact sum: value is rounded, what rounding lost goes into carry. No branch. */
ALWAYS_INLINE void REAL(add)(struct REAL(sum) * s, real x)
{
    real t = s->value + x, part = t - s->value;
    s->carry += (s->value - (t - part)) + (x - part);
    s->value = t;
}

/* Adds what a piece moved. */
ALWAYS_INLINE void REAL(book)(int n_inputs, struct REAL(ledger) * l, const real *work, real damping)
{
    real gross = l->gross;
    unsigned active = l->active;
    UNROLL
    for (int i = 0; i < n_inputs; i++) {
        if (!((active >> i) & 1u))
            continue;
        REAL(add)(&l->work[i], work[i]);
        gross += REAL(fabs)(work[i]);
    }
    REAL(add)(&l->damping, damping);
    l->gross = gross + damping;
}

/* One piece. Its end is handed to the next one field by field: those that an instantiation does not set cost
 * nothing. Velocities stand in the state. */
ALWAYS_INLINE real REAL(one_piece)(struct REAL(booked) m, struct REAL(ledger) * l, const number *p,
                                   const struct REAL(input) (*at)[MODEL_INPUTS], const real *x0,
                                   const real *x1)
{
    struct REAL(flow) *begin = &l->flow, end, middle;
    real x[MODEL_STATES], work[MODEL_INPUTS] = {(real){0.0}};
    number sixth = l->rule.sixth;
    m.flow(p, at[1], x1, &end);
    REAL(middle_of)(m.n, &l->rule, begin->x_dot, end.x_dot, x0, x1, x);
    m.flow(p, at[0], x, &middle);
    UNROLL
    for (int i = 0; i < m.n_inputs; i++) {
        work[i] = REAL(simpson)(sixth, begin->work[i], middle.work[i], end.work[i]);
        begin->work[i] = end.work[i];
    }
    REAL(book)(m.n_inputs, l, work, REAL(simpson)(sixth, begin->damping, middle.damping, end.damping));
    real force = REAL(real_larger)(begin->force, REAL(real_larger)(middle.force, end.force));
    for (int k = m.n / 2; k < m.n; k++)
        begin->x_dot[k] = end.x_dot[k];
    begin->damping = end.damping;
    begin->force = end.force;
    return force;
}
