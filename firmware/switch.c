/* switch.c - see switch.h. */
#include "firmware/switch.h"

#include <math.h>

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

/* Where the cubic is largest inside (0, 1): the root of its derivative with negative curvature; -1 if none. */
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

double switch_guess(const struct input *g0, const struct input *g1, double length, bool closed)
{
    struct cubic q = cubic_of(g0, g1, length, closed ? 1.0 : -1.0);
    double peak = cubic_peak(&q);
    if (peak > 0.0 && cubic_at(&q, peak) >= 0.0)
        return length * cubic_zero(&q, 0.0, peak);
    if (cubic_at(&q, 1.0) >= 0.0)
        return length * cubic_zero(&q, 0.0, 1.0);
    return -1.0;
}
