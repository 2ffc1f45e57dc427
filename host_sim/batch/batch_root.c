/* batch_root.c - the first sign change of a series, four trajectories at once.
 *
 * As firmware/method/taylor/taylor_root.c. A lane that has its answer, or needs none, only looks on while
 * others go on. */
#include "host_sim/batch/batch_root.h"

enum {
    NEWTON = 40,    /* steps to a root inside its bracket; 2 or 3 are usual */
    BISECTIONS = 30 /* to the peak of a dip: 1e-9 of its interval */
};

/* sign * series, divided by x where it starts at 0. */
struct function {
    const struct batch_series *s;
    double sign;
    mask from_zero;
    bool any_from_zero;
};

struct point {
    quad x, value, slope;
};

ALWAYS_INLINE struct point at(const struct function *f, quad x)
{
    struct point p = {x, f->sign * series_value(f->s->a, x), f->sign * series_value(f->s->b, x)};
    if (f->any_from_zero) {
        quad inverse = 1.0 / x, value = p.value * inverse, slope = (p.slope - value) * inverse;
        p.value = where(f->from_zero, value, p.value);
        p.slope = where(f->from_zero, slope, p.slope);
    }
    return p;
}

ALWAYS_INLINE struct point start_of(const struct function *f)
{
    const struct batch_series *s = f->s;
    return (struct point){all_lanes(0.0), f->sign * where(f->from_zero, s->a[1], s->a[0]),
                          f->sign * where(f->from_zero, s->a[2], s->b[0])};
}

ALWAYS_INLINE struct point point_where(mask m, struct point a, struct point b)
{
    return (struct point){where(m, a.x, b.x), where(m, a.value, b.value), where(m, a.slope, b.slope)};
}

/* Lanes that may have been positive in between although both ends are negative: the end tangents meet
 * above zero. */
ALWAYS_INLINE mask dips(const struct point *lo, const struct point *hi)
{
    quad length = hi->x - lo->x;
    quad meet = (hi->value - lo->value - hi->slope * length) / (lo->slope - hi->slope);
    return (hi->value < 0.0) & (lo->slope > 0.0) & (hi->slope < 0.0) & (lo->value + lo->slope * meet > 0.0);
}

/* The peak between lo and hi becomes hi in those of the lanes where it is not negative; true in these. */
static mask find_peak(const struct function *f, const struct point *lo, mask lanes, struct point *hi)
{
    quad left = lo->x, right = hi->x;
    for (int i = 0; i < BISECTIONS; i++) {
        quad middle = 0.5 * (left + right);
        mask rising = at(f, middle).slope > 0.0;
        left = where(rising, middle, left);
        right = where(rising, right, middle);
    }
    struct point peak = at(f, left);
    mask crossed = lanes & (peak.value >= 0.0);
    peak.slope = all_lanes(0.0);
    *hi = point_where(crossed, peak, *hi);
    return crossed;
}

ALWAYS_INLINE mask crosses(const struct function *f, const struct point *lo, struct point *hi)
{
    mask dip = dips(lo, hi), crossed = hi->value >= 0.0;
    if (any_lane(dip))
        crossed |= find_peak(f, lo, dip, hi);
    return crossed;
}

/* The inverse function's Hermite cubic at zero where both ends rise, else the middle. */
ALWAYS_INLINE quad guess(const struct point *lo, const struct point *hi)
{
    quad span = hi->value - lo->value, u = -lo->value / span, r = 1.0 - u, middle = 0.5 * (lo->x + hi->x);
    quad z = (lo->x * (r * r) * (1.0 + 2.0 * u) + hi->x * (u * u) * (3.0 - 2.0 * u)) +
             span * (u * r) * (r / lo->slope - u / hi->slope);
    mask sound = (lo->slope > 0.0) & (hi->slope > 0.0) & (span > 0.0) & (z > lo->x) & (z < hi->x);
    return where(sound, z, middle);
}

/* Newton, kept inside the bracket until it converges: the last step is taken as it is. */
static void sharpen(const struct function *f, quad lo, quad hi, const quad *end, struct batch_root *root)
{
    quad z = root->at;
    mask active = root->found;
    for (int i = 0; i < NEWTON && any_lane(active); i++) {
        struct point p = at(f, z);
        quad move = where(p.slope > 0.0, -p.value / p.slope, *end);
        mask negative = p.value < 0.0;
        /* Converging quadratically, the correction after this one is below rounding. */
        mask close = magnitude(move) <= 1e-8 * *end;
        lo = where(negative, z, lo);
        hi = where(negative, hi, z);
        mask inside = (z + move >= lo) & (z + move <= hi);
        quad next = where(close | inside, z + move, 0.5 * (lo + hi));
        z = where(active, next, z);
        active &= ~close;
    }
    root->at = lesser(greater(z, all_lanes(0.0)), *end);
    root->residual = active;
}

void batch_series_root(const struct batch_series *s, double sign, const quad *end, struct batch_root *root)
{
    struct function f = {s, sign, s->a[0] == 0.0, false};
    f.any_from_zero = any_lane(f.from_zero);
    struct point start = start_of(&f), middle = at(&f, 0.5 * *end), last = at(&f, *end);
    mask first = crosses(&f, &start, &middle), second = crosses(&f, &middle, &last);
    root->found = first | second;
    root->residual = root->found ^ root->found;
    root->at = *end;
    if (!any_lane(root->found))
        return;
    struct point lo = point_where(first, start, middle), hi = point_where(first, middle, last);
    root->at = where(root->found, guess(&lo, &hi), *end);
    sharpen(&f, lo.x, hi.x, end, root);
}
