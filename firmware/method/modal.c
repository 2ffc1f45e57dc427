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

/* Rotation of one mode: q <- c q + s v, v <- c v - r q. */
struct turn {
    double c, s, r;
};

/* A switch within the tick that has not been reported yet. */
struct late {
    double early;
};

/* In scratch memory. */
struct modal {
    struct modal_form form;
    double h;
    struct turn whole[MODEL_MODES], part[MODEL_MODES]; /* over h, and h/KICKS */
    double decay[MODEL_MODES], spread[MODEL_MODES];    /* in the heat of one h */
    double correction;                                 /* gap per force, over h, in permanent contact */
    bool gaussian;
    struct late late[KICKS]; /* the latest last */
    int n_late;
    struct method_books books;
};
STATIC_ASSERT(sizeof(struct modal) <= METHOD_SCRATCH * sizeof(double), modal_fits);

/* A tick in hand: modes against the base, v without the speed of the frame. */
struct tick {
    double q[MODEL_MODES], v[MODEL_MODES];
    double branch;
    double base, base_rate; /* the frame, at the beginning, and its speed */
    struct input u[MODEL_INPUTS];
    bool closed, watches;
};

/* ---- set-up ---- */

static void set_turn(double omega, double length, struct turn *t)
{
    double c, s;
    cos_sin(omega * length, &c, &s);
    *t = (struct turn){c, s / omega, s * omega};
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
    for (int i = 0; i < s->form.n_modes; i++) {
        set_turn(s->form.omega[i], h, &s->whole[i]);
        set_turn(s->form.omega[i], h / KICKS, &s->part[i]);
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

static double sum_of_modes(const struct modal *s, const double *of)
{
    double sum = of[0];
    for (int i = 1; i < s->form.n_modes; i++)
        sum += of[i];
    return sum;
}

static double gap_of(const struct modal *s, const struct tick *t)
{
    return (s->form.height + t->u[s->form.base].value) + sum_of_modes(s, t->q);
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

/* Forces and base at one end of the tick (which: 0 or 2), for half of it. */
static void kick_by_inputs(struct modal *s, const struct segment *e, int which, struct tick *t)
{
    double half = 0.5 * e->length, v;
    int n = s->form.n_modes, base = s->form.base;
    for (int i = 0; e->active >> i != 0; i++) {
        if (!((e->active & s->form.forces) >> i & 1u))
            continue;
        double push = half * e->at[which][i].value, before = sum_of_modes(s, t->v);
        for (int k = 0; k < n; k++)
            t->v[k] += push;
        v = before + 0.5 * n * push;
        for (int k = 0; k < n; k++)
            v += s->form.participation[k] * t->base_rate;
        s->books.work[i] += push * v;
    }
    if (!((e->active >> base) & 1u))
        return;
    v = half * acceleration(&e->wave[base], which ? e->length : 0.0, &e->at[which][base]);
    for (int k = 0; k < n && v != 0.0; k++)
        t->v[k] -= s->form.participation[k] * v;
}

/* The force of the sample where the tip is. */
static void feel(const struct model *m, const double *p, const struct modal *s, const struct tick *t,
                 struct tip_force *f)
{
    double gap = gap_of(s, t);
    m->tip_force(p, t->u, t->branch, gap, f);
    if (s->correction > 0.0)
        m->tip_force(p, t->u, t->branch, gap + s->correction * f->force, f);
}

/* The sample, for `half` of a kick's time. The drag is taken at the mean of the speeds before and after. */
static void kick_by_sample(struct modal *s, double half, const struct tip_force *f, struct tick *t)
{
    int n = s->form.n_modes;
    double push = half * f->force;
    if (f->drag > 0.0 || f->modulation != 0.0) {
        double before = sum_of_modes(s, t->v) + t->base_rate, drag = half * f->drag;
        double mean = (before + 0.5 * n * push) / (1.0 + 0.5 * n * drag);
        s->books.damping += drag * mean * mean;
        s->books.work[s->form.stiffness] += half * f->modulation * mean;
        push -= drag * mean;
    }
    if (f->force > s->books.force)
        s->books.force = f->force;
    for (int i = 0; i < n; i++)
        t->v[i] += push;
    if (t->base_rate != 0.0) {
        double share = -1.0;
        for (int i = 0; i < n; i++)
            share += s->form.participation[i];
        s->books.work[s->form.base] += share * push * t->base_rate;
    }
}

static void turn_modes(struct modal *s, const struct turn *turn, struct tick *t)
{
    for (int i = 0; i < s->form.n_modes; i++) {
        double q = t->q[i], v = t->v[i];
        t->q[i] = turn[i].c * q + turn[i].s * v;
        t->v[i] = turn[i].c * v - turn[i].r * q;
        if (t->base_rate != 0.0)
            s->books.work[s->form.base] += s->form.participation[i] * t->base_rate * (t->v[i] - v);
    }
}

/* After a kick, `left` before the end of the tick: contact and branch. */
static void note(const struct model *m, const double *p, struct modal *s, double left, struct tip_force *f,
                 struct tick *t)
{
    bool closed = f->gap < 0.0;
    if (closed != t->closed && t->watches && s->n_late < KICKS)
        s->late[s->n_late++].early = left;
    t->closed = closed;
    if (s->form.latched) {
        double loss, before = t->branch;
        t->branch = m->tip_branch(p, before, gap_of(s, t), sum_of_modes(s, t->v) + t->base_rate, &loss);
        s->books.damping += loss;
        if (t->branch != before)
            feel(m, p, s, t, f);
    }
}

/* Kicks of the sample and turns over the whole segment. */
static void swing(const struct model *m, const double *p, struct modal *s, const struct segment *e,
                  struct tick *t)
{
    double rate = sum_of_modes(s, t->v) + t->base_rate, gap = gap_of(s, t), near = s->form.near;
    int kicks = near > 0.0 && (gap < near || gap + rate * e->length < near) ? KICKS : 1;
    double part = e->length / kicks;
    struct turn own[MODEL_MODES];
    const struct turn *turn = kicks == 1 ? s->whole : s->part;
    struct tip_force f;
    if (e->length != s->h) {
        for (int i = 0; i < s->form.n_modes; i++)
            set_turn(s->form.omega[i], part, &own[i]);
        turn = own;
    }
    feel(m, p, s, t, &f);
    for (int k = 1; k <= kicks; k++) {
        kick_by_sample(s, 0.5 * part, &f, t);
        turn_modes(s, turn, t);
        inputs_at(s, e, k == kicks ? 1.0 : (1.0 / KICKS) * k, t->u);
        feel(m, p, s, t, &f);
        kick_by_sample(s, 0.5 * part, &f, t);
        note(m, p, s, part * (kicks - k), &f, t);
    }
}

/* The noise of all modes at this instant: a function of seed and instant alone. */
static void noise_of(const struct modal *s, uint64_t instant, double *xi)
{
    const uint64_t heat = UINT64_C(0x6865617400000000); /* another sequence than those of the inputs */
    uint64_t word = noise_word(heat ^ s->form.seed, instant);
    for (int i = 0; i < s->form.n_modes; i++) {
        uint64_t part = word >> (WORD_BITS * i) & ((1u << WORD_BITS) - 1u);
        xi[i] = s->gaussian ? noise_deviate(noise_word(word, (uint64_t)i))
                            : ((double)part + 0.5) * (1.0 / (1 << WORD_BITS)) - 0.5;
    }
}

static void heat(struct modal *s, const struct segment *e, struct tick *t)
{
    double xi[MODEL_MODES] = {0.0}, decay, spread;
    bool whole = e->length == s->h;
    if (s->form.heat > 0.0)
        noise_of(s, e->instant, xi);
    for (int i = 0; i < s->form.n_modes; i++) {
        double v = t->v[i], slowed, lost;
        if (!whole)
            set_heat(s, i, e->length, &decay, &spread);
        slowed = (whole ? s->decay[i] : decay) * v;
        t->v[i] = slowed + (whole ? s->spread[i] : spread) * xi[i];
        lost = 0.5 * (v - slowed) * (v + slowed);
        s->books.damping += lost;
        s->books.heat += 0.5 * (t->v[i] - slowed) * (t->v[i] + slowed);
        if (t->base_rate != 0.0)
            s->books.work[s->form.base] += s->form.participation[i] * t->base_rate * (t->v[i] - v);
    }
}

/* ---- the step ---- */

static void load(const struct modal *s, const struct segment *e, unsigned regime, const double *x,
                 struct tick *t)
{
    const struct input *z = &e->at[0][s->form.base];
    int base = s->form.base;
    bool moves = (e->active >> base) & 1u;
    memcpy(t->u, e->at[0], sizeof t->u);
    t->branch = x[MODEL_MODES];
    t->watches = !(regime & REGIME_ANY);
    t->closed = regime & 1u;
    t->base_rate = moves && e->length > 0.0 ? (e->at[2][base].value - z->value) / e->length : 0.0;
    for (int i = 0; i < s->form.n_modes; i++) {
        t->q[i] = x[i] - s->form.participation[i] * z->value;
        t->v[i] = x[MODEL_MODES + 1 + i] - s->form.participation[i] * z->rate;
    }
}

static bool store(const struct modal *s, const struct segment *e, const struct tick *t, double *x)
{
    const struct input *z = &e->at[2][s->form.base];
    double size = 0.0;
    for (int i = 0; i < s->form.n_modes; i++)
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
    struct tick t;
    double force = s->books.force;
    s->books = (struct method_books){.force = 0.0};
    if (e->length > 0.0) {
        s->n_late = 0;
        load(s, e, regime, x, &t);
        kick_by_inputs(s, e, 0, &t);
        swing(m, p, s, e, &t);
        kick_by_inputs(s, e, 2, &t);
        heat(s, e, &t);
        if (!store(s, e, &t, x))
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
    .title = "levers: exact turns and heat of free modes, kicks by the sample; order 2 in its force",
    .order = 2,
    .n_scratch = n_scratch,
    .refuse = refuse,
    .prepare = prepare,
    .bind = bind,
    .books = books,
};
