/* taylor_short.c - one tick by a series of low order, read once at its end.
 *
 * A plant in a loop gets a new input each tick: a long series would be thrown away after a small part of its reach. And
 * where a long series reaches only a few ticks, a short one in every tick costs less. Time is in ticks, so that the
 * coefficients are the terms themselves: their sum is the state, their tail the error. */
#include <math.h>
#include "firmware/taylor_piece.h"

enum { ORDER = 8, LAST = ORDER - 2 };

/* A long series is cheaper where it reaches further than this many ticks. */
#define MANY 4.0
/* Its reach in ticks is about (tolerance/tail^2)^(1/16), tail that of the short one: MANY^-16. */
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

/* The terms of eta over a tick of length h. */
ALWAYS_INLINE void expand(const struct taylor_lanes *lanes, const struct load *load, bool closed,
                          enum shape shape, double h, double *e)
{
    const double *g = load->lane[0], *k = load->lane[1];
    double f[ORDER], square = h * h, damping = lanes->damping * h;
    double inverse = closed ? 1.0 / e[0] : 0.0, e1_inverse = e[1] * inverse, root = closed ? sqrt(e[0]) : 0.0;
    TAYLOR_UNROLL
    for (int n = 0; n <= LAST; n++) {
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

static void expand_flight(const struct taylor_lanes *lanes, const struct load *load, double h, double *e)
{
    if (load->shape == STRAIGHT)
        expand(lanes, load, false, STRAIGHT, h, e);
    else
        expand(lanes, load, false, FORCE_TURNS, h, e);
}

static void expand_contact(const struct taylor_lanes *lanes, const struct load *load, double h, double *e)
{
    if (load->shape == STRAIGHT)
        expand(lanes, load, true, STRAIGHT, h, e);
    else if (load->shape == FORCE_TURNS)
        expand(lanes, load, true, FORCE_TURNS, h, e);
    else
        expand(lanes, load, true, STIFFNESS_TURNS, h, e);
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

bool taylor_short(struct taylor *t, const struct excitation *e)
{
    struct load load;
    double h = e->length, term[ORDER + 1] = {t->eta, t->rate * h};
    bool closed = t->closed != 0.0;
    double end = term[0] + term[1], nearest = fabs(end) < fabs(term[0]) ? end : term[0];
    t->brief = 0.0;
    if (t->contact == 0.0 || closed != (t->eta > 0.0) || closed != (end > 0.0) || h == 0.0)
        return false;
    if (!(fabs(nearest) > h * h)) /* the forces of a tick may carry it to zero: not worth a try */
        return false;
    load_of(&t->lanes, e, &load);
    (closed ? expand_contact : expand_flight)(&t->lanes, &load, h, term);
    double change = 0.0, speed = 0.0,
           most = 0.0; /* the newest term last: the others are there while it is on its way */
    TAYLOR_UNROLL
    for (int n = 2; n <= ORDER; n++) {
        change += term[n];
        speed += n * term[n];
        most += fabs(term[n]);
    }
    /* Away from zero all the way, and the last terms of the rate below the tolerance. */
    double tail = tail_of(term, ORDER), most_tail = allowed(t) * h;
    if (!(most < fabs(nearest)) || !(tail <= most_tail))
        return false;
    t->brief = tail * tail > EASY * h * most_tail ? 1.0 : 0.0;
    t->eta = end + change;
    t->rate += speed * (1.0 / h);
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
