/* exact_root.c - the instant at which a gap leaves its regime, on the closed form itself. */
#include "firmware/method/exact/exact_root.h"

#include <float.h>
#include <math.h>
#include "firmware/method/exact/exact_series.h"

enum {
    ROOT_STEPS =
        40 /* 2 are usual; bisections, where the third-order step leaves the bracket, are among them */
};

/* The gap over theta in [0, end], signed so that it is negative while the regime holds. */
struct polynomial {
    int n_terms; /* even */
    double end, c[EXACT_TERMS];
};

/* Value and derivatives. */
struct jet {
    double f, d, dd;
};

/* Horner's rule in theta^2, even and odd terms side by side: the chain has half the steps. */
ALWAYS_INLINE struct jet jet_of(const struct polynomial *q, int n_terms, double theta)
{
    double square = theta * theta;
    exact_pair f = exact_load(&q->c[n_terms - 2]), d = {0.0, 0.0}, half_dd = {0.0, 0.0};
    EXACT_UNROLL for (int n = n_terms - 4; n >= 0; n -= 2)
    {
        half_dd = half_dd * square + d;
        d = d * square + f;
        f = f * square + exact_load(&q->c[n]);
    }
    return (struct jet){f[0] + theta * f[1], f[1] + 2.0 * theta * (d[0] + theta * d[1]),
                        2.0 * d[0] + 6.0 * theta * d[1] + 8.0 * square * (half_dd[0] + theta * half_dd[1])};
}

/* One copy for the paths that come from the tables. */
static struct jet jet_at(const struct polynomial *q, double theta)
{
    return q->n_terms == 2 + EXACT_CURVE ? jet_of(q, 2 + EXACT_CURVE, theta) : jet_of(q, q->n_terms, theta);
}

/* The step to the lower root of the parabola through the jet. It is of third order, and right for the two
 * close roots of a grazing contact, too. 0 when the parabola has no root. */
static double step_to_zero(const struct jet *j)
{
    double disc = j->d * j->d - 2.0 * j->f * j->dd;
    if (!(disc > 0.0))
        return 0.0;
    double w = sqrt(disc);
    return j->d >= 0.0 ? -2.0 * j->f / (j->d + w) : (w - j->d) / j->dd;
}

/* A guess of the zero of f between points i - 1 and i of five: the secant, corrected by the next second
 * difference. */
static double guess(const double *f, int i)
{
    double rise = f[i] - f[i - 1];
    double bend = i > 1 ? rise - (f[i - 1] - f[i - 2]) : (f[2] - f[1]) - rise;
    double secant = -f[i - 1] / rise, t = secant + 0.5 * secant * (1.0 - secant) * bend / rise;
    return t >= 0.0 && t <= 1.0 ? t : secant;
}

/* Values at one, two and three quarters of the span. */
ALWAYS_INLINE void quarters(const struct polynomial *q, int n_terms, double quarter, double *f)
{
    exact_pair y[3];
    for (int i = 0; i < 3; i++)
        y[i] = exact_load(&q->c[n_terms - 2]);
    EXACT_UNROLL for (int n = n_terms - 4; n >= 0; n -= 2)
    {
        EXACT_UNROLL for (int i = 0; i < 3; i++) y[i] =
            y[i] * ((i + 1) * (i + 1) * quarter * quarter) + exact_load(&q->c[n]);
    }
    for (int i = 0; i < 3; i++)
        f[i] = y[i][0] + (i + 1) * quarter * y[i][1];
}

/* The first quarter of the span that ends across zero: its ends, and a guess of the zero. A contact may
 * leave, return and leave again in one span; the end alone would show the last of these only. */
static bool find_quarter(const struct polynomial *q, double last, double *lo, double *hi, double *t)
{
    double quarter = 0.25 * q->end, f[5] = {q->c[0], 0.0, 0.0, 0.0, last};
    if (q->n_terms == 2 + EXACT_CURVE)
        quarters(q, 2 + EXACT_CURVE, quarter, &f[1]);
    else
        quarters(q, q->n_terms, quarter, &f[1]);
    for (int i = 1; i <= 4; i++) {
        if (f[i] >= 0.0) {
            *lo = quarter * (i - 1);
            *hi = quarter * i;
            *t = f[i] > f[i - 1] ? *lo + quarter * guess(f, i) : *hi;
            return true;
        }
    }
    return false;
}

/* The gap is on its side at both ends. Does it dip across zero in between? Then an instant there.
 * falls: its rate at the end is negative. */
static bool find_dip(const struct polynomial *q, bool falls, double *inside)
{
    double lo = 0.0, hi = q->end, t = 0.5 * hi;
    bool rises = q->c[1] > 0.0;
    for (int i = 0; i < ROOT_STEPS; i++) {
        struct jet j = jet_at(q, t);
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
static void sharpen(const struct polynomial *q, double lo, double hi, double t, struct exact_root *root)
{
    for (int i = 0; i < ROOT_STEPS; i++) {
        struct jet j = jet_at(q, t);
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
static double gap_series(const struct exact_path *path, const struct exact_gap *gap, double sign,
                         struct polynomial *q)
{
    double slope = sign * gap->slope;
    const double *c = path->c[gap->position];
    q->n_terms = path->n_terms;
    q->end = path->end;
    for (int n = 0; n < path->n_terms; n += 2)
        exact_store(&q->c[n], exact_load(&c[n]) * slope);
    q->c[0] += sign * gap->constant;
    return 8.0 * DBL_EPSILON * (fabs(gap->constant) + fabs(slope) * (fabs(c[0]) + fabs(c[1])));
}

/* gap / theta, with its value and rate at the end. */
static void divide_by_theta(struct polynomial *q, struct input *last)
{
    last->value = (last->value - q->c[0]) / q->end;
    last->rate = (last->rate - last->value) / q->end;
    for (int n = 1; n < q->n_terms; n++)
        q->c[n - 1] = q->c[n];
    q->c[q->n_terms - 1] = 0.0;
}

bool exact_first_root(const struct exact_path *path, const struct exact_gap *gap, bool closed,
                      const struct input *last, struct exact_root *root)
{
    struct polynomial q;
    double sign = closed ? 1.0 : -1.0, lo, hi, t;
    double rounding = gap_series(path, gap, sign, &q);
    struct input end = {sign * last->value, sign * last->rate * path->unit};
    *root = (struct exact_root){0.0, true};
    /* Already across, or leaving zero: two contacts that switch together, or a state that was set. */
    if (q.c[0] > rounding || (q.c[0] >= -rounding && q.c[1] > 0.0))
        return true;
    if (!(q.end > 0.0))
        return false;
    /* Just switched, on its way inwards: theta = 0 is that switch. The next is the first zero of
     * gap/theta. */
    if (q.c[0] >= -rounding)
        divide_by_theta(&q, &end);
    if (find_quarter(&q, end.value, &lo, &hi, &t)) {
        sharpen(&q, lo, hi, t, root);
        return true;
    }
    if (!find_dip(&q, end.rate < 0.0, &t))
        return false;
    sharpen(&q, 0.0, t, t, root);
    return true;
}
