/* modal.c - a lever of free modes under one force at its tip: half kick, turn, half kick, heat.
 *
 *   half kick   v_n += (h/2) F(d)                                     all modes, the same F
 *   turn        (q_n, v_n) by omega_n h about the base
 *   half kick
 *   heat        v_n <- e v_n + s sqrt(1 - e^2) xi,  e = exp(-damping_n h)   (Ornstein & Uhlenbeck)
 *
 * Turn and heat each keep the Gibbs distribution, so the mean square motion is exact at any step. The turn
 * keeps phase volume, so a ring-down is exact, too. Order 2 in the force. Forces and the base's
 * acceleration enter as kicks at the ends of a tick: without error at a lever's resonance. The linear part of
 * the base's motion moves the frame of the turn. Near the surface a tick is cut into MODAL_KICKS kicks
 * of the sample. In permanent contact there is one, of the force at d + (h^2/12) n F (Takahashi & Imada
 * 1984): effective order 4.
 *
 * A contact switch is timed to a kick. It is reported when the tick is done, with crossing->early telling how
 * long before; the state of the event is that at the end of the tick. A tick is 1 or MODAL_KICKS turns: the
 * work is bounded, and nothing is searched. The energies are booked as they move (struct method_books). */
#include "firmware/method/modal.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include "models/math/elementary.h"

enum { GAUSSIAN_BELOW = 5 /* quality below which uniform noise would show in the distribution */ };

STATIC_ASSERT(sizeof(struct modal) <= METHOD_SCRATCH * sizeof(double), modal_fits);

/* ---- set-up ---- */

static void set_turns(const struct modal *s, double length, struct turns *t)
{
    memset(t, 0, sizeof *t);
    for (int i = 0; i < s->form.n_modes; i++) {
        double c, d;
        cos_sin(s->form.omega[i] * length, &c, &d);
        t->c[i] = c;
        t->s[i] = d / s->form.omega[i];
        t->r[i] = d * s->form.omega[i];
    }
}

/* Uniform noise of MODAL_WORD_BITS has the variance (1 - 2^-2 MODAL_WORD_BITS)/12: spread makes it exact. It
 * is for odd numbers up to 2^MODAL_WORD_BITS on both sides. */
static void set_heat(const struct modal *s, int i, double length, double *decay, double *spread)
{
    const double grid = 1.0 / (1 << MODAL_WORD_BITS);
    double angle = s->form.damping[i] * length, e = exponential(-angle);
    double lost = angle < 1e-3
                      ? 2.0 * angle * (1.0 - angle * (1.0 - (2.0 / 3.0) * angle * (1.0 - 0.5 * angle)))
                      : (1.0 - e) * (1.0 + e);
    *decay = e;
    *spread =
        s->form.heat * sqrt(lost) * (s->gaussian ? 1.0 : sqrt(12.0 / (1.0 - grid * grid))) * (0.5 * grid);
}

static size_t n_scratch(const struct model *m)
{
    return m->modal_form ? (sizeof(struct modal) + sizeof(double) - 1) / sizeof(double) : 0;
}

static void prepare(const struct model *m, const double *p, double h, double tol, double *scratch)
{
    struct modal *s = (struct modal *)(void *)scratch;
    (void)tol;
    memset(s, 0, sizeof *s);
    m->modal_form(p, &s->form);
    s->h = h;
    s->gaussian = s->form.omega[0] < GAUSSIAN_BELOW * s->form.damping[0];
    s->near = s->form.near > 0.0 ? s->form.near : -DBL_MAX;
    s->correction = s->form.near > 0.0 ? 0.0 : h * h * s->form.n_modes * (1.0 / 12.0);
    set_turns(s, h, &s->whole);
    s->part = h / MODAL_KICKS;
    set_turns(s, s->part, &s->in_part);
    for (int i = 0; i < s->form.n_modes; i++) {
        set_heat(s, i, h, &s->decay[i], &s->spread[i]);
    }
}

static const char *refuse(const struct model *m, const double *p, double h, double tol)
{
    struct modal_form f;
    (void)tol;
    if (!m->modal_form)
        return "modal is for levers of modes (afm_lever); take auto";
    m->modal_form(p, &f);
    double kick = f.near > 0.0 ? h / MODAL_KICKS : h;
    if (!(h * f.omega[f.n_modes - 1] < 2.5))
        return "step too coarse for modal: frequency * step of the highest mode is 2.5 rad or more (more "
               "substeps, or fewer modes)";
    if (!(kick * sqrt(1.0 + f.n_modes * f.stiffest) < 1.0))
        return "step too coarse for modal: on the sample at indentation_max_m the tip turns by 1 rad or more "
               "from kick to kick (more substeps, or a smaller indentation_max_m)";
    return NULL;
}

/* ---- one tick ---- */

NEVER_INLINE double kick_of_base(const struct segment *e, int which, int base)
{
    return 0.5 * e->length * wave_acceleration(&e->wave[base], which ? e->length : 0.0, &e->at[which][base]);
}

ALWAYS_INLINE void kick_by_base(const struct modal *s, const struct segment *e, int which, struct tick *t,
                                int n)
{
    double v = e->wave[s->form.base].omega == 0.0 ? 0.0 : kick_of_base(e, which, s->form.base);
    if (v == 0.0)
        return;
    MODES_UNROLL
    for (int i = 0; i < n; i++)
        t->v[i] -= s->form.participation[i] * v;
}

/* A sum of the modes' rates with what the base's speed adds to each. */
ALWAYS_INLINE double with_base(const struct modal *s, double v, const struct tick *t, int n)
{
    MODES_UNROLL
    for (int i = 0; i < n; i++)
        v += s->form.participation[i] * t->base_rate;
    return v;
}

/* Forces and base at one end of the tick (which: 0 or 2), for half of it. */
ALWAYS_INLINE void kick_by_inputs(struct modal *s, const struct segment *e, int which, struct tick *t, int n)
{
    double half = 0.5 * e->length;
    unsigned forces = e->active & s->form.forces;
    for (int i = 0; forces != 0; i++, forces >>= 1) {
        if (!(forces & 1u))
            continue;
        double push = half * e->at[which][i].value;
        double v = sum_of_modes(t->v, n) + 0.5 * n * push;
        push_modes(push, t, n);
        if (t->base_rate != 0.0)
            v = with_base(s, v, t, n);
        s->books.work[i] += push * v;
    }
    if ((e->active >> s->form.base) & 1u)
        kick_by_base(s, e, which, t, n);
}

/* ---- the step ---- */

ALWAYS_INLINE void load(const struct modal *s, const struct segment *e, unsigned regime, const double *x,
                        struct tick *t, int n)
{
    int base = s->form.base, stiffness = s->form.stiffness;
    const struct input *z = &e->at[0][base];
    bool moves = (e->active >> base) & 1u;
    for (int k = 0; k < 3; k++) {
        t->base_at[k] = e->at[k][base].value;
        t->stiffness_at[k] = e->at[k][stiffness].value;
    }
    t->base = t->base_at[0];
    t->stiffness = t->stiffness_at[0];
    t->branch = x[MODEL_MODES];
    t->side = tip_side_of(&s->form.law, t->stiffness, t->branch);
    t->peak = 0.0;
    t->watches = !(regime & REGIME_ANY);
    t->closed = regime & 1u;
    t->moves = (e->active & ~s->form.forces) != 0;
    t->base_rate = moves && e->length > 0.0 ? (e->at[2][base].value - z->value) / e->length : 0.0;
    MODES_UNROLL
    for (int i = 0; i < n; i++) {
        t->q[i] = x[i] - s->form.participation[i] * z->value;
        t->v[i] = x[MODEL_MODES + 1 + i] - s->form.participation[i] * z->rate;
    }
}

ALWAYS_INLINE bool store(const struct modal *s, const struct segment *e, const struct tick *t, double *x,
                         int n)
{
    const struct input *z = &e->at[2][s->form.base];
    double size = 0.0;
    MODES_UNROLL
    for (int i = 0; i < n; i++)
        size += fabs(t->q[i]) + fabs(t->v[i]);
    if (!(size <= DBL_MAX))
        return false;
    MODES_UNROLL
    for (int i = 0; i < n; i++) {
        x[i] = t->q[i] + s->form.participation[i] * z->value;
        x[MODEL_MODES + 1 + i] = t->v[i] + s->form.participation[i] * z->rate;
    }
    x[MODEL_MODES] = t->branch;
    return true;
}

/* Turns and heat of a length that is not h: the begin and the end of a tick that is cut. */
struct own {
    struct turns turns;
    double decay[MODEL_MODES], spread[MODEL_MODES];
};

NEVER_INLINE void set_own(const struct modal *s, double part, double length, struct own *own)
{
    set_turns(s, part, &own->turns);
    for (int i = 0; i < s->form.n_modes; i++)
        set_heat(s, i, length, &own->decay[i], &own->spread[i]);
}

ALWAYS_INLINE bool tick(const struct model *m, const double *p, struct modal *s, const struct segment *e,
                        unsigned regime, double *x, int n)
{
    struct tick t;
    struct own own;
    bool cut = e->length != s->h;
    double part = s->part;
    load(s, e, regime, x, &t, n);
    kick_by_inputs(s, e, 0, &t, n);
    double gap = gap_of(s, &t, n);
    int kicks = kicks_for(s, e->length, gap, &t, n);
    const struct turns *turn = kicks == 1 ? &s->whole : &s->in_part;
    if (cut) {
        part = e->length / MODAL_KICKS;
        set_own(s, kicks == 1 ? e->length : part, e->length, &own);
        turn = &own.turns;
    }
    swing(m, p, &s->form.law, s, kicks == 1 ? e->length : part, turn, kicks, gap, &s->felt, &t, n, true);
    kick_by_inputs(s, e, 2, &t, n);
    heat(s, cut ? own.decay : s->decay, cut ? own.spread : s->spread, e->instant, &t, n, true);
    s->books.force = t.peak;
    return store(s, e, &t, x, n);
}

#define TICK(n)                                                                                              \
    NEVER_INLINE bool tick_##n(const struct model *m, const double *p, struct modal *s,                      \
                               const struct segment *e, unsigned regime, double *x)                          \
    {                                                                                                        \
        return tick(m, p, s, e, regime, x, n);                                                               \
    }
TICK(1)
TICK(2)
TICK(3)
TICK(4)
STATIC_ASSERT(MODEL_MODES == 4, each_number_of_modes_has_its_tick);

typedef bool tick_function(const struct model *m, const double *p, struct modal *s, const struct segment *e,
                           unsigned regime, double *x);
static tick_function *const tick_of[MODEL_MODES] = {tick_1, tick_2, tick_3, tick_4};

/* The first of the switches not yet reported; the peak force goes to each of them. */
static enum step_status report(struct modal *s, double length, struct crossing *c)
{
    if (s->n_late == 0)
        return STEP_END;
    *c = (struct crossing){.done = length, .early = s->late[0].early};
    s->n_late--;
    memmove(s->late, s->late + 1, (size_t)s->n_late * sizeof *s->late);
    return STEP_SWITCH;
}

static enum step_status step(const struct model *m, const double *p, double *scratch, const struct segment *e,
                             unsigned regime, double *x, struct crossing *c)
{
    struct modal *s = (struct modal *)(void *)scratch;
    double force = s->books.force;
    s->books = (struct method_books){.force = 0.0};
    if (e->length > 0.0) {
        s->n_late = 0;
        if (!tick_of[s->form.n_modes - 1](m, p, s, e, regime, x))
            return STEP_NOT_FINITE;
    } else {
        s->books.force = force; /* only further reports are left */
    }
    return regime & REGIME_ANY ? STEP_END : report(s, e->length, c);
}

static step_function *bind(const struct model *m)
{
    (void)m;
    return step;
}

static const struct method_books *books(const double *scratch)
{
    return &((const struct modal *)(const void *)scratch)->books;
}

const struct method modal = {
    .name = "modal",
    .title = "levers: exact turns and heat of free modes, kicks by the sample, no tolerance; order 2, with "
             "two branches 1",
    .order = 2,
    .n_scratch = n_scratch,
    .refuse = refuse,
    .prepare = prepare,
    .bind = bind,
    .books = books,
};
