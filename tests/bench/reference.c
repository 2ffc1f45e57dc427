/* reference.c - the reference of the benchmark, for every method: power series of order 30 in long double.
 *
 * A Hertzian contact is expanded in s, eta = y^2, dt = 2 y ds, w = eta', where touchdown and lift-off are
 * simple roots; flight and the shaft's regimes in time. Roots by bisection of the sampled series. Nothing
 * here is shared with the methods under test; reference_check() computes the same motion without series,
 * regularisation or roots. */
#include "tests/bench/bench.h"

#include <math.h>
#include <string.h>

enum { N = 30, GRID = 64, BISECTIONS = 70, PIECES = 100000 };
#define TOL 1e-19L

static long double value(const long double *a, long double x)
{
    long double sum = 0.0L;
    for (int n = N; n >= 0; n--)
        sum = sum * x + a[n];
    return sum;
}

static long double slope(const long double *a, long double x)
{
    long double sum = 0.0L;
    for (int n = N; n >= 1; n--)
        sum = sum * x + n * a[n];
    return sum;
}

/* Coefficient n of a product. */
static long double times(const long double *a, const long double *b, int n)
{
    long double sum = 0.0L;
    for (int j = 0; j <= n; j++)
        sum += a[j] * b[n - j];
    return sum;
}

/* Largest step at which the last two terms stay below the tolerance. */
static long double reach(const long double *a, long double limit)
{
    for (int n = N - 1; n <= N; n++) {
        if (a[n] != 0.0L)
            limit = fminl(limit, powl(TOL / fabsl(a[n]), 1.0L / n));
    }
    return limit;
}

/* First root of sign * a + offset coming from above zero, in (0, x]; -1 for none. */
static long double first_root(const long double *a, long double sign, long double offset, long double x)
{
    for (int i = 1; i <= GRID; i++) {
        long double lo = x * (i - 1) / GRID, hi = x * i / GRID;
        if (sign * value(a, hi) + offset > 0.0L)
            continue;
        /* A series that begins at its root leaves it first. */
        if (i == 1 && sign * a[0] + offset <= TOL)
            lo = 1e-6L * hi;
        for (int k = 0; k < BISECTIONS; k++) {
            long double middle = 0.5L * (lo + hi);
            if (sign * value(a, middle) + offset > 0.0L)
                lo = middle;
            else
                hi = middle;
        }
        return 0.5L * (lo + hi);
    }
    return -1.0L;
}

struct tone {
    long double omega, phase;
};

struct state {
    long double t, x[EQUATION_STATES];
    unsigned closed;
};

static void phases(const struct equation *e, struct tone tone[2])
{
    tone[0] = (struct tone){e->w1, e->phase1};
    tone[1] = (struct tone){e->w2, 0.0L};
}

/* Series of y, w and time in s. */
static void contact_series(const struct equation *e, const struct state *z, long double *y, long double *w,
                           long double *t)
{
    long double c[2][N + 1], s[2][N + 1], q[N + 1], qq[N + 1];
    struct tone tone[2];
    phases(e, tone);
    for (int i = 0; i < 2; i++) {
        c[i][0] = cosl(tone[i].omega * z->t + tone[i].phase);
        s[i][0] = sinl(tone[i].omega * z->t + tone[i].phase);
    }
    y[0] = sqrtl(z->x[0]);
    w[0] = z->x[1];
    t[0] = 0.0L;
    for (int n = 0; n < N; n++) {
        q[n] = times(y, y, n);
        qq[n] = times(q, q, n);
        long double force =
            (e->f0 + (long double)e->held) * y[n] + e->f1 * times(y, c[0], n) + e->f2 * times(y, c[1], n);
        long double elastic = e->k * times(q, y, n) + e->b * (qq[n] + e->r * times(qq, c[1], n));
        y[n + 1] = w[n] / (n + 1);
        t[n + 1] = 2.0L * y[n] / (n + 1);
        q[n + 1] = times(y, y, n + 1);
        w[n + 1] = 2.0L * (force - elastic) / (n + 1) - e->c * q[n + 1];
        for (int i = 0; i < 2; i++) {
            c[i][n + 1] = -2.0L * tone[i].omega * times(y, s[i], n) / (n + 1);
            s[i][n + 1] = 2.0L * tone[i].omega * times(y, c[i], n) / (n + 1);
        }
    }
}

static void contact_piece(const struct equation *e, struct state *z, long double end)
{
    long double y[N + 1], w[N + 1], t[N + 1];
    contact_series(e, z, y, w, t);
    long double s = reach(w, reach(y, 0.5L)), left = end - z->t;
    long double lift = first_root(y, 1.0L, 0.0L, s);
    s = lift > 0.0L ? lift : s;
    if (value(t, s) >= left) {
        s = first_root(t, -1.0L, left, s);
        lift = -1.0L;
        z->t = end;
    } else {
        z->t += value(t, s);
    }
    long double root = value(y, s);
    z->x[0] = lift > 0.0L ? 0.0L : root * root;
    z->x[1] = value(w, s);
    z->closed = lift <= 0.0L;
}

static void flight_piece(const struct equation *e, struct state *z, long double end)
{
    long double x[N + 1], left = end - z->t, power[2] = {1.0L, 1.0L}, factorial = 1.0L;
    long double amplitude[2] = {e->f1, e->f2};
    struct tone tone[2];
    phases(e, tone);
    x[0] = z->x[0];
    x[1] = z->x[1];
    for (int n = 0; n + 2 <= N; n++) {
        long double force = n == 0 ? e->f0 + (long double)e->held : 0.0L;
        factorial *= n > 0 ? n : 1;
        for (int i = 0; i < 2; i++) {
            long double quarter = 1.57079632679489661923132169163975L * n;
            force +=
                amplitude[i] * power[i] / factorial * cosl(tone[i].omega * z->t + tone[i].phase + quarter);
            power[i] *= tone[i].omega;
        }
        x[n + 2] = (force - e->c * (n + 1) * x[n + 1] - e->k * x[n]) / ((n + 1) * (n + 2));
    }
    long double h = fminl(left, reach(x, 0.5L));
    long double touch = first_root(x, -1.0L, 0.0L, h);
    bool last = h == left && touch < 0.0L;
    h = touch > 0.0L ? touch : h;
    z->x[0] = touch > 0.0L ? 0.0L : value(x, h);
    z->x[1] = slope(x, h);
    z->t = last ? end : z->t + h;
    z->closed = touch > 0.0L;
}

static void shaft_series(const struct equation *e, const struct state *z, long double x[3][N + 1])
{
    long double power = 1.0L, factorial = 1.0L;
    for (int i = 0; i < 3; i++) {
        x[i][0] = z->x[i];
        x[i][1] = z->x[3 + i];
    }
    for (int n = 0; n + 2 <= N; n++) {
        long double bend = x[0][n] + x[2][n] - 2.0L * x[1][n];
        factorial *= n > 0 ? n : 1;
        long double drive =
            e->f1 * power / factorial * cosl(e->w1 * z->t + 1.57079632679489661923132169163975L * n);
        power *= e->w1;
        for (int i = 0; i < 3; i++) {
            long double force =
                (i == 1 ? drive + (n == 0 ? e->held : 0.0L) + 2.0L * bend : -e->support[i] * x[i][n] - bend);
            for (int side = 0; side < 2 && i != 1; side++) {
                if ((z->closed >> (i + side)) & 1u)
                    force -= e->spring * (x[i][n] - (n == 0 ? 1 - 2 * side : 0));
            }
            x[i][n + 2] = (force - e->damper[i] * (n + 1) * x[i][n + 1]) /
                          ((n + 1) * (n + 2) * (long double)e->mass[i]);
        }
    }
}

static void shaft_piece(const struct equation *e, struct state *z, long double end)
{
    long double x[3][N + 1], left = end - z->t, h = fminl(left, 0.25L);
    bool last = h == left;
    int which = -1;
    shaft_series(e, z, x);
    for (int i = 0; i < e->n_contacts; i++) {
        long double out = (z->closed >> i) & 1u ? 1.0L : -1.0L, side = (i & 1) ? -1.0L : 1.0L;
        long double root = first_root(x[i < 2 ? 0 : 2], out * side, -out, h);
        if (root > 0.0L && root < h) {
            h = root;
            which = i;
        }
    }
    for (int i = 0; i < 3; i++) {
        z->x[i] = value(x[i], h);
        z->x[3 + i] = slope(x[i], h);
    }
    if (which >= 0) {
        z->closed ^= 1u << which;
        z->x[which < 2 ? 0 : 2] = (which & 1) ? -1.0L : 1.0L;
    }
    z->t = last && which < 0 ? end : z->t + h;
}

static void advance(const struct equation *e, struct state *z, long double end)
{
    for (int i = 0; i < PIECES && z->t < end; i++) {
        if (e->n == 6)
            shaft_piece(e, z, end);
        else if (z->closed)
            contact_piece(e, z, end);
        else
            flight_piece(e, z, end);
    }
}

void reference_series(struct problem *b)
{
    struct equation e = b->eq;
    struct state z = {.closed = equation_regime(&e, b->y0)};
    for (int i = 0; i < e.n; i++)
        z.x[i] = b->y0[i];
    for (int k = 0; k < b->n_out; k++) {
        for (int j = 0; j < b->holds; j++) {
            if (b->held)
                e.held = b->held[k * b->holds + j];
            advance(&e, &z, (long double)b->interval * ((long double)k + (long double)(j + 1) / b->holds));
        }
        for (int i = 0; i < e.n; i++) {
            b->ref[k][i] = (double)z.x[i];
            b->column[i] = fmax(b->column[i], fabs(b->ref[k][i]));
        }
    }
}
