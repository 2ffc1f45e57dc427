/* test_taylor_series.c - every coefficient of the series against the equation that it stands for, in extended
 * precision and by plain convolutions; roots against closed forms. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/method/taylor/taylor_load.h"
#include "firmware/method/taylor/taylor_regular.h"
#include "firmware/method/taylor/taylor_root.h"
#include "firmware/method/taylor/taylor_series.h"
#include "models/math/elementary.h"
#include "tests/fixture/exact.h"

/* Extended precision is the point here. */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdouble-promotion"

enum { TERMS = TAYLOR_TERMS, CASES = 40 };

static struct hertz_form hertz;
static struct polynomial_form polynomial;

static void hertz_view(const double *p, struct hertz_form *f)
{
    (void)p;
    *f = hertz;
}

static void polynomial_view_of(const double *p, struct polynomial_form *f)
{
    (void)p;
    *f = polynomial;
}

static const struct model contact_model = {.hertz_form = hertz_view};
static const struct model polynomial_model = {.polynomial_form = polynomial_view_of};

static double between(uint64_t *seed, double a, double b)
{
    return a + (b - a) * exact_uniform(seed);
}

/* Waves on the inputs of `active`; with a ramp where `ramp`
 * has the bit, two of one frequency where `twin` is set. */
static void random_segment(uint64_t *seed, unsigned active, unsigned ramp, bool twin, struct segment *e)
{
    memset(e, 0, sizeof *e);
    e->length = 0.1;
    e->active = active;
    for (int i = 0; i < MODEL_INPUTS; i++) {
        struct wave *w = &e->wave[i];
        bool ramps = (ramp >> i) & 1u;
        w->offset = between(seed, -0.3, 0.3);
        w->amplitude = between(seed, -0.5, 0.5);
        w->omega = twin && i == 1 ? e->wave[0].omega : between(seed, 0.1, 5.0);
        w->slope = ramps ? between(seed, -0.4, 0.4) : 0.0;
        w->growth = ramps ? between(seed, -0.4, 0.4) : 0.0;
        cos_sin(between(seed, -3.0, 3.0), &w->cosine, &w->sine);
    }
}

static void random_forms(uint64_t *seed, bool full)
{
    memset(&hertz, 0, sizeof hertz);
    memset(&polynomial, 0, sizeof polynomial);
    hertz.side = 1.0;
    hertz.constant = 2.0 / 3.0;
    hertz.hertz = full ? -0.4 : 2.0 / 3.0;
    hertz.damping = polynomial.damping = 0.03;
    hertz.stiffness = full ? 1.0 : 0.0;
    for (int i = 0; i < MODEL_INPUTS; i++) {
        hertz.force[i] = between(seed, -1.0, 1.0);
        hertz.shift[i] = i == 2 ? -1.0 : 0.0;
        hertz.drag[i] = i == 1 ? 0.3 : 0.0;
        hertz.modulation[i] = full && i == 3 ? 1.0 : 0.0;
    }
    if (full)
        hertz.force[3] = 0.0;
    for (int k = 0; k < 4; k++) {
        polynomial.constant[k] = between(seed, -1.0, 1.0);
        for (int i = 0; i < MODEL_INPUTS; i++) {
            polynomial.modulation[k][i] = full || k == 0 ? between(seed, -0.5, 0.5) : 0.0;
            polynomial.rate[k][i] = full && k < 2 ? between(seed, -0.2, 0.2) : 0.0;
        }
    }
}

/* (a b)_n */
static long double conv(const long double *a, const long double *b, int n)
{
    long double sum = 0.0L;
    for (int j = 0; j <= n; j++)
        sum += a[j] * b[n - j];
    return sum;
}

/* Coefficients of value, rate and acceleration of a wave:
 * offset + slope t + (A + G t) cos(theta + omega t). */
static void wave_series(const struct wave *w, long double u[3][TERMS + 3])
{
    long double c[TERMS + 3], quarter[4] = {w->cosine, -w->sine, -w->cosine, w->sine}, power = 1.0L;
    for (int n = 0; n < TERMS + 3; n++) {
        c[n] = power * quarter[n % 4];
        power *= (long double)w->omega / (n + 1);
    }
    for (int n = 0; n < TERMS + 3; n++)
        u[0][n] = w->amplitude * c[n] + (n > 0 ? w->growth * c[n - 1] : 0.0L);
    u[0][0] += w->offset;
    u[0][1] += w->slope;
    for (int d = 1; d < 3; d++) {
        for (int n = 0; n + d < TERMS + 3; n++)
            u[d][n] = (n + 1) * u[d - 1][n + 1];
    }
}

/* The force lane and the contact's stiffness of the hertz_form as series in time. */
static void hertz_lanes(const struct segment *e, long double *g, long double *k)
{
    long double u[3][TERMS + 3];
    for (int n = 0; n < TERMS; n++) {
        g[n] = n == 0 ? hertz.constant : 0.0L;
        k[n] = n == 0 ? hertz.hertz : 0.0L;
    }
    for (int i = 0; i < MODEL_INPUTS; i++) {
        if (!((e->active >> i) & 1u))
            continue;
        wave_series(&e->wave[i], u);
        for (int n = 0; n < TERMS; n++) {
            g[n] += hertz.force[i] * u[0][n] + hertz.drag[i] * u[1][n] + hertz.shift[i] * u[2][n];
            k[n] += (long double)hertz.hertz * hertz.modulation[i] * u[0][n];
        }
    }
}

static void widen(const double *a, long double *b, int n)
{
    for (int i = 0; i < n; i++)
        b[i] = a[i];
}

/* |a - b| over the size of what was added up. */
static void compare(double *worst, long double a, long double b, long double size)
{
    exact_worst(worst, (a - b) / (1.0L + fabsl(a) + fabsl(b) + fabsl(size)));
}

/* Case number to load: every number of tones, ramps, twins
 * of one frequency, with and without a modulated contact. */
static void make_case(uint64_t *seed, int i, struct segment *e, struct taylor_load *load)
{
    static const unsigned actives[8] = {0, 1, 3, 5, 9, 8, 15, 12};
    struct taylor_lanes lanes;
    random_forms(seed, i % 3 == 1);
    random_segment(seed, actives[i % 8], i % 5 == 4 ? 0xFu : i % 5 == 3 ? 4u : 0u, i % 4 == 2, e);
    taylor_lanes_of(&contact_model, NULL, &lanes);
    taylor_load_begin(load, &lanes, e);
}

/* F F = eta^3 and the equation of motion. */
TEST(taylor_contact_series)
{
    uint64_t seed = 11;
    double worst_force = 0.0, worst_motion = 0.0;
    for (int i = 0; i < CASES; i++) {
        struct segment e;
        struct taylor_load load;
        double eta[TERMS], force[TERMS];
        long double g[TERMS], k[TERMS], x[TERMS], f[TERMS], x2[TERMS];
        make_case(&seed, i, &e, &load);
        taylor_contact(&load, between(&seed, 0.6, 2.0), between(&seed, -1.0, 1.0), eta, force);
        hertz_lanes(&e, g, k);
        widen(eta, x, TERMS);
        widen(force, f, TERMS - 2);
        for (int n = 0; n < TERMS; n++)
            x2[n] = conv(x, x, n);
        for (int n = 0; n + 2 < TERMS; n++) {
            long double motion =
                g[n] - conv(k, f, n) - hertz.damping * (n + 1) * x[n + 1] - hertz.stiffness * x[n];
            compare(&worst_force, conv(f, f, n), conv(x2, x, n), 0.0L);
            compare(&worst_motion, (n + 1) * (n + 2) * x[n + 2], motion, conv(k, f, n));
        }
    }
    check_below("worst coefficient of F F against eta^3", worst_force, 1e-14);
    check_below("worst coefficient of the equation of motion in contact", worst_motion, 1e-14);
}

TEST(taylor_flight_series)
{
    uint64_t seed = 12;
    double worst = 0.0;
    for (int i = 0; i < CASES; i++) {
        struct segment e;
        struct taylor_load load;
        double eta[TERMS];
        long double g[TERMS], k[TERMS];
        make_case(&seed, i, &e, &load);
        taylor_flight(&load, between(&seed, -2.0, 0.0), between(&seed, -1.0, 1.0), eta);
        hertz_lanes(&e, g, k);
        for (int n = 0; n + 2 < TERMS; n++)
            compare(&worst, (n + 1.0L) * (n + 2) * eta[n + 2],
                    g[n] - (long double)hertz.damping * (n + 1) * eta[n + 1] -
                        (long double)hertz.stiffness * eta[n],
                    g[n]);
    }
    check_below("worst coefficient of the equation of motion in flight", worst, 1e-14);
}

/* out = f(t(s)) of a series in time, by Horner's rule on series. */
static void compose(const long double *f, const long double *t, long double *out)
{
    long double r[TERMS];
    for (int n = 0; n < TERMS; n++)
        out[n] = n == 0 ? f[TERMS - 1] : 0.0L;
    for (int k = TERMS - 2; k >= 0; k--) {
        for (int n = 0; n < TERMS; n++)
            r[n] = conv(out, t, n);
        memcpy(out, r, sizeof r);
        out[0] += f[k];
    }
}

/* y' = w, t' = 2 y, w' = 2 y (g(t(s)) - k(t(s)) y^3 - stiffness y^2 - damping w). */
TEST(taylor_regular_series)
{
    uint64_t seed = 13;
    double worst[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < CASES; i++) {
        struct segment e;
        struct taylor_load load;
        double y[TERMS], w[TERMS], t[TERMS];
        long double g[TERMS], k[TERMS], gs[TERMS], ks[TERMS], Y[TERMS], W[TERMS], T[TERMS], y2[TERMS],
            y3[TERMS], pull[TERMS];
        make_case(&seed, i, &e, &load);
        taylor_regular(&load, i % 7 == 0 ? 0.0 : between(&seed, 0.05, 1.2), between(&seed, -1.0, 1.0), y, w,
                       t);
        hertz_lanes(&e, g, k);
        widen(y, Y, TERMS);
        widen(w, W, TERMS);
        widen(t, T, TERMS);
        compose(g, T, gs);
        compose(k, T, ks);
        for (int n = 0; n < TERMS; n++)
            y2[n] = conv(Y, Y, n);
        for (int n = 0; n < TERMS; n++)
            y3[n] = conv(y2, Y, n);
        for (int n = 0; n + 1 < TERMS; n++) {
            pull[n] = gs[n] - conv(ks, y3, n) - hertz.stiffness * y2[n] - hertz.damping * W[n];
            compare(&worst[0], (n + 1) * Y[n + 1], W[n], 0.0L);
            compare(&worst[1], (n + 1) * T[n + 1], 2.0L * Y[n], 0.0L);
            compare(&worst[2], (n + 1) * W[n + 1], 2.0L * conv(Y, pull, n), conv(ks, y3, n));
        }
    }
    check_below("worst coefficient of y' = w", worst[0], 1e-15);
    check_below("worst coefficient of t' = 2 y", worst[1], 1e-15);
    check_below("worst coefficient of w' in regularised variables", worst[2], 2e-14);
}

TEST(taylor_polynomial_series)
{
    uint64_t seed = 14;
    double worst = 0.0;
    for (int i = 0; i < CASES; i++) {
        struct segment e;
        struct taylor_load load;
        struct taylor_lanes lanes;
        double x[TERMS];
        long double a[4][TERMS], u[3][TERMS + 3], X[3][TERMS];
        make_case(&seed, i, &e, &load);
        taylor_lanes_of(&polynomial_model, NULL, &lanes);
        taylor_load_begin(&load, &lanes, &e);
        taylor_polynomial(&load, between(&seed, -1.0, 1.0), between(&seed, -1.0, 1.0), x);
        for (int k = 0; k < 4; k++) {
            for (int n = 0; n < TERMS; n++)
                a[k][n] = n == 0 ? polynomial.constant[k] : 0.0L;
            for (int j = 0; j < MODEL_INPUTS; j++) {
                if (!((e.active >> j) & 1u))
                    continue;
                wave_series(&e.wave[j], u);
                for (int n = 0; n < TERMS; n++)
                    a[k][n] += polynomial.modulation[k][j] * u[0][n] + polynomial.rate[k][j] * u[1][n];
            }
        }
        widen(x, X[0], TERMS);
        for (int k = 1; k < 3; k++) {
            for (int n = 0; n < TERMS; n++)
                X[k][n] = conv(X[k - 1], X[0], n);
        }
        for (int n = 0; n + 2 < TERMS; n++) {
            long double force = a[0][n] + conv(a[1], X[0], n) + conv(a[2], X[1], n) + conv(a[3], X[2], n);
            compare(&worst, (n + 1) * (n + 2) * X[0][n + 2],
                    force - polynomial.damping * (n + 1) * X[0][n + 1], force);
        }
    }
    check_below("worst coefficient of the equation of motion with a polynomial force", worst, 1e-14);
}

/* A load moved by s and the load of the same waves begun there: the same series. */
TEST(taylor_load_move)
{
    uint64_t seed = 15;
    double worst = 0.0;
    for (int i = 0; i < CASES; i++) {
        struct segment e, later;
        struct taylor_load load, begun;
        struct taylor_lanes lanes;
        double s = between(&seed, 0.0, 3.0), moved_eta[TERMS], eta[TERMS], force[TERMS];
        make_case(&seed, i, &e, &load);
        taylor_load_move(&load, s);
        later = e;
        later.length = s;
        segment_tail(&later, MODEL_INPUTS, s);
        taylor_lanes_of(&contact_model, NULL, &lanes);
        taylor_load_begin(&begun, &lanes, &later);
        taylor_contact(&load, 1.1, 0.2, moved_eta, force);
        taylor_contact(&begun, 1.1, 0.2, eta, force);
        for (int n = 0; n < TERMS; n++)
            compare(&worst, moved_eta[n], eta[n], 0.0L);
    }
    check_below("worst coefficient, load moved against load begun there", worst, 2e-14);
}

TEST(taylor_evaluation)
{
    uint64_t seed = 16;
    double value_error = 0.0, slope_error = 0.0;
    for (int i = 0; i < CASES; i++) {
        double c[TERMS], x = between(&seed, -1.0, 1.0);
        long double value = 0.0L, slope = 0.0L;
        for (int n = 0; n < TERMS; n++)
            c[n] = between(&seed, -1.0, 1.0);
        for (int n = TERMS - 1; n >= 0; n--) {
            slope = slope * x + value;
            value = value * x + c[n];
        }
        exact_worst(&value_error, taylor_value(c, x) - value);
        exact_worst(&slope_error, taylor_jet_at(c, x).slope - slope);
    }
    check_below("value of a series against Horner's rule in extended precision", value_error, 2e-15);
    check_below("slope of a series against Horner's rule in extended precision", slope_error, 2e-14);
}

/* (x - a)(x - b) and the like: roots that are known. */
TEST(taylor_root)
{
    double c[TERMS] = {0.0};
    struct taylor_root root = {0.0, false};
    c[0] = -0.06;
    c[1] = 0.5;
    c[2] = -1.0; /* -(x - 0.2)(x - 0.3) */
    check_true("a rise that falls back inside one interval is found", taylor_first_root(c, 1.0, 4.0, &root));
    check_near("its first root", root.at, 0.2, 1e-14);
    check_true("and converges", !root.residual);
    check_true("nothing before it", !taylor_first_root(c, 1.0, 0.19, &root));
    c[0] = -0.0625 - 1e-9; /* the peak stays 1e-9 below zero */
    check_true("a peak 1e-9 short of zero is no root", !taylor_first_root(c, 1.0, 1.0, &root));
    c[0] = -0.0625 + 1e-9;
    check_true("a peak 1e-9 beyond zero is one", taylor_first_root(c, 1.0, 1.0, &root));
    check_near("where it comes first", root.at, 0.25 - sqrt(1e-9), 1e-10);
    memset(c, 0, sizeof c);
    c[1] = -0.3;
    c[2] = 1.0; /* x (x - 0.3): leaves zero downwards */
    check_true("a start at zero does not count", taylor_first_root(c, 1.0, 1.0, &root));
    check_near("the root after it", root.at, 0.3, 1e-15);
    c[1] = -1e-12;
    check_true("a root next to the start", taylor_first_root(c, 1.0, 1.0, &root));
    check_near("in its own scale", root.at / 1e-12, 1.0, 1e-3);
    memset(c, 0, sizeof c);
    c[0] = 1.0;
    c[3] = -8.0; /* falls to zero at 1/2 */
    check_true("the other sign", taylor_first_root(c, -1.0, 1.0, &root));
    check_near("a falling root", root.at, 0.5, 1e-15);
}

#pragma GCC diagnostic pop
