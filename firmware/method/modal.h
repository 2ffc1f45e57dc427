/* modal.h - one tick of `modal` (modal.c), inline for the method, which keeps books, and for
 * modal_run.c, which keeps none. `n` is the number of modes and `books` a choice: constants of the compiler.
 * Loops over the modes are unrolled, so that the modes stay in registers. */
#ifndef FIRMWARE_MODAL_H
#define FIRMWARE_MODAL_H

#include "firmware/method/method.h"
#include "models/check.h"
#include "models/math/deviate.h"
#include "models/tip_law.h"

enum {
    /* Kicks in a tick near the surface. One orbit of 74 is off by 0.55 degrees with 8, none by more than 0.10
     * with 12 (tests/physics/afm). */
    MODAL_KICKS = 12,
    MODAL_WORD_BITS = 16, /* taken from one word of noise by each mode */
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
    double part;                 /* h/MODAL_KICKS */
    struct turns whole, in_part; /* over h, and over part */
    /* In the heat of one h: for an odd number of noise from -65535 to 65535. */
    double decay[MODEL_MODES], spread[MODEL_MODES];
    double near;       /* below this gap a tick has MODAL_KICKS kicks */
    double correction; /* gap per force, over h, in permanent contact */
    bool gaussian;
    struct felt felt;
    struct late late[MODAL_KICKS]; /* the latest last */
    int n_late;
    struct method_books books;
};

/* A tick in hand: modes against the base, v without the speed of the frame. */
struct tick {
    double q[MODEL_MODES], v[MODEL_MODES];
    double branch;
    double base_rate;                   /* speed of the frame */
    double base, stiffness;             /* now */
    double base_at[3], stiffness_at[3]; /* at the begin, the middle and the end of the tick */
    bool moves;                         /* base or stiffness */
    struct tip_side side;               /* belongs to branch and stiffness */
    double peak;                        /* largest force of the sample so far */
    bool closed, watches;
};

/* The order of the operations, and so the bits, are those of a loop. */
#if defined(__clang__)
#pragma clang diagnostic ignored "-Wpass-failed" /* clang warns at low levels, where loops stay loops */
#define MODES_UNROLL _Pragma("clang loop unroll(full)")
#else
#define MODES_UNROLL _Pragma("GCC unroll 4")
#endif

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
    return (s->form.height + t->base) + sum_of_modes(t->q, n);
}

ALWAYS_INLINE void push_modes(double push, struct tick *t, int n)
{
    MODES_UNROLL
    for (int i = 0; i < n; i++)
        t->v[i] += push;
}

/* Base and stiffness after kick k: the parabola through their three instants. */
ALWAYS_INLINE double parabola(const double *at, int k)
{
    double part = (1.0 / MODAL_KICKS) * k;
    double first = (1.0 - part) * (1.0 - 2.0 * part), last = part * (2.0 * part - 1.0);
    double middle = 4.0 * part * (1.0 - part);
    return (first * at[0] + middle * at[1]) + last * at[2];
}

ALWAYS_INLINE void move_inputs(const struct tip_law *w, struct tick *t, int k, int kicks, bool books)
{
    t->base = k == kicks ? t->base_at[2] : parabola(t->base_at, k);
    if (books) {
        t->stiffness = k == kicks ? t->stiffness_at[2] : parabola(t->stiffness_at, k);
        t->side.hertz = w->hertz * (1.0 + t->stiffness);
    }
}

/* ---- books ---- */

/* The base delivers this where the modes' rates changed from `before`. */
ALWAYS_INLINE void book_base(struct modal *s, const double *before, const struct tick *t, int n)
{
    double work = s->books.work[s->form.base];
    MODES_UNROLL
    for (int i = 0; i < n; i++)
        work += s->form.participation[i] * t->base_rate * (t->v[i] - before[i]);
    s->books.work[s->form.base] = work;
}

ALWAYS_INLINE void book_base_and_sample(struct modal *s, double push, const struct tick *t, int n)
{
    double share = -1.0;
    MODES_UNROLL
    for (int i = 0; i < n; i++)
        share += s->form.participation[i];
    s->books.work[s->form.base] += share * push * t->base_rate;
}

/* ---- the sample ---- */

/* The force of permanent contact, or of a modulated sample: rare. */
NEVER_INLINE void feel_other(const struct tip_law *w, double correction, double stiffness, double branch,
                             double gap, struct tip_force *f)
{
    struct tip_side side = tip_side_of(w, stiffness, branch);
    tip_force_at(w, &side, gap, f);
    if (correction > 0.0) {
        gap += correction * f->force;
        tip_force_at(w, &side, gap, f);
    }
    if (stiffness != 0.0)
        f->modulation = tip_modulation(w, branch, gap, f);
}

/* The force of the sample at this gap. */
ALWAYS_INLINE void feel(const struct tip_law *w, const struct modal *s, const struct tick *t, double gap,
                        struct tip_force *f, bool books)
{
    struct tip_force other;
    if (s->correction > 0.0 || (books && t->stiffness != 0.0)) {
        feel_other(w, s->correction, t->stiffness, t->branch, gap, &other);
        *f = other;
    } else {
        tip_force_at(w, &t->side, gap, f);
    }
}

/* The drag, at the mean of the speeds before and after; returns the push. */
ALWAYS_INLINE double drag_by_sample(struct modal *s, double half, const struct tip_force *f,
                                    const struct tick *t, int n, bool books)
{
    double push = half * f->force, drag = half * f->drag;
    double before = sum_of_modes(t->v, n) + t->base_rate;
    double mean = (before + 0.5 * n * push) / (1.0 + 0.5 * n * drag);
    if (books) {
        s->books.damping += drag * mean * mean;
        s->books.work[s->form.stiffness] += half * f->modulation * mean;
    }
    return push - drag * mean;
}

/* The sample, for `half` of a kick's time. */
ALWAYS_INLINE void kick_by_sample(struct modal *s, double half, const struct tip_force *f, struct tick *t,
                                  int n, bool books)
{
    double push = half * f->force;
    if (f->drag > 0.0 || (books && f->modulation != 0.0))
        push = drag_by_sample(s, half, f, t, n, books);
    if (f->force > t->peak)
        t->peak = f->force;
    push_modes(push, t, n);
    if (books && t->base_rate != 0.0)
        book_base_and_sample(s, push, t, n);
}

ALWAYS_INLINE void turn_modes(struct modal *s, const struct turns *turn, struct tick *t, int n, bool books)
{
    double before[MODEL_MODES];
    MODES_UNROLL
    for (int i = 0; i < n; i++) {
        double q = t->q[i], v = t->v[i];
        before[i] = v;
        t->q[i] = turn->c[i] * q + turn->s[i] * v;
        t->v[i] = turn->c[i] * v - turn->r[i] * q;
    }
    if (books && t->base_rate != 0.0)
        book_base(s, before, t, n);
}

/* After a kick at `gap`, `left` before the end of the tick: contact and branch. */
ALWAYS_INLINE void note(const struct model *m, const double *p, const struct tip_law *w, struct modal *s,
                        double left, double gap, struct tip_force *f, struct tick *t, int n, bool books)
{
    bool closed = f->gap < 0.0;
    if (books && closed != t->closed && t->watches && s->n_late < MODAL_KICKS)
        s->late[s->n_late++].early = left;
    t->closed = closed;
    if (s->form.latched) {
        double loss, before = t->branch;
        t->branch = m->tip_branch(p, before, gap, sum_of_modes(t->v, n) + t->base_rate, &loss);
        s->books.damping += loss;
        if (t->branch != before) {
            struct tip_force other;
            t->side = tip_side_of(w, t->stiffness, t->branch);
            feel_other(w, s->correction, t->stiffness, t->branch, gap, &other);
            *f = other;
        }
    }
}

/* One of so many kicks, and a turn. */
ALWAYS_INLINE void swing_once(const struct model *m, const double *p, const struct tip_law *w,
                              struct modal *s, double part, const struct turns *turn, int k, int kicks,
                              struct felt *felt, struct tick *t, int n, bool books)
{
    kick_by_sample(s, 0.5 * part, &felt->force, t, n, books);
    turn_modes(s, turn, t, n, books);
    if (t->moves)
        move_inputs(w, t, k, kicks, books);
    felt->gap = gap_of(s, t, n);
    feel(w, s, t, felt->gap, &felt->force, books);
    kick_by_sample(s, 0.5 * part, &felt->force, t, n, books);
    note(m, p, w, s, part * (kicks - k), felt->gap, &felt->force, t, n, books);
}

/* Kicks of the sample and turns, each for `part`. */
ALWAYS_INLINE void swing(const struct model *m, const double *p, const struct tip_law *w, struct modal *s,
                         double part, const struct turns *turn, int kicks, double gap, struct felt *felt,
                         struct tick *t, int n, bool books)
{
    bool same = felt->known && felt->gap == gap;
    if (books) /* else nothing can have changed them */
        same = same && felt->branch == t->branch && felt->stiffness == t->stiffness;
    if (!same)
        feel(w, s, t, gap, &felt->force, books);
    for (int k = 1; k <= kicks; k++)
        swing_once(m, p, w, s, part, turn, k, kicks, felt, t, n, books);
    felt->branch = t->branch;
    felt->stiffness = t->stiffness;
    felt->known = true;
}

/* Kicks that a tick of this length needs, beginning at `gap`. */
ALWAYS_INLINE int kicks_for(const struct modal *s, double length, double gap, const struct tick *t, int n)
{
    double rate = sum_of_modes(t->v, n) + t->base_rate;
    return gap < s->near || gap + rate * length < s->near ? MODAL_KICKS : 1;
}

/* ---- heat ---- */

/* Gaussian noise in the place of the uniform one, each mode's own word. */
NEVER_INLINE void gaussian_noise(uint64_t word, double *xi, int n)
{
    for (int i = 0; i < n; i++)
        xi[i] = noise_deviate(noise_word(word, (uint64_t)i)) * (2.0 * (1 << MODAL_WORD_BITS));
}

/* The noise of all modes at this instant: a function of seed and instant alone; in 1/2^17. */
ALWAYS_INLINE void noise_of(const struct modal *s, uint64_t instant, double *xi, int n)
{
    const uint64_t heat = UINT64_C(0x6865617400000000); /* another sequence than those of the inputs */
    uint64_t word = noise_word(heat ^ s->form.seed, instant);
    MODES_UNROLL
    for (int i = 0; i < n; i++) {
        uint32_t part = (uint32_t)(word >> (MODAL_WORD_BITS * i)) & ((1u << MODAL_WORD_BITS) - 1u);
        xi[i] = (double)(2 * (int32_t)part - ((1 << MODAL_WORD_BITS) - 1));
    }
    if (s->gaussian) {
        double own[MODEL_MODES];
        gaussian_noise(word, own, n);
        MODES_UNROLL
        for (int i = 0; i < n; i++)
            xi[i] = own[i];
    }
}

ALWAYS_INLINE void heat(struct modal *s, const double *decay, const double *spread, uint64_t instant,
                        struct tick *t, int n, bool books)
{
    double xi[MODEL_MODES] = {0.0}, before[MODEL_MODES];
    if (s->form.heat > 0.0)
        noise_of(s, instant, xi, n);
    MODES_UNROLL
    for (int i = 0; i < n; i++) {
        double v = t->v[i], slowed = decay[i] * v, now = slowed + spread[i] * xi[i];
        if (books) {
            s->books.damping += 0.5 * (v - slowed) * (v + slowed);
            s->books.heat += 0.5 * (now - slowed) * (now + slowed);
        }
        before[i] = v;
        t->v[i] = now;
    }
    if (books && t->base_rate != 0.0)
        book_base(s, before, t, n);
}

#endif
