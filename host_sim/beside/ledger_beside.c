/* ledger_beside.c - see ledger_beside.h. */
#include "host_sim/beside/ledger_beside.h"

#include "firmware/method/instances.h"
#include "host_sim/beside/ledger_beside_avx2.h"
#include "models/check.h"

#if TICK_LANES > 1
typedef void flow_function(const real_beside *p, const struct input_beside *u, const real_beside *x,
                           struct flow_beside *flow);

/* The model as compile-time constants of one instantiation. */
struct inlined_beside {
    int numbers, n, n_inputs;
    flow_function *flow;
};

/* As the structs of ledger.h, for PLANT_LANES plants. */
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

ALWAYS_INLINE void take_up(struct inlined_beside m, struct ledger_beside *b, const struct ledger_side *books)
{
    b->rule = (struct ledger_rule_beside){
        .sixth = OF_EACH(books, l->rule.sixth),
        .a = OF_EACH(books, l->rule.a),
        .b = OF_EACH(books, l->rule.b),
        .c = OF_EACH(books, l->rule.c),
        .inverse = OF_EACH(books, l->rule.inverse),
        .mean = OF_EACH(books, l->rule.mean),
    };
    UNROLL
    for (int i = 0; i < m.n_inputs; i++) {
        b->work[i] = (struct sum_beside){OF_EACH(books, l->work[i].value), OF_EACH(books, l->work[i].carry)};
        b->flow.work[i] = OF_EACH(books, l->flow.work[i]);
    }
    UNROLL
    for (int i = m.n / 2; i < m.n; i++)
        b->flow.x_dot[i] = OF_EACH(books, l->flow.x_dot[i]);
    b->flow.damping = OF_EACH(books, l->flow.damping);
    b->flow.force = OF_EACH(books, l->flow.force);
    b->damping = (struct sum_beside){OF_EACH(books, l->damping.value), OF_EACH(books, l->damping.carry)};
    b->gross = OF_EACH(books, l->gross);
    b->active = 0; /* an input that is silent here but not there adds 0 */
    UNROLL
    for (int k = 0; k < PLANT_LANES; k++)
        b->active |= books[k].l->active;
}

/* Lane k goes back to its ledger. */
ALWAYS_INLINE void put_back(struct inlined_beside m, const struct ledger_beside *b, int k, struct ledger *l)
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

/* PLANT_LANES plants. */
ALWAYS_INLINE void book_lanes(struct inlined_beside m, struct ledger_side *books,
                              const struct method_side *side, uint32_t n)
{
    struct ledger_beside b;
    struct input_beside u[2][MODEL_INPUTS];
    real_beside p[MODEL_DERIVED], x[2][MODEL_STATES], force;
    take_up(m, &b, books);
    force = b.flow.force;
    UNROLL
    for (int i = 0; i < m.numbers; i++)
        p[i] = OF_EACH(side, p[i]);
    UNROLL
    for (int i = 0; i < m.n; i++)
        x[0][i] = OF_EACH(side, x[0][i]);
    for (uint32_t tick = 0; tick < n; tick++) {
        UNROLL
        for (int i = 0; i < m.n; i++)
            x[1][i] = OF_EACH(side, x[tick + 1][i]);
        UNROLL
        for (int i = 0; i < m.n_inputs; i++) {
            UNROLL
            for (uint32_t j = 0; j < 2; j++)
                u[j][i] = (struct input_beside){OF_EACH(side, at[2 * tick + 1 + j][i].value),
                                                OF_EACH(side, at[2 * tick + 1 + j][i].rate)};
        }
        force = real_larger_beside(force, one_piece_beside(m, &b, p, u, x[0], x[1]));
        UNROLL
        for (int i = 0; i < m.n; i++)
            x[0][i] = x[1][i];
    }
    UNROLL
    for (int k = 0; k < PLANT_LANES; k++) {
        put_back(m, &b, k, books[k].l);
        books[k].force = force[k];
    }
}

ALWAYS_INLINE void book_sides(struct inlined_beside m, struct ledger_side *books,
                              const struct method_side *side, uint32_t plants, uint32_t n)
{
    for (uint32_t k = 0; k < plants; k += PLANT_LANES)
        book_lanes(m, &books[k], &side[k], n);
}

#define BOOK_BESIDE(name, for_models, numbers, states, contacts, n_inputs, rhs, gap, flow)                   \
    CALLED_FROM_ANYWHERE void book_beside_##name(struct ledger_side *books, const struct method_side *side,  \
                                                 uint32_t plants, uint32_t n)                                \
    {                                                                                                        \
        book_sides((struct inlined_beside){numbers, states, n_inputs, flow##_beside}, books, side, plants,   \
                   n);                                                                                       \
    }
INSTANCES_BESIDE(BOOK_BESIDE)
#endif

ledger_beside_function *ledger_bind_beside_plain(const struct model *m, unsigned active)
{
    (void)m, (void)active;
#if TICK_LANES > 1
#define BIND_BESIDE(name, for_models, ...)                                                                   \
    if (for_models)                                                                                          \
        return book_beside_##name;
    INSTANCES_BESIDE(BIND_BESIDE)
#endif
    return NULL;
}

#ifndef BESIDE_COPY
ledger_beside_function *ledger_bind_beside(const struct model *m, unsigned active)
{
#ifdef BESIDE_AVX2
    if (__builtin_cpu_supports("avx2"))
        return ledger_bind_beside_avx2(m, active);
#endif
    return ledger_bind_beside_plain(m, active);
}
#endif
