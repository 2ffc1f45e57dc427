/* test_lockin.c - the lock-in against the closed form of a Hann-windowed sum. */
#include "tests/unit/test.h"

#include <complex.h>
#include <math.h>
#include "firmware/observe/lockin.h"

static const double TWO_PI = 6.283185307179586;

/* y_k = offset + amplitude cos(n theta_k + phase) + other cos(2 pi other_turns k + other_phase),
 * theta_k = 2 pi (turns k + start) */
struct tones {
    uint32_t n_ticks, harmonic;
    double turns, start;
    double offset, amplitude, phase;
    double other, other_turns, other_phase;
};

static double signal_at(const struct tones *t, uint32_t k)
{
    double theta = TWO_PI * (t->turns * k + t->start);
    return t->offset + t->amplitude * cos(t->harmonic * theta + t->phase) +
           t->other * cos(TWO_PI * t->other_turns * k + t->other_phase);
}

static double complex unit_at(double angle)
{
    return cos(angle) + sin(angle) * (double complex)I;
}

/* sum over m = -(n-1)/2 .. (n-1)/2 of exp(i x m) */
static double dirichlet(double x, double n)
{
    double s = sin(0.5 * x);
    return fabs(s) < 1e-13 ? n : sin(0.5 * n * x) / s;
}

/* sum of w_k exp(i (delta k + alpha)) over the window: about its middle, w = 1/2 + cos(2 pi m / n) / 2 */
static double complex hann_sum(double delta, double alpha, double n)
{
    double side = TWO_PI / n;
    double sum = n == 1.0 ? 1.0
                          : 0.5 * dirichlet(delta, n) +
                                0.25 * (dirichlet(delta + side, n) + dirichlet(delta - side, n));
    return sum * unit_at(delta * 0.5 * (n - 1.0) + alpha);
}

static double complex expected(const struct tones *t)
{
    double n = t->n_ticks, weight = n == 1.0 ? 1.0 : 0.5 * n;
    double w = TWO_PI * t->turns * t->harmonic, a = TWO_PI * t->start * t->harmonic;
    double v = TWO_PI * t->other_turns;
    double complex sum = t->offset * hann_sum(-w, -a, n);
    sum += 0.5 * t->amplitude * (hann_sum(0.0, t->phase, n) + hann_sum(-2.0 * w, -2.0 * a - t->phase, n));
    sum +=
        0.5 * t->other * (hann_sum(v - w, t->other_phase - a, n) + hann_sum(-v - w, -t->other_phase - a, n));
    return 2.0 / weight * sum;
}

/* A window, its sum and its harmonic. */
struct slot {
    struct lockin_window window;
    struct lockin_sum sum;
    uint32_t harmonic;
};

static void slot_start(struct slot *l, uint32_t n_ticks, uint32_t harmonic)
{
    *l = (struct slot){.harmonic = harmonic};
    lockin_begin(&l->window, n_ticks);
}

/* True at the end of a window, and the next one begins. */
static bool slot_add(struct slot *l, double y, double cosine, double sine, double *amplitude, double *phase)
{
    lockin_add(&l->sum, l->harmonic, lockin_weight(&l->window) * y, cosine, sine);
    if (l->window.i_tick < l->window.n_ticks)
        return false;
    lockin_polar(&l->sum, 2.0 / l->window.weight, amplitude, phase);
    slot_start(l, l->window.n_ticks, l->harmonic);
    return true;
}

/* The result of the first window as a complex number; *at is the number of samples it took. */
static double complex measured(const struct tones *t, uint32_t *at)
{
    struct slot l;
    double amplitude = -1.0, phase = 0.0;
    slot_start(&l, t->n_ticks, t->harmonic);
    for (*at = 0; *at < 2 * t->n_ticks;) {
        double theta = TWO_PI * (t->turns * *at + t->start);
        double y = signal_at(t, (*at)++);
        if (slot_add(&l, y, cos(theta), sin(theta), &amplitude, &phase))
            break;
    }
    return amplitude * unit_at(phase);
}

TEST(lockin_closed_form)
{
    static const struct tones CASE[] = {
        {1000, 1, 0.01, 0.0, 0.0, 2.0, 0.7, 0.0, 0.0, 0.0},
        {1000, 1, 0.01, 0.3, 5.0, 2.0, -2.9, 0.0, 0.0, 0.0},
        {1000, 1, 0.0123, 0.3, 5.0, 2.0, 3.1, 1.0, 0.0345678, 1.0},
        {640, 2, 0.0123, 0.6, -3.0, 1e-3, 1.5, 1.0, 0.0345678, 1.0},
        {640, 16, 0.0023, 0.6, -3.0, 4.0, 2.5, 1.0, 0.0345678, 1.0},
        {977, 3, 0.1, 0.25, 1.0, 1.0, 0.0, 0.5, 0.31, -2.0},
        {2, 1, 0.1, 0.25, -1.5, 1.0, 0.4, 1.0, 0.31, -2.0},
        {1, 1, 0.1, 0.15, -1.5, 1.0, 0.4, 1.0, 0.31, -2.0},
    };
    for (int i = 0; i < 8; i++) {
        uint32_t at;
        double complex z = measured(&CASE[i], &at), ideal = expected(&CASE[i]);
        check_below(check_name("n_ticks %u harmonic %u: |z| %.9g, off the closed form", (unsigned)at,
                               (unsigned)CASE[i].harmonic, cabs(ideal)),
                    cabs(z - ideal), 1e-12);
        check_int("samples in a window", at, CASE[i].n_ticks);
    }
    struct tones whole = CASE[1];
    uint32_t at;
    double complex z = measured(&whole, &at);
    check_near("whole periods: amplitude", cabs(z), 2.0, 1e-12);
    check_near("whole periods: phase", carg(z), -2.9, 1e-12);
    whole.n_ticks = 4000000;
    z = measured(&whole, &at);
    check_near("4e6 ticks: amplitude", cabs(z), 2.0, 1e-9);
    check_near("4e6 ticks: phase", carg(z), -2.9, 1e-9);
}

/* Each window ends at its last tick and knows nothing of the one before. */
TEST(lockin_windows)
{
    struct slot l;
    double amplitude = 0.0, phase = 0.0;
    int ends = 0, right = 0;
    slot_start(&l, 50, 1);
    for (int k = 0; k < 500; k++) {
        double theta = TWO_PI * 0.1 * k, window = k / 50;
        if (!slot_add(&l, (1.0 + window) * cos(theta + 0.1 * window), cos(theta), sin(theta), &amplitude,
                      &phase))
            continue;
        ends++;
        right += k % 50 == 49 && fabs(amplitude - 1.0 - window) < 1e-13 && fabs(phase - 0.1 * window) < 1e-13;
    }
    check_int("windows in 500 ticks of 50", ends, 10);
    check_int("... each with its own amplitude and phase", right, 10);
}

TEST(lockin_leakage)
{
    static const double DISTANCE[] = {1.5, 2.5, 5.5, 10.5, 20.5, 40.5};
    uint32_t at;
    for (int i = 0; i < 6; i++) {
        double d = DISTANCE[i], bound = 1.0 / (0.5 * TWO_PI * d * (d * d - 1.0));
        struct tones tone = {.n_ticks = 4000, .harmonic = 1, .turns = 0.2, .other = 1.0};
        tone.other_turns = 0.2 + d / 4000.0;
        check_below(check_name("a tone %.1f periods away leaks", d), cabs(measured(&tone, &at)),
                    bound * 1.001);
        struct tones offset = {.n_ticks = 4000, .harmonic = 1, .turns = d / 4000.0, .offset = 1.0};
        check_below(check_name("an offset over %.1f periods leaks", d), cabs(measured(&offset, &at)),
                    2.0 * bound * 1.001);
    }
}

/* The phasor is the drive's own: a frequency that doubles within the window changes nothing. */
TEST(lockin_chirp)
{
    struct slot l;
    double amplitude = 0.0, phase = 0.0;
    int n = 10000;
    slot_start(&l, (uint32_t)n, 2);
    for (int k = 0; k < n; k++) {
        double theta = TWO_PI * (0.02 * k + 0.01 / n * k * k);
        (void)slot_add(&l, 1.0 + 3.0 * cos(2.0 * theta - 1.0), cos(theta), sin(theta), &amplitude, &phase);
    }
    check_near("chirp: amplitude of harmonic 2", amplitude, 3.0, 1e-6);
    check_near("chirp: phase of harmonic 2", phase, -1.0, 1e-6);
}
