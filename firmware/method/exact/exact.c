/* exact.c - the exact solution of piecewise linear plants: its error does not depend on the step.
 *
 * While no contact switches, the state after a tick is a matrix times the state before, plus the responses to
 * the phasors and samples of the inputs. All are tabulated at the start: (n + 2) n multiply-adds for one
 * harmonic drive. Inside a tick each position is a polynomial in time, a sum of tabulated curves
 * (exact_series.h). It serves parts of a tick, and ticks in which a position is, or may have been, beyond a
 * wall; the switch is located on it. Only tables of frequencies are carried from one tick to the next.
 *
 * At the limit of the step (2.1 rad of the fastest mode) a chaotic shaft has one switch in about 500 000 that
 * is not seen: a brief parting inside a tick. A model without contacts misses nothing, and its ticks may be
 * 32 times as long.
 *
 * Cost on the shaft with one harmonic drive, in instructions by gcc -O3 for x86-64-v3:
 *     a tick with its books, in a block                                                  280
 *     a switch (two polynomials, the root, the state there and at the end, books)       3000
 *     a tick or part of it by the series itself                                 1500 to 2500 */
#include "firmware/method/exact/exact.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include "firmware/method/exact/exact_books.h"
#include "firmware/method/exact/exact_root.h"
#include "firmware/method/exact/exact_series.h"
#include "firmware/method/exact/exact_tables.h"

enum {
    ANY_PIECES = 256 /* bound on the pieces of a step that runs through its switches */
};

/* The arguments that the functions below share. */
struct task {
    const struct model *m;
    struct exact *w;
    struct method_books *books; /* where those of the step go, if powers are known */
};

/* Pairs of a row: of n states, and of the last of them half a tick earlier. */
ALWAYS_INLINE int row_pairs(int n)
{
    return n - n / 4;
}

/* y += row * size */
ALWAYS_INLINE void add_row(int pairs, exact_pair *y, const double *row, double size)
{
    EXACT_UNROLL for (int k = 0; k < pairs; k++) y[k] += exact_load(&row[2 * k]) * size;
}

/* The tables cover this wave over a whole tick. */
ALWAYS_INLINE bool covers(const struct exact_response *q, const struct wave *v)
{
    return v->growth == 0.0 && (v->amplitude == 0.0 || v->omega == q->omega);
}

/* Adds the response to one input. */
ALWAYS_INLINE void respond(int pairs, const struct exact_response *q, double amplitude, double cosine,
                           double sine, double offset, exact_pair *y)
{
    if (amplitude != 0.0) {
        add_row(pairs, y, q->cosine, amplitude * cosine);
        add_row(pairs, y, q->sine, -amplitude * sine);
    }
    if (offset != 0.0)
        add_row(pairs, y, q->offset, offset);
}

/* x1 becomes the state a tick after x, in pairs, and behind it stand the last states half a tick after x. y:
 * the responses to c and to the inputs. Three sums of a third of the terms each make shorter chains than one.
 */
ALWAYS_INLINE void tick(int n, int pairs, const struct exact_system *s, const exact_pair *y,
                        const exact_pair *x, exact_pair *x1)
{
    const int half = n / 2;
    EXACT_UNROLL for (int k = 0; k < pairs; k++)
    {
        exact_pair position = exact_load(&s->whole[0][2 * k]) * x[0][0];
        exact_pair velocity = exact_load(&s->whole[half][2 * k]) * x[half / 2][half % 2];
        EXACT_UNROLL for (int j = 1; j < half; j++)
        {
            position += exact_load(&s->whole[j][2 * k]) * x[j / 2][j % 2];
            velocity += exact_load(&s->whole[half + j][2 * k]) * x[(half + j) / 2][(half + j) % 2];
        }
        x1[k] = x[k < half ? k : k - half + half / 2] + ((position + velocity) + y[k]);
    }
}

typedef long long exact_bits __attribute__((vector_size(16)));

ALWAYS_INLINE exact_pair magnitude(exact_pair v)
{
    const exact_bits all_but_sign = {0x7fffffffffffffff, 0x7fffffffffffffff};
    return (exact_pair)((exact_bits)v & all_but_sign);
}

/* How far a position that turns can be beyond both ends, over the sum of the rates there. Its Hermite cubic
 * reaches 4/27; a quarter leaves room for what is not cubic. */
static const double overshoot = 0.25;

/* Both ends are finite and too far from every wall for a switch in between. Only the first and the last
 * position are looked at: where others have walls, no tick is clear (struct exact_regime). */
ALWAYS_INLINE bool clear(int half, const struct exact_regime *r, double length, const exact_pair *x,
                         const exact_pair *x1)
{
    int last = half - 1;
    exact_pair from = {x[0][0], x[last / 2][last % 2]}, to = {x1[0][0], x1[last / 2][last % 2]};
    exact_pair v = {x[half / 2][half % 2], x[last][1]}, v1 = {x1[half / 2][half % 2], x1[last][1]};
    exact_pair far = (magnitude(v) + magnitude(v1)) * (overshoot * length);
    if (half == 3) { /* the position and velocity in between are finite, too */
        exact_pair sum = x1[0] + x1[last];
        far += sum - sum;
    }
    exact_pair above = exact_load(r->ends_above) - far, below = exact_load(r->ends_below) + far;
    exact_bits inside = (from < above) & (to < above) & (from > below) & (to > below);
    return (inside[0] & inside[1]) != 0;
}
STATIC_ASSERT(EXACT_HALF == 3, one_in_between_at_most);

static struct input gap_at(const struct exact_gap *g, int half, const double *x)
{
    int k = g->position;
    return (struct input){g->constant + g->slope * x[k], g->slope * x[half + k]};
}

/* True when a function of time rises to zero in the span, or may do so. It turns down when the rates at the
 * ends say so, or one of them together with the rate of their Hermite cubic half-way. Rates are per span. */
static bool may_rise(double f0, double d0, double f1, double d1)
{
    double halfway = 1.5 * (f1 - f0) - 0.25 * (d0 + d1);
    return f1 >= 0.0 || (d0 > 0.0 && (d1 < 0.0 || halfway < 0.0)) || (halfway > 0.0 && d1 < 0.0);
}

/* The contacts that may have switched between x and x1. */
static unsigned suspects(int half, const struct exact_regime *r, double length, const double *x,
                         const double *x1)
{
    unsigned found = 0;
    for (int i = 0; i < half; i++) {
        double v = length * x[half + i], v1 = length * x1[half + i], far = overshoot * (fabs(v) + fabs(v1));
        double above = r->above[i], below = r->below[i];
        if ((x[i] > x1[i] ? x[i] : x1[i]) + far >= above && may_rise(x[i] - above, v, x1[i] - above, v1))
            found |= 1u << r->contact_above[i];
        if ((x[i] < x1[i] ? x[i] : x1[i]) - far <= below && may_rise(below - x[i], -v, below - x1[i], -v1))
            found |= 1u << r->contact_below[i];
    }
    return found;
}

/* The state there in place of that at the start. */
static void advance(const struct exact_path *path, int n, double theta, double *x)
{
    double dx[MODEL_LINEAR_STATES];
    exact_change(path, n, theta, dx);
    for (int k = 0; k < n; k += 2)
        exact_store(&x[k], exact_load(&x[k]) + exact_load(&dx[k]));
}

/* The first switch of these contacts on the path; x moves there. */
static bool locate(const struct task *t, const struct exact_path *path, unsigned regime, unsigned contacts,
                   double length, double *x, const double *x_end, struct crossing *c)
{
    struct exact_root root, first = {DBL_MAX, true};
    int n = t->m->n_states;
    for (int i = 0; contacts >> i; i++) {
        const struct exact_gap *gap = &t->w->gap[i];
        if (!((contacts >> i) & 1u))
            continue;
        struct input last = gap_at(gap, n / 2, x_end);
        if (exact_first_root(path, gap, (regime >> i) & 1u, &last, &root) && root.theta < first.theta) {
            first = root;
            c->contact = i;
        }
    }
    if (first.theta > path->end)
        return false;
    double done = first.theta * path->unit;
    c->done = done < length ? done : length;
    c->residual = !first.converged;
    advance(path, n, first.theta, x);
    return true;
}

/* Makes the tables of a frequency that has stayed; one that has just moved may move again. This takes the
 * deepest stack of the method, so it is done while nothing else is on it. */
static void tune(const struct task *t, const struct exact_regime *r, const struct segment *e)
{
    struct exact_system *s = exact_system_of(t->w, r);
    if (e->length != r->tick || e->changed)
        return;
    for (int i = 0; e->active >> i; i++) {
        const struct wave *v = &e->wave[i];
        if (((e->active >> i) & 1u) && v->amplitude != 0.0 && v->omega != s->input[i].omega)
            exact_tune(s, t->m, t->w->h, i, v->omega);
    }
}

/* x - x is zero, or a NaN when x is not finite. */
static bool finite_state(const double *x, int n)
{
    exact_pair zero = {0.0, 0.0};
    for (int k = 0; k < n; k += 2)
        zero += exact_load(&x[k]) - exact_load(&x[k]);
    return zero[0] + zero[1] == 0.0;
}

static void copy_pairs(double *to, const double *from, int n)
{
    for (int k = 0; k < n; k += 2)
        exact_store(&to[k], exact_load(&from[k]));
}

/* Behind the end of a row: the last states in the middle of the path up to theta. */
static void find_middle(const struct exact_path *path, int n, double theta, const double *x0, double *row)
{
    double change[MODEL_LINEAR_STATES];
    exact_change(path, n, 0.5 * theta, change);
    for (int k = n / 4 * 2, i = n; k < n; k += 2, i += 2)
        exact_store(&row[i], exact_load(&x0[k]) + exact_load(&change[k]));
}

/* The books of a piece, e or its part up to a switch, from x0 to a row of its end and middle. The input in
 * the middle of such a part is that of the cubic through its ends. */
ALWAYS_INLINE void book_states(int n, const struct task *t, const struct segment *e, unsigned regime,
                               double length, const double *x0, const double *row)
{
    exact_pair from[MODEL_LINEAR_STATES / 2], to[EXACT_ROW / 2];
    EXACT_UNROLL for (int k = 0; k < n / 2; k++) from[k] = exact_load(&x0[2 * k]);
    EXACT_UNROLL for (int k = 0; k < row_pairs(n); k++) to[k] = exact_load(&row[2 * k]);
    exact_book(n, t->w, regime, length, from, to, t->books);
    for (int i = 0; e->active >> i; i++) {
        if (!((e->active >> i) & 1u))
            continue;
        struct input u0 = e->at[0][i], u1 = e->at[2][i];
        double middle = e->at[1][i].value;
        if (length < e->length) {
            wave_at(&e->wave[i], length, &u1);
            middle = 0.5 * (u0.value + u1.value) + 0.125 * length * (u0.rate - u1.rate);
        }
        t->books->work[i] = exact_work(n, t->w, i, length, from, to, u0.value, middle, u1.value);
    }
}

static void book_piece(const struct task *t, const struct segment *e, unsigned regime, double length,
                       const double *x0, const double *row)
{
    if (t->m->n_states == 6)
        book_states(6, t, e, regime, length, x0, row);
    else if (t->m->n_states == 4)
        book_states(4, t, e, regime, length, x0, row);
    else
        book_states(2, t, e, regime, length, x0, row);
}

/* From x to the first switch before the end of a row, or to its end. `drawn`: path is filled already, and the
 * row has no middle. */
static enum step_status close_in(const struct task *t, const struct exact_regime *r, const struct segment *e,
                                 unsigned regime, struct exact_path *path, bool drawn, double *x, double *row,
                                 struct crossing *c)
{
    int n = t->m->n_states;
    double x0[MODEL_LINEAR_STATES];
    if (!finite_state(row, n))
        return STEP_NOT_FINITE;
    unsigned contacts = suspects(n / 2, r, e->length, x, row);
    if (contacts && !drawn)
        exact_follow(t->w, r, t->m, e, x, path);
    copy_pairs(x0, x, n);
    bool switches = contacts && locate(t, path, regime, contacts, e->length, x, row, c);
    copy_pairs(switches ? row : x, switches ? x : row, n);
    if (t->w->powers.known) {
        if (switches || drawn)
            find_middle(path, n, switches ? c->done / path->unit : path->end, x0, row);
        book_piece(t, e, regime, switches ? c->done : e->length, x0, row);
    }
    return switches ? STEP_SWITCH : STEP_END;
}

/* A segment within the reach of its regime. */
static enum step_status step_part(const struct task *t, const struct exact_regime *r, const struct segment *e,
                                  unsigned regime, double *x, struct crossing *c)
{
    struct exact_path path;
    double row[EXACT_ROW];
    int n = t->m->n_states;
    exact_follow(t->w, r, t->m, e, x, &path);
    copy_pairs(row, x, n);
    advance(&path, n, path.end, row);
    return close_in(t, r, e, regime, &path, true, x, row, c);
}

/* A step that was forced past the limit, in sound pieces. */
static enum step_status step_far(const struct task *t, const struct segment *e, unsigned regime, double *x,
                                 struct crossing *c)
{
    struct exact_regime *r = &t->w->regime[regime];
    struct segment head;
    if (r->reach == 0.0)
        return STEP_NOT_FINITE; /* contacts that cannot be closed together */
    segment_head(e, t->m->n_inputs, r->reach, &head);
    head.changed = true;
    enum step_status status = step_part(t, r, &head, regime, x, c);
    if (status != STEP_END)
        return status;
    c->done = r->reach;
    return STEP_BUDGET;
}

static unsigned regime_of(const struct task *t, const double *x)
{
    unsigned regime = 0;
    for (int i = 0; i < t->m->n_contacts; i++)
        regime |= (unsigned)(gap_at(&t->w->gap[i], t->m->n_states / 2, x).value < 0.0) << i;
    return regime;
}

/* Adds the books of a piece, which become those of all so far. */
static void add_books(const struct model *m, struct method_books *sum, struct method_books *piece)
{
    for (int i = 0; i < m->n_inputs; i++)
        sum->work[i] += piece->work[i];
    sum->damping += piece->damping;
    sum->force = piece->force > sum->force ? piece->force : sum->force;
    *piece = *sum;
}

/* Runs to the end through all switches. */
NEVER_INLINE enum step_status step_any(const struct task *t, const struct segment *e, unsigned regime,
                                       double *x)
{
    struct segment rest = *e;
    struct method_books sum = {.damping = 0.0};
    for (int piece = 0; piece < ANY_PIECES; piece++) {
        struct crossing c = {0.0, 0, 0, 0.0};
        struct exact_regime *r = &t->w->regime[regime];
        enum step_status status = rest.length <= r->reach ? step_part(t, r, &rest, regime, x, &c)
                                                          : step_far(t, &rest, regime, x, &c);
        add_books(t->m, &sum, t->books);
        if (status == STEP_END || status == STEP_NOT_FINITE)
            return status;
        if (status == STEP_SWITCH)
            regime ^= 1u << c.contact;
        segment_tail(&rest, t->m->n_inputs, c.done);
    }
    return STEP_NOT_FINITE;
}

/* Anything but a whole tick that the tables cover. */
NEVER_INLINE enum step_status step_other(const struct model *m, const double *p, double *scratch,
                                         const struct segment *e, unsigned regime, double *x,
                                         struct crossing *c)
{
    struct exact *w = (struct exact *)(void *)scratch;
    const struct task t = {m, w, w->books};
    bool any = (regime & REGIME_ANY) || m->n_contacts == 0;
    unsigned begin = any ? regime_of(&t, x) : regime;
    const struct exact_regime *r = &t.w->regime[begin];
    (void)p;
    tune(&t, r, e);
    if (any)
        return step_any(&t, e, begin, x);
    if (!(e->length <= r->reach))
        return step_far(&t, e, begin, x, c);
    return step_part(&t, r, e, begin, x, c);
}

/* A tick whose end is known, near a wall. */
NEVER_INLINE enum step_status step_near(const struct model *m, const double *p, double *scratch,
                                        const struct segment *e, unsigned regime, double *x,
                                        struct crossing *c)
{
    struct exact *w = (struct exact *)(void *)scratch;
    const struct task t = {m, w, w->books};
    struct exact_path path;
    (void)p;
    return close_in(&t, &t.w->regime[regime], e, regime, &path, false, x, t.w->end, c);
}

/* Rare cases are tail calls: the common tick needs no stack frame. pairs: of a row, or n / 2 where nothing is
 * booked. */
ALWAYS_INLINE enum step_status step(int n, int pairs, const struct model *m, const double *p, double *scratch,
                                    const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    struct exact *w = (struct exact *)(void *)scratch;
    const struct exact_regime *r = &w->regime[regime % EXACT_REGIMES];
    const struct exact_system *s = exact_system_of(w, r);
    exact_pair y[EXACT_ROW / 2], from[MODEL_LINEAR_STATES / 2], to[EXACT_ROW / 2];
    if ((regime & REGIME_ANY) || e->length != r->tick)
        return step_other(m, p, scratch, e, regime, x, c);
    EXACT_UNROLL for (int k = 0; k < pairs; k++) y[k] = exact_load(&r->rest[2 * k]);
    EXACT_UNROLL for (int k = 0; k < n / 2; k++) from[k] = exact_load(&x[2 * k]);
    const struct wave *v = e->wave;
    const struct exact_response *q = s->input;
    for (unsigned left = e->active; left; left >>= 1, v++, q++) {
        if (!(left & 1u))
            continue;
        if (!covers(q, v))
            return step_other(m, p, scratch, e, regime, x, c);
        respond(pairs, q, v->amplitude, v->cosine, v->sine, v->offset, y);
        if (v->slope != 0.0)
            add_row(pairs, y, q->slope, v->slope);
    }
    tick(n, pairs, s, y, from, to);
    if (!clear(n / 2, r, e->length, from, to)) {
        EXACT_UNROLL for (int k = 0; k < pairs; k++) exact_store(&w->end[2 * k], to[k]);
        return step_near(m, p, scratch, e, regime, x, c);
    }
    EXACT_UNROLL for (int k = 0; k < n / 2; k++) exact_store(&x[2 * k], to[k]);
    if (pairs == n / 2 || !w->powers.known)
        return STEP_END;
    exact_book(n, w, regime, e->length, from, to, w->books);
    int i = 0;
    for (unsigned left = e->active; left; left >>= 1, i++)
        if (left & 1u)
            w->books->work[i] = exact_work(n, w, i, e->length, from, to, e->at[0][i].value, e->at[1][i].value,
                                           e->at[2][i].value);
    return STEP_END;
}

#if TICK_LANES > 1
/* Tick k of the block, from x on. */
static void take_segment(const struct method_block *b, unsigned k, struct segment *e)
{
    e->length = b->length;
    e->active = b->active;
    e->changed = false;
    for (int i = 0; b->active >> i; i++) {
        if (!((b->active >> i) & 1u))
            continue;
        e->wave[i] = b->wave[i];
        e->wave[i].cosine = b->phasor[k][i].cosine;
        e->wave[i].sine = b->phasor[k][i].sine;
        for (int j = 0; j < 3; j++)
            e->at[j][i] = b->at[2 * k + (unsigned)j][i];
        if (e->wave[i].amplitude == 0.0) {
            e->wave[i].offset = e->at[1][i].value;
            e->at[0][i] = e->at[1][i];
        }
    }
}

/* The state is where the model means something. */
ALWAYS_INLINE bool within(int n, const exact_pair *x)
{
    exact_pair size = magnitude(x[0]);
    EXACT_UNROLL for (int k = 1; k < n / 2; k++) size += magnitude(x[k]);
    return size[0] + size[1] <= METHOD_STATE_LIMIT;
}

/* Ticks of a block that the tables cover: what all of them share. */
struct run {
    struct task t;
    const struct method_block *b;
    unsigned regime;            /* now */
    int on[MODEL_INPUTS], n_on; /* the inputs that sound */
};

/* Tick k of the block, whose row is known, near a wall; x is its begin and becomes its end. A switch in it is
 * noted. False when single steps have to take it. */
NEVER_INLINE bool run_near(struct run *q, unsigned k, double *row, double *x)
{
    struct exact *w = q->t.w;
    struct method_switches *noted = q->b->switches;
    struct exact_path path;
    struct segment e;
    take_segment(q->b, k, &e);
    struct crossing c = {0.0, 0, 0, 0.0};
    enum step_status status = close_in(&q->t, &w->regime[q->regime], &e, q->regime, &path, false, x, row, &c);
    if (status != STEP_SWITCH || noted->n == EXACT_SWITCHES)
        return status == STEP_END;
    const unsigned then = q->regime ^ 1u << c.contact;
    const struct method_switch s = {(uint32_t)(q->t.books - w->books),
                                    c.contact,
                                    c.done,
                                    0.0,
                                    false,
                                    w->at_switch[noted->n],
                                    &w->before[noted->n]};
    if (c.residual || !(c.done > 0.0 && c.done < e.length))
        return false;
    w->before[noted->n] = *q->t.books;
    copy_pairs(w->at_switch[noted->n], x, q->t.m->n_states);
    segment_tail(&e, q->t.m->n_inputs, c.done);
    if (!(e.length <= w->regime[then].reach) ||
        step_part(&q->t, &w->regime[then], &e, then, x, &c) != STEP_END)
        return false;
    noted->at[noted->n++] = s;
    q->regime = then;
    return true;
}

/* Up to n ticks, to the end of one with a switch in it. */
ALWAYS_INLINE uint32_t run_ticks(int n, struct run *q, const struct exact_system *s,
                                 const struct exact_regime *r, const struct input (*at)[MODEL_INPUTS],
                                 double (*x)[MODEL_STATES], uint32_t ticks)
{
    const struct method_block *b = q->b;
    struct exact *w = q->t.w;
    const double length = b->length;
    const unsigned regime = q->regime;
    const uint32_t begin = (uint32_t)(at - b->at) / 2, end = begin + ticks;
    uint32_t k = begin;
    exact_pair from[MODEL_LINEAR_STATES / 2], to[EXACT_ROW / 2], y[EXACT_ROW / 2];
    EXACT_UNROLL for (int j = 0; j < n / 2; j++) from[j] = exact_load(&x[0][2 * j]);
    for (; k < end && q->regime == regime; k++, at += 2, x++, q->t.books++) {
        EXACT_UNROLL for (int j = 0; j < row_pairs(n); j++) y[j] = exact_load(&r->rest[2 * j]);
        for (int j = 0; j < q->n_on; j++) {
            const int i = q->on[j];
            const struct wave *v = &b->wave[i];
            respond(row_pairs(n), &s->input[i], v->amplitude, b->phasor[k][i].cosine, b->phasor[k][i].sine,
                    v->amplitude == 0.0 ? at[1][i].value : v->offset, y);
        }
        tick(n, row_pairs(n), s, y, from, to);
        if (!within(n, to))
            break;
        if (clear(n / 2, r, length, from, to)) {
            const struct input *u0 = at[(b->jumps >> k) & 1u]; /* a jump holds from the begin on */
            struct method_books *books = q->t.books;
            EXACT_UNROLL for (int j = 0; j < n / 2; j++) exact_store(&x[1][2 * j], to[j]);
            exact_book(n, w, regime, length, from, to, books);
            for (int j = 0; j < q->n_on; j++) {
                const int i = q->on[j];
                books->work[i] =
                    exact_work(n, w, i, length, from, to, u0[i].value, at[1][i].value, at[2][i].value);
            }
        } else {
            EXACT_UNROLL for (int j = 0; j < row_pairs(n); j++) exact_store(&w->end[2 * j], to[j]);
            EXACT_UNROLL for (int j = 0; j < n / 2; j++) exact_store(&x[1][2 * j], from[j]);
            if (!run_near(q, k, w->end, x[1]))
                break;
            EXACT_UNROLL for (int j = 0; j < n / 2; j++) to[j] = exact_load(&x[1][2 * j]);
            if (!within(n, to)) {
                b->switches->n -= q->regime != regime;
                q->regime = regime;
                break;
            }
        }
        EXACT_UNROLL for (int j = 0; j < n / 2; j++) from[j] = to[j];
    }
    return k - begin;
}

/* One copy for each number of states. Tables are arguments: so their rows are reached from one register. */
NEVER_INLINE uint32_t run_2(struct run *q, const struct exact_system *s, const struct exact_regime *r,
                            const struct input (*at)[MODEL_INPUTS], double (*x)[MODEL_STATES], uint32_t n)
{
    return run_ticks(2, q, s, r, at, x, n);
}

NEVER_INLINE uint32_t run_4(struct run *q, const struct exact_system *s, const struct exact_regime *r,
                            const struct input (*at)[MODEL_INPUTS], double (*x)[MODEL_STATES], uint32_t n)
{
    return run_ticks(4, q, s, r, at, x, n);
}

NEVER_INLINE uint32_t run_6(struct run *q, const struct exact_system *s, const struct exact_regime *r,
                            const struct input (*at)[MODEL_INPUTS], double (*x)[MODEL_STATES], uint32_t n)
{
    return run_ticks(6, q, s, r, at, x, n);
}

/* Ticks of one regime. Slopes are left to single steps. */
static uint32_t run_regime(struct run *q, const struct input (*at)[MODEL_INPUTS], double (*x)[MODEL_STATES],
                           uint32_t n)
{
    struct exact *w = q->t.w;
    const struct exact_regime *r = &w->regime[q->regime % EXACT_REGIMES];
    const struct exact_system *s = exact_system_of(w, r);
    bool covered = q->b->length == r->tick;
    for (int j = 0; j < q->n_on; j++) {
        const struct wave *v = &q->b->wave[q->on[j]];
        covered = covered && v->slope == 0.0 && covers(&s->input[q->on[j]], v);
    }
    if (!covered)
        return 0;
    return q->t.m->n_states == 2   ? run_2(q, s, r, at, x, n)
           : q->t.m->n_states == 4 ? run_4(q, s, r, at, x, n)
                                   : run_6(q, s, r, at, x, n);
}

static uint32_t run(const struct model *m, const double *p, double *scratch, const struct method_block *b,
                    const struct input (*at)[MODEL_INPUTS], double (*x)[MODEL_STATES], uint32_t n)
{
    struct exact *w = (struct exact *)(void *)scratch;
    struct run q = {.t = {m, w, w->books}, .b = b, .regime = b->regime};
    uint32_t done = 0, before;
    unsigned regime;
    (void)p;
    for (int i = 0; b->active >> i; i++)
        if ((b->active >> i) & 1u)
            q.on[q.n_on++] = i;
    do {
        before = done;
        regime = q.regime;
        done += run_regime(&q, &at[2 * done], &x[done], n - done);
    } while (done < n && done > before && q.regime != regime);
    return done;
}
#endif

static bool known(const double *scratch)
{
    return ((const struct exact *)(const void *)scratch)->powers.known;
}

/* Copies for each number of states: two for 2, as many models of that kind have other powers. */
static enum step_status step_2(const struct model *m, const double *p, double *scratch,
                               const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    return known(scratch) ? step(2, row_pairs(2), m, p, scratch, e, regime, x, c)
                          : step(2, 2 / 2, m, p, scratch, e, regime, x, c);
}

static enum step_status step_4(const struct model *m, const double *p, double *scratch,
                               const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    return step(4, row_pairs(4), m, p, scratch, e, regime, x, c);
}

static enum step_status step_6(const struct model *m, const double *p, double *scratch,
                               const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    return step(6, row_pairs(6), m, p, scratch, e, regime, x, c);
}

static step_function *bind(const struct model *m)
{
    return m->n_states == 2 ? step_2 : m->n_states == 4 ? step_4 : step_6;
}

#if TICK_LANES > 1
static run_function *bind_run(const struct model *m, const double *scratch)
{
    (void)m;
    return known(scratch) ? run : NULL;
}

#endif

static const struct method_books *books(const double *scratch)
{
    return known(scratch) ? ((const struct exact *)(const void *)scratch)->books : NULL;
}

static size_t n_scratch(const struct model *m)
{
    size_t regimes = (size_t)1 << m->n_contacts;
    size_t systems = regimes < EXACT_SYSTEMS ? regimes : EXACT_SYSTEMS;
    return (sizeof(struct exact) + systems * sizeof(struct exact_system)) / sizeof(double);
}

STATIC_ASSERT(sizeof(struct exact) + EXACT_SYSTEMS * sizeof(struct exact_system) <=
                  METHOD_SCRATCH * sizeof(double),
              work_of_exact);

const struct method exact = {
    .name = "exact",
    .title = "exact solution of piecewise linear plants; switches located on it",
    .order = 0,
    .n_scratch = n_scratch,
    .refuse = exact_refuse,
    .prepare = exact_prepare,
    .bind = bind,
    .books = books,
#if TICK_LANES > 1
    .bind_run = bind_run,
#endif
};
