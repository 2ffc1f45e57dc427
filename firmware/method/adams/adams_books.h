/* adams_books.h - the energies of a tick of `adams`.
 *
 * The trapezoid rule with end terms, of order 4. Over ticks of length h a power P moves the sum of h P at
 * their ends. To it comes the share h/2 P + h^2/12 P' of the first begin, less that of the last end. So rates
 * of powers are needed where a run of ticks begins or ends only. They need no force but g, which is there. */
#ifndef FIRMWARE_METHOD_ADAMS_BOOKS_H
#define FIRMWARE_METHOD_ADAMS_BOOKS_H

#include "firmware/method/adams/adams.h"
#include "models/check.h"

/* Powers, of each active input in turn, and their rates. */
struct powers {
    double work[MODEL_INPUTS], work_rate[MODEL_INPUTS], damping, damping_rate;
};

/* The forces and the modulations of the active inputs, and the damping. Times 1 they make powers, times a
 * length energies. */
struct gauge {
    double force[MODEL_INPUTS], modulation[MODEL_INPUTS], damping, length;
};

/* An end of a tick. */
struct end {
    const struct input *u;
    double fast[MODEL_INPUTS];  /* how fast the inputs' rates change, where they move the contact */
    double place, rate, change; /* eta, its rate, and the rate of that */
    double contact, steepness;  /* hertz eta^1.5, and its derivative */
};

/* on[k] is the place of active input k, here and below. */
ALWAYS_INLINE struct gauge gauge_of(const struct adams *s, double length, const int *on, int n_on)
{
    struct gauge g;
    g.damping = length * s->form.damping;
    g.length = length;
    UNROLL_TWO
    for (int k = 0; k < n_on; k++) {
        g.force[k] = length * s->force[k];
        g.modulation[k] = length * s->form.modulation[on[k]];
    }
    return g;
}

/* Active input k moves the body, and takes part in the contact as far as it makes that stiffer than the
 * stored energy says. */
ALWAYS_INLINE void book_force(const struct gauge *g, int k, const struct input *u, const struct input *body,
                              const struct input *contact, enum adams_kind kind, struct powers *q)
{
    double power = g->force[k] * body->value, rate = g->force[k] * body->rate;
    if (kind != ADAMS_FORCED) {
        power -= unfused(g->modulation[k] * contact->value);
        rate -= g->modulation[k] * contact->rate;
    }
    q->work[k] = u->value * power;
    q->work_rate[k] = u->rate * power + u->value * rate;
}

/* A base moves against spring and contact. `hangs` is the share of the damper that it moves against, too;
 * the damper's force is `damper`. */
ALWAYS_INLINE void book_shift(const struct adams *s, double length, int k, const struct end *e,
                              const struct input *pull, const struct input *damper, struct powers *q)
{
    int i = s->on[k];
    if (s->form.shift[i] == 0.0)
        return;
    double shift = length * s->form.shift[i], hangs = shift - length * (s->form.drag[i] * s->per_damping);
    double push = shift * pull->value + hangs * damper->value;
    double push_rate = shift * pull->rate + hangs * damper->rate;
    q->work[k] += push * e->u[i].rate;
    q->work_rate[k] += push_rate * e->u[i].rate + push * e->fast[i];
}

/* Power and rate of the contact, but for its modulation. */
ALWAYS_INLINE struct input contact_power(const struct end *e)
{
    return (struct input){e->contact * e->rate, e->steepness * (e->rate * e->rate) + e->contact * e->change};
}

/* All of it, where the contact is moved. */
ALWAYS_INLINE void powers_shifted(const struct adams *s, const struct gauge *g, const struct end *e, int n_on,
                                  struct powers *q)
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
    const struct input contact = contact_power(e);
    for (int k = 0; k < n_on; k++) {
        book_force(g, k, &e->u[s->on[k]], &body, &contact, ADAMS_SHIFTED, q);
        book_shift(s, g->length, k, e, &pull, &damper, q);
    }
    double of_damper = g->length * s->per_damping;
    q->damping = of_damper * (damper.value * damper.value);
    q->damping_rate = 2.0 * (of_damper * (damper.value * damper.rate));
}

ALWAYS_INLINE void powers_of(const struct adams *s, const struct gauge *g, const struct end *e,
                             enum adams_kind kind, const int *on, int n_on, struct powers *q)
{
    if (kind == ADAMS_SHIFTED) {
        powers_shifted(s, g, e, n_on, q);
        return;
    }
    const struct input body = {e->rate, e->change}, contact = contact_power(e);
    UNROLL_TWO
    for (int k = 0; k < n_on; k++)
        book_force(g, k, &e->u[on[k]], &body, &contact, kind, q);
    double loss = g->damping * e->rate;
    q->damping = loss * e->rate;
    q->damping_rate = 2.0 * (loss * e->change);
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
        e->contact = m->contact.plain;
        e->steepness = 1.5 * f->hertz * m->contact.root;
    }
}

/* The share of m in the energies of ticks that are `length` long, at inputs u, `since` behind the begin of
 * their waves. on[k] is the place of active input k in u and in `work`. */
ALWAYS_INLINE void book_end(const struct adams *s, double length, double since, const struct input *u,
                            const struct adams_motion *m, enum adams_kind kind, const int *on, int n_on,
                            double *work, double *damping)
{
    const struct gauge g = gauge_of(s, 1.0, on, n_on);
    double half = 0.5 * length, twelfth = length * length * (1.0 / 12.0);
    struct powers q;
    struct end e;
    find_end(s, since, u, m, kind, on, n_on, &e);
    powers_of(s, &g, &e, kind, on, n_on, &q);
    UNROLL_TWO
    for (int k = 0; k < n_on; k++)
        work[on[k]] = half * q.work[k] + twelfth * q.work_rate[k];
    *damping = half * q.damping + twelfth * q.damping_rate;
}

/* The powers of m times `weight`, with any inputs. */
NEVER_INLINE void powers_any(const struct adams *s, double weight, double since, const struct input *u,
                             const struct adams_motion *m, struct powers *q)
{
    const struct gauge g = gauge_of(s, weight, s->on, s->n_on);
    struct end e;
    find_end(s, since, u, m, s->kind, s->on, s->n_on, &e);
    powers_of(s, &g, &e, s->kind, s->on, s->n_on, q);
}

/* book_end for any inputs. */
static void book_share(const struct adams *s, double length, double since, const struct input *u,
                       const struct adams_motion *m, struct method_share *share)
{
    double half = 0.5 * length, twelfth = length * length * (1.0 / 12.0);
    struct powers q;
    powers_any(s, 1.0, since, u, m, &q);
    for (int k = 0; k < s->n_on; k++)
        share->work[s->on[k]] = half * q.work[k] + twelfth * q.work_rate[k];
    share->damping = half * q.damping + twelfth * q.damping_rate;
}

/* A tick's energies, but for the shares of its ends: as if the powers at its end m were those of all of it.
 */
ALWAYS_INLINE void book_tick(const struct adams *s, const struct gauge *g, const struct input *u,
                             const struct adams_motion *m, enum adams_kind kind, const int *on, int n_on,
                             double *work, double *damping)
{
    struct powers q;
    struct end e;
    find_end(s, g->length, u, m, kind, on, n_on, &e);
    powers_of(s, g, &e, kind, on, n_on, &q);
    UNROLL_TWO
    for (int k = 0; k < n_on; k++)
        work[on[k]] = q.work[k];
    *damping = q.damping;
}

ALWAYS_INLINE struct method_share share_between(const struct method_share *a, const struct method_share *b)
{
    struct method_share more;
    for (int i = 0; i < MODEL_INPUTS; i++)
        more.work[i] = b->work[i] - a->work[i];
    more.damping = b->damping - a->damping;
    return more;
}

/* on[k] is the number of active input k. */
ALWAYS_INLINE void add_share(const struct method_share *more, const int *on, int n_on, struct method_books *b)
{
    for (int k = 0; k < n_on; k++)
        b->work[on[k]] += more->work[on[k]];
    b->damping += more->damping;
}

#endif
