/* adams_books.h - the energies of a tick of `adams`.
 *
 * The trapezoid rule with end terms, of order 4: a power P moves h/2 P + h^2/12 P' of the begin of a tick,
 * and h/2 P - h^2/12 P' of its end. The rates of the powers need no force but g, which is there. */
#ifndef FIRMWARE_METHOD_ADAMS_BOOKS_H
#define FIRMWARE_METHOD_ADAMS_BOOKS_H

#include <math.h>
#include "firmware/method/adams/adams.h"
#include "models/check.h"

/* Powers, of each active input in turn, and their rates. */
struct powers {
    double work[MODEL_INPUTS], work_rate[MODEL_INPUTS], damping, damping_rate;
};

/* An end of a tick. */
struct end {
    const struct input *u;
    double fast[MODEL_INPUTS];  /* how fast the inputs' rates change, where they move the contact */
    double place, rate, change; /* eta, its rate, and the rate of that */
    double contact, steepness;  /* hertz eta^1.5, and its derivative */
};

ALWAYS_INLINE void book_force(const struct adams *s, int k, const struct input *u, double rate, double change,
                              struct powers *q)
{
    q->work[k] = q->work_rate[k] = 0.0;
    if (s->force[k] == 0.0)
        return;
    q->work[k] = s->force[k] * (u->value * rate);
    q->work_rate[k] = s->force[k] * (u->rate * rate + u->value * change);
}

/* The contact is stiffer by a part than the stored energy says. */
ALWAYS_INLINE void book_modulation(const struct adams *s, int k, const struct end *e, struct powers *q)
{
    int i = s->on[k];
    if (s->form.modulation[i] == 0.0)
        return;
    double part = s->form.modulation[i], power = e->contact * e->rate;
    double power_rate = e->steepness * (e->rate * e->rate) + e->contact * e->change;
    q->work[k] -= part * (e->u[i].value * power);
    q->work_rate[k] -= part * (e->u[i].rate * power + e->u[i].value * power_rate);
}

/* A base moves against spring and contact. `hangs` is the share of the damper that it moves against, too;
 * the damper's force is `damper`. */
ALWAYS_INLINE void book_shift(const struct adams *s, int k, const struct end *e, const struct input *pull,
                              const struct input *damper, struct powers *q)
{
    int i = s->on[k];
    if (s->form.shift[i] == 0.0)
        return;
    double shift = s->form.shift[i], hangs = shift - s->form.drag[i] * s->per_damping;
    double push = shift * pull->value + hangs * damper->value;
    double push_rate = shift * pull->rate + hangs * damper->rate;
    q->work[k] += push * e->u[i].rate;
    q->work_rate[k] += push_rate * e->u[i].rate + push * e->fast[i];
}

/* All of it, where the contact is moved. */
ALWAYS_INLINE void powers_shifted(const struct adams *s, const struct end *e, int n_on, struct powers *q)
{
    const struct hertz_form *f = &s->form;
    struct input more = {1.0, 0.0}, body = {e->rate, e->change};
    struct input damper = {f->damping * e->rate, f->damping * e->change};
    for (int k = 0; k < n_on; k++) {
        int i = s->on[k];
        if (f->modulation[i] != 0.0) {
            more.value += f->modulation[i] * e->u[i].value;
            more.rate += f->modulation[i] * e->u[i].rate;
        }
        if (f->shift[i] != 0.0) {
            body.value -= f->shift[i] * e->u[i].rate;
            body.rate -= f->shift[i] * e->fast[i];
            damper.value -= f->drag[i] * e->u[i].rate;
            damper.rate -= f->drag[i] * e->fast[i];
        }
    }
    const struct input pull = {f->stiffness * e->place + more.value * e->contact,
                               f->stiffness * e->rate + more.value * (e->steepness * e->rate) +
                                   more.rate * e->contact};
    for (int k = 0; k < n_on; k++) {
        book_force(s, k, &e->u[s->on[k]], body.value, body.rate, q);
        book_modulation(s, k, e, q);
        book_shift(s, k, e, &pull, &damper, q);
    }
    q->damping = s->per_damping * (damper.value * damper.value);
    q->damping_rate = 2.0 * (s->per_damping * (damper.value * damper.rate));
}

ALWAYS_INLINE void powers_of(const struct adams *s, const struct end *e, enum adams_kind kind, const int *on,
                             int n_on, struct powers *q)
{
    if (kind == ADAMS_SHIFTED) {
        powers_shifted(s, e, n_on, q);
        return;
    }
    UNROLL_TWO
    for (int k = 0; k < n_on; k++) {
        book_force(s, k, &e->u[on[k]], e->rate, e->change, q);
        if (kind == ADAMS_MODULATED)
            book_modulation(s, k, e, q);
    }
    double loss = s->form.damping * e->rate;
    q->damping = loss * e->rate;
    q->damping_rate = 2.0 * (loss * e->change);
}

ALWAYS_INLINE struct adams_rule rule_of(double length)
{
    return (struct adams_rule){0.5 * length, length * length * (1.0 / 12.0)};
}

ALWAYS_INLINE double fast_of(const struct wave *w, double s, const struct input *u)
{
    if (w->growth != 0.0)
        return wave_acceleration(w, s, u);
    return -w->omega * (w->omega * ((u->value - w->offset) - w->slope * s));
}

/* Where the motion stands. Only what `kind` needs of the contact. */
ALWAYS_INLINE void find_end(const struct adams *s, double length, const struct input *u,
                            const struct adams_motion *m, enum adams_kind kind, const int *on, int n_on,
                            struct end *e)
{
    const struct hertz_form *f = &s->form;
    e->u = u;
    e->place = m->at[ADAMS_PLACE];
    e->rate = m->at[ADAMS_RATE];
    e->change = f->constant + m->g[0];
    e->contact = e->steepness = 0.0;
    UNROLL_TWO
    for (int k = 0; k < n_on; k++) {
        int i = on[k];
        e->change += s->force[k] * u[i].value;
        if (kind == ADAMS_SHIFTED && f->shift[i] != 0.0) {
            e->fast[i] = fast_of(&s->wave[i], length, &u[i]);
            e->change += f->drag[i] * u[i].rate + f->shift[i] * e->fast[i];
        }
    }
    if (kind != ADAMS_FORCED) {
        double depth = e->place > 0.0 ? e->place : 0.0, root = sqrt(depth);
        e->contact = f->hertz * depth * root;
        e->steepness = 1.5 * f->hertz * root;
    }
}

/* The part by rule r of the tick that begins at m; on[k] is the place of active input k in u. */
ALWAYS_INLINE void book_begin(const struct adams *s, const struct adams_rule *r, const struct input *u,
                              enum adams_kind kind, const int *on, int n_on, struct adams_motion *m)
{
    struct powers q;
    struct end e;
    find_end(s, 0.0, u, m, kind, on, n_on, &e);
    powers_of(s, &e, kind, on, n_on, &q);
    UNROLL_TWO
    for (int k = 0; k < n_on; k++)
        m->begun.work[k] = r->half * q.work[k] + r->twelfth * q.work_rate[k];
    m->begun.damping = r->half * q.damping + r->twelfth * q.damping_rate;
}

/* The books by rule r of the tick that ends at m and began with `begun`. on[k] is the place of active input k
 * in u and in `work`. The next one begins there and is as
 * long. */
ALWAYS_INLINE void book_end(const struct adams *s, const struct adams_rule *r, double length,
                            const struct input *u, enum adams_kind kind, const int *on, int n_on,
                            const struct adams_half *begun, struct adams_motion *m, double *work,
                            double *damping)
{
    struct powers q;
    struct end e;
    find_end(s, length, u, m, kind, on, n_on, &e);
    powers_of(s, &e, kind, on, n_on, &q);
    UNROLL_TWO
    for (int k = 0; k < n_on; k++) {
        double even = r->half * q.work[k], odd = r->twelfth * q.work_rate[k];
        work[on[k]] = begun->work[k] + (even - odd);
        m->begun.work[k] = even + odd;
    }
    double even = r->half * q.damping, odd = r->twelfth * q.damping_rate;
    *damping = begun->damping + (even - odd);
    m->begun.damping = even + odd;
}

/* book_end for any inputs: for single steps, and where room is short. */
NEVER_INLINE void book_any(const struct adams *s, const struct adams_rule *r, double length,
                           const struct input *u, const struct adams_half *begun, struct adams_motion *m,
                           struct method_books *b)
{
    book_end(s, r, length, u, s->kind, s->on, s->n_on, begun, m, b->work, &b->damping);
}

#endif
