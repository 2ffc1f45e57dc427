/* exact_root.c - where a gap leaves its regime, on the closed form itself. */
#include "firmware/exact_series.h"

#include <float.h>
#include <math.h>

enum {
    ROOT_STEPS =
        40 /* 3 are usual; bisections, where the third-order step leaves the bracket, are among them */
};

/* The gap over theta, signed so that it is negative while the regime holds. */
struct polynomial {
    int order;
    double c[EXACT_TERMS];
};

/* Value and derivatives. */
struct jet {
    double f, d, dd;
};

static struct jet jet_at(const struct polynomial *q, int order, double theta)
{
    double f = q->c[order], d = 0.0, half_dd = 0.0;
    for (int n = order - 1; n >= 0; n--) {
        half_dd = half_dd * theta + d;
        d = d * theta + f;
        f = f * theta + q->c[n];
    }
    return (struct jet){f, d, 2.0 * half_dd};
}

/* Through a rising zero: the step to the lower root of the parabola through the jet. Third order, and right for the
 * two close roots of a grazing contact too. 0 when the parabola has none. */
static double step_to_zero(const struct jet *j)
{
    double disc = j->d * j->d - 2.0 * j->f * j->dd;
    if (!(disc > 0.0))
        return 0.0;
    double w = sqrt(disc);
    return j->d >= 0.0 ? -2.0 * j->f / (j->d + w) : (w - j->d) / j->dd;
}

/* The first quarter of the span that ends across zero: its ends, and where the secant crosses. A contact may leave,
 * return and leave again in one span; the end alone would show the last of these. */
static bool find_quarter(const struct polynomial *q, double f1, double *lo, double *hi, double *t)
{
    double f[5] = {q->c[0], q->c[q->order], q->c[q->order], q->c[q->order], f1};
    for (int n = q->order - 1; n >= 0; n--) {
        f[1] = f[1] * 0.25 + q->c[n];
        f[2] = f[2] * 0.5 + q->c[n];
        f[3] = f[3] * 0.75 + q->c[n];
    }
    for (int i = 1; i <= 4; i++) {
        if (f[i] >= 0.0) {
            *lo = 0.25 * (i - 1);
            *hi = 0.25 * i;
            *t = f[i] > f[i - 1] ? *lo + 0.25 * f[i - 1] / (f[i - 1] - f[i]) : *hi;
            return true;
        }
    }
    return false;
}

/* The gap is on its side at both ends. Does it dip across zero in between? Then an instant there.
 * falls: its rate at the end is negative. */
static bool find_dip(const struct polynomial *q, bool falls, double *inside)
{
    double lo = 0.0, hi = 1.0, t = 0.5;
    bool rises = q->c[1] > 0.0;
    for (int i = 0; i < ROOT_STEPS; i++) {
        struct jet j = jet_at(q, q->order, t);
        if (j.f >= 0.0) {
            *inside = t;
            return true;
        }
        /* Half-way: where the rate goes from plus to minus, if anywhere. */
        if (i == 0 && !((rises && falls) || (j.d > 0.0 ? falls : rises)))
            return false;
        if (j.d > 0.0)
            lo = t;
        else
            hi = t;
        double next = t - j.d / j.dd;
        if (!(j.dd < 0.0 && next > lo && next < hi))
            next = 0.5 * (lo + hi);
        /* This is the extremum, to rounding in its value, and it stays short of zero. */
        if (fabs(next - t) <= 1e-9)
            return false;
        t = next;
    }
    return false;
}

/* f(lo) < 0 <= f(hi). */
static void sharpen(const struct polynomial *q, double reach, double lo, double hi, double t,
                    struct exact_root *root)
{
    for (int i = 0; i < ROOT_STEPS; i++) {
        int order = exact_order(reach * t);
        struct jet j = jet_at(q, order < q->order ? order : q->order, t);
        if (j.f < 0.0)
            lo = t;
        else
            hi = t;
        double move = step_to_zero(&j), next = t + move;
        bool inside = next >= lo && next <= hi && (move != 0.0 || j.f == 0.0);
        if (!inside)
            next = 0.5 * (lo + hi);
        /* The step's error is of third order in it: this one is the last. */
        if ((inside && fabs(move) <= 1e-6) || hi - lo <= 2.0 * DBL_EPSILON * hi) {
            *root = (struct exact_root){next, true};
            return;
        }
        t = next;
    }
    *root = (struct exact_root){t, false};
}

/* The gap's series, and what rounding leaves of a zero. */
static double gap_series(const struct exact *w, int contact, double sign, int order, struct polynomial *q)
{
    const struct exact_gap *g = &w->gap[contact];
    double slope = sign * g->slope;
    double position = fabs(w->term[0][g->position]), velocity = fabs(w->term[0][EXACT_LANES + g->position]);
    q->order = order;
    for (int n = 0; n <= order; n++)
        q->c[n] = slope * w->term[n][g->position];
    q->c[0] += sign * g->constant;
    return 8.0 * DBL_EPSILON * (fabs(g->constant) + fabs(slope) * (position + w->h * velocity));
}

bool exact_first_root(const struct exact *w, int contact, bool closed, double reach, const struct input *end,
                      struct exact_root *root)
{
    struct polynomial q;
    double sign = closed ? 1.0 : -1.0, f1 = sign * end->value, d1 = sign * end->rate;
    int order = exact_order(reach);
    double rounding = gap_series(w, contact, sign, order, &q);
    double lo, hi, t;
    *root = (struct exact_root){0.0, true};
    /* Already across, or on its way from zero: two contacts that switch together, or a state that was set. */
    if (q.c[0] > rounding || (q.c[0] >= -rounding && q.c[1] > 0.0))
        return true;
    /* Just switched, on its way inwards: theta = 0 is that switch. The next is the first zero of gap/theta. */
    if (q.c[0] >= -rounding) {
        f1 -= q.c[0];
        d1 -= f1;
        for (int n = 0; n < order; n++)
            q.c[n] = q.c[n + 1];
        q.order--;
    }
    if (find_quarter(&q, f1, &lo, &hi, &t)) {
        sharpen(&q, reach, lo, hi, t, root);
        return true;
    }
    if (!find_dip(&q, d1 < 0.0, &t))
        return false;
    sharpen(&q, reach, 0.0, t, t, root);
    return true;
}
