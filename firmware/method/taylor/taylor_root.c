/* taylor_root.c - the first sign change of a series. */
#include "firmware/method/taylor/taylor_root.h"

#include <math.h>

enum {
    SAMPLES = 4,     /* a series within its tolerance turns by less than half a wave between them */
    NEWTON = 40,     /* steps to a root inside its bracket; 3 or 4 are usual */
    BISECTIONS = 30, /* to the peak of a dip: 1e-9 of its interval */
};

/* Interval with a sign change of a function that is negative at lo (or leaves zero there): values and
 * slopes. */
struct bracket {
    double lo, lo_value, lo_slope, hi, hi_value, hi_slope;
};

/* An upper bound of the series over [0, x] below zero: no root, the usual answer, from sums of magnitudes. */
static bool excluded(const double *c, double x)
{
    double square = x * x, even = fabs(c[TAYLOR_ORDER]), odd = fabs(c[TAYLOR_ORDER - 1]);
    TAYLOR_UNROLL
    for (int n = TAYLOR_ORDER - 2; n >= 2; n -= 2) {
        even = even * square + fabs(c[n]);
        if (n > 2)
            odd = odd * square + fabs(c[n - 1]);
    }
    double linear = c[1] > 0.0 ? c[0] + c[1] * x : c[0];
    return linear + (even + odd * x) * square < 0.0;
}

/* The peak of the series between lo (rising) and hi (falling) when it is not negative there. */
static bool peak(const double *c, double lo, double hi, double *at)
{
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = 0.5 * (lo + hi);
        if (taylor_jet_at(c, middle).slope > 0.0)
            lo = middle;
        else
            hi = middle;
    }
    *at = lo;
    return taylor_value(c, lo) >= 0.0;
}

/* The first interval of (0, x] in which the series stops being negative. */
static bool find(const double *c, double x, struct bracket *b)
{
    *b = (struct bracket){.lo = 0.0, .lo_value = c[0], .lo_slope = c[1]};
    for (int i = 1; i <= SAMPLES; i++) {
        b->hi = x * ((double)i / SAMPLES);
        struct taylor_jet end = taylor_jet_at(c, b->hi);
        b->hi_value = end.value;
        b->hi_slope = end.slope;
        if (b->hi_value >= 0.0)
            return true;
        /* A dip to the other side and back: only where the end tangents meet above zero. */
        double length = b->hi - b->lo, v0 = b->lo_value, d0 = b->lo_slope, v1 = b->hi_value, d1 = b->hi_slope;
        if (d0 > 0.0 && d1 < 0.0 && v0 + d0 * ((v1 - v0 - d1 * length) / (d0 - d1)) > 0.0 &&
            peak(c, b->lo, b->hi, &b->hi)) {
            b->hi_value = taylor_value(c, b->hi);
            b->hi_slope = 0.0;
            return true;
        }
        b->lo = b->hi;
        b->lo_value = v1;
        b->lo_slope = d1;
    }
    return false;
}

/* The inverse function's Hermite cubic at zero where both ends rise, else the middle. */
static double guess(const struct bracket *b)
{
    double span = b->hi_value - b->lo_value, u = -b->lo_value / span, r = 1.0 - u;
    double z = 0.5 * (b->lo + b->hi);
    if (b->lo_slope > 0.0 && b->hi_slope > 0.0 && span > 0.0)
        z = (b->lo * (r * r) * (1.0 + 2.0 * u) + b->hi * (u * u) * (3.0 - 2.0 * u)) +
            span * (u * r) * (r / b->lo_slope - u / b->hi_slope);
    return z > b->lo && z < b->hi ? z : 0.5 * (b->lo + b->hi);
}

/* Newton, kept inside the bracket until it converges: the last step is taken as it is. */
static void sharpen(const double *c, double x, struct bracket b, struct taylor_root *root)
{
    double z = guess(&b);
    root->residual = true;
    for (int i = 0; i < NEWTON && root->residual; i++) {
        struct taylor_jet here = taylor_jet_at(c, z);
        double move = here.slope > 0.0 ? -here.value / here.slope : x;
        /* Converging quadratically, the correction after this one is below rounding. */
        root->residual = fabs(move) > 1e-8 * x;
        if (here.value < 0.0)
            b.lo = z;
        else
            b.hi = z;
        if (root->residual && !(z + move >= b.lo && z + move <= b.hi))
            move = 0.5 * (b.lo + b.hi) - z;
        z += move;
    }
    root->at = z < 0.0 ? 0.0 : z > x ? x : z;
}

bool taylor_first_root(const double *c, double sign, double x, struct taylor_root *root)
{
    double q[TAYLOR_TERMS];
    struct bracket b;
    if (c[0] != 0.0) {
        for (int n = 0; n <= TAYLOR_ORDER; n++)
            q[n] = sign * c[n];
    } else {
        for (int n = 0; n < TAYLOR_ORDER; n++)
            q[n] = sign * c[n + 1];
        q[TAYLOR_ORDER] = 0.0;
    }
    if (excluded(q, x) || !find(q, x, &b))
        return false;
    sharpen(q, x, b, root);
    return true;
}
