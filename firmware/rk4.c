/* rk4.c - the classical Runge-Kutta method of order 4, with contact switches located by its own shortened steps.
 *
 * Smooth motion: order 4. Across a Hertz contact's kink any one-step method falls to order 2.5 in velocity, located
 * or not (the force starts like t^{3/2}); a gap spring keeps order 4 because the step is split at the switch.
 * Cost with the model inlined: four evaluations of its rhs and one of its gaps per step, three more per switch. */
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include "firmware/check.h"
#include "firmware/method.h"
#include "firmware/switch.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/polynomial.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"

typedef void rhs_function(const double *p, const struct input *u, const double *x, double *x_dot);
typedef void gap_function(const double *p, const struct input *u, const double *x, struct input *gap);

/* The model as compile-time constants of one instantiation. */
struct inlined {
    rhs_function *rhs;
    gap_function *gap;
    int n, n_contacts;
};

/* Classical RK4 of x'' = f(t, x, x'), positions first in the state, then velocities. Written for the second-order
 * system (the stage velocities put into the stage positions), the chain from one force to the next is two operations
 * shorter, and there is nothing to add up for the positions but three accelerations. */
ALWAYS_INLINE void advance(struct inlined m, const double *p, const struct excitation *e, const double *x,
                           double *x1)
{
    double k1[MODEL_STATES], k2[MODEL_STATES], k3[MODEL_STATES], k4[MODEL_STATES], y[MODEL_STATES];
    double h = e->length, half = 0.5 * h, quarter = half * half, square = half * h;
    int n = m.n / 2;
    m.rhs(p, e->at[0], x, k1);
    for (int i = 0; i < n; i++) {
        y[i] = x[i] + half * x[n + i];
        y[n + i] = x[n + i] + half * k1[n + i];
    }
    m.rhs(p, e->at[1], y, k2);
    for (int i = 0; i < n; i++) {
        y[i] = (x[i] + half * x[n + i]) + quarter * k1[n + i];
        y[n + i] = x[n + i] + half * k2[n + i];
    }
    m.rhs(p, e->at[1], y, k3);
    for (int i = 0; i < n; i++) {
        y[i] = (x[i] + h * x[n + i]) + square * k2[n + i];
        y[n + i] = x[n + i] + h * k3[n + i];
    }
    m.rhs(p, e->at[2], y, k4);
    double sixth = h * (1.0 / 6.0), sixth_square = h * sixth;
    for (int i = 0; i < n; i++) {
        double middle = k2[n + i] + k3[n + i];
        x1[i] = (x[i] + h * x[n + i]) + sixth_square * (k1[n + i] + middle);
        x1[n + i] = x[n + i] + sixth * ((k1[n + i] + k4[n + i]) + 2.0 * middle);
    }
}

static bool finite_state(const double *x, int n)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += fabs(x[i]);
    return sum <= DBL_MAX;
}

/* The same arithmetic, and so the same bits, as an instantiation; for what happens rarely. */
static struct inlined through_pointers(const struct model *m)
{
    return (struct inlined){m->rhs, m->gap, m->n_states, m->n_contacts};
}

static void advance_general(const struct model *m, const double *p, const double *work,
                            const struct excitation *e, const double *x, double *x1)
{
    (void)work;
    advance(through_pointers(m), p, e, x, x1);
}

/* Something switched, or nearly did: the whole step once more, now to locate it. What stays in registers in `step`
 * would have to go through memory to be handed over, in every step. */
NEVER_INLINE enum step_status locate(const struct model *m, const double *p, const struct excitation *e,
                                     unsigned regime, double *x, struct crossing *c)
{
    struct switch_stepper stepper = {advance_general, m, p, NULL, 4.0 * DBL_EPSILON * e->length};
    return switch_locate(&stepper, e, regime, x, c);
}

ALWAYS_INLINE enum step_status step(struct inlined m, const struct model *model, const double *p,
                                    const struct excitation *e, unsigned regime, double *x,
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
            return locate(model, p, e, regime, x, c);
    }
    for (int i = 0; i < m.n; i++)
        x[i] = x1[i];
    return STEP_END;
}

/* One instantiation a full model. */
static enum step_status step_hertz_rig(const struct model *m, const double *p, double *work,
                                       const struct excitation *e, unsigned regime, double *x,
                                       struct crossing *c)
{
    (void)work;
    if (e->active & (1u << RIG_BASE | 1u << RIG_STIFFNESS))
        return step((struct inlined){hertz_rig_rhs, hertz_rig_gap, 2, 1}, m, p, e, regime, x, c);
    return step((struct inlined){hertz_rig_rhs_forced, hertz_rig_gap_forced, 2, 1}, m, p, e, regime, x, c);
}

static enum step_status step_rolling_contact(const struct model *m, const double *p, double *work,
                                             const struct excitation *e, unsigned regime, double *x,
                                             struct crossing *c)
{
    (void)work;
    return step((struct inlined){rolling_contact_rhs, rolling_contact_gap, 2, 1}, m, p, e, regime, x, c);
}

static enum step_status step_afm_tip(const struct model *m, const double *p, double *work,
                                     const struct excitation *e, unsigned regime, double *x,
                                     struct crossing *c)
{
    (void)work;
    return step((struct inlined){afm_tip_rhs, afm_tip_gap, 2, 1}, m, p, e, regime, x, c);
}

static enum step_status step_shaft_bearing(const struct model *m, const double *p, double *work,
                                           const struct excitation *e, unsigned regime, double *x,
                                           struct crossing *c)
{
    (void)work;
    return step((struct inlined){shaft_bearing_rhs, shaft_bearing_gap, 6, SHAFT_CONTACTS}, m, p, e, regime, x,
                c);
}

static enum step_status step_shaft_linear(const struct model *m, const double *p, double *work,
                                          const struct excitation *e, unsigned regime, double *x,
                                          struct crossing *c)
{
    (void)work;
    return step((struct inlined){shaft_bearing_rhs_open, model_no_gap, 6, 0}, m, p, e, regime, x, c);
}

static enum step_status step_shaft_mode(const struct model *m, const double *p, double *work,
                                        const struct excitation *e, unsigned regime, double *x,
                                        struct crossing *c)
{
    (void)work;
    return step((struct inlined){shaft_mode_rhs, shaft_mode_gap, 2, SHAFT_CONTACTS}, m, p, e, regime, x, c);
}

/* One a shape of the rungs of one degree of freedom. */
#define POLYNOMIAL_STEP(shape)                                                                               \
    static enum step_status step_##shape(const struct model *m, const double *p, double *work,               \
                                         const struct excitation *e, unsigned regime, double *x,             \
                                         struct crossing *c)                                                 \
    {                                                                                                        \
        (void)work;                                                                                          \
        return step((struct inlined){polynomial_rhs_##shape, model_no_gap, 2, 0}, m, p, e, regime, x, c);    \
    }
POLYNOMIAL_STEP(linear_force)
POLYNOMIAL_STEP(linear_forces)
POLYNOMIAL_STEP(linear_last)
POLYNOMIAL_STEP(linear_4)
POLYNOMIAL_STEP(cubic_force)
POLYNOMIAL_STEP(cubic_forces)
POLYNOMIAL_STEP(cubic_last)
POLYNOMIAL_STEP(cubic_4)

/* Of two inputs: a silent one costs nothing. */
#define POLYNOMIAL_TWO(degree)                                                                               \
    static enum step_status step_##degree##_2(const struct model *m, const double *p, double *work,          \
                                              const struct excitation *e, unsigned regime, double *x,        \
                                              struct crossing *c)                                            \
    {                                                                                                        \
        if (e->active <= 1u)                                                                                 \
            return step_##degree##_force(m, p, work, e, regime, x, c);                                       \
        return step((struct inlined){polynomial_rhs_##degree##_2, model_no_gap, 2, 0}, m, p, e, regime, x,   \
                    c);                                                                                      \
    }
POLYNOMIAL_TWO(linear)
POLYNOMIAL_TWO(cubic)

/* Of four. By a table a shape is a jump; a call would hand everything over anew. */
#define POLYNOMIAL_FOUR(degree)                                                                              \
    static enum step_status step_##degree(const struct model *m, const double *p, double *work,              \
                                          const struct excitation *e, unsigned regime, double *x,            \
                                          struct crossing *c)                                                \
    {                                                                                                        \
        static step_function *const shape[] = {step_##degree##_force, step_##degree##_forces,                \
                                               step_##degree##_last, step_##degree##_4};                     \
        unsigned a = e->active;                                                                              \
        return shape[a <= 1u ? 0 : a <= 3u ? 1 : a & 4u ? 3 : 2](m, p, work, e, regime, x, c);               \
    }
POLYNOMIAL_FOUR(linear)
POLYNOMIAL_FOUR(cubic)

static step_function *bind_polynomial(const struct model *m)
{
    if (m->n_inputs == 1)
        return m->linear ? step_linear_force : step_cubic_force;
    if (m->n_inputs == 2)
        return m->linear ? step_linear_2 : step_cubic_2;
    return m->linear ? step_linear : step_cubic;
}

/* Any other model, through its pointers. */
static enum step_status step_general(const struct model *m, const double *p, double *work,
                                     const struct excitation *e, unsigned regime, double *x,
                                     struct crossing *c)
{
    (void)work;
    return step(through_pointers(m), m, p, e, regime, x, c);
}

static step_function *bind(const struct model *m)
{
    if (m == &hertz_rig)
        return step_hertz_rig;
    if (m == &rolling_contact)
        return step_rolling_contact;
    if (m == &afm_tip)
        return step_afm_tip;
    if (polynomial_shaped(m))
        return bind_polynomial(m);
    if (m == &shaft_bearing)
        return step_shaft_bearing;
    if (m == &shaft_bearing_mode)
        return step_shaft_mode;
    return m == &shaft_bearing_linear ? step_shaft_linear : step_general;
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

static void prepare(const struct model *m, const double *p, double h, double tol, double *work)
{
    (void)m, (void)p, (void)h, (void)tol, (void)work;
}

const struct method rk4 = {
    .name = "rk4",
    .title = "classical Runge-Kutta, order 4; switches located by Newton on shortened steps",
    .order = 4,
    .n_work = n_work,
    .refuse = refuse,
    .prepare = prepare,
    .bind = bind,
};
