/* rk4_beside.c - see rk4_beside.h. */
#include "host_sim/beside/rk4_beside.h"

#include "firmware/method/instances.h"
#include "host_sim/beside/rk4_beside_avx2.h"
#include "models/check.h"

#if TICK_LANES > 1
#define real       real_beside
#define REAL(name) name##_beside
#include "firmware/method/rk4_text.h"
#undef real
#undef REAL

enum { VECTORS = SIDES / PLANT_LANES };

/* PLANT_LANES plants under way: one lane for each. */
struct company {
    real_beside p[MODEL_DERIVED], h, x[MODEL_STATES];
    real_beside sign[MODEL_CONTACTS]; /* sign * gap > 0 is a switch */
    struct input_beside u[3][MODEL_INPUTS];
};

ALWAYS_INLINE void take_up(struct inlined_beside m, int numbers, int n_inputs, struct company *c,
                           const struct method_side *side)
{
    c->h = OF_EACH(side, b->length);
    UNROLL
    for (int i = 0; i < numbers; i++)
        c->p[i] = OF_EACH(side, p[i]);
    UNROLL
    for (int i = 0; i < m.n; i++)
        c->x[i] = OF_EACH(side, x[0][i]);
    UNROLL
    for (int i = 0; i < m.n_contacts; i++)
        c->sign[i] = 2.0 * OF_EACH(side, b->regime >> i & 1u) - 1.0;
    UNROLL
    for (int i = 0; i < n_inputs; i++)
        c->u[2][i] = (struct input_beside){OF_EACH(side, at[0][i].value), OF_EACH(side, at[0][i].rate)};
}

/* The inputs of tick k, which begins where the last one ended. */
ALWAYS_INLINE void excite(int n_inputs, struct company *c, const struct method_side *side, uint32_t k)
{
    UNROLL
    for (int i = 0; i < n_inputs; i++) {
        c->u[0][i] = c->u[2][i];
        UNROLL
        for (uint32_t j = 1; j < 3; j++)
            c->u[j][i] = (struct input_beside){OF_EACH(side, at[2 * k + j][i].value),
                                               OF_EACH(side, at[2 * k + j][i].rate)};
    }
}

/* Lanes whose tick to x1 may not be one to its end: inside and switch_suspected, as rk4.c asks them. */
ALWAYS_INLINE mask_beside suspected(struct inlined_beside m, const struct company *c, const real_beside *x1)
{
    struct input_beside g0[MODEL_CONTACTS], g1[MODEL_CONTACTS];
    real_beside size = fabs_beside(x1[0]);
    UNROLL
    for (int i = 1; i < m.n; i++)
        size += fabs_beside(x1[i]);
    mask_beside good = size <= METHOD_STATE_LIMIT;
    m.gap(c->p, c->u[0], c->x, g0);
    m.gap(c->p, c->u[2], x1, g1);
    UNROLL
    for (int i = 0; i < m.n_contacts; i++) {
        real_beside end = c->sign[i] * g1[i].value, v0 = c->sign[i] * g0[i].rate,
                    v1 = c->sign[i] * g1[i].rate;
        mask_beside turns = (v0 > 0.0) & (v1 < 0.0);
        good &= end < 0.0;
        if (!any_beside(turns))
            continue;
        real_beside begin = c->sign[i] * g0[i].value, s = (end - begin - v1 * c->h) / (v0 - v1);
        good &= ~(turns & (begin + v0 * s > 0.0));
    }
    return ~good;
}

ALWAYS_INLINE uint32_t run_beside(struct inlined_beside m, int numbers, int n_inputs,
                                  const struct method_side *side, uint32_t n)
{
    struct company c[VECTORS];
    UNROLL
    for (int v = 0; v < VECTORS; v++)
        take_up(m, numbers, n_inputs, &c[v], &side[v * PLANT_LANES]);
    for (uint32_t tick = 0; tick < n; tick++) {
        real_beside x1[VECTORS][MODEL_STATES];
        mask_beside bad = {0};
        UNROLL
        for (int v = 0; v < VECTORS; v++) {
            excite(n_inputs, &c[v], &side[v * PLANT_LANES], tick);
            advance_beside(m, c[v].p, c[v].h, c[v].u[0], c[v].u[1], c[v].u[2], c[v].x, x1[v]);
            bad |= suspected(m, &c[v], x1[v]);
        }
        if (any_beside(bad))
            return tick;
        UNROLL
        for (int v = 0; v < VECTORS; v++) {
            UNROLL
            for (int i = 0; i < m.n; i++) {
                c[v].x[i] = x1[v][i];
                UNROLL
                for (int k = 0; k < PLANT_LANES; k++)
                    side[v * PLANT_LANES + k].x[tick + 1][i] = x1[v][i][k];
            }
        }
    }
    return n;
}

#define RUN_BESIDE(name, for_models, numbers, states, contacts, n_inputs, rhs, gap, flow)                    \
    CALLED_FROM_ANYWHERE uint32_t run_beside_##name(const struct method_side *side, uint32_t n)              \
    {                                                                                                        \
        return run_beside((struct inlined_beside){rhs##_beside, gap##_beside, states, contacts}, numbers,    \
                          n_inputs, side, n);                                                                \
    }
INSTANCES_BESIDE(RUN_BESIDE)
#endif

run_beside_function *rk4_bind_beside_plain(const struct model *m, unsigned active)
{
    (void)m, (void)active;
#if TICK_LANES > 1
#define BIND_BESIDE(name, for_models, ...)                                                                   \
    if (for_models)                                                                                          \
        return run_beside_##name;
    INSTANCES_BESIDE(BIND_BESIDE)
#endif
    return NULL;
}

#ifndef BESIDE_COPY
run_beside_function *rk4_bind_beside(const struct model *m, unsigned active)
{
#ifdef BESIDE_AVX2
    if (__builtin_cpu_supports("avx2"))
        return rk4_bind_beside_avx2(m, active);
#endif
    return rk4_bind_beside_plain(m, active);
}
#endif
