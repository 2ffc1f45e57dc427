/* test_fast_orbit.c - the seed's question: where a modulated contact stiffness moves the tip's resonance,
 * with the full contact. Floquet multipliers about the fast orbit, and the peak of a sweep of a small force.
 */
#include "tests/unit/test.h"

#include <math.h>
#include "models/afm_tip.h"
#include "tests/fixture/paper.h"
#include "tests/fixture/afm/pressed.h"

#define TWO_PI 6.283185307179586477

enum { PERIOD_TICKS = 1024, NEWTON = 12 };

/* By shooting and Floquet's theorem, made without this code; damping 0.02. */
static const struct fast_orbit {
    double sign, beta, r, omega, free, shifted;
} fast_orbit[] = {
    {-1.0, 0.8, 0.5, 5.0, 1.341640786, 1.343549427},
    {-1.0, 0.8, 1.0, 5.0, 1.341640786, 1.349360975},
    {-1.0, 29.7, 0.5, 30.0, 5.540758071, 5.553886927},
    {1.0, 0.8, 0.4, 2.0, 0.447213595, 0.483636808},
};
enum { FAST_ORBITS = sizeof fast_orbit / sizeof fast_orbit[0] };

static void fast_orbit_paper(double *paper, const struct fast_orbit *w)
{
    paper_defaults(&afm_tip, paper);
    paper[TIP_PAPER_SIGN] = w->sign;
    paper[TIP_PAPER_BETA] = w->beta;
    paper[TIP_PAPER_R] = w->r;
    paper[TIP_PAPER_FAST_OMEGA] = w->omega;
}

/* Through one period of the modulation. */
static void one_period(const struct fast_orbit *w, const double *from, double *to)
{
    static struct plant pl;
    double paper[MODEL_PARAMETERS];
    fast_orbit_paper(paper, w);
    paper_start(&pl, &afm_tip, paper, TWO_PI / w->omega / PERIOD_TICKS, from);
    check_true("runs", plant_run(&pl, PERIOD_TICKS));
    paper_now(&pl, to);
}

/* The map of small motions about `at` over a period. */
static void tangent(const struct fast_orbit *w, const double *at, double m[2][2])
{
    const double step = 1e-5;
    for (int k = 0; k < 2; k++) {
        double low[2] = {at[0], at[1]}, high[2] = {at[0], at[1]}, a[MODEL_STATES], b[MODEL_STATES];
        low[k] -= step;
        high[k] += step;
        one_period(w, low, a);
        one_period(w, high, b);
        for (int i = 0; i < 2; i++)
            m[i][k] = (b[i] - a[i]) / (2.0 * step);
    }
}

/* Newton's way to the orbit that is the same after a period. Returns how far it misses. */
static double find_orbit(const struct fast_orbit *w, double *at)
{
    double end[MODEL_STATES], m[2][2], e[2] = {1.0, 1.0};
    at[0] = at[1] = 0.0;
    for (int i = 0; i < NEWTON; i++) {
        one_period(w, at, end);
        e[0] = end[0] - at[0];
        e[1] = end[1] - at[1];
        tangent(w, at, m);
        double a = m[0][0] - 1.0, d = m[1][1] - 1.0, all = a * d - m[0][1] * m[1][0];
        at[0] -= (d * e[0] - m[0][1] * e[1]) / all;
        at[1] -= (a * e[1] - m[1][0] * e[0]) / all;
    }
    return fabs(e[0]) + fabs(e[1]);
}

TEST(fast_orbit_floquet)
{
    for (int i = 0; i < FAST_ORBITS; i++) {
        const struct fast_orbit *w = &fast_orbit[i];
        double at[2], m[2][2], c = 0.02;
        check_near("the orbit closes", find_orbit(w, at), 0.0, 1e-11);
        tangent(w, at, m);
        double det = m[0][0] * m[1][1] - m[0][1] * m[1][0], T = TWO_PI / w->omega;
        double angle = acos(0.5 * (m[0][0] + m[1][1]) / sqrt(det));
        check_near("loss in a period, by Liouville", log(det), -c * T, 1e-8);
        check_near(check_name("sign %g, beta %g, r %g, W %g: frequency", w->sign, w->beta, w->r, w->omega),
                   angle / T, w->shifted, 1e-7);
        check_near("  without modulation", sqrt(1.0 - w->sign * w->beta), w->free, 1e-8);
    }
}

/* A lever with real modes and adhesion. The still lever has the root of the beam's equation with all modes,
 * 3.70228482. The other references are by a program of its own for the equations of
 * docs/reference/afm_lever.md (RK4, bisection for the spring of the modes left out). DMT's adhesion is a
 * constant force in contact, so it shifts nothing. */
TEST(fast_orbit_beam)
{
    static const struct {
        const char *name;
        int modes;
        double hamaker, fast, modulation, guess, want, tolerance;
    } at[] = {
        {"point mass, still", 1, 0.0, 30.0, 0.0, 5.54, 5.540758071, 1e-5},
        {"point mass, r 0.5, W 30", 1, 0.0, 30.0, 0.5, 5.54, 5.553886927, 1e-5},
        {"four modes, still", 4, 0.0, 30.0, 0.0, 3.7, 3.70228482, 3e-5},
        {"four modes, r 0.5, W 30: lower", 4, 0.0, 30.0, 0.5, 3.7, 3.69345127, 1e-6},
        {"four modes, r 0.5, W 50: higher", 4, 0.0, 50.0, 0.5, 3.7, 3.70572826, 1e-5},
        {"four modes and adhesion, r 0.5, W 30", 4, 6.4e-20, 30.0, 0.5, 3.7, 3.69345127, 1e-6},
    };
    static struct lever lever;
    for (size_t i = 0; i < sizeof at / sizeof at[0]; i++)
        check_near(
            at[i].name,
            pressed_frequency(&lever, at[i].modes, at[i].hamaker, at[i].fast, at[i].modulation, at[i].guess),
            at[i].want, at[i].tolerance);
}

/* ---- a sweep ---- */

/* Amplitude of the answer to a small force at w, with a Hann window over whole periods. */
static double answer(const struct fast_orbit *r, double w, double force)
{
    static struct plant pl;
    double paper[MODEL_PARAMETERS], start[2], now[MODEL_STATES], re = 0.0, im = 0.0,
                                                                 h = TWO_PI / r->omega / 128.0;
    long rest = lround(1200.0 / h), n = lround(300.0 * TWO_PI / w / h);
    fast_orbit_paper(paper, r);
    paper[TIP_PAPER_F] = force;
    paper[TIP_PAPER_OMEGA] = w;
    find_orbit(r, start);
    paper_start(&pl, &afm_tip, paper, h, start);
    check_true("runs", plant_run(&pl, (uint64_t)rest));
    for (long i = 0; i < n; i++) {
        if (!plant_run(&pl, 1))
            return (double)NAN;
        paper_now(&pl, now);
        double window = (1.0 - cos(TWO_PI * ((double)i + 0.5) / (double)n)) * 2.0 / (double)n;
        re += window * now[0] * cos(w * h * (double)(rest + i + 1));
        im += window * now[0] * sin(w * h * (double)(rest + i + 1));
    }
    return sqrt(re * re + im * im);
}

/* 1/A^2 is a parabola in w^2, least at w0^2 - c^2/2. */
TEST(fast_orbit_sweep)
{
    for (int i = 0; i < FAST_ORBITS; i++) {
        double y[3], centre = fast_orbit[i].shifted * fast_orbit[i].shifted, d = 0.02 * fast_orbit[i].shifted,
                     c = 0.02;
        for (int k = 0; k < 3; k++) {
            double a = answer(&fast_orbit[i], sqrt(centre + (k - 1) * d), 1e-4);
            y[k] = 1.0 / (a * a);
        }
        double peak = centre + 0.5 * d * (y[0] - y[2]) / (y[0] - 2.0 * y[1] + y[2]);
        check_near("peak of the sweep", sqrt(peak + 0.5 * c * c), fast_orbit[i].shifted,
                   1e-3 * fast_orbit[i].shifted);
    }
}
