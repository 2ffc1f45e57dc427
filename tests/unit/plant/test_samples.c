/* test_samples.c - samples told ahead: a linear rig under a staircase of force against the closed form, and
 * long arrays against each sample told at its instant. And samples that are reached by ramps. */
#include "tests/unit/test.h"

#include <math.h>
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/hertz_rig.h"
#include "models/models.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "tests/fixture/exact.h"

enum { SAMPLES = 700, HELD = 150 };

static struct plant pl, other;
static double scratch[METHOD_SCRATCH], other_scratch[METHOD_SCRATCH];
static double sample[SAMPLES]; /* model units */

static void draw_samples(double most)
{
    uint64_t seed = 5;
    for (int k = 0; k < SAMPLES; k++)
        sample[k] = most * (2.0 * exact_uniform(&seed) - 1.0);
}

/* A tick is `angle` of the eigenfrequency's radian. */
static bool start(struct plant *to, const struct model *m, const struct method *method, double angle,
                  double tol, double *memory)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct scale scale;
    for (int i = 0; i < m->n_parameters; i++)
        si[i] = m->parameter[i].initial;
    m->prepare(si, p, &scale);
    const struct plant_config c = {.model = m,
                                   .si = si,
                                   .method = method,
                                   .tick_s = angle / m->eigenfrequency(p) * scale.time_s,
                                   .dilation = 1.0,
                                   .tol = tol,
                                   .scratch = memory};
    return plant_init(to, &c) == NULL;
}

static void to_si(const struct plant *of, double *si)
{
    double unit = scale_of(&of->scale, of->model->input_signal[RIG_FORCE].quantity);
    for (int k = 0; k < SAMPLES; k++)
        si[k] = sample[k] * unit;
}

/* x'' = load - stiffness x - damping x', load = constant + gain u; what u delivers. */
struct swing {
    long double x, v, work;
};

static void swing_on(const struct polynomial_form *f, long double u, long double time, struct swing *s)
{
    long double delta = 0.5L * (long double)f->damping, square = -(long double)f->constant[1];
    long double gain = (long double)f->modulation[0][RIG_FORCE], omega = sqrtl(square - delta * delta);
    long double rest = ((long double)f->constant[0] + gain * u) / square, x = s->x - rest, v = s->v;
    long double fade = expl(-delta * time), c = cosl(omega * time), d = sinl(omega * time) / omega;
    s->x = rest + fade * (c * x + d * (v + delta * x));
    s->v = fade * (c * v - d * (delta * v + square * x));
    s->work += gain * u * (s->x - rest - x);
}

static void check_staircase(const struct method *method, uint64_t ticks, double tolerance, double of_ledger)
{
    static double si[SAMPLES];
    struct polynomial_form f;
    check_true(method->name, start(&pl, &hertz_rig_linear, method, 0.05, 1e-12, scratch));
    draw_samples(0.3);
    to_si(&pl, si);
    hertz_rig_linear.polynomial_form(pl.p, &f);
    struct swing s = {(long double)pl.x[0], (long double)pl.x[1], 0.0L};
    for (int k = 0; k < SAMPLES; k++)
        swing_on(&f, (long double)sample[k], (long double)pl.h * ticks, &s);
    check_true("finite", plant_run_samples(&pl, RIG_FORCE, si, SAMPLES, ticks));
    check_near("displacement", pl.x[0], (double)s.x, tolerance);
    check_near("velocity", pl.x[1], (double)s.v, tolerance);
    check_near("work", sum_of(&pl.ledger.work[RIG_FORCE]), (double)s.work, of_ledger);
    check_near("residual over all that moved", plant_residual(&pl) / pl.scale.energy_J / pl.ledger.gross, 0.0,
               of_ledger);
}

/* By rk4 the error is the method's, of order 4. By the others books are off by the ledger's rule: Simpson's
 * has (h omega)^4/2880, 2e-9. */
TEST(samples_staircase)
{
    for (uint64_t ticks = 1; ticks <= 3; ticks++) {
        check_staircase(&rk4, ticks, 1e-6, 1e-6);
        check_staircase(&exact, ticks, 1e-12, 1e-8);
        check_staircase(&taylor, ticks, 1e-11, 1e-8);
    }
}

/* Under a load that begins at u and climbs by `rate`: the rest moves, too. */
static void swing_up(const struct polynomial_form *f, long double u, long double rate, long double time,
                     struct swing *s)
{
    long double square = -(long double)f->constant[1];
    long double drift = (long double)f->modulation[0][RIG_FORCE] * rate / square;
    long double behind = (long double)f->damping * drift / square;
    s->x += behind;
    s->v -= drift;
    swing_on(f, u, time, s);
    s->x += drift * time - behind;
    s->v += drift;
}

/* A sample a frame, reached at its end, as a controller in a loop tells them. */
static void check_ramps(const struct method *method, uint64_t ticks, double tolerance)
{
    static double si[SAMPLES];
    struct polynomial_form f;
    double before = 0.0;
    bool good = start(&pl, &hertz_rig_linear, method, 0.05, 1e-12, scratch);
    draw_samples(0.3);
    to_si(&pl, si);
    hertz_rig_linear.polynomial_form(pl.p, &f);
    struct swing s = {(long double)pl.x[0], (long double)pl.x[1], 0.0L};
    for (int k = 0; k < SAMPLES && good; k++) {
        long double time = (long double)pl.h * ticks;
        swing_up(&f, (long double)before, ((long double)sample[k] - (long double)before) / time, time, &s);
        before = sample[k];
        plant_sample(&pl, RIG_FORCE, si[k], ticks);
        good = plant_run(&pl, ticks);
    }
    check_true(method->name, good);
    check_near("displacement", pl.x[0], (double)s.x, tolerance);
    check_near("velocity", pl.x[1], (double)s.v, tolerance);
    check_near("residual over all that moved", plant_residual(&pl) / pl.scale.energy_J / pl.ledger.gross, 0.0,
               5e-6);
}

/* The force has a kink at each sample, of which the ledger's rule sees the tick behind; rk4 runs for 1e4 rad.
 */
TEST(samples_ramps)
{
    static const uint64_t ticks[] = {1, 3, 64};
    for (int i = 0; i < 3; i++) {
        check_ramps(&rk4, ticks[i], 1e-5);
        check_ramps(&exact, ticks[i], 1e-12);
        check_ramps(&taylor, ticks[i], 1e-11);
    }
}

/* Equal bits by samples told ahead, in calls of various lengths, and by each told at its instant; the last of
 * each call is held. */
static void check_ahead(const struct model *m, const struct method *method, uint64_t ticks, double most)
{
    static double si[SAMPLES];
    if (!start(&pl, m, method, 0.02, 1e-3, scratch) || !start(&other, m, method, 0.02, 1e-3, other_scratch))
        return;
    draw_samples(most);
    to_si(&pl, si);
    bool good = true;
    uint32_t length = 1;
    for (uint32_t k = 0; k < SAMPLES && good; k += length) {
        length = 2 * length + 1 < SAMPLES - k ? 2 * length + 1 : SAMPLES - k;
        for (uint32_t j = k; j < k + length && good; j++) {
            plant_sample(&other, RIG_FORCE, si[j], 0);
            good = plant_run(&other, ticks);
        }
        good = good && plant_run_samples(&pl, RIG_FORCE, &si[k], length, ticks);
        good = good && plant_run(&other, HELD) && plant_run(&pl, HELD);
    }
    check_true(method->name, good);
    check_hex("the same bits", plant_hash(&pl), plant_hash(&other));
    check_int("switches", (int)pl.counts.switches, (int)other.counts.switches);
    check_near("peak force", pl.peak_force, other.peak_force, 0.0);
    check_near("all that moved", pl.ledger.gross, other.ledger.gross, 0.0);
}

/* Longer than a phasor lasts, with contact kept and lost, held for one tick up to more than auto calls
 * steady. */
TEST(samples_ahead)
{
    static const uint64_t ticks[] = {1, 2, 5, 40};
    for (int i = 0; i < METHODS; i++) {
        for (int k = 0; k < 4; k++) {
            check_ahead(&hertz_rig, method_table[i], ticks[k], 0.2);
            check_ahead(&hertz_rig, method_table[i], ticks[k], 4.0);
        }
    }
}
