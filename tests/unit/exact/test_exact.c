/* test_exact.c - method exact on one degree of freedom, against closed forms in extended precision. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "models/hertz_rig.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/gap_oscillator.h"

/* x'' + 2 zeta x' + k x = 0 from (x0, v0): the textbook's three cases. */
static void free_motion(long double zeta, long double k, long double t, long double *x, long double *v)
{
    long double d = zeta * zeta - k, x0 = *x, v0 = *v, c, s; /* c = cosh, s = sinh / root */
    if (d < 0.0L) {
        long double w = sqrtl(-d);
        c = cosl(w * t), s = sinl(w * t) / w;
    } else if (d == 0.0L) {
        c = 1.0L, s = t;
    } else {
        long double w = sqrtl(d);
        c = coshl(w * t), s = sinhl(w * t) / w;
    }
    long double e = expl(-zeta * t);
    *x = e * (x0 * c + (v0 + zeta * x0) * s);
    *v = e * (v0 * c - (k * x0 + zeta * v0) * s);
}

/* Undamped, overdamped, critical, rigid, unstable: no case is special. */
TEST(exact_free)
{
    static const double set[7][2] = {{0.0, 1.0}, {0.02, 1.0}, {1.0, 1.0}, {1.0 + 1e-9, 1.0},
                                     {3.0, 1.0}, {0.0, 0.0},  {0.1, -0.5}};
    static struct gap_run run;
    for (int i = 0; i < 7; i++) {
        double si[GAP_PARAMETERS] = {set[i][0], set[i][1], 0.0, 1e6}, x[2] = {0.3, -0.7}, error = 0.0,
               size = 0.0;
        gap_start(&run, &gap_oscillator, &exact, si, NULL, 0.3, x);
        for (int n = 1; n <= 60; n++) {
            long double a = (long double)x[0], b = (long double)x[1];
            gap_advance(&run, 1, NULL, NULL);
            free_motion((long double)si[GAP_ZETA], (long double)si[GAP_K], (long double)run.plant.h * n, &a,
                        &b);
            error = fmax(error, fabs(run.plant.x[0] - (double)a) + fabs(run.plant.x[1] - (double)b));
            size = fmax(size, (double)(fabsl(a) + fabsl(b)));
        }
        check_below(check_name("zeta %g, k %g: free motion over 60 ticks", si[GAP_ZETA], si[GAP_K]), error,
                    1e-14 * size);
    }
}

/* Ticks as long as allowed, in parts of every length: the curves inside a tick, velocities too. */
TEST(exact_parts)
{
    /* fastest: 1, 1, 2, 2 */
    static const double set[4][2] = {{0.0, 1.0}, {1.0, 1.0}, {0.1, 4.0}, {1.25, 1.0}};
    static const double fastest[4] = {1.0, 1.0, 2.0, 2.0};
    static struct gap_run run;
    for (int i = 0; i < 4; i++) {
        double si[GAP_PARAMETERS] = {set[i][0], set[i][1], 0.0, 1e6}, x[2] = {0.3, -0.7}, error = 0.0;
        gap_start(&run, &gap_oscillator, &exact, si, NULL, 2.05 / fastest[i], x);
        for (uint32_t n = 1; n <= 60; n++) {
            long double a = (long double)x[0], b = (long double)x[1];
            struct instant to = {n * 5u / 64u, n * 5u % 64u * (TICK_FRACTIONS / 64u)};
            check_true("a part", plant_advance(&run.plant, to));
            free_motion((long double)si[GAP_ZETA], (long double)si[GAP_K],
                        (long double)run.plant.h * n * 5.0L / 64.0L, &a, &b);
            error = fmax(error, fabs(run.plant.x[0] - (double)a) + fabs(run.plant.x[1] - (double)b));
        }
        check_below(check_name("zeta %g, k %g: in parts of 5/64 of a tick", si[GAP_ZETA], si[GAP_K]), error,
                    1e-14);
    }
}

/* Steady response to force and base, damped: amplitude and phase of the textbook. */
TEST(exact_damped)
{
    static struct gap_run run;
    const double si[GAP_PARAMETERS] = {0.05, 1.0, 0.0, 1e6}, zero[2] = {0.0, 0.0};
    const struct harmonic drive[3] = {{0.7, 0.8, 0.3}, {0.2, 3.1, -1.0}, {0.4, 1.7, 2.0}};
    double error = 0.0;
    gap_start(&run, &gap_oscillator, &exact, si, drive, 0.25, zero);
    gap_advance(&run, 3200, NULL, NULL); /* e^{-0.05 * 800} of the start is left */
    for (int n = 3201; n < 3300; n++) {
        long double x = 0.0L;
        gap_advance(&run, 1, NULL, NULL);
        for (int i = 0; i < 3; i++) {
            long double w = (long double)drive[i].omega, re = 1.0L - w * w,
                        im = 2.0L * (long double)si[GAP_ZETA] * w;
            long double cosine = cosl(w * 0.25L * n + (long double)drive[i].phase);
            long double sine = sinl(w * 0.25L * n + (long double)drive[i].phase);
            /* f cos + g sin has the response ((f re - g im) cos + (f im + g re) sin)/(re^2 + im^2) */
            long double f = 1.0L, g = i == 2 ? -im : 0.0L; /* the base acts through spring and damper */
            long double c = f * re - g * im, s = f * im + g * re;
            x += (long double)drive[i].amplitude * (c * cosine + s * sine) / (re * re + im * im);
        }
        error = fmax(error, fabs(run.plant.x[0] - (double)x));
    }
    check_below("force and base, steady state", error, 2e-13);
}

/* A drive exactly on an undamped mode: x = a t sin(t)/2,
 * no steady response exists. And with a gap never reached. */
TEST(exact_resonance)
{
    static struct gap_run run;
    const double si[GAP_PARAMETERS] = {0.0, 1.0, 50.0, 1e6}, zero[2] = {0.0, 0.0};
    const struct harmonic drive[3] = {{1.0, 1.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    double error = 0.0;
    gap_start(&run, &gap_oscillator, &exact, si, drive, 0.2, zero);
    for (int n = 1; n <= 1000; n++) {
        gap_advance(&run, 1, NULL, NULL);
        double t = 0.2 * n;
        error = fmax(error, fabs(run.plant.x[0] - 0.5 * t * sin(t)));
        error = fmax(error, fabs(run.plant.x[1] - 0.5 * (sin(t) + t * cos(t))));
    }
    check_below("resonance, amplitude 100", error, 1e-11);
}

/* Free vibration between two gap springs without damping: equal contacts, equal crossings of the gap. */
struct bounces {
    long double gap_time, contact_time, first, worst;
    int n;
};

static void time_bounce(void *context, const struct plant *pl, const struct event *e)
{
    struct bounces *b = context;
    long double t = ((long double)e->tick + (long double)e->fraction) * (long double)pl->tick_s;
    /* event n: n/2 contacts and n/2 crossings (rounded up) after the first touchdown */
    long double expected =
        b->first + (b->n / 2) * (b->contact_time + b->gap_time) + (b->n % 2) * b->contact_time;
    b->worst = fmaxl(b->worst, fabsl(t - expected));
    b->n++;
}

TEST(exact_bounce)
{
    static struct gap_run run;
    /* through x = 0 with v: reaches g = 1 at asin(1/v); speed there sqrt(v^2 - 1) */
    const double x[2] = {0.0, 1.5};
    const long double v = 1.5L, kappa = 400.0L;
    static const double tick[4] = {0.1, 0.03, 0.01, 0.003};
    const double si[GAP_PARAMETERS] = {0.0, 1.0, 400.0, 1.0};
    long double w = sqrtl(1.0L + kappa), u = sqrtl(v * v - 1.0L);
    for (int i = 0; i < 4; i++) {
        /* in contact x = c + (1 - c) cos w t + (u/w) sin w t about c = kappa/w^2; back at 1 with -u */
        struct bounces b = {.first = asinl(1.0L / v), .gap_time = 2.0L * asinl(1.0L / v)};
        long double c = kappa / (w * w);
        b.contact_time = 2.0L * atan2l(u / w, 1.0L - c) / w;
        int ticks = (int)(100.0 / tick[i]);
        char text[80];
        gap_start(&run, &gap_oscillator, &exact, si, NULL, tick[i], x);
        gap_advance(&run, (uint64_t)ticks, time_bounce, &b);
        int expected = 2 * (int)((100.0L - b.first) / (b.gap_time + b.contact_time));
        snprintf(text, sizeof text, "tick %g: switches in 100", tick[i]);
        check_above(text, b.n, expected);
        check_below(text, b.n, expected + 2);
        /* In contact kappa x and kappa g cancel but for 1: kappa eps = 1e-13 of the force is lost each time,
         * adds up over 66 switches, and shifts what follows. */
        check_below("worst instant of a switch", (double)b.worst, 3e-11);
        double energy = gap_oscillator.energy(run.plant.p, run.plant.segment.at[2], run.plant.x);
        check_near("energy at the end", energy, 1.125, 2e-12);
    }
}

/* A dip of depth d into the gap spring, inside one tick, at its very ends, and one that misses by d. */
TEST(exact_grazing)
{
    static struct gap_run run;
    const double si[GAP_PARAMETERS] = {0.0, 1.0, 50.0, 1.0};
    for (int power = 3; power <= 10; power++) {
        double d = pow(10.0, -power);
        int found = 0, missed = 0;
        double error = 0.0;
        for (int shift = 0; shift < 25; shift++) {
            double reach = 1.0 + d, angle = -1.0 - 0.011 * shift; /* x = reach cos(t + angle) */
            const double x[2] = {reach * cos(angle), -reach * sin(angle)};
            const double low[2] = {(1.0 - d) * cos(angle), -(1.0 - d) * sin(angle)};
            struct event e;
            gap_start(&run, &gap_oscillator, &exact, si, NULL, 0.28, x);
            if (!plant_run(&run.plant, 6) || !plant_take_event(&run.plant, &e))
                continue;
            double t = ((double)e.tick + e.fraction) * run.plant.tick_s;
            error = fmax(error, fabs(t + acos(1.0 / reach) + angle));
            found += e.touch && plant_take_event(&run.plant, &e) && !e.touch;
            gap_start(&run, &gap_oscillator, &exact, si, NULL, 0.28, low);
            missed += plant_run(&run.plant, 6) && !plant_take_event(&run.plant, &e);
        }
        check_int(check_name("depth 1e-%d of the gap: touchdown and lift-off", power), found, 25);
        check_int("a miss by as much: no switch", missed, 25);
        /* an instant is as well defined as rounding of x over the speed sqrt(2 d) there */
        check_below("instant of the touchdown", error, 1e-15 / sqrt(d) + 1e-15);
    }
}

/* A free mass under F cos(3 t + phi), one tick from t = 0
 * to 1: y(t) = drift t - (F/9) (cos(3 t + phi) - cos phi). */
struct free_mass {
    double force, phi, drift;
};

static long double free_path(const struct free_mass *q, long double t)
{
    long double phi = (long double)q->phi;
    return (long double)q->drift * t - (long double)q->force / 9.0L * (cosl(3.0L * t + phi) - cosl(phi));
}

/* Where the path rises through `level` between a and b. */
static double free_crossing(const struct free_mass *q, long double level, long double a, long double b)
{
    for (int i = 0; i < 100; i++) {
        long double t = 0.5L * (a + b);
        *(free_path(q, t) < level ? &a : &b) = t;
    }
    return (double)a;
}

/* Starts so that the path meets the wall above at `level`, and takes one tick. */
static void check_double_turn(const char *text, const struct free_mass *q, long double level, long double a,
                              long double b)
{
    static struct gap_run run;
    const double si[GAP_PARAMETERS] = {0.0, 0.0, 1.0, 2.0};
    const struct harmonic drive[3] = {{q->force, 3.0, q->phi}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    const double x[2] = {(double)(2.0L - level), q->drift + q->force / 3.0 * sin(q->phi)};
    struct event e = {.fraction = -1.0};
    gap_start(&run, &gap_oscillator, &exact, si, drive, 1.0, x);
    check_true("one tick", plant_run(&run.plant, 1));
    check_true("a touchdown", plant_take_event(&run.plant, &e));
    check_true("a touchdown", e.touch);
    check_int("a touchdown", e.contact, 0);
    check_near(text, e.fraction, free_crossing(q, level, a, b), 1e-13);
}

/* Out of the gap and back with rates of the same sign at both ends: up, down and up in one tick, or down, up
 * and down. The ends' rates do not show the turn, only the rate half-way does. */
TEST(exact_double_turn)
{
    const double alpha = 0.3, margin = 0.5 * (3.0 - (M_PI - 2.0 * alpha));
    const struct free_mass up = {9.0, M_PI + alpha - margin, 3.0 * sin(alpha)},
                           down = {-9.0, up.phi, -up.drift};
    /* the rate drift + 3 sin(3 t + phi) of `up` is negative from `first` to `second` */
    const long double first = (long double)(margin / 3.0), second = 1.0L - first;
    for (int i = 1; i < 10; i++) {
        long double top = free_path(&up, first), end = free_path(&down, 1.0L), share = 0.1L * i;
        check_double_turn("up, down, up: touchdown", &up, share * top, 0.0L, first);
        top = free_path(&down, second);
        check_double_turn("down, up, down: touchdown", &down, end + share * (top - end), 0.5L, second);
    }
}

static const char *refusal(const struct model *m, const double *si, double h)
{
    double p[MODEL_DERIVED];
    struct scale scale;
    m->prepare(si, p, &scale);
    const char *why = exact.refuse(m, p, h, 0.0);
    return why ? why : "accepted";
}

/* The shaft with a system of its own in each regime. */
static bool ever_other(const double *p, unsigned regime, struct linear *l)
{
    bool exists = shaft_bearing.linear(p, regime, l);
    l->a[3][0] -= 1e-3 * (double)regime;
    return exists;
}

TEST(exact_refusal)
{
    struct model other = shaft_bearing;
    double shaft[MODEL_PARAMETERS];
    /* fastest: sqrt(1 + 99) = 10 while a contact is closed */
    const double si[GAP_PARAMETERS] = {0.0, 1.0, 99.0, 1.0},
                 overdamped[GAP_PARAMETERS] = {5.05, 1.0, 0.0, 1.0};
    double rig[MODEL_PARAMETERS];
    for (int i = 0; i < hertz_rig.n_parameters; i++)
        rig[i] = hertz_rig.parameter[i].initial;
    check_string("lambda h = 2.095", refusal(&gap_oscillator, si, 0.2095), "accepted");
    check_string("lambda h = 2.105",
                 strstr(refusal(&gap_oscillator, si, 0.2105), "coarse") ? "coarse" : "accepted", "coarse");
    /* lambda = -10 and -0.1 */
    check_string("real lambda h = 2.095", refusal(&gap_oscillator, overdamped, 0.2095), "accepted");
    check_contains("real lambda h = 2.105", refusal(&gap_oscillator, overdamped, 0.2105), "coarse");
    check_contains("a Hertz contact", refusal(&hertz_rig, rig, 1e-6), "piecewise linear");
    check_string("its linear model", refusal(&hertz_rig_linear, rig, 0.1), "accepted");
    for (int i = 0; i < shaft_bearing.n_parameters; i++)
        shaft[i] = shaft_bearing.parameter[i].initial;
    other.linear = ever_other;
    check_string("nine regimes, four systems", refusal(&shaft_bearing, shaft, 0.1), "accepted");
    check_contains("nine systems", refusal(&other, shaft, 0.1), "four different");
    check_contains("step not a number", refusal(&gap_oscillator, si, (double)NAN), "coarse");
}

/* One step of the method itself. */
static enum step_status step(double *scratch, double h, unsigned regime, double *x, struct crossing *c)
{
    struct segment e;
    double p[MODEL_DERIVED] = {0.0, 1.0, 99.0, 1.0};
    memset(&e, 0, sizeof e);
    e.length = h;
    return exact.bind(&gap_oscillator)(&gap_oscillator, p, scratch, &e, regime, x, c);
}

/* Forced past its limit the method stops short of the end and says so, and what it has found is right. */
TEST(exact_far)
{
    static double scratch[METHOD_SCRATCH];
    const double p[MODEL_DERIVED] = {0.0, 1.0, 99.0, 1.0};
    double x[2] = {0.5, 0.25}, t = 0.0;
    struct crossing c = {0.0, 0, 0, 0.0};
    int pieces = 0;
    exact.prepare(&gap_oscillator, p, 2.0, 0.0, scratch);
    /* open the rate is 1 and h = 2 within reach; closed it is 10 */
    check_int("open, within reach", step(scratch, 2.0, 0, x, &c), STEP_END);
    x[0] = 0.0, x[1] = 2.0;
    check_int("touchdown", step(scratch, 2.0, 0, x, &c), STEP_SWITCH);
    check_near("at asin(1/2)", c.done, asin(0.5), 1e-15);
    for (enum step_status s = STEP_BUDGET; s == STEP_BUDGET && pieces < 20; pieces++) {
        s = step(scratch, 2.0 - t, 1, x, &c);
        t += c.done;
    }
    check_above("pieces", pieces, 2);
    /* x = 0.99 + 0.01 cos 10 t + (sqrt 3/10) sin 10 t */
    check_near("lift-off", t, 0.2 * atan2(sqrt(3.0) / 10.0, 0.01), 1e-15);
    check_near("speed kept", x[1], -sqrt(3.0), 1e-14);
    check_int("no such regime", step(scratch, 0.1, 3, x, &c), STEP_NOT_FINITE);
    x[0] = (double)INFINITY;
    check_int("not finite", step(scratch, 0.1, 0, x, &c), STEP_NOT_FINITE);
}

/* Run through without stops: the same end as with every switch taken. */
TEST(exact_any)
{
    static double scratch[METHOD_SCRATCH];
    const double p[MODEL_DERIVED] = {0.0, 1.0, 99.0, 1.0};
    double x[2] = {0.3, 3.0}, y[2] = {0.3, 3.0}, left = 0.2;
    struct crossing c = {0.0, 0, 0, 0.0};
    unsigned regime = 0;
    int switches = 0;
    exact.prepare(&gap_oscillator, p, 0.2, 0.0, scratch);
    for (int tick = 0; tick < 50; tick++) {
        left = 0.2;
        while (step(scratch, left, regime, x, &c) == STEP_SWITCH) {
            regime ^= 1u << c.contact;
            left -= c.done;
            switches++;
        }
        check_int("through", step(scratch, 0.2, REGIME_ANY, y, &c), STEP_END);
    }
    check_above("switches on the way", switches, 20);
    check_near("position", y[0], x[0], 1e-13);
    check_near("velocity", y[1], x[1], 1e-12);
}
