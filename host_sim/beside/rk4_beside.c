/* rk4_beside.c - see rk4_beside.h. */
#include "host_sim/beside/rk4_beside.h"

#include "firmware/method/instances.h"
#include "host_sim/beside/ledger_beside.h"
#include "host_sim/beside/rk4_beside_avx2.h"
#include "models/check.h"

#if TICK_LANES > 1
#define real       real_beside
#define REAL(name) name##_beside
#include "firmware/method/rk4_text.h"
#undef real
#undef REAL

enum { VECTORS = SIDES / PLANT_LANES };

/* A row of INSTANCES_BESIDE. */
struct row {
    int numbers, n_inputs;
    struct inlined_beside method;
    struct booked_beside ledger;
};

/* PLANT_LANES plants under way: one lane for each. */
struct lanes {
    real_beside p[MODEL_DERIVED], h, x[MODEL_STATES], slope[MODEL_STATES];
    real_beside sign[MODEL_CONTACTS]; /* sign * gap > 0 is a switch */
    struct input_beside u[3][MODEL_INPUTS];
    struct ledger_beside ledger;
    real_beside peak_force, total_time, loss_time, lost; /* as in struct plant; a tick's loss */
};

ALWAYS_INLINE void take_up(struct row m, struct lanes *c, const struct plant_side *side)
{
    real_beside touching = OF_EACH(side, pl->regime != 0);
    c->h = OF_EACH(side, b->length);
    UNROLL
    for (int i = 0; i < m.numbers; i++)
        c->p[i] = OF_EACH(side, pl->p[i]);
    UNROLL
    for (int i = 0; i < m.method.n; i++)
        c->x[i] = OF_EACH(side, x[0][i]);
    UNROLL
    for (int i = 0; i < m.method.n_contacts; i++)
        c->sign[i] = 2.0 * OF_EACH(side, b->regime >> i & 1u) - 1.0;
    UNROLL
    for (int i = 0; i < m.n_inputs; i++)
        c->u[2][i] = (struct input_beside){OF_EACH(side, at[0][i].value), OF_EACH(side, at[0][i].rate)};
    m.method.rhs(c->p, c->u[2], c->x, c->slope);
    c->peak_force = OF_EACH(side, pl->peak_force);
    c->total_time = OF_EACH(side, pl->total_time);
    c->loss_time = OF_EACH(side, pl->loss_time);
    c->lost = m.method.n_contacts > 0 ? c->h - touching * c->h : (real_beside){0.0};
    open_books(m.ledger, &c->ledger, side);
}

/* The inputs of tick k, which begins where the last one ended. */
ALWAYS_INLINE void excite(int n_inputs, struct lanes *c, const struct plant_side *side, uint32_t k)
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
ALWAYS_INLINE mask_beside suspected(struct inlined_beside m, const struct lanes *c, const real_beside *x1)
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

/* Tick k, with the state x1 at its end. The books need the force there, as the next tick does. */
ALWAYS_INLINE void take_tick(struct row m, struct lanes *c, const struct plant_side *side, uint32_t k,
                             const real_beside *x1)
{
    real_beside force = one_piece_beside(m.ledger, &c->ledger, c->p, &c->u[1], c->x, x1);
    m.method.rhs(c->p, c->u[2], x1, c->slope);
    c->peak_force = real_larger_beside(force, c->peak_force);
    c->total_time += c->h;
    c->loss_time += c->lost;
    UNROLL
    for (int i = 0; i < m.method.n; i++) {
        c->x[i] = x1[i];
        UNROLL
        for (int j = 0; j < PLANT_LANES; j++)
            side[j].x[k + 1][i] = x1[i][j];
    }
}

/* But for lanes whose bit is in `left_out`. */
ALWAYS_INLINE void put_back(struct row m, const struct lanes *c, const struct plant_side *side,
                            unsigned left_out)
{
    UNROLL
    for (int k = 0; k < PLANT_LANES; k++) {
        struct plant *pl = side[k].pl;
        if ((left_out >> k) & 1u)
            continue;
        close_books(m.ledger, &c->ledger, k, &pl->ledger);
        pl->peak_force = c->peak_force[k];
        pl->total_time = c->total_time[k];
        pl->loss_time = c->loss_time[k];
    }
}

ALWAYS_INLINE uint32_t run_sides(struct row m, const struct plant_side *side, uint32_t n, unsigned *stopped)
{
    struct lanes c[VECTORS];
    *stopped = 0;
    UNROLL
    for (int v = 0; v < VECTORS; v++)
        take_up(m, &c[v], &side[v * PLANT_LANES]);
    for (uint32_t tick = 0; tick < n; tick++) {
        real_beside x1[VECTORS][MODEL_STATES];
        mask_beside bad[VECTORS], any = {0};
        UNROLL
        for (int v = 0; v < VECTORS; v++) {
            excite(m.n_inputs, &c[v], &side[v * PLANT_LANES], tick);
            advance_from_beside(m.method, c[v].p, c[v].h, c[v].slope, c[v].u[1], c[v].u[2], c[v].x, x1[v]);
            bad[v] = suspected(m.method, &c[v], x1[v]);
            any |= bad[v];
        }
        if (any_beside(any)) {
            n = tick + 1;
            UNROLL
            for (int v = 0; v < VECTORS; v++) {
                unsigned which = which_beside(bad[v]);
                *stopped |= which << (v * PLANT_LANES);
                put_back(m, &c[v], &side[v * PLANT_LANES], ~which);
            }
        }
        UNROLL
        for (int v = 0; v < VECTORS; v++)
            take_tick(m, &c[v], &side[v * PLANT_LANES], tick, x1[v]);
    }
    UNROLL
    for (int v = 0; v < VECTORS; v++)
        put_back(m, &c[v], &side[v * PLANT_LANES], *stopped >> (v * PLANT_LANES));
    return n;
}

#define RUN_SIDES(name, for_models, numbers, states, contacts, n_inputs, rhs, gap, flow)                     \
    CALLED_FROM_ANYWHERE uint32_t run_sides_##name(const struct plant_side *side, uint32_t n,                \
                                                   unsigned *stopped)                                        \
    {                                                                                                        \
        const struct row m = {numbers,                                                                       \
                              n_inputs,                                                                      \
                              {rhs##_beside, gap##_beside, states, contacts},                                \
                              {states, n_inputs, flow##_beside}};                                            \
        return run_sides(m, side, n, stopped);                                                               \
    }
INSTANCES_BESIDE(RUN_SIDES)
#endif

plant_sides_function *rk4_bind_sides_plain(const struct model *m, unsigned active)
{
    (void)m, (void)active;
#if TICK_LANES > 1
#define BIND_SIDES(name, for_models, ...)                                                                    \
    if (for_models)                                                                                          \
        return run_sides_##name;
    INSTANCES_BESIDE(BIND_SIDES)
#endif
    return NULL;
}

#ifndef BESIDE_COPY
plant_sides_function *rk4_bind_sides(const struct model *m, unsigned active)
{
#ifdef BESIDE_AVX2
    if (__builtin_cpu_supports("avx2"))
        return rk4_bind_sides_avx2(m, active);
#endif
    return rk4_bind_sides_plain(m, active);
}
#endif
