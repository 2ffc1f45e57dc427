/* switch.c - location of a contact switch inside a step; see switch.h. */
#include "firmware/method/switch.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Cubic a + b t + c t^2 + d t^3 on 0 <= t <= 1. */
struct cubic {
    double a, b, c, d;
};

static double cubic_at(const struct cubic *q, double t)
{
    return q->a + t * (q->b + t * (q->c + t * q->d));
}

/* Hermite cubic of sign * gap over t = s/length. */
static struct cubic cubic_of(const struct input *g0, const struct input *g1, double length, double sign)
{
    double y0 = sign * g0->value, y1 = sign * g1->value;
    double m0 = sign * g0->rate * length, m1 = sign * g1->rate * length;
    return (struct cubic){y0, m0, 3.0 * (y1 - y0) - 2.0 * m0 - m1, 2.0 * (y0 - y1) + m0 + m1};
}

/* The maximum of the cubic inside (0, 1): the root of its derivative with negative curvature; -1 if there is
 * none. */
static double cubic_peak(const struct cubic *q)
{
    double disc = q->c * q->c - 3.0 * q->d * q->b;
    if (disc < 0.0)
        return -1.0;
    /* b + 2 c t + 3 d t^2 = 0 with c + 3 d t = -sqrt(disc), written without cancellation. */
    double root = sqrt(disc);
    double t = q->c <= 0.0 ? q->b / (root - q->c) : -(q->c + root) / (3.0 * q->d);
    return t > 0.0 && t < 1.0 ? t : -1.0;
}

/* The zero of the cubic between lo (negative) and hi (not negative), by bisection to 2^-40. */
static double cubic_zero(const struct cubic *q, double lo, double hi)
{
    for (int i = 0; i < 40; i++) {
        double middle = 0.5 * (lo + hi);
        if (cubic_at(q, middle) < 0.0)
            lo = middle;
        else
            hi = middle;
    }
    return hi;
}

/* The cubic rises from 0 to 1: a look without a root, which not every cubic that does so passes. */
static bool cubic_rises(const struct cubic *q)
{
    double last = 2.0 * q->c + 3.0 * q->d;
    return q->b > 0.0 && q->b + last > 0.0 && (q->d <= 0.0 || q->c >= 0.0);
}

/* Where a cubic that begins below zero has got there first, in (0, 1]; -1 when it does not. */
static double cubic_beyond(const struct cubic *q)
{
    double peak = cubic_rises(q) ? -1.0 : cubic_peak(q);
    if (peak > 0.0 && cubic_at(q, peak) >= 0.0)
        return peak;
    return cubic_at(q, 1.0) >= 0.0 ? 1.0 : -1.0;
}

double switch_guess(const struct input *g0, const struct input *g1, double length, bool closed)
{
    struct cubic q = cubic_of(g0, g1, length, closed ? 1.0 : -1.0);
    double beyond = cubic_beyond(&q);
    return beyond > 0.0 ? length * cubic_zero(&q, 0.0, beyond) : -1.0;
}

/* As cubic_zero, to 1e-11, by Newton from the secant inside the bracket: a quarter of the work. A cubic
 * that begins at zero goes below it first: from the other end. */
static double cubic_root(const struct cubic *q, double lo, double hi)
{
    double begin = cubic_at(q, lo), t = hi;
    if (begin < 0.0)
        t = lo + (hi - lo) * (begin / (begin - cubic_at(q, hi)));
    for (int i = 0; i < SWITCH_ITERATIONS; i++) {
        double value = cubic_at(q, t), last = t;
        if (value < 0.0)
            lo = t;
        else
            hi = t;
        t -= value / (q->b + t * (2.0 * q->c + 3.0 * t * q->d));
        if (!(t > lo && t < hi))
            t = 0.5 * (lo + hi);
        if (fabs(t - last) <= 1e-6)
            break;
    }
    return t;
}

bool switch_find(const struct input *g0, const struct input *g1, double length, bool closed,
                 struct switch_found *f)
{
    double sign = closed ? 1.0 : -1.0;
    struct cubic q = cubic_of(g0, g1, length, sign);
    double beyond = cubic_beyond(&q), per = 1.0 / length;
    if (!(beyond > 0.0))
        return false;
    double t = cubic_root(&q, 0.0, beyond), third = 3.0 * t * q.d;
    f->done = length * t;
    f->rate = sign * per * (q.b + t * (2.0 * q.c + third));
    f->bend = sign * (per * per) * (2.0 * (q.c + third));
    return true;
}

double switch_highest(const struct input *g0, const struct input *g1, double length)
{
    struct cubic q = cubic_of(g0, g1, length, 1.0);
    double ends = g0->value > g1->value ? g0->value : g1->value, peak = cubic_peak(&q);
    double most = peak > 0.0 ? cubic_at(&q, peak) : ends;
    return most > ends ? most : ends;
}

/* A switch being sharpened: the old regime holds at lo, the new one at hi. */
struct bracket {
    double lo, hi, s;
};

/* A gap below this is zero to rounding; positions are in units of the contact's own length. */
static double gap_rounding(const struct model *m, const double *x)
{
    double size = 1.0;
    for (int i = 0; i < m->n_states / 2; i++)
        size += fabs(x[i]);
    return 8.0 * DBL_EPSILON * size;
}

/* Newton on the gap of real steps, kept inside the bracket; x1 and g are the state and the gaps at the root.
 * 1: converged. */
static bool sharpen(const struct switch_stepper *by, const struct segment *e, int which, bool closed,
                    struct bracket *b, const double *x, double *x1, struct input *g)
{
    struct segment head;
    double sign = closed ? 1.0 : -1.0;
    for (int i = 0; i < SWITCH_ITERATIONS; i++) {
        segment_head(e, by->m->n_inputs, b->s, &head);
        by->advance(by->m, by->p, by->scratch, &head, x, x1);
        by->m->gap(by->p, head.at[2], x1, g);
        double gap = sign * g[which].value, rate = sign * g[which].rate;
        double move = rate != 0.0 ? -gap / rate : 0.0;
        /* Nearer than the rounding of time or gap: a further step would only change the last bits. */
        if (rate > 0.0 && (fabs(move) <= by->resolution || fabs(gap) <= gap_rounding(by->m, x1)))
            return true;
        if (gap < 0.0)
            b->lo = b->s;
        else
            b->hi = b->s;
        b->s += move;
        if (!(rate > 0.0 && b->s > b->lo && b->s < b->hi))
            b->s = 0.5 * (b->lo + b->hi);
    }
    return false;
}

/* The first contact that may have switched in this step, and about when; -1 for none. */
static int first_switch(const struct input *g0, const struct input *g1, double length, unsigned regime,
                        int n_contacts, double *guess)
{
    int which = -1;
    for (int i = 0; i < n_contacts; i++) {
        bool closed = (regime >> i) & 1u;
        double s;
        if (!switch_suspected(&g0[i], &g1[i], length, closed))
            continue;
        s = switch_guess(&g0[i], &g1[i], length, closed);
        if (s >= 0.0 && (which < 0 || s < *guess)) {
            which = i;
            *guess = s;
        }
    }
    return which;
}

/* The contact beside `last` that went farthest beyond its switch between x (gaps g0) and x1 (gaps g). It went
 * by more than rounding, so it switched before. -1 when there is none. */
static int earlier_switch(const struct model *m, const double *x1, const struct input *g0,
                          const struct input *g, unsigned regime, int last)
{
    int which = -1;
    double most = gap_rounding(m, x1);
    for (int i = 0; i < m->n_contacts; i++) {
        double sign = (regime >> i) & 1u ? 1.0 : -1.0;
        if (i != last && sign * g0[i].value < 0.0 && sign * g[i].value > most) {
            which = i;
            most = sign * g[i].value;
        }
    }
    return which;
}

/* The first switch, from the contact c->contact and the instant `guess`. A guess has the error of a cubic.
 * When two contacts switch nearly at once, it may be that of the later one. */
static void sharpen_first(const struct switch_stepper *by, const struct segment *e, unsigned regime,
                          double guess, const struct input *g0, const double *x, double *x1,
                          struct crossing *c)
{
    struct bracket b = {0.0, e->length, guess};
    struct input g[MODEL_CONTACTS];
    int next = c->contact;
    for (int i = 0; i < by->m->n_contacts && next >= 0; i++) {
        c->contact = next;
        c->residual = !sharpen(by, e, next, (regime >> next) & 1u, &b, x, x1, g);
        c->done = b.s;
        b = (struct bracket){0.0, b.s, b.s};
        next = earlier_switch(by->m, x1, g0, g, regime, next);
    }
}

enum step_status switch_locate(const struct switch_stepper *by, const struct segment *e, unsigned regime,
                               double *x, struct crossing *c)
{
    const struct model *m = by->m;
    struct input g0[MODEL_CONTACTS], g1[MODEL_CONTACTS];
    double x1[MODEL_STATES];
    double guess = 0.0;
    by->advance(m, by->p, by->scratch, e, x, x1);
    m->gap(by->p, e->at[0], x, g0);
    m->gap(by->p, e->at[2], x1, g1);
    int which = first_switch(g0, g1, e->length, regime, m->n_contacts, &guess);
    if (which >= 0) {
        c->contact = which;
        sharpen_first(by, e, regime, guess, g0, x, x1, c);
    }
    memcpy(x, x1, (size_t)m->n_states * sizeof *x);
    return which >= 0 ? STEP_SWITCH : STEP_END;
}
