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
 * the base's motion moves the frame of the turn. Near the surface a tick is cut into KICKS kicks of the
 * sample. In permanent contact there is one, of the force at d + (h^2/12) n F (Takahashi & Imada 1984):
 * effective order 4.
 *
 * A contact switch is timed to a kick. It is reported when the tick is done, with crossing->early telling how
 * long before; the state of the event is that at the end of the tick. A tick is 1 or KICKS turns: the work is
 * bounded, and nothing is searched. The energies are booked as they move (struct method_books). */
#include <float.h>
#include <math.h>
#include <string.h>
#include "firmware/method/method.h"
#include "firmware/plant/noise.h"
#include "models/check.h"
#include "models/math/elementary.h"

enum {
    /* Kicks in a tick near the surface. One orbit of 74 is off by 0.55 degrees with 8, none by more than 0.10
     * with 12 (tests/physics/afm). */
    KICKS = 12,
    WORD_BITS = 16,     /* taken from one word of noise by each mode */
    GAUSSIAN_BELOW = 5, /* quality below which uniform noise would show in the distribution */
};

/* Rotation of each mode: q <- c q + s v, v <- c v - r q. */
struct turns {
    double c[MODEL_MODES], s[MODEL_MODES], r[MODEL_MODES];
};

/* The force of the sample where it was felt last. The next tick begins there, if nothing else moved the tip.
 */
struct felt {
    double gap, branch, stiffness;
    struct tip_force force;
    bool known;
};

/* A switch within the tick that has not been reported yet. */
struct late {
    double early;
};

/* In scratch memory. */
struct modal {
    struct modal_form form;
    double h;
    struct turns whole, part;                       /* over h, and h/KICKS */
    double mode[MODEL_MODES], half_modes;           /* 1 for each mode; half their number */
    double decay[MODEL_MODES], spread[MODEL_MODES]; /* in the heat of one h */
    double correction;                              /* gap per force, over h, in permanent contact */
    bool gaussian;
    struct felt felt;
    struct late late[KICKS]; /* the latest last */
    int n_late;
    struct method_books books;
};
STATIC_ASSERT(sizeof(struct modal) <= METHOD_SCRATCH * sizeof(double), modal_fits);

/* A tick in hand: modes against the base, v without the speed of the frame. Modes that the lever lacks, up to
 * the number that the loops run over, stay 0. */
struct tick {
    double q[MODEL_MODES], v[MODEL_MODES];
    double branch;
    double base_rate; /* speed of the frame */
    struct input u[MODEL_INPUTS];
    bool closed, watches;
};

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

/* Uniform noise of WORD_BITS has the variance (1 - 2^-2 WORD_BITS)/12: spread makes it exact. */
static void set_heat(const struct modal *s, int i, double length, double *decay, double *spread)
{
    const double grid = 1.0 / (1 << WORD_BITS);
    double angle = s->form.damping[i] * length, e = exponential(-angle);
    double lost = angle < 1e-3
                      ? 2.0 * angle * (1.0 - angle * (1.0 - (2.0 / 3.0) * angle * (1.0 - 0.5 * angle)))
                      : (1.0 - e) * (1.0 + e);
    *decay = e;
    *spread = s->form.heat * sqrt(lost) * (s->gaussian ? 1.0 : sqrt(12.0 / (1.0 - grid * grid)));
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
    s->correction = s->form.near > 0.0 ? 0.0 : h * h * s->form.n_modes * (1.0 / 12.0);
    s->half_modes = 0.5 * s->form.n_modes;
    set_turns(s, h, &s->whole);
    set_turns(s, h / KICKS, &s->part);
    for (int i = 0; i < s->form.n_modes; i++) {
        s->mode[i] = 1.0;
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
    double kick = f.near > 0.0 ? h / KICKS : h;
    if (!(h * f.omega[f.n_modes - 1] < 2.5))
        return "step too coarse for modal: frequency * step of the highest mode is 2.5 rad or more (more "
               "substeps, or fewer modes)";
    if (!(kick * sqrt(1.0 + f.n_modes * f.stiffest) < 1.0))
        return "step too coarse for modal: on the sample at indentation_max_m the tip turns by 1 rad or more "
               "from kick to kick (more substeps, or a smaller indentation_max_m)";
    return NULL;
}

/* ---- one tick ---- */

/* Loops over the modes run to `n`, a constant of the compiler: 1 or MODEL_MODES. Unrolled they keep the modes
 * in registers. The order of the operations, and so the bits, are those of the loop. */
#if defined(__clang__)
#pragma clang diagnostic ignored "-Wpass-failed" /* clang warns at low levels, where loops stay loops */
#define MODES_UNROLL _Pragma("clang loop unroll(full)")
#else
#define MODES_UNROLL _Pragma("GCC unroll 4")
#endif

/* Base and stiffness at `part` of the tick: the parabola through its three instants. */
static void inputs_at(const struct modal *s, const struct segment *e, double part, struct input *u)
{
    double first = (1.0 - part) * (1.0 - 2.0 * part), last = part * (2.0 * part - 1.0);
    double middle = 4.0 * part * (1.0 - part);
    const int which[2] = {s->form.base, s->form.stiffness};
    for (int k = 0; k < 2; k++) {
        int i = which[k];
        if ((e->active >> i) & 1u)
            u[i].value = (first * e->at[0][i].value + middle * e->at[1][i].value) + last * e->at[2][i].value;
    }
}

ALWAYS_INLINE double sum_of_modes(const double *of, int n)
{
    double sum = of[0];
    MODES_UNROLL
    for (int i = 1; i < n; i++)
        sum += of[i];
    return sum;
}

ALWAYS_INLINE double gap_of(const struct modal *s, const struct tick *t, int n)
{
    return (s->form.height + t->u[s->form.base].value) + sum_of_modes(t->q, n);
}

ALWAYS_INLINE void push_modes(const struct modal *s, double push, struct tick *t, int n)
{
    MODES_UNROLL
    for (int i = 0; i < n; i++)
        t->v[i] += push * s->mode[i];
}

/* The base delivers this where the modes' rates changed from `before`. */
NEVER_INLINE void book_base(struct modal *s, const double *before, const struct tick *t)
{
    for (int i = 0; i < s->form.n_modes; i++)
        s->books.work[s->form.base] += s->form.participation[i] * t->base_rate * (t->v[i] - before[i]);
}

/* The second derivative of the oscillating part of a wave at s, where the input is `u`. */
static double acceleration(const struct wave *w, double s, const struct input *u)
{
    double ramp = 0.0, c, d;
    if (w->omega == 0.0)
        return 0.0;
    if (w->growth != 0.0) {
        cos_sin(w->omega * s, &c, &d);
        ramp = 2.0 * w->growth * (w->sine * c + w->cosine * d);
    }
    return -w->omega * (w->omega * ((u->value - w->offset) - w->slope * s) + ramp);
}

NEVER_INLINE void kick_by_base(const struct modal *s, const struct segment *e, int which, struct tick *t)
{
    int base = s->form.base;
    double v = 0.5 * e->length * acceleration(&e->wave[base], which ? e->length : 0.0, &e->at[which][base]);
    for (int k = 0; k < s->form.n_modes && v != 0.0; k++)
        t->v[k] -= s->form.participation[k] * v;
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
        double v = sum_of_modes(t->v, n) + s->half_modes * push;
        push_modes(s, push, t, n);
        if (t->base_rate != 0.0)
            v = with_base(s, v, t, n);
        s->books.work[i] += push * v;
    }
    if ((e->active >> s->form.base) & 1u)
        kick_by_base(s, e, which, t);
}

/* The force of the sample at this gap. */
ALWAYS_INLINE void feel(const struct model *m, const double *p, const struct modal *s, const struct tick *t,
                        double gap, struct tip_force *f)
{
    m->tip_force(p, t->u, t->branch, gap, f);
    if (s->correction > 0.0)
        m->tip_force(p, t->u, t->branch, gap + s->correction * f->force, f);
}

/* The drag, at the mean of the speeds before and after, and what the modulation brings; returns the push. */
NEVER_INLINE double drag_by_sample(struct modal *s, double half, const struct tip_force *f,
                                   const struct tick *t)
{
    double push = half * f->force, drag = half * f->drag;
    double before = sum_of_modes(t->v, s->form.n_modes) + t->base_rate;
    double mean = (before + s->half_modes * push) / (1.0 + s->half_modes * drag);
    s->books.damping += drag * mean * mean;
    s->books.work[s->form.stiffness] += half * f->modulation * mean;
    return push - drag * mean;
}

/* The sample, for `half` of a kick's time. */
ALWAYS_INLINE void kick_by_sample(struct modal *s, double half, const struct tip_force *f, struct tick *t,
                                  int n)
{
    double push = half * f->force;
    if (f->drag > 0.0 || f->modulation != 0.0)
        push = drag_by_sample(s, half, f, t);
    if (f->force > s->books.force)
        s->books.force = f->force;
    push_modes(s, push, t, n);
    if (t->base_rate != 0.0) {
        double share = -1.0;
        MODES_UNROLL
        for (int i = 0; i < n; i++)
            share += s->form.participation[i];
        s->books.work[s->form.base] += share * push * t->base_rate;
    }
}

ALWAYS_INLINE void turn_modes(struct modal *s, const struct turns *turn, struct tick *t, int n)
{
    double before[MODEL_MODES];
    MODES_UNROLL
    for (int i = 0; i < n; i++) {
        double q = t->q[i], v = t->v[i];
        before[i] = v;
        t->q[i] = turn->c[i] * q + turn->s[i] * v;
        t->v[i] = turn->c[i] * v - turn->r[i] * q;
    }
    if (t->base_rate != 0.0)
        book_base(s, before, t);
}

/* After a kick at `gap`, `left` before the end of the tick: contact and branch. */
ALWAYS_INLINE void note(const struct model *m, const double *p, struct modal *s, double left, double gap,
                        struct tip_force *f, struct tick *t, int n)
{
    bool closed = f->gap < 0.0;
    if (closed != t->closed && t->watches && s->n_late < KICKS)
        s->late[s->n_late++].early = left;
    t->closed = closed;
    if (s->form.latched) {
        double loss, before = t->branch;
        t->branch = m->tip_branch(p, before, gap, sum_of_modes(t->v, n) + t->base_rate, &loss);
        s->books.damping += loss;
        if (t->branch != before)
            feel(m, p, s, t, gap, f);
    }
}

/* Kicks of the sample and turns over the whole segment. */
ALWAYS_INLINE void swing(const struct model *m, const double *p, struct modal *s, const struct segment *e,
                         struct tick *t, int n)
{
    double rate = sum_of_modes(t->v, n) + t->base_rate, gap = gap_of(s, t, n), near = s->form.near;
    int kicks = near > 0.0 && (gap < near || gap + rate * e->length < near) ? KICKS : 1;
    double part = e->length / kicks, *stiffness = &t->u[s->form.stiffness].value;
    bool moves = (e->active & ~s->form.forces) != 0;
    struct turns own;
    const struct turns *turn = kicks == 1 ? &s->whole : &s->part;
    struct tip_force f = s->felt.force;
    if (e->length != s->h) {
        set_turns(s, part, &own);
        turn = &own;
    }
    if (!(s->felt.known && s->felt.gap == gap && s->felt.branch == t->branch &&
          s->felt.stiffness == *stiffness))
        feel(m, p, s, t, gap, &f);
    for (int k = 1; k <= kicks; k++) {
        kick_by_sample(s, 0.5 * part, &f, t, n);
        turn_modes(s, turn, t, n);
        if (moves)
            inputs_at(s, e, k == kicks ? 1.0 : (1.0 / KICKS) * k, t->u);
        gap = gap_of(s, t, n);
        feel(m, p, s, t, gap, &f);
        kick_by_sample(s, 0.5 * part, &f, t, n);
        note(m, p, s, part * (kicks - k), gap, &f, t, n);
    }
    s->felt = (struct felt){gap, t->branch, *stiffness, f, true};
}

/* The noise of all modes at this instant: a function of seed and instant alone. */
ALWAYS_INLINE void noise_of(const struct modal *s, uint64_t instant, double *xi, int n)
{
    const uint64_t heat = UINT64_C(0x6865617400000000); /* another sequence than those of the inputs */
    uint64_t word = noise_word(heat ^ s->form.seed, instant);
    MODES_UNROLL
    for (int i = 0; i < n; i++) {
        uint32_t part = (uint32_t)(word >> (WORD_BITS * i)) & ((1u << WORD_BITS) - 1u);
        xi[i] = ((double)(int32_t)part + 0.5) * (1.0 / (1 << WORD_BITS)) - 0.5;
    }
    for (int i = 0; s->gaussian && i < s->form.n_modes; i++)
        xi[i] = noise_deviate(noise_word(word, (uint64_t)i));
}

ALWAYS_INLINE void heat(struct modal *s, const struct segment *e, struct tick *t, int n)
{
    double xi[MODEL_MODES] = {0.0}, own[2][MODEL_MODES] = {{0.0}}, before[MODEL_MODES];
    const double *decay = s->decay, *spread = s->spread;
    if (e->length != s->h) {
        for (int i = 0; i < s->form.n_modes; i++)
            set_heat(s, i, e->length, &own[0][i], &own[1][i]);
        decay = own[0];
        spread = own[1];
    }
    if (s->form.heat > 0.0)
        noise_of(s, e->instant, xi, n);
    MODES_UNROLL
    for (int i = 0; i < n; i++) {
        double v = t->v[i], slowed = decay[i] * v, now = slowed + spread[i] * xi[i];
        s->books.damping += 0.5 * (v - slowed) * (v + slowed);
        s->books.heat += 0.5 * (now - slowed) * (now + slowed);
        before[i] = v;
        t->v[i] = now;
    }
    if (t->base_rate != 0.0)
        book_base(s, before, t);
}

/* ---- the step ---- */

ALWAYS_INLINE void load(const struct modal *s, const struct segment *e, unsigned regime, const double *x,
                        struct tick *t, int n)
{
    const struct input *z = &e->at[0][s->form.base];
    int base = s->form.base;
    bool moves = (e->active >> base) & 1u;
    memcpy(t->u, e->at[0], sizeof t->u);
    t->branch = x[MODEL_MODES];
    t->watches = !(regime & REGIME_ANY);
    t->closed = regime & 1u;
    t->base_rate = moves && e->length > 0.0 ? (e->at[2][base].value - z->value) / e->length : 0.0;
    MODES_UNROLL
    for (int i = 0; i < n; i++) {
        t->q[i] = x[i] - s->form.participation[i] * z->value;
        t->v[i] = x[MODEL_MODES + 1 + i] - s->form.participation[i] * z->rate;
    }
    for (int i = s->form.n_modes; i < n; i++)
        t->q[i] = t->v[i] = 0.0;
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
    for (int i = 0; i < s->form.n_modes; i++) {
        x[i] = t->q[i] + s->form.participation[i] * z->value;
        x[MODEL_MODES + 1 + i] = t->v[i] + s->form.participation[i] * z->rate;
    }
    x[MODEL_MODES] = t->branch;
    return true;
}

ALWAYS_INLINE bool tick(const struct model *m, const double *p, struct modal *s, const struct segment *e,
                        unsigned regime, double *x, int n)
{
    struct tick t;
    load(s, e, regime, x, &t, n);
    kick_by_inputs(s, e, 0, &t, n);
    swing(m, p, s, e, &t, n);
    kick_by_inputs(s, e, 2, &t, n);
    heat(s, e, &t, n);
    return store(s, e, &t, x, n);
}

NEVER_INLINE bool tick_one(const struct model *m, const double *p, struct modal *s, const struct segment *e,
                           unsigned regime, double *x)
{
    return tick(m, p, s, e, regime, x, 1);
}

NEVER_INLINE bool tick_many(const struct model *m, const double *p, struct modal *s, const struct segment *e,
                            unsigned regime, double *x)
{
    return tick(m, p, s, e, regime, x, MODEL_MODES);
}

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
        if (!(s->form.n_modes == 1 ? tick_one : tick_many)(m, p, s, e, regime, x))
            return STEP_NOT_FINITE;
    } else {
        s->books.force = force; /* only further reports are left */
    }
    return regime & REGIME_ANY ? STEP_END : report(s, e->length, c);
}

void modal_change_sample(double *scratch)
{
    ((struct modal *)(void *)scratch)->felt.known = false;
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
    .title = "levers: exact turns and heat of free modes, kicks by the sample; order 2 in its force",
    .order = 2,
    .n_scratch = n_scratch,
    .refuse = refuse,
    .prepare = prepare,
    .bind = bind,
    .books = books,
};
