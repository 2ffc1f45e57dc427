/* taylor_short.c - one tick whose inputs are new and straight lines: a series of low order, read once at its end.
 *
 * A plant in a loop gets a new input each tick: a long series would be thrown away after a small part of its reach. Time
 * is in ticks, so that the coefficients are the terms themselves: their sum is the state, their tail the error. */
#include <math.h>
#include "firmware/taylor_piece.h"

enum { ORDER = 8, LAST = ORDER - 2 };

/* (5/2) j/n - 1 */
#define HALF(j, n) ((5.0 * (j)-2.0 * (n)) / (2.0 * (n)))

/* Lane l: constant + slope t. */
struct line {
    double constant[2], slope[2];
};

/* False when an input is harmonic. */
static bool lines_of(const struct taylor_lanes *lanes, const struct excitation *e, struct line *line)
{
    *line = (struct line){{lanes->base[0], lanes->base[1]}, {0.0, 0.0}};
    unsigned active = e->active;
    for (int i = 0; active != 0; i++, active >>= 1) {
        const struct wave *w = &e->wave[i];
        if (!(active & 1u))
            continue;
        if (w->amplitude != 0.0 || w->growth != 0.0)
            return false;
        int end = (int)lanes->first[i + 1];
        for (int k = (int)lanes->first[i]; k < end; k++) {
            const struct taylor_term *term = &lanes->term[k];
            int l = (int)term->lane;
            line->constant[l] += term->value * w->offset + term->rate * w->slope;
            line->slope[l] += term->value * w->slope;
        }
    }
    return true;
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

/* The terms of eta over a tick of length h. */
ALWAYS_INLINE void expand(const struct taylor_lanes *lanes, const struct line *line, bool closed, double h,
                          double *e)
{
    double f[ORDER], g[2] = {line->constant[0], line->slope[0] * h}, square = h * h;
    double damping = lanes->damping * h, k0 = line->constant[1], k1 = line->slope[1] * h;
    double inverse = closed ? 1.0 / e[0] : 0.0, e1_inverse = e[1] * inverse, root = closed ? sqrt(e[0]) : 0.0;
    TAYLOR_UNROLL
    for (int n = 0; n <= LAST; n++) {
        double a = (n < 2 ? g[n] : 0.0) - lanes->stiffness * e[n];
        if (closed) {
            f[n] = n == 0 ? e[0] * root : force(e, f, n, inverse, e1_inverse, root);
            a -= k0 * f[n] + (n > 0 ? k1 * f[n - 1] : 0.0);
        }
        e[n + 2] = a * (square * (1.0 / ((n + 1) * (n + 2)))) - (damping * (1.0 / (n + 2))) * e[n + 1];
    }
}

bool taylor_short(struct taylor *t, const struct excitation *e)
{
    struct line line;
    double h = e->length, term[ORDER + 1] = {t->eta, t->rate * h};
    bool closed = t->closed != 0.0;
    if (t->contact == 0.0 || closed != (t->eta > 0.0) || !lines_of(&t->lanes, e, &line))
        return false;
    double tail = t->tol * (fabs(t->eta) > 1.0 ? fabs(t->eta) : 1.0) * h;
    if (closed)
        expand(&t->lanes, &line, true, h, term);
    else
        expand(&t->lanes, &line, false, h, term);
    double change = 0.0, speed = 0.0,
           most = 0.0; /* the newest term last: the others are there while it is on its way */
    TAYLOR_UNROLL
    for (int n = 2; n <= ORDER; n++) {
        change += term[n];
        speed += n * term[n];
        most += fabs(term[n]);
    }
    /* Away from zero all the way, and the last terms of the rate below the tolerance. */
    double end = term[0] + term[1], nearest = fabs(end) < fabs(term[0]) ? end : term[0];
    if ((end > 0.0) != closed || !(most < fabs(nearest)) || !(tail_of(term, ORDER) <= tail))
        return false;
    t->eta = end + change;
    t->rate += speed * (1.0 / h);
    return true;
}
