/* test_noise_motion.c - random motion: the methods against each other on one noise path, the linear plant's
 * exact covariance, and Nayak's stationary density of the rolling contact. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/exact.h"
#include "tests/fixture/paper.h"

#define PI 3.14159265358979323846

enum { BATCHES = 40 };
static double memory[METHOD_SCRATCH];

/* A plant in the paper's time and default parameters,
 * with this damping ratio where it has one called zeta. */
static void start_at_rest(struct plant *pl, const struct model *m, const struct method *method, double h,
                          double zeta)
{
    double paper[MODEL_PARAMETERS], si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    int i_zeta = paper_index(m, "zeta");
    paper_defaults(m, paper);
    if (i_zeta >= 0)
        paper[i_zeta] = zeta;
    m->from_paper(paper, si, drive);
    struct plant_config c = {.model = m, .si = si, .method = method, .tick_s = h, .dilation = 1.0};
    c.scratch = memory; /* only one plant here has a method that takes any */
    const char *why = plant_init(pl, &c);
    if (why)
        check_string("plant_init", why, "no refusal");
}

static void run_ticks(struct plant *pl, uint64_t ticks)
{
    if (!plant_run(pl, ticks))
        check_true("the plant stays finite", 0);
}

/* Noise on all inputs, each with its own hold; `fine` ticks of b for one of a give the same path. The first
 * tick is the ramp, where a straight line over the tick stands for the product of two: after it both begin
 * with one state. */
static void shake(struct plant *a, struct plant *b, double deviation, uint32_t fine)
{
    for (int i = 0; i < a->model->n_inputs; i++) {
        double unit = scale_of(&a->scale, a->model->input_signal[i].quantity);
        plant_noise(a, i, deviation * unit, (uint32_t)(1 + i), 5, 0.0);
        plant_noise(b, i, deviation * unit, (uint32_t)(1 + i) * fine, 5, 0.0);
    }
    run_ticks(a, 1);
    run_ticks(b, fine);
    plant_set_state(b, a->x);
}

/* Largest difference of the states at ticks of the coarse plant, over the largest state. */
static double difference(struct plant *a, uint64_t a_ticks, struct plant *b, uint64_t b_ticks, int n)
{
    double worst = 0.0, size = 0.0;
    for (int i = 0; i < n; i++) {
        run_ticks(a, a_ticks);
        run_ticks(b, b_ticks);
        for (int k = 0; k < a->model->n_states; k++) {
            worst = fmax(worst, fabs(a->x[k] - b->x[k]));
            size = fmax(size, fabs(a->x[k]));
        }
    }
    return worst / size;
}

/* taylor and a finer rk4, contact kept; then rk4 alone with contact lost, where its order is 2.5. */
TEST(noise_methods_hertz)
{
    const struct model *const model[] = {&rolling_contact, &hertz_rig, &afm_tip};
    for (int i = 0; i < 3; i++) {
        struct plant a, b;
        start_at_rest(&a, model[i], &taylor, 0.1, 0.01);
        start_at_rest(&b, model[i], &rk4, 0.1 / 32, 0.01);
        shake(&a, &b, 0.05, 32);
        check_below(model[i]->name, difference(&a, 1, &b, 32, 400), 1e-10);
        check_int("contact kept: switches", a.counts.switches, 0);
    }
    struct plant a, b;
    start_at_rest(&a, &rolling_contact, &taylor, 0.1, 0.01);
    start_at_rest(&b, &rolling_contact, &rk4, 0.1 / 64, 0.01);
    shake(&a, &b, 0.4, 64);
    check_below("rolling_contact, contact lost", difference(&a, 1, &b, 64, 300), 1e-6);
    check_above("switches", a.counts.switches, 10);
    check_int("switches of both", b.counts.switches, a.counts.switches);
}

TEST(noise_methods_linear)
{
    const struct model *const model[] = {&rolling_contact_linear, &hertz_rig_linear, &shaft_bearing_linear};
    for (int i = 0; i < 3; i++) {
        double h = i < 2 ? 0.1 : 0.2 * 4.55e-4; /* the shaft's paper is in SI */
        struct plant a, b;
        start_at_rest(&a, model[i], &exact, h, 0.01);
        start_at_rest(&b, model[i], &rk4, h / 64, 0.01);
        shake(&a, &b, 0.3, 64);
        check_below(model[i]->name, difference(&a, 1, &b, 64, 1000), 1e-9);
    }
}

/* rk4 keeps its order 4 on a path that is held or straight between the grid's points. */
TEST(noise_order)
{
    double error[3];
    for (int i = 0; i < 3; i++) {
        struct plant a, b;
        uint32_t fine = 1u << i;
        start_at_rest(&a, &hertz_rig_linear, &exact, 0.13, 0.01);
        start_at_rest(&b, &hertz_rig_linear, &rk4, 0.13 / fine, 0.01);
        shake(&a, &b, 0.3, fine);
        error[i] = difference(&a, 1, &b, fine, 500);
    }
    for (int i = 0; i < 2; i++)
        check_near("order", log(error[i] / error[i + 1]) / log(2.0), 4.0, 0.1);
}

/* ---- averages with their standard errors, from batches ---- */

struct average {
    double batch[BATCHES];
};

static double average_of(const struct average *a, double *error)
{
    double mean = 0.0, square = 0.0;
    for (int i = 0; i < BATCHES; i++)
        mean += a->batch[i] / BATCHES;
    for (int i = 0; i < BATCHES; i++)
        square += (a->batch[i] - mean) * (a->batch[i] - mean);
    *error = sqrt(square / (BATCHES - 1) / BATCHES);
    return mean;
}

/* Within four standard errors, and these below a share of the value: else the check would prove nothing. */
static void check_average(const char *name, const struct average *a, double expected, double share)
{
    double error, mean = average_of(a, &error);
    check_near(name, mean, expected, 4.0 * error);
    check_below("      its standard error, relative", error / fabs(expected), share);
}

/* ---- the linear plant ---- */

/* Stationary covariance of y'' + 2 zeta y' + y = f at the ends of steps T over which f is held at values of
 * variance 1: the solution of P = A P A' + B B'. */
static void held_covariance(double zeta, double T, double p[3])
{
    double w = sqrt(1.0 - zeta * zeta), decay = exp(-zeta * T), c = cos(w * T), s = sin(w * T) / w;
    double a[4] = {decay * (c + zeta * s), decay * s, -decay * s, decay * (c - zeta * s)};
    double b[2] = {1.0 - a[0], decay * s};
    memset(p, 0, 3 * sizeof *p);
    for (int i = 0; i < 100000; i++) {
        double yy = p[0], yv = p[1], vv = p[2];
        p[0] = a[0] * a[0] * yy + 2.0 * a[0] * a[1] * yv + a[1] * a[1] * vv + b[0] * b[0];
        p[1] = a[0] * a[2] * yy + (a[0] * a[3] + a[1] * a[2]) * yv + a[1] * a[3] * vv + b[0] * b[1];
        p[2] = a[2] * a[2] * yy + 2.0 * a[2] * a[3] * yv + a[3] * a[3] * vv + b[1] * b[1];
    }
}

/* u that gives f = (2/3) u the two-sided density Phi, see docs/reference/models.md. */
static double deviation_of(double Phi, double T)
{
    return 1.5 * sqrt(2.0 * PI * Phi / T);
}

/* var(eta) = var(eta') = pi Phi/(2 zeta) for white noise;
 * a held input is T^2/12 weaker at the eigenfrequency. */
TEST(noise_covariance)
{
    enum { TICKS = 50000 };
    const double zeta = 0.25, T = 0.2, Phi = 0.01, white = PI * Phi / (2.0 * zeta);
    struct plant pl;
    struct average yy = {{0}}, vv = {{0}}, yv = {{0}}, mean = {{0}};
    double p[3], variance = 2.0 * PI * Phi / T;
    held_covariance(zeta, T, p);
    check_near("held against white: position", p[0] * variance / white, 1.0 - T * T / 12.0, T * T / 12.0);
    check_near("held against white: velocity", p[2] * variance / white, 1.0 - T * T / 12.0, T * T / 6.0);
    start_at_rest(&pl, &rolling_contact_linear, &exact, T, zeta);
    plant_noise(&pl, ROLLING_FORCE, deviation_of(Phi, T), 1, 3, 0.0);
    run_ticks(&pl, 500);
    for (int i = 0; i < BATCHES * TICKS; i++) {
        run_ticks(&pl, 1);
        double y = pl.x[0] - 1.0, v = pl.x[1];
        yy.batch[i / TICKS] += y * y / TICKS;
        yv.batch[i / TICKS] += y * v / TICKS;
        vv.batch[i / TICKS] += v * v / TICKS;
        mean.batch[i / TICKS] += (y + 1.0) / TICKS;
    }
    check_average("variance of the position", &yy, p[0] * variance, 0.01);
    check_average("variance of the velocity", &vv, p[2] * variance, 0.01);
    check_average("mean position", &mean, 1.0, 0.01);
    double error, covariance = average_of(&yv, &error);
    check_near("covariance", covariance, p[1] * variance, 4.0 * error);
}

/* ---- Nayak's random contact ---- */

enum { LEVELS = 4 };
static const double level[LEVELS] = {0.0, 1.0, 1.5, 2.0};

struct stationary {
    double mean, variance, skewness, kurtosis; /* moments of eta; the kurtosis in excess of 3 */
    double above[LEVELS];                      /* share of time above a level */
    double crossing[LEVELS];                   /* up-crossings per time */
    double force;                              /* mean of eta_+^(3/2) */
};

/* Phi/zeta = 0.01 and 0.1, by quadrature elsewhere with 15 digits. */
static const struct stationary stationary_reference[2] = {
    {0.9960194336381,
     0.01580394904398,
     -0.06444571910137,
     0.01689305492591,
     {0.9999999999993, 0.4915936664186, 1.583787938439e-05, 5.058681342198e-18},
     {1.386825324554e-12, 0.1589424605771, 2.971570816919e-05, 1.991401348955e-17},
     1.0},
    {0.9507496200122,
     0.1747065428916,
     -0.3458369682992,
     0.5449371734253,
     {0.9817519963223, 0.4698028409735, 0.08514496608599, 0.002910788321784},
     {0.01224543530104, 0.1562773523805, 0.06623242557499, 0.004015022019209},
     1.0},
};

/* Nayak's density p(eta) = C exp{-(2 zeta/(pi Phi)) (2/3) (0.4 eta_+^(5/2) - eta)}, by the trapezoidal rule;
 * crossings by Rice's formula with var(eta') = pi Phi/(2 zeta). */
static void stationary_of(double ratio, struct stationary *s)
{
    const double h = 1e-4, cold = 2.0 / (PI * ratio), speed = sqrt(0.5 * PI * ratio / (2.0 * PI));
    double m[5] = {0.0}, force = 0.0;
    memset(s, 0, sizeof *s);
    for (int i = 0; i < 160000; i++) {
        double eta = -10.0 + h * i, touch = eta > 0.0 ? eta : 0.0, root = sqrt(touch);
        double p = exp(-cold * (2.0 / 3.0) * (0.4 * touch * touch * root - eta + 0.6)), power = 1.0;
        for (int k = 0; k < 5; k++, power *= eta)
            m[k] += p * power;
        force += p * touch * root;
        for (int k = 0; k < LEVELS; k++) {
            double edge = (eta - level[k]) / h; /* half of the point on the level is above it */
            s->above[k] += edge > 0.25 ? p : edge > -0.25 ? 0.5 * p : 0.0;
            s->crossing[k] += fabs(edge) < 0.25 ? speed * p / h : 0.0;
        }
    }
    double mean = m[1] / m[0], square = m[2] / m[0], cube = m[3] / m[0], fourth = m[4] / m[0];
    double v = square - mean * mean;
    s->mean = mean;
    s->variance = v;
    s->skewness = (cube - 3.0 * mean * square + 2.0 * mean * mean * mean) / (v * sqrt(v));
    s->kurtosis =
        (fourth - 4.0 * mean * cube + 6.0 * mean * mean * square - 3.0 * pow(mean, 4)) / (v * v) - 3.0;
    s->force = force / m[0];
    for (int k = 0; k < LEVELS; k++) {
        s->above[k] /= m[0];
        s->crossing[k] /= m[0];
    }
}

TEST(noise_density)
{
    for (int i = 0; i < 2; i++) {
        const struct stationary *r = &stationary_reference[i];
        struct stationary s;
        stationary_of(i ? 0.1 : 0.01, &s);
        check_near("mean", s.mean, r->mean, 1e-10);
        check_near("variance", s.variance, r->variance, 1e-10);
        check_near("skewness", s.skewness, r->skewness, 1e-8);
        check_near("excess kurtosis", s.kurtosis, r->kurtosis, 1e-7);
        check_near("mean contact force", s.force, r->force, 1e-8);
        for (int k = 0; k < LEVELS; k++) {
            check_near("share above 0, 1, 1.5, 2", s.above[k] / r->above[k], 1.0, 1e-5);
            check_near("up-crossings", s.crossing[k] / r->crossing[k], 1.0, 1e-5);
        }
    }
}

/* Up-crossings of z inside a tick from (y0, v0) to (y1, v1):
 * the ends tell, or the vertex of the parabola between. */
static int up_crossings(double z, double T, const double a[2], const double b[2])
{
    bool above = a[0] > z;
    double bend = a[1] - b[1];
    if (above != (b[0] > z))
        return !above;
    if (!(a[1] * b[1] < 0.0) || (a[1] > 0.0) == above)
        return 0;
    return (a[0] + 0.5 * a[1] * a[1] * T / bend > z) != above;
}

struct measured {
    struct average moment[4]; /* moments of eta about the expected mean */
    struct average above[LEVELS], crossing[LEVELS], loss, force, scratch, damping;
};

static void measure(struct plant *pl, struct measured *m, int batch, int ticks, double mean)
{
    double T = pl->h, before[2], work_before = sum_of(&pl->ledger.work[ROLLING_FORCE]);
    double damping_before = sum_of(&pl->ledger.damping), share = 1.0 / ticks;
    uint32_t switches = pl->counts.switches;
    for (int i = 0; i < ticks; i++) {
        memcpy(before, pl->x, sizeof before);
        run_ticks(pl, 1);
        double eta = pl->x[0], d = eta - mean, power = d * share;
        for (int k = 0; k < 4; k++, power *= d)
            m->moment[k].batch[batch] += power;
        m->force.batch[batch] += eta > 0.0 ? eta * sqrt(eta) * share : 0.0;
        for (int k = 0; k < LEVELS; k++) {
            m->above[k].batch[batch] += eta > level[k] ? share : 0.0;
            m->crossing[k].batch[batch] += up_crossings(level[k], T, before, pl->x) * share / T;
        }
    }
    m->loss.batch[batch] = 0.5 * (pl->counts.switches - switches) * share / T;
    m->scratch.batch[batch] = (sum_of(&pl->ledger.work[ROLLING_FORCE]) - work_before) * share / T;
    m->damping.batch[batch] = (sum_of(&pl->ledger.damping) - damping_before) * share / T;
}

/* Against the density at Phi sinc^2(T/2), the density that the held input has at the eigenfrequency.
 * Between ticks the velocity's mean square is smaller than at ticks by 2 zeta T/3, to first order in T for
 * the linear plant. So are power and damping. The rates of crossing are smaller by half of that. */
TEST(noise_rolling_contact)
{
    enum { TICKS = 100000 };
    static struct measured m;
    const double zeta = 0.2, T = 0.05, Phi = 0.1 * zeta, between = 1.0 - 2.0 * zeta * T / 3.0;
    const char *const name[] = {"mean", "variance", "third moment", "fourth moment"};
    struct plant pl;
    struct stationary s;
    memset(&m, 0, sizeof m);
    stationary_of(Phi / zeta * (1.0 - T * T / 12.0), &s);
    start_at_rest(&pl, &rolling_contact, &rk4, T, zeta);
    plant_noise(&pl, ROLLING_FORCE, deviation_of(Phi, T), 1, 2024, 0.0);
    run_ticks(&pl, 1000);
    double stored = plant_energy(&pl), driven = sum_of(&pl.ledger.work[ROLLING_FORCE]),
           damping = sum_of(&pl.ledger.damping);
    for (int i = 0; i < BATCHES; i++)
        measure(&pl, &m, i, TICKS, s.mean);
    driven = sum_of(&pl.ledger.work[ROLLING_FORCE]) - driven;
    damping = sum_of(&pl.ledger.damping) - damping;
    double sigma = sqrt(s.variance),
           scale[4] = {1.0, s.variance, s.variance * sigma, s.variance * s.variance};
    double expected[4] = {0.0, 1.0, s.skewness, s.kurtosis + 3.0};
    for (int k = 0; k < 4; k++) {
        double error, moment = average_of(&m.moment[k], &error) / scale[k];
        printf("      %s, standard error %.2g\n", name[k], error / scale[k]);
        check_near("      of eta about Nayak's mean, in powers of the standard deviation", moment,
                   expected[k], 4.0 * error / scale[k]);
    }
    for (int k = 0; k < LEVELS; k++) {
        check_average("share above 0, 1, 1.5, 2", &m.above[k], s.above[k], 0.05);
        check_average("up-crossings", &m.crossing[k], s.crossing[k] * sqrt(between), 0.05);
    }
    check_average("touchdowns by located switches", &m.loss, s.crossing[0] * sqrt(between), 0.03);
    check_average("mean contact force over preload", &m.force, 1.0, 0.01);
    check_average("mean power of the drive, pi Phi", &m.scratch, PI * Phi * between, 0.01);
    check_average("mean power of the damper", &m.damping, PI * Phi * between, 0.01);
    check_near("work - damping - stored, over work",
               (driven - damping - (plant_energy(&pl) - stored) / pl.scale.energy_J) / driven, 0.0, 1e-4);
}
