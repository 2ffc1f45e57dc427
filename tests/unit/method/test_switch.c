/* test_switch.c - finding a switch between two instants, on gaps that are known cubics with known zeros. */
#include "tests/unit/test.h"

#include <math.h>
#include <stddef.h>
#include "firmware/method/method.h"
#include "firmware/method/switch.h"
#include "tests/fixture/exact.h"

/* A cubic gap by its coefficients, and its ends over `length`. */
struct gap {
    double c[4];
    double length;
};

static struct input gap_at(const struct gap *g, double s, double sign)
{
    double value = g->c[0] + s * (g->c[1] + s * (g->c[2] + s * g->c[3]));
    double rate = g->c[1] + s * (2.0 * g->c[2] + s * 3.0 * g->c[3]);
    return (struct input){sign * value, sign * rate};
}

/* factor (s - r1)(s - r2)(s - r3). */
static struct gap from_roots(double factor, double r1, double r2, double r3, double length)
{
    return (struct gap){
        {-factor * r1 * r2 * r3, factor * (r1 * r2 + r1 * r3 + r2 * r3), -factor * (r1 + r2 + r3), factor},
        length};
}

/* The switch found, in the regime `closed` (a gap is given
 * as it opens: negative first); -2 when none is suspected. */
static double find(const struct gap *g, bool closed)
{
    double sign = closed ? 1.0 : -1.0;
    struct input g0 = gap_at(g, 0.0, sign), g1 = gap_at(g, g->length, sign);
    if (!switch_suspected(&g0, &g1, g->length, closed))
        return -2.0;
    return switch_guess(&g0, &g1, g->length, closed);
}

/* One zero inside: (s - r)((s - a)^2 + b^2). */
TEST(switch_crossing)
{
    uint64_t seed = 1;
    double error = 0.0;
    for (int i = 0; i < 20000; i++) {
        double length = 0.001 + exact_uniform(&seed), r = length * (0.001 + 0.998 * exact_uniform(&seed));
        double a = length * (3.0 * exact_uniform(&seed) - 1.0), b = length * (0.1 + exact_uniform(&seed)),
               k = a * a + b * b;
        struct gap g = {{-r * k, k + 2.0 * a * r, -2.0 * a - r, 1.0}, length};
        error = fmax(error, fabs(find(&g, i & 1) - r) / length);
    }
    check_below("20,000 single crossings, both regimes, error over the length", error, 2e-12);
}

/* Three zeros, or two, inside: the first counts. */
TEST(switch_first_of_many)
{
    uint64_t seed = 2;
    double three = 0.0, two = 0.0;
    for (int i = 0; i < 20000; i++) {
        double length = 0.01 + exact_uniform(&seed), u = length / 10.0;
        double r1 = u * (0.2 + 2.5 * exact_uniform(&seed)), r2 = r1 + u * (0.2 + 2.5 * exact_uniform(&seed)),
               r3 = r2 + u * (0.2 + 2.5 * exact_uniform(&seed));
        struct gap g = from_roots(1.0, r1, r2, r3, length);
        three = fmax(three, fabs(find(&g, i & 1) - r1) / length);
        g = from_roots(-1.0, -2.0 * length * (1.0 + exact_uniform(&seed)), r1, r2, length);
        two = fmax(two, fabs(find(&g, i & 1) - r1) / length);
    }
    check_below("first of three zeros, error over the length", three, 1e-10);
    check_below("first of two zeros: a dip across and back", two, 1e-10);
}

/* A dip whose top is `top` above zero, or below: k (top - (s - r)^2 / length^2). */
static double graze(double top, double r, bool closed)
{
    const double length = 0.02, k = 3.0;
    double q = k / (length * length), s = r * length;
    struct gap g = {{k * top - q * s * s, 2.0 * q * s, -q, 0.0}, length};
    return find(&g, closed) / length;
}

TEST(switch_grazing)
{
    const double top[] = {0.04, 1e-4, 1e-8, 1e-12}, r[] = {0.3, 0.5, 0.77};
    for (int closed = 0; closed < 2; closed++) {
        for (int i = 0; i < 4; i++) {
            double reaching = 0.0;
            int missing = 0;
            for (int j = 0; j < 3; j++) {
                /* the root's error is rounding over the slope 2 sqrt(top) */
                reaching = fmax(reaching, fabs(graze(top[i], r[j], closed) - (r[j] - sqrt(top[i]))));
                missing += graze(-top[i], r[j], closed) < 0.0;
            }
            check_below("dip just reaching zero, error of the first zero", reaching,
                        2e-12 + 1e-15 / sqrt(top[i]));
            check_int("dips just missing zero, refused", missing, 3);
        }
    }
    /* exact in binary: a double root is reached */
    check_near("double root", graze(0.0, 0.5, true), 0.5, 1e-7);
    check_near("double root, opening regime", graze(0.0, 0.5, false), 0.5, 1e-7);
}

/* A dip that begins hollow, top - (s - 0.6)^2 (s + 0.5):
 * its double root is that of the other sign of the formula. */
static double hollow(double top, bool closed)
{
    struct gap g = {{top - 0.18, 0.24, 0.7, -1.0}, 1.0};
    return find(&g, closed);
}

TEST(switch_hollow)
{
    for (int closed = 0; closed < 2; closed++) {
        struct gap from_rest = {{-1e-20, 2e-20, 0.5, -2.0 / 3.0},
                                1.0}; /* s^2/2 just after a touch without speed */
        for (double top = 1e-4; top > 1e-9; top *= 0.1) {
            check_near("first zero of a dip that reaches zero", hollow(top, closed), 0.6 - sqrt(top / 1.1),
                       top);
            check_is("one that misses it", hollow(-top, closed), <, 0.0);
        }
        check_near("left at once", find(&from_rest, closed), 1e-10 * sqrt(2.0), ldexp(1.0, -40));
    }
}

TEST(switch_ends)
{
    for (int closed = 0; closed < 2; closed++) {
        struct gap leaving = {{-1.0, 0.0, 0.0, 8.0}, 0.5};           /* zero at the end, still opening */
        struct gap touching = {{-1.0, 4.0, -4.0, 0.0}, 0.5};         /* zero at the end, with rate zero */
        struct gap away = {{-1.0, -1.0, 0.0, 0.0}, 0.5};             /* moves away */
        struct gap valley = {{-1.0, -1.0, 3.0, 0.0}, 0.5};           /* away and back, stays below */
        struct gap dip_far = {{-1.0, 1.0, -1.0, 0.0}, 1.0};          /* tangents cross below zero */
        struct gap just_left = {{0.0, -1.0, -1.0, 0.0}, 0.5};        /* starts at zero and moves away */
        struct gap just_left_wrong = {{1e-17, -1.0, 0.0, 0.0}, 0.5}; /* just_left with a root's rounding */
        check_near("zero at the end, moving on", find(&leaving, closed), 0.5, 1e-12);
        check_near("zero at the end, turning there: not a switch yet", find(&touching, closed), -2.0, 0.0);
        check_near("moving away", find(&away, closed), -2.0, 0.0);
        check_near("a valley", find(&valley, closed), -2.0, 0.0);
        check_near("a dip whose tangents stay below", find(&dip_far, closed), -2.0, 0.0);
        check_near("a start at zero, moving away", find(&just_left, closed), -2.0, 0.0);
        check_near("the same with rounding", find(&just_left_wrong, closed), -2.0, 0.0);
    }
}

/* For every parabola the cheap test agrees with a scan: never
 * misses a switch, and refuses what the tangents exclude. */
TEST(switch_cheap_test_is_safe)
{
    uint64_t seed = 5;
    int missed = 0, wrong = 0, found = 0;
    for (int i = 0; i < 20000; i++) {
        struct gap g = {
            {-exact_uniform(&seed), 8.0 * exact_uniform(&seed) - 4.0, 8.0 * exact_uniform(&seed) - 4.0, 0.0},
            1.0};
        bool closed = i & 1;
        double peak = -g.c[1] / (2.0 * g.c[2]), top = fmax(g.c[0], g.c[0] + g.c[1] + g.c[2]);
        if (peak > 0.0 && peak < 1.0)
            top = fmax(top, g.c[0] + 0.5 * g.c[1] * peak);
        double at = find(&g, closed);
        found += top >= 0.0;
        missed += top > 1e-14 && at < 0.0;
        wrong += top < -1e-14 && at >= 0.0;
    }
    check_int("switches missed", missed, 0);
    check_int("switches found where there is none", wrong, 0);
    check_above("of 20,000 parabolas with a switch", found, 5000.0);
}

/* A model that stands still while its gap is the input. */
static void still_rhs(const double *p, const struct input *u, const double *x, double *x_dot)
{
    (void)p, (void)u, (void)x;
    x_dot[0] = x_dot[1] = 0.0;
}

static void input_gap(const double *p, const struct input *u, const double *x, struct input *gap)
{
    (void)p, (void)x;
    *gap = u[0];
}

static struct segment cosine_of(double offset, double phase, double omega)
{
    struct segment e = {.length = 1.0, .active = 1};
    e.wave[0] = (struct wave){offset, 0.0, 1.0, 0.0, cos(phase), sin(phase), omega};
    for (int k = 0; k < 3; k++) {
        e.at[k][0].value = (double)exact_wave(&e.wave[0], 0.5L * k);
        e.at[k][0].rate = (double)exact_wave_rate(&e.wave[0], 0.5L * k);
    }
    return e;
}

/* Gaps that are no cubics, up to most of a turn of a cosine in one step. The guess is poor, and Newton
 * alone would leave the step. The result must be a zero, inside the step, where the regime is left. */
TEST(switch_sharpened)
{
    struct model m = {.n_states = 2, .n_inputs = 1, .n_contacts = 1, .rhs = still_rhs, .gap = input_gap};
    uint64_t seed = 11;
    int n = 0, missed = 0, outside = 0, wrong_way = 0, residual = 0;
    double worst = 0.0;
    for (int i = 0; i < 20000; i++) {
        double omega = 0.5 + 4.5 * exact_uniform(&seed);
        double offset = 1.8 * exact_uniform(&seed) - 0.9, phase = 6.28 * exact_uniform(&seed);
        struct segment e = cosine_of(offset, phase, omega);
        double x[2] = {0.0, 0.0};
        struct crossing c = {-1.0, -1, 0, 0.0};
        bool closed = e.at[0][0].value < 0.0;
        enum step_status status = rk4.bind(&m)(&m, NULL, NULL, &e, closed ? 1u : 0u, x, &c);
        missed += (e.at[2][0].value < 0.0) != closed && status != STEP_SWITCH;
        if (status != STEP_SWITCH)
            continue;
        n++;
        residual += c.residual;
        outside += !(c.done > 0.0 && c.done <= 1.0) || c.contact != 0;
        wrong_way += (exact_wave_rate(&e.wave[0], (long double)c.done) > 0.0L) != closed;
        if (!c.residual)
            exact_worst(&worst, exact_wave(&e.wave[0], (long double)c.done));
    }
    check_above("switches in 20,000 steps", n, 5000.0);
    check_int("missed although the ends differ", missed, 0);
    check_int("outside the step, or of another contact", outside, 0);
    check_int("where the regime is entered, not left", wrong_way, 0);
    check_below("gap that is left", worst, 2e-14);
    check_int("roots that kept a residual", residual, 0);
}
