/* taylor_short.c - one tick by a series of low order, read once at its end.
 *
 * A plant in a loop gets a new input each tick: a long series would be thrown away after a small part of its reach. And
 * where a long series reaches only a few ticks, a short one in every tick costs less. Time is in ticks, so that the
 * coefficients are the terms themselves: their sum is the state, their tail the error. */
#include <math.h>
#include "firmware/taylor_piece.h"

/* The terms above FIRST where it does not meet the tolerance. */
enum { FIRST = 8, ORDER = 10, LAST = ORDER - 2 };

/* A long series is cheaper where it reaches further than this many ticks. */
#define MANY 4.0
/* Its reach in ticks is about (tolerance/tail^2)^(1/16), tail that of the first terms here: MANY^-16. */
#define EASY 2.3e-10

/* (5/2) j/n - 1 */
#define HALF(j, n) ((5.0 * (j)-2.0 * (n)) / (2.0 * (n)))

/* The load over the tick: lane l, order n; orders beyond the first only with tones. */
enum shape { STRAIGHT, FORCE_TURNS, STIFFNESS_TURNS };
struct load {
    double lane[2][LAST + 1];
    enum shape shape;
};

static void begin_tones(struct load *load)
{
    TAYLOR_UNROLL
    for (int n = 2; n <= LAST; n++)
        load->lane[0][n] = load->lane[1][n] = 0.0;
    load->shape = FORCE_TURNS;
}

/* The tone p, q: p' = turn q, q' = -turn p. */
ALWAYS_INLINE void add_tone(double p, double q, double turn, int orders, double *lane)
{
    taylor_pair z = {p, q}, omega = {turn, -turn};
    TAYLOR_UNROLL
    for (int n = 0; n <= orders; n++) {
        lane[n] += z[0];
        z = (taylor_pair){z[1], z[0]} * (taylor_both(1.0 / (n + 1)) * omega);
    }
}

static void add_wave(const struct taylor_lanes *lanes, int i, const struct wave *w, double h,
                     struct load *load)
{
    int end = (int)lanes->first[i + 1];
    for (int k = (int)lanes->first[i]; k < end; k++) {
        const struct taylor_term *term = &lanes->term[k];
        double *lane = load->lane[(int)term->lane];
        lane[0] += term->value * w->offset + term->rate * w->slope;
        lane[1] += term->value * w->slope * h;
        if (w->amplitude == 0.0 && w->growth == 0.0)
            continue;
        struct taylor_tone t = taylor_tone_of(term, w);
        if (load->shape == STRAIGHT)
            begin_tones(load);
        if (t.lane == 1)
            load->shape = STIFFNESS_TURNS;
        add_tone(t.p, t.q, t.omega * h, LAST, lane);
        if (w->growth != 0.0)
            add_tone(t.tp * h, t.tq * h, t.omega * h, LAST - 1, lane + 1);
    }
}

/* F_n of F = eta^{3/2}, as in taylor_series.c; what holds the newest terms comes last. */
ALWAYS_INLINE double force(const double *e, const double *f, int n, double inverse, double e1_inverse,
                           double root)
{
    double older = 0.0, newest = (HALF(1, n) * e1_inverse) * f[n - 1];
    TAYLOR_UNROLL
    for (int j = 3; j < n; j++)
        older += (HALF(j, n) * e[j]) * f[n - j];
    if (n > 2)
        older += (HALF(2, n) * e[2]) * f[n - 2];
    if (n > 1)
        newest += (HALF(n, n) * root) * e[n];
    return older * inverse + newest;
}

/* The last two terms of the rate, over a tick. */
ALWAYS_INLINE double tail_of(const double *e, int order)
{
    return order * fabs(e[order]) + (order - 1) * fabs(e[order - 1]);
}

/* sum_{j=2..n} k_j F_{n-j} */
ALWAYS_INLINE double product(const double *k, const double *f, int n)
{
    double sum = 0.0;
    TAYLOR_UNROLL
    for (int j = 2; j <= n; j++)
        sum += k[j] * f[n - j];
    return sum;
}

struct terms {
    double e[ORDER + 1]; /* eta */
    double f[ORDER - 1]; /* eta^{3/2} */
    double inverse, root;
};

/* The terms of eta over a tick of length h: orders from + 2 to `order`. */
ALWAYS_INLINE void expand(const struct taylor_lanes *lanes, const struct load *load, bool closed,
                          enum shape shape, double h, int from, int order, struct terms *t)
{
    const double *g = load->lane[0], *k = load->lane[1];
    double *e = t->e, *f = t->f, square = h * h, damping = lanes->damping * h;
    if (closed && from == 0) {
        t->inverse = 1.0 / e[0];
        t->root = sqrt(e[0]);
    }
    double inverse = closed ? t->inverse : 0.0, e1_inverse = e[1] * inverse, root = closed ? t->root : 0.0;
    TAYLOR_UNROLL
    for (int n = from; n <= order - 2; n++) {
        double a = (n < 2 || shape != STRAIGHT ? g[n] : 0.0) - lanes->stiffness * e[n];
        if (closed) {
            double older = n > 0 ? k[1] * f[n - 1] : 0.0;
            if (shape == STIFFNESS_TURNS)
                older += product(k, f, n);
            f[n] = n == 0 ? e[0] * root : force(e, f, n, inverse, e1_inverse, root);
            a -= k[0] * f[n] + older;
        }
        e[n + 2] = a * (square * (1.0 / ((n + 1) * (n + 2)))) - (damping * (1.0 / (n + 2))) * e[n + 1];
    }
}

/* The first terms, or those that follow them. */
ALWAYS_INLINE void expand_part(const struct taylor_lanes *lanes, const struct load *load, bool closed,
                               double h, bool more, struct terms *t)
{
    int from = more ? FIRST - 1 : 0, order = more ? ORDER : FIRST;
    if (load->shape == STRAIGHT)
        expand(lanes, load, closed, STRAIGHT, h, from, order, t);
    else if (load->shape == FORCE_TURNS || !closed)
        expand(lanes, load, closed, FORCE_TURNS, h, from, order, t);
    else
        expand(lanes, load, closed, STIFFNESS_TURNS, h, from, order, t);
}

static void expand_flight(const struct taylor_lanes *lanes, const struct load *load, double h,
                          struct terms *t)
{
    expand_part(lanes, load, false, h, false, t);
}

static void expand_contact(const struct taylor_lanes *lanes, const struct load *load, double h,
                           struct terms *t)
{
    expand_part(lanes, load, true, h, false, t);
}

NEVER_INLINE void expand_more(const struct taylor_lanes *lanes, const struct load *load, bool closed,
                              double h, struct terms *t)
{
    if (closed)
        expand_part(lanes, load, true, h, true, t);
    else
        expand_part(lanes, load, false, h, true, t);
}

static void load_of(const struct taylor_lanes *lanes, const struct excitation *e, struct load *load)
{
    unsigned active = e->active;
    load->shape = STRAIGHT;
    load->lane[0][0] = lanes->base[0];
    load->lane[1][0] = lanes->base[1];
    load->lane[0][1] = load->lane[1][1] = 0.0;
    for (int i = 0; active != 0; i++, active >>= 1)
        if (active & 1u)
            add_wave(lanes, i, &e->wave[i], e->length, load);
}

/* The error, per model time and relative where eta is large, that a series may leave at its end. */
static double allowed(const struct taylor *t)
{
    return t->tol * (fabs(t->eta) > 1.0 ? fabs(t->eta) : 1.0);
}

/* Of the terms from the second on: the changes of eta and of its rate times h, and how far eta may be from a straight line. */
struct sums {
    double change, speed, most;
};

/* The newest term last: the others are there while it is on its way. */
ALWAYS_INLINE void add_terms(struct sums *sums, const double *e, int from, int order)
{
    TAYLOR_UNROLL
    for (int n = from; n <= order; n++) {
        sums->change += e[n];
        sums->speed += n * e[n];
        sums->most += fabs(e[n]);
    }
}

bool taylor_short(struct taylor *t, const struct excitation *e)
{
    struct load load;
    struct terms terms;
    struct sums sums = {0.0, 0.0, 0.0};
    double h = e->length, begin = t->eta, end = begin + t->rate * h;
    double nearest = fabs(end) < fabs(begin) ? end : begin;
    bool closed = t->closed != 0.0;
    t->brief = 0.0;
    if (t->contact == 0.0 || closed != (begin > 0.0) || closed != (end > 0.0) || h == 0.0)
        return false;
    if (!(fabs(nearest) > h * h)) /* the forces of a tick may carry it to zero: not worth a try */
        return false;
    load_of(&t->lanes, e, &load);
    terms.e[0] = begin;
    terms.e[1] = t->rate * h;
    (closed ? expand_contact : expand_flight)(&t->lanes, &load, h, &terms);
    add_terms(&sums, terms.e, 2, FIRST);
    double tail = tail_of(terms.e, FIRST), most_tail = allowed(t) * h;
    bool brief = tail * tail > EASY * h * most_tail;
    if (sums.most < fabs(nearest) && tail > most_tail) {
        expand_more(&t->lanes, &load, closed, h, &terms);
        add_terms(&sums, terms.e, FIRST + 1, ORDER);
        tail = tail_of(terms.e, ORDER);
    }
    /* Away from zero all the way, and the last terms of the rate below the tolerance. */
    if (!(sums.most < fabs(nearest)) || !(tail <= most_tail))
        return false;
    t->brief = brief ? 1.0 : 0.0;
    t->eta = end + sums.change;
    t->rate += sums.speed * (1.0 / h);
    t->root = -1.0;
    t->kind = TAYLOR_NONE;
    return true;
}

bool taylor_is_brief(const struct taylor *t, double h)
{
    double h2 = h * h, h6 = h2 * h2 * h2;
    if (t->contact == 0.0 || t->kind != TAYLOR_TIME || t->event != 0.0 || t->end > MANY * h)
        return false;
    return (8.0 * fabs(t->a[8]) * h + 7.0 * fabs(t->a[7])) * h6 <= allowed(t);
}
