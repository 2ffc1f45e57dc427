/* rk4.c - the classical Runge-Kutta method of order 4, with contact switches located by its own shortened
 * steps.
 *
 * Smooth motion: order 4. Across the kink of a Hertzian contact any one-step method falls to order 2.5 in
 * velocity, with or without location, because the force starts like t^{3/2}. A gap spring keeps order 4,
 * because the step is split at the switch. Cost with the model inlined (instances.h): four evaluations of its
 * rhs and one of its gaps per step, three more per switch. */
#include "firmware/method/rk4.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include "models/check.h"
#include "firmware/method/instances.h"
#include "firmware/method/switch.h"

#define real       double
#define REAL(name) name
#include "firmware/method/rk4_text.h"
#undef real
#undef REAL

static bool inside(const double *x, int n, double limit)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += fabs(x[i]);
    return sum <= limit;
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
    advance(through_pointers(m), p, e->length, e->at[0], e->at[1], e->at[2], x, x1);
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

/* May a contact switch between x and x1? */
ALWAYS_INLINE bool suspected(struct inlined m, const double *p, double h, const struct input *begin,
                             const struct input *end, unsigned regime, const double *x, const double *x1)
{
    struct input g0[MODEL_CONTACTS], g1[MODEL_CONTACTS];
    bool any = false;
    m.gap(p, begin, x, g0);
    m.gap(p, end, x1, g1);
    for (int i = 0; i < m.n_contacts; i++)
        any |= switch_suspected(&g0[i], &g1[i], h, (regime >> i) & 1u);
    return any;
}

ALWAYS_INLINE enum step_status step(struct inlined m, const struct model *model, const double *p,
                                    double *scratch, const struct segment *e, unsigned regime, double *x,
                                    struct crossing *c)
{
    double x1[MODEL_STATES];
    advance(m, p, e->length, e->at[0], e->at[1], e->at[2], x, x1);
    if (!inside(x1, m.n, DBL_MAX))
        return STEP_NOT_FINITE;
    if (!(regime & REGIME_ANY) && suspected(m, p, e->length, e->at[0], e->at[2], regime, x, x1))
        return locate(model, p, scratch, e, regime, x, c);
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
#define STEP(name, for_models, jumps, states, contacts, n_inputs, rhs, gap, ...)                             \
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

/* Several ticks in one call need a second copy of each row. A board without vector registers has no room for
 * it; there all ticks are single steps. */
#if TICK_LANES > 1
/* The contacts that are not as in `regime` at the end. */
ALWAYS_INLINE unsigned switched(struct inlined m, const double *p, const struct input *u, unsigned regime,
                                const double *x)
{
    struct input gap[MODEL_CONTACTS];
    unsigned closed = 0;
    m.gap(p, u, x, gap);
    for (int i = 0; i < m.n_contacts; i++)
        closed |= (gap[i].value < 0.0 ? 1u : 0u) << i;
    return closed ^ regime;
}

/* Contacts that switch at the end of a tick of length h. False: there is no room for those of another tick.
 */
NEVER_INLINE bool note_switches(struct method_switches *s, uint32_t tick, unsigned which, double h,
                                const double *x)
{
    for (int i = 0; which != 0; i++, which >>= 1) {
        if (which & 1u)
            s->at[s->n++] = (struct method_switch){tick, i, h, 0.0, true, x, NULL};
    }
    return s->n <= RUN_SWITCHES - MODEL_CONTACTS;
}

/* The state stays in registers from tick to tick. */
ALWAYS_INLINE uint32_t run(struct inlined m, bool located, const double *p, const struct method_block *b,
                           const struct input (*at)[MODEL_INPUTS], double (*to)[MODEL_STATES], uint32_t n)
{
    double x[MODEL_STATES], x1[MODEL_STATES], h = b->length;
    unsigned regime = b->regime;
    const int first = b->jumps ? 1 : 0; /* the inputs at the begin of a tick */
    for (int i = 0; i < m.n; i++)
        x[i] = to[0][i];
    for (uint32_t k = 0; k < n; k++, at += 2) {
        advance(m, p, h, at[first], at[1], at[2], x, x1);
        if (!inside(x1, m.n, METHOD_STATE_LIMIT))
            return k;
        if (located && suspected(m, p, h, at[first], at[2], regime, x, x1))
            return k;
        unsigned which = located ? 0 : switched(m, p, at[2], regime, x1);
        to++;
        for (int i = 0; i < m.n; i++)
            to[0][i] = x[i] = x1[i];
        regime ^= which;
        if (which != 0 && !note_switches(b->switches, k, which, h, to[0]))
            return k + 1;
    }
    return n;
}

static uint32_t run_general(const struct model *m, const double *p, double *scratch,
                            const struct method_block *b, const struct input (*at)[MODEL_INPUTS],
                            double (*x)[MODEL_STATES], uint32_t n)
{
    (void)scratch;
    return run(through_pointers(m), true, p, b, at, x, n);
}

static uint32_t through_general(const struct model *m, const double *p, double *scratch,
                                const struct method_block *b, const struct input (*at)[MODEL_INPUTS],
                                double (*x)[MODEL_STATES], uint32_t n)
{
    (void)scratch;
    return run(through_pointers(m), false, p, b, at, x, n);
}

#define DECLARE_RUN(name, ...) static run_function run_##name, through_##name;
INSTANCES(DECLARE_RUN)

#define TICKS(kind, located, name, jumps, states, contacts, rhs, gap)                                        \
    CALLED_FROM_ANYWHERE uint32_t kind##_##name(                                                             \
        const struct model *m, const double *p, double *scratch, const struct method_block *b,               \
        const struct input(*at)[MODEL_INPUTS], double(*x)[MODEL_STATES], uint32_t n)                         \
    {                                                                                                        \
        unsigned active = b->active;                                                                         \
        (void)m, (void)scratch, (void)active;                                                                \
        jumps;                                                                                               \
        return run((struct inlined){rhs, gap, states, contacts}, located, p, b, at, x, n);                   \
    }

#undef JUMP
#define JUMP(row, when)                                                                                      \
    if (when)                                                                                                \
        return run_##row(m, p, scratch, b, at, x, n);

#define RUN(name, for_models, jumps, states, contacts, n_inputs, rhs, gap, ...)                              \
    TICKS(run, true, name, jumps, states, contacts, rhs, gap)
INSTANCES(RUN)

#undef JUMP
#define JUMP(row, when)                                                                                      \
    if (when)                                                                                                \
        return through_##row(m, p, scratch, b, at, x, n);

#define RUN_THROUGH(name, for_models, jumps, states, contacts, n_inputs, rhs, gap, ...)                      \
    TICKS(through, false, name, jumps, states, contacts, rhs, gap)
INSTANCES(RUN_THROUGH)

static run_function *bind_run(const struct model *m, const double *scratch)
{
    (void)scratch;
#define BIND_RUN(name, for_models, ...)                                                                      \
    if (for_models)                                                                                          \
        return run_##name;
    INSTANCES(BIND_RUN)
    return run_general;
}

static run_function *bind_through(const struct model *m, const double *scratch)
{
    (void)scratch;
#define BIND_THROUGH(name, for_models, ...)                                                                  \
    if (for_models)                                                                                          \
        return through_##name;
    INSTANCES(BIND_THROUGH)
    return through_general;
}
#else
static run_function *bind_run(const struct model *m, const double *scratch)
{
    (void)m, (void)scratch;
    return NULL;
}

static run_function *bind_through(const struct model *m, const double *scratch)
{
    (void)m, (void)scratch;
    return NULL;
}
#endif

static size_t n_scratch(const struct model *m)
{
    (void)m;
    return 0;
}

/* NULL, or what of a lever only `modal` can do. */
static const char *modal_alone(const struct model *m, const double *p)
{
    struct modal_form f;
    if (!m->modal_form)
        return NULL;
    m->modal_form(p, &f);
    if (f.heat > 0.0)
        return "heat needs method modal; or set temperature_K to 0";
    return f.latched ? "two branches of adhesion need method modal; or set hamaker_out_J to hamaker_J" : NULL;
}

static const char *refuse(const struct model *m, const double *p, double h, double tol)
{
    (void)tol;
    if (!(h * m->eigenfrequency(p) <= RK4_ANGLE_MAX))
        return "step too coarse for rk4: eigenfrequency * step is above 0.2 rad (more substeps, or a slower "
               "rig)";
    return modal_alone(m, p);
}

static void prepare(const struct model *m, const double *p, double h, double tol, double *scratch)
{
    (void)m, (void)p, (void)h, (void)tol, (void)scratch;
}

const struct method rk4 = {
    .name = "rk4",
    .title = "classical Runge-Kutta, order 4; switches located by Newton on shortened steps",
    .order = 4,
    .n_scratch = n_scratch,
    .refuse = refuse,
    .prepare = prepare,
    .bind = bind,
    .bind_run = bind_run,
};

/* ---- rk4_unlocated: through its contact switches ----
 *
 * A switch is told at the end of its step, and ticks go on through it in blocks.
 * The trajectory is that of the steps of rk4, to the last bit. The search for the instant, the cut of the
 * step there and their costs are left out. Order 4 in smooth motion; 2.5 across a Hertzian contact as with
 * rk4, with an error a few times larger; 2 across a gap spring, where rk4 keeps 4 (docs/why/accuracy.md). A
 * contact that closes and opens within a step is not seen. */

static enum step_status step_unlocated(const struct model *m, const double *p, double *scratch,
                                       const struct segment *e, unsigned regime, double *x,
                                       struct crossing *c)
{
    struct input gap[MODEL_CONTACTS];
    enum step_status status = STEP_END;
    if (e->length > 0.0) /* 0 is left after a switch at the end */
        status = rk4.bind(m)(m, p, scratch, e, REGIME_ANY, x, c);
    if (status != STEP_END || (regime & REGIME_ANY))
        return status;
    m->gap(p, e->at[2], x, gap);
    for (int i = 0; i < m->n_contacts; i++) {
        if ((gap[i].value < 0.0) == (((regime >> i) & 1u) != 0))
            continue;
        *c = (struct crossing){e->length, i, 0, 0.0};
        return STEP_SWITCH;
    }
    return STEP_END;
}

static const char *refuse_unlocated(const struct model *m, const double *p, double h, double tol)
{
    if (m->n_contacts == 0)
        return "this model has no contact whose switches to leave unlocated; take rk4";
    return refuse(m, p, h, tol);
}

static step_function *bind_unlocated(const struct model *m)
{
    (void)m;
    return step_unlocated;
}

const struct method rk4_unlocated = {
    .name = "rk4_unlocated",
    .title = "rk4 through contact switches, each told at its step's end; order 2 to 2.5 across them",
    .order = 4,
    .n_scratch = n_scratch,
    .refuse = refuse_unlocated,
    .prepare = prepare,
    .bind = bind_unlocated,
    .bind_run = bind_through,
};
