/* taylor_short.c - one tick by a series of low order, read once at its end.
 *
 * A plant in a loop gets a new input each tick, and a long series would be used for a small part of its reach
 * only. And where a long series reaches a few ticks, a short one in every tick costs less. Time is in ticks,
 * so that the coefficients are the terms themselves: their sum is the state, their tail the error. */
#include "firmware/method/taylor/taylor_short.h"

#include <math.h>
#include "firmware/method/taylor/taylor_load.h"

/* Orders tried one after the other until one meets the tolerance. */
enum { FIRST = 8, SECOND = 10, ORDER = 12, LAST = ORDER - 2 };

/* A long series is cheaper where it reaches further than this many ticks. */
#define MANY       4.0
#define MANY_CUBIC 8.0 /* for a polynomial force */
/* For a polynomial force with a modulation: its long series are convolutions in four lanes. */
#define MANY_MODULATED 20.0
/* Its reach in ticks is about (tolerance/tail^2)^(1/16), tail that of the first terms here: MANY^-16. */
#define EASY 2.3e-10

/* (5/2) j/n - 1 */
#define HALF(j, n) ((5.0 * (j)-2.0 * (n)) / (2.0 * (n)))

/* F_n of F = eta^{3/2}, as in taylor_series.c, n > 0; what holds the newest terms comes last. */
ALWAYS_INLINE double force(const double *e, const double *f, int n, double inverse, double e1_inverse,
                           double root)
{
    double newest = (HALF(1, n) * e1_inverse) * f[n - 1];
    if (n > 1)
        newest += (HALF(n, n) * root) * e[n];
    if (n < 3)
        return newest;
    double older = (HALF(n - 1, n) * e[n - 1]) * f[1];
    TAYLOR_UNROLL
    for (int j = n - 2; j >= 2; j--)
        if (5 * j != 2 * n) /* a weight of zero */
            older += (HALF(j, n) * e[j]) * f[n - j];
    return older * inverse + newest;
}

/* sum_{j=0..n} k_j F_{n-j} */
ALWAYS_INLINE double product(const double *k, const double *f, int n)
{
    double sum = k[n] * f[0];
    TAYLOR_UNROLL
    for (int j = n - 1; j >= 0; j--)
        sum += k[j] * f[n - j];
    return sum;
}

/* The terms over a tick: e of eta, u = n e of its rate, f of the force. */
struct terms {
    double e[ORDER + 1], u[ORDER + 1];
    double f[LAST + 1];
    double inverse, root; /* 1/e[0], and sqrt(e[0]) times a constant stiffness */
};

/* The terms of orders from + 2 to `order` over a tick of length h. */
ALWAYS_INLINE void expand(const struct taylor_lanes *lanes, const struct taylor_short_load *load, bool closed,
                          bool modulated, double h, int from, int order, struct terms *t)
{
    const double *g = load->lane[0], *k = load->lane[1];
    double *e = t->e, *u = t->u, *f = t->f, square = h * h, damping = lanes->damping * h;
    if (closed && from == 0) {
        t->inverse = 1.0 / e[0];
        t->root = modulated ? sqrt(e[0]) : k[0] * sqrt(e[0]);
        f[0] = e[0] * t->root;
    }
    double inverse = closed ? t->inverse : 0.0, e1_inverse = e[1] * inverse, root = closed ? t->root : 0.0;
    TAYLOR_UNROLL
    for (int n = from; n <= order - 2; n++) {
        double a = g[n] - lanes->stiffness * e[n];
        if (closed && n > 0)
            f[n] = force(e, f, n, inverse, e1_inverse, root);
        if (closed)
            a -= modulated ? product(k, f, n) : f[n];
        a = a * square - damping * u[n + 1];
        u[n + 2] = a * (1.0 / (n + 1));
        e[n + 2] = a * (1.0 / ((n + 1) * (n + 2)));
    }
}

ALWAYS_INLINE void expand_part(const struct taylor_lanes *lanes, const struct taylor_short_load *load,
                               bool closed, double h, int from, int order, struct terms *t)
{
    if (!closed)
        expand(lanes, load, false, false, h, from, order, t);
    else if (load->modulated)
        expand(lanes, load, true, true, h, from, order, t);
    else
        expand(lanes, load, true, false, h, from, order, t);
}

/* The last two terms of the rate, over a tick. */
ALWAYS_INLINE double tail_of(const struct terms *t, int order)
{
    return fabs(t->u[order]) + fabs(t->u[order - 1]);
}

/* Sums of the terms from the second on: the changes of eta and of its rate times h, and how far eta may be
 * from a straight line. */
struct sums {
    double change, speed, most;
};

/* The newest term last: the others are there while it is on its way. */
ALWAYS_INLINE void add_terms(struct sums *sums, const struct terms *t, int from, int order)
{
    TAYLOR_UNROLL
    for (int n = from; n <= order; n++) {
        sums->change += t->e[n];
        sums->speed += t->u[n];
        sums->most += fabs(t->e[n]);
    }
}

/* Two orders more; the tail of these. */
NEVER_INLINE double expand_second(const struct taylor_lanes *lanes, const struct taylor_short_load *load,
                                  bool closed, double h, struct terms *t, struct sums *sums)
{
    expand_part(lanes, load, closed, h, FIRST - 1, SECOND, t);
    add_terms(sums, t, FIRST + 1, SECOND);
    return tail_of(t, SECOND);
}

NEVER_INLINE double expand_last(const struct taylor_lanes *lanes, const struct taylor_short_load *load,
                                bool closed, double h, struct terms *t, struct sums *sums)
{
    expand_part(lanes, load, closed, h, SECOND - 1, ORDER, t);
    add_terms(sums, t, SECOND + 1, ORDER);
    return tail_of(t, ORDER);
}

bool taylor_short(struct taylor *t, const struct segment *e)
{
    struct taylor_short_load load;
    struct terms terms;
    double h = e->length, begin = t->eta, end = begin + t->rate * h;
    bool closed = t->closed;
    double nearest = closed == (end < begin) ? end : begin, clear = closed ? nearest : -nearest;
    t->brief = false;
    if (h == 0.0)
        return false;
    if (!(clear > h * h)) /* the forces of a tick may carry it to zero: not worth a try */
        return false;
    taylor_short_load(&t->lanes, e, e->active, 2, LAST, &load);
    terms.e[0] = begin;
    terms.e[1] = terms.u[1] = t->rate * h;
    expand_part(&t->lanes, &load, closed, h, 0, FIRST, &terms);
    struct sums sums = {terms.e[2], terms.u[2], fabs(terms.e[2])};
    add_terms(&sums, &terms, 3, FIRST);
    double tail = tail_of(&terms, FIRST), most_tail = taylor_short_allowed(t, h) * h;
    bool brief = tail * tail > EASY * h * (taylor_long_allowed(t) * h);
    if (sums.most < clear && tail > most_tail) {
        tail = expand_second(&t->lanes, &load, closed, h, &terms, &sums);
        t->count.further += SECOND - FIRST;
    }
    if (sums.most < clear && tail > most_tail) {
        tail = expand_last(&t->lanes, &load, closed, h, &terms, &sums);
        t->count.further += ORDER - SECOND;
    }
    /* Away from zero all the way, and the last terms of the rate below the tolerance. */
    if (!(sums.most < clear) || !(tail <= most_tail))
        return false;
    t->brief = brief;
    t->count.brief++;
    t->eta = end + sums.change;
    t->rate += sums.speed * (1.0 / h);
    t->root = -1.0;
    t->kind = TAYLOR_NONE;
    return true;
}

bool taylor_is_brief(const struct taylor *t, const struct segment *e)
{
    double h = e->length, h2 = h * h, h6 = h2 * h2 * h2;
    double many = t->contact                                     ? MANY
                  : taylor_modulating(&t->lanes, e->active) >= 0 ? MANY_MODULATED
                                                                 : MANY_CUBIC;
    if (t->kind != TAYLOR_TIME || t->event || t->end > many * h)
        return false;
    return (8.0 * fabs(t->a[8]) * h + 7.0 * fabs(t->a[7])) * h6 <= taylor_short_allowed(t, h);
}
