/* test_lever.c - the AFM lever's lock-in amplitude over 100 of its periods, at the steps that
 * docs/why/boards.md says are enough for 1e-3, against an integration of our own in extended precision. */
#include <math.h>
#include "firmware/observe/lockin.h"
#include "firmware/plant/plant.h"
#include "firmware/plant/plant_change.h"
#include "models/afm_tip.h"
#include "tests/unit/test.h"

#define TWO_PI 6.283185307179586477

enum { LEVER_PERIODS = 100, FINE = 2048 /* reference steps a period, at least */ };

static double scratch[METHOD_SCRATCH];

/* W = 3; driven by f = 0.008 at the tip's eigenfrequency sqrt(1 - sign beta). */
struct driven_tip {
    const char *name;
    double beta, sign, r;
    const struct method *method;
    double tol;
    double steps; /* a period of the lever */
};

static void paper_of(const struct driven_tip *c, double *paper)
{
    for (int i = 0; i < TIP_PAPER; i++)
        paper[i] = afm_tip_paper[i].initial;
    paper[TIP_PAPER_BETA] = c->beta;
    paper[TIP_PAPER_SIGN] = c->sign;
    paper[TIP_PAPER_R] = c->r;
    paper[TIP_PAPER_FAST_OMEGA] = 3.0;
    paper[TIP_PAPER_F] = 0.008;
    paper[TIP_PAPER_OMEGA] = sqrt(1.0 - c->sign * c->beta);
}

static int ticks_of(const struct driven_tip *c)
{
    return (int)lround(LEVER_PERIODS * c->steps);
}

static double measured_amplitude(const struct driven_tip *c)
{
    double paper[TIP_PAPER], si[TIP_PARAMETERS], amplitude, phase;
    struct harmonic drive[TIP_INPUTS];
    struct plant pl;
    struct lockin_window window;
    struct lockin_sum sum = {0.0, 0.0};
    paper_of(c, paper);
    afm_tip.from_paper(paper, si, drive);
    const struct plant_config config = {.model = &afm_tip,
                                        .si = si,
                                        .method = c->method,
                                        .tick_s = TWO_PI / c->steps,
                                        .dilation = 1.0,
                                        .tol = c->tol,
                                        .scratch = scratch};
    const char *why = plant_init(&pl, &config);
    check_no_error(why ? why : c->name, why);
    for (int i = 0; i < TIP_INPUTS; i++)
        if (drive[i].amplitude != 0.0)
            plant_drive_start(&pl, i, drive[i].amplitude, drive[i].omega / TWO_PI, drive[i].phase);
    lockin_begin(&window, (uint32_t)ticks_of(c));
    for (int i = 0; i < ticks_of(c) && plant_run(&pl, 1); i++) {
        const struct drive *d = &pl.drive[TIP_FORCE];
        lockin_add(&sum, 1, lockin_weight(&window) * pl.x[0], d->cosine, d->sine);
    }
    lockin_polar(&sum, 2.0 / window.weight, &amplitude, &phase);
    return amplitude;
}

/* eta'' of models/afm_tip.h, written down anew. */
static long double acceleration(const struct driven_tip *c, long double t, long double eta, long double rate)
{
    long double b = -2.0L / 3.0L * (long double)c->sign * (long double)c->beta,
                closed = eta > 0.0L ? eta : 0.0L;
    long double omega = sqrtl(1.0L - (long double)c->sign * (long double)c->beta);
    return 1.0L + b - eta - 0.008L * cosl(omega * t) - 0.02L * rate -
           b * (1.0L + (long double)c->r * cosl(3.0L * t)) * closed * sqrtl(closed);
}

static void reference_step(const struct driven_tip *c, long double t, long double h, long double *x)
{
    long double k1 = acceleration(c, t, x[0], x[1]), v2 = x[1] + h / 2 * k1;
    long double k2 = acceleration(c, t + h / 2, x[0] + h / 2 * x[1], v2), v3 = x[1] + h / 2 * k2;
    long double k3 = acceleration(c, t + h / 2, x[0] + h / 2 * v2, v3), v4 = x[1] + h * k3;
    long double k4 = acceleration(c, t + h, x[0] + h * v3, v4);
    x[0] += h / 6 * (x[1] + 2 * v2 + 2 * v3 + v4);
    x[1] += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
}

/* The lock-in's window at the instants of the plant's ticks, over the true motion. */
static double true_amplitude(const struct driven_tip *c)
{
    int n = ticks_of(c), fine = (int)ceil(FINE / c->steps);
    long double tick = 2.0L * acosl(-1.0L) / (long double)c->steps, h = tick / fine, x[2] = {1.0L, 0.0L};
    long double omega = sqrtl(1.0L - (long double)c->sign * (long double)c->beta);
    long double re = 0.0L, im = 0.0L, weight = 0.0L;
    for (int k = 0; k < n; k++) {
        for (int i = 0; i < fine; i++)
            reference_step(c, k * tick + i * h, h, x);
        long double w = 0.5L - 0.5L * cosl(2.0L * acosl(-1.0L) * (k + 0.5L) / n), t = (k + 1) * tick;
        re += w * x[0] * cosl(omega * t);
        im -= w * x[0] * sinl(omega * t);
        weight += w;
    }
    return (double)(2.0L / weight * sqrtl(re * re + im * im));
}

TEST(lever_amplitude)
{
    static const struct driven_tip CASE[] = {
        {"beta 0.8, attracted, rk4", 0.8, 1.0, 0.5, &rk4, 0.0, 24},
        {"beta 0.8, attracted, adams, 16 ticks", 0.8, 1.0, 0.5, &adams, 0.0, 16},
        {"beta 0.8, attracted, adams, 24 ticks", 0.8, 1.0, 0.5, &adams, 0.0, 24},
        {"beta 0.8, repelled, adams", 0.8, -1.0, 0.5, &adams, 0.0, 32},
        {"beta 29.7, repelled, adams", 29.7, -1.0, 0.0, &adams, 0.0, 128},
        {"beta 0.8, attracted, rk4_float32", 0.8, 1.0, 0.5, &rk4_float32, 0.0, 24},
        {"beta 0.8, repelled, rk4", 0.8, -1.0, 0.5, &rk4, 0.0, 48},
        /* relative to the whole motion, of which this amplitude is a part */
        {"beta 0.8, repelled, taylor", 0.8, -1.0, 0.5, &taylor, 3e-4, 16},
        {"beta 29.7, repelled, taylor", 29.7, -1.0, 0.0, &taylor, 1e-4, 22.165},
    };
    for (unsigned i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        double truth = true_amplitude(&CASE[i]);
        check_above("the tip moves", truth, 1e-3);
        check_below(CASE[i].name, fabs(measured_amplitude(&CASE[i]) / truth - 1.0), 1e-3);
    }
}
