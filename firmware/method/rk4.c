/* rk4.c - the classical Runge-Kutta method of order 4, with contact switches located by its own shortened
 * steps.
 *
 * Smooth motion: order 4. Across the kink of a Hertzian contact any one-step method falls to order 2.5 in
 * velocity, with or without location, because the force starts like t^{3/2}. A gap spring keeps order 4,
 * because the step is split at the switch. Cost with the model inlined (instances.h): four evaluations of its
 * rhs and one of its gaps per step, three more per switch. */
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include "models/check.h"
#include "firmware/method/instances.h"
#include "firmware/method/method.h"
#include "firmware/method/rk4_step.h"
#include "firmware/method/switch.h"

/* The model as compile-time constants of one instantiation. */
struct inlined {
    rhs_function *rhs;
    gap_function *gap;
    int n, n_contacts;
};

ALWAYS_INLINE void advance(struct inlined m, const double *p, const struct segment *e, const double *x,
                           double *x1)
{
    rk4_advance(m.rhs, m.n, p, e->length, e->at[0], e->at[1], e->at[2], x, x1);
}

static bool finite_state(const double *x, int n)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += fabs(x[i]);
    return sum <= DBL_MAX;
}

/* Any model, with the bits of its inlined copy; for rare cases. */
static struct inlined through_pointers(const struct model *m)
{
    return (struct inlined){m->rhs, m->gap, m->n_states, m->n_contacts};
}

static void advance_general(const struct model *m, const double *p, const double *scratch,
                            const struct segment *e, const double *x, double *x1)
{
    (void)scratch;
    advance(through_pointers(m), p, e, x, x1);
}

/* Something switched, or nearly did: takes the step once more, to locate it. Handing over the values that
 * `step` has in registers would cost a store in every step. It takes the arguments of a step, so that it is a
 * tail call. */
CALLED_FROM_ANYWHERE enum step_status locate(const struct model *m, const double *p, double *scratch,
                                             const struct segment *e, unsigned regime, double *x,
                                             struct crossing *c)
{
    struct switch_stepper stepper = {advance_general, m, p, NULL, 4.0 * DBL_EPSILON * e->length};
    (void)scratch;
    return switch_locate(&stepper, e, regime, x, c);
}

ALWAYS_INLINE enum step_status step(struct inlined m, const struct model *model, const double *p,
                                    double *scratch, const struct segment *e, unsigned regime, double *x,
                                    struct crossing *c)
{
    double x1[MODEL_STATES];
    struct input g0[MODEL_CONTACTS], g1[MODEL_CONTACTS];
    bool suspected = false;
    advance(m, p, e, x, x1);
    if (!finite_state(x1, m.n))
        return STEP_NOT_FINITE;
    if (!(regime & REGIME_ANY)) {
        m.gap(p, e->at[0], x, g0);
        m.gap(p, e->at[2], x1, g1);
        for (int i = 0; i < m.n_contacts; i++)
            suspected |= switch_suspected(&g0[i], &g1[i], e->length, (regime >> i) & 1u);
        if (suspected)
            return locate(model, p, scratch, e, regime, x, c);
    }
    for (int i = 0; i < m.n; i++)
        x[i] = x1[i];
    return STEP_END;
}

/* Any model, through its pointers. */
static enum step_status step_general(const struct model *m, const double *p, double *scratch,
                                     const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    return step(through_pointers(m), m, p, scratch, e, regime, x, c);
}

#define DECLARE(name, ...) static step_function step_##name;
INSTANCES(DECLARE)

#define JUMP(row, when)                                                                                      \
    if (when)                                                                                                \
        return step_##row(m, p, scratch, e, regime, x, c);

/* One function per row. A jump to another one costs no more than that: the arguments stay in their places. */
#define STEP(name, for_models, jumps, states, contacts, n_inputs, rhs, gap, flow)                            \
    CALLED_FROM_ANYWHERE enum step_status step_##name(const struct model *m, const double *p,                \
                                                      double *scratch, const struct segment *e,              \
                                                      unsigned regime, double *x, struct crossing *c)        \
    {                                                                                                        \
        unsigned active = e->active;                                                                         \
        (void)active;                                                                                        \
        jumps;                                                                                               \
        return step((struct inlined){rhs, gap, states, contacts}, m, p, scratch, e, regime, x, c);           \
    }
INSTANCES(STEP)

static step_function *bind(const struct model *m)
{
#define BIND(name, for_models, ...)                                                                          \
    if (for_models)                                                                                          \
        return step_##name;
    INSTANCES(BIND)
    return step_general;
}

static size_t n_work(const struct model *m)
{
    (void)m;
    return 0;
}

static const char *refuse(const struct model *m, const double *p, double h, double tol)
{
    (void)tol;
    if (!(h * m->eigenfrequency(p) <= RK4_ANGLE_MAX))
        return "step too coarse for rk4: eigenfrequency * step is above 0.2 rad (more substeps, or a slower "
               "rig)";
    return NULL;
}

static void prepare(const struct model *m, const double *p, double h, double tol, double *scratch)
{
    (void)m, (void)p, (void)h, (void)tol, (void)scratch;
}

static bool runs_rk4(const double *work)
{
    (void)work;
    return true;
}

const struct method rk4 = {
    .name = "rk4",
    .title = "classical Runge-Kutta, order 4; switches located by Newton on shortened steps",
    .order = 4,
    .n_work = n_work,
    .refuse = refuse,
    .prepare = prepare,
    .bind = bind,
    .runs_rk4 = runs_rk4,
};
