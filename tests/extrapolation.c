/* extrapolation.c - see extrapolation.h. */
#include "tests/extrapolation.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { COLUMNS = 9, COLUMNS_MIN = 4, ROUNDS = 80, HALVINGS = 90, SAMPLES = 16 };

typedef long double state[EXTRAPOLATION_STATES];

/* The modified midpoint rule with 2 m steps over h. */
static void midpoint(const struct extrapolation *e, long double h, int m, state y)
{
    state before, now, slope;
    long double s = h / (2 * m);
    memcpy(before, e->x, sizeof before);
    e->rhs(e->context, e->regime, e->t, before, slope);
    for (int k = 0; k < e->n; k++)
        now[k] = before[k] + s * slope[k];
    for (int i = 1; i < 2 * m; i++) {
        e->rhs(e->context, e->regime, e->t + i * s, now, slope);
        for (int k = 0; k < e->n; k++) {
            long double next = before[k] + 2 * s * slope[k];
            before[k] = now[k];
            now[k] = next;
        }
    }
    e->rhs(e->context, e->regime, e->t + h, now, slope);
    for (int k = 0; k < e->n; k++)
        y[k] = 0.5L * (now[k] + before[k] + s * slope[k]);
}

/* The last correction of row j, relative to what is allowed. */
static long double excess(const struct extrapolation *e, const state better, const state good)
{
    long double worst = 0.0L;
    for (int k = 0; k < e->n; k++) {
        int half = 2 * k >= e->n;
        long double scale = fmaxl(e->most[half], e->least[half]);
        long double allowed = e->error * scale + 4e-19L * fabsl(better[k]);
        worst = fmaxl(worst, fabsl(better[k] - good[k]) / allowed);
    }
    return worst;
}

/* The state h later into y; how many columns that took, 0: it did not converge. */
static int attempt(const struct extrapolation *e, long double h, state y)
{
    state table[COLUMNS], fresh, older;
    for (int j = 0; j < COLUMNS; j++) {
        midpoint(e, h, j + 1, fresh);
        for (int i = 0; i < j; i++) {
            long double ratio = (long double)(j + 1) / (j - i);
            memcpy(older, table[i], sizeof older);
            memcpy(table[i], fresh, sizeof fresh);
            for (int k = 0; k < e->n; k++)
                fresh[k] += (fresh[k] - older[k]) / (ratio * ratio - 1);
        }
        memcpy(table[j], fresh, sizeof fresh);
        if (j + 1 >= COLUMNS_MIN && excess(e, fresh, table[j - 1]) <= 1.0L) {
            memcpy(y, fresh, sizeof fresh);
            return j + 1;
        }
    }
    return 0;
}

/* ---- switches ---- */

struct look {
    long double gap[EXTRAPOLATION_GAPS], rate[EXTRAPOLATION_GAPS];
};

static void look(const struct extrapolation *e, long double h, const state x, struct look *l)
{
    e->gap(e->context, e->t + h, x, l->gap, l->rate);
}

static int side(const struct extrapolation *e, int i)
{
    return (e->regime >> i) & 1u ? -1 : 1;
}

/* Has contact i left its regime at the end, or perhaps in between, where it comes near zero and turns? */
static bool left(const struct extrapolation *e, int i, const struct look *end)
{
    return side(e, i) * end->gap[i] < 0.0L;
}

static bool grazes(const struct extrapolation *e, int i, long double h, const struct look *a,
                   const struct look *b)
{
    long double s = side(e, i), d0 = s * a->rate[i] * h, d1 = s * b->rate[i] * h;
    long double g0 = s * a->gap[i], g1 = s * b->gap[i], least = g1;
    if (!(d0 < 0.0L && d1 > 0.0L))
        return false;
    for (int k = 1; k < SAMPLES; k++) {
        long double u = (long double)k / SAMPLES, v = 1 - u;
        long double value =
            g0 * v * v * (1 + 2 * u) + g1 * u * u * (3 - 2 * u) + d0 * u * v * v - d1 * u * u * v;
        least = fminl(least, value);
    }
    return least < 0.02L * (d1 - d0);
}

/* Where contact i leaves its regime within h: the end of the bracket behind it, by Illinois' rule; y is the state there. */
static long double locate(const struct extrapolation *e, int i, long double h, const struct look *a, state y)
{
    struct look l;
    long double lo = 0.0L, hi = h, flo = side(e, i) * a->gap[i], fhi;
    int stuck = 0;
    look(e, hi, y, &l);
    fhi = side(e, i) * l.gap[i];
    for (int round = 0; round < ROUNDS && hi - lo > 1e-19L * e->t + 1e-17L * h; round++) {
        state z;
        long double at = flo > 0.0L ? (lo * fhi - hi * flo) / (fhi - flo) : 0.5L * (lo + hi);
        if (!(at > lo && at < hi))
            at = 0.5L * (lo + hi);
        if (!attempt(e, at, z))
            at = 0.5L * (lo + hi);
        if (!attempt(e, at, z))
            break;
        look(e, at, z, &l);
        long double f = side(e, i) * l.gap[i];
        if (f > 0.0L) {
            fhi *= stuck > 0 ? 0.5L : 1.0L;
            stuck = 1;
            lo = at;
            flo = f;
        } else {
            flo *= stuck < 0 ? 0.5L : 1.0L;
            stuck = -1;
            hi = at;
            fhi = f;
            memcpy(y, z, sizeof z);
        }
    }
    return hi;
}

/* ---- the motion ---- */

static void measure(struct extrapolation *e)
{
    for (int k = 0; k < e->n; k++) {
        long double deviation = fabsl(e->x[k] - e->rest[k]);
        int half = 2 * k >= e->n;
        e->most[half] = fmaxl(e->most[half], deviation);
    }
}

void extrapolation_start(struct extrapolation *e)
{
    struct look l;
    look(e, 0.0L, e->x, &l);
    e->regime = 0;
    for (int i = 0; i < e->n_gaps; i++)
        e->regime |= (l.gap[i] < 0.0L ? 1u : 0u) << i;
    e->most[0] = e->most[1] = 0.0L;
    e->step = e->step_max;
    measure(e);
}

/* One step of h at most, its state into y: cut where the first contact switches. *which: that contact, or -1. */
static long double take(struct extrapolation *e, long double h, state y, int *which, int *columns)
{
    struct look a, b;
    look(e, 0.0L, e->x, &a);
    for (int halving = 0; halving < HALVINGS; halving++, h *= 0.5L) {
        bool near = false;
        *which = -1;
        *columns = attempt(e, h, y);
        if (!*columns)
            continue;
        look(e, h, y, &b);
        for (int i = 0; i < e->n_gaps; i++) {
            near |= h > 1e-9L * e->step_max && side(e, i) * a.gap[i] > 0.0L && !left(e, i, &b) &&
                    grazes(e, i, h, &a, &b);
            if (*which < 0 && left(e, i, &b))
                *which = i;
        }
        if (!near)
            break;
    }
    if (!*columns)
        e->failures++;
    for (int i = *which; i >= 0 && i < e->n_gaps; i++) { /* each later one only if it is earlier */
        look(e, h, y, &b);
        if (!left(e, i, &b))
            continue;
        h = locate(e, i, h, &a, y);
        *which = i;
    }
    return h;
}

void extrapolation_run(struct extrapolation *e, long double end)
{
    while (e->t < end) {
        state y;
        int which, columns;
        long double rest = end - e->t, wanted = fminl(e->step, e->step_max);
        bool last = wanted >= rest;
        long double h = take(e, last ? rest : wanted, y, &which, &columns);
        memcpy(e->x, y, sizeof y);
        last = last && h == rest;
        e->t = last ? end : e->t + h;
        measure(e);
        if (which >= 0) {
            e->regime ^= 1u << which;
            e->switches++;
            e->step = 1e-3L * e->step_max;
        } else if (!last || h > e->step) {
            e->step = h * (columns < 6 ? 4.0L : columns < 8 ? 1.5L : 1.0L);
        }
    }
}
