/* ledger_beside.h - the books of PLANT_LANES plants in the lanes of vectors, to the bits of ledger.h. */
#ifndef HOST_SIM_LEDGER_BESIDE_H
#define HOST_SIM_LEDGER_BESIDE_H

#include "firmware/plant/plant_beside.h"
#include "models/check.h"

#if TICK_LANES > 1
typedef void flow_function_beside(const real_beside *p, const struct input_beside *u, const real_beside *x,
                                  struct flow_beside *flow);

/* As in ledger.c. */
struct booked_beside {
    int n, n_inputs;
    flow_function_beside *flow;
};

/* As the structs of ledger.h. */
struct sum_beside {
    real_beside value, carry;
};

struct ledger_rule_beside {
    real_beside length, sixth, a, b, c, inverse, mean;
};

struct ledger_beside {
    struct sum_beside work[MODEL_INPUTS], damping;
    real_beside gross;
    struct flow_beside flow;
    struct ledger_rule_beside rule;
    unsigned active;
};

#define number       real_beside
#define NUMBER(name) name##_beside
#define real         real_beside
#define REAL(name)   name##_beside
#define EACH         UNROLL
#include "firmware/plant/ledger_middle.h"
#include "firmware/plant/ledger_piece.h"
#undef real
#undef REAL
#undef EACH
#undef number
#undef NUMBER

ALWAYS_INLINE void open_books(struct booked_beside m, struct ledger_beside *b, const struct plant_side *side)
{
    b->rule = (struct ledger_rule_beside){
        .sixth = OF_EACH(side, pl->ledger.rule.sixth),
        .a = OF_EACH(side, pl->ledger.rule.a),
        .b = OF_EACH(side, pl->ledger.rule.b),
        .c = OF_EACH(side, pl->ledger.rule.c),
        .inverse = OF_EACH(side, pl->ledger.rule.inverse),
        .mean = OF_EACH(side, pl->ledger.rule.mean),
    };
    UNROLL
    for (int i = 0; i < m.n_inputs; i++) {
        b->work[i].value = OF_EACH(side, pl->ledger.work[i].value);
        b->work[i].carry = OF_EACH(side, pl->ledger.work[i].carry);
        b->flow.work[i] = OF_EACH(side, pl->ledger.flow.work[i]);
    }
    UNROLL
    for (int i = m.n / 2; i < m.n; i++)
        b->flow.x_dot[i] = OF_EACH(side, pl->ledger.flow.x_dot[i]);
    b->flow.damping = OF_EACH(side, pl->ledger.flow.damping);
    b->flow.force = OF_EACH(side, pl->ledger.flow.force);
    b->damping.value = OF_EACH(side, pl->ledger.damping.value);
    b->damping.carry = OF_EACH(side, pl->ledger.damping.carry);
    b->gross = OF_EACH(side, pl->ledger.gross);
    b->active = 0; /* an input that is silent here but not there adds 0 */
    UNROLL
    for (int k = 0; k < PLANT_LANES; k++)
        b->active |= side[k].pl->ledger.active;
}

/* Lane k goes back to its ledger. */
ALWAYS_INLINE void close_books(struct booked_beside m, const struct ledger_beside *b, int k, struct ledger *l)
{
    UNROLL
    for (int i = 0; i < m.n_inputs; i++) {
        l->work[i] = (struct sum){b->work[i].value[k], b->work[i].carry[k]};
        l->flow.work[i] = b->flow.work[i][k];
    }
    UNROLL
    for (int i = m.n / 2; i < m.n; i++)
        l->flow.x_dot[i] = b->flow.x_dot[i][k];
    l->flow.damping = b->flow.damping[k];
    l->flow.force = b->flow.force[k];
    l->damping = (struct sum){b->damping.value[k], b->damping.carry[k]};
    l->gross = b->gross[k];
}
#endif

#endif
