/* test_ledger.c - the energy balance against an integration of our own in extended precision. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/hertz_rig.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "tests/fixture/rig.h"

#define TWO_PI 6.283185307179586477

/* The rig in the paper's units, q = (3/2)(y - 1), with
 * the powers of all drives and of the damper as states. */
struct truth {
    long double q, v, work[4], damping;
};

enum { TRUTH = sizeof(struct truth) / sizeof(long double) };

static void truth_rate(const double *paper, long double t, const struct truth *x, struct truth *rate)
{
    long double slow = cosl((long double)paper[OMEGA] * t), O = (long double)paper[FAST_OMEGA];
    long double fast = cosl(O * t), sine = sinl(O * t), ab = (long double)paper[A_BASE],
                xi = (long double)paper[XI];
    long double p = x->q - ab * fast, p_dot = x->v + ab * O * sine, base_dot = -ab * O * sine;
    long double eta = 1.0L + p * 2.0L / 3.0L, contact = eta > 0.0L ? eta * sqrtl(eta) : 0.0L;
    long double modulation = (long double)paper[A_STIFF] * fast;
    rate->q = x->v;
    rate->v = 1.0L - (1.0L + modulation) * contact - 2.0L * xi * p_dot + (long double)paper[SIGMA] * slow +
              (long double)paper[A_FORCE] * fast;
    rate->work[RIG_FORCE] = (long double)paper[SIGMA] * slow * x->v;
    rate->work[RIG_FAST_FORCE] = (long double)paper[A_FORCE] * fast * x->v;
    /* the base works against what the contact and the damper push it with */
    rate->work[RIG_BASE] = -((1.0L + modulation) * contact + 2.0L * xi * p_dot) * base_dot;
    rate->work[RIG_STIFFNESS] = -modulation * contact * p_dot;
    rate->damping = 2.0L * xi * p_dot * p_dot;
}

static void truth_step(const double *paper, long double t, long double h, struct truth *x)
{
    long double at[TRUTH], k[5][TRUTH] = {{0.0L}};
    const long double share[4] = {0.0L, 0.5L, 0.5L, 1.0L};
    memcpy(at, x, sizeof at);
    for (int stage = 0; stage < 4; stage++) {
        long double y[TRUTH];
        struct truth now, rate;
        for (int i = 0; i < TRUTH; i++)
            y[i] = at[i] + share[stage] * h * k[stage][i];
        memcpy(&now, y, sizeof now);
        truth_rate(paper, t + share[stage] * h, &now, &rate);
        memcpy(k[stage + 1], &rate, sizeof rate);
    }
    for (int i = 0; i < TRUTH; i++)
        at[i] += h / 6.0L * (k[1][i] + 2.0L * k[2][i] + 2.0L * k[3][i] + k[4][i]);
    memcpy(x, at, sizeof at);
}

static struct truth truth_run(const double *paper, double q, double v, double time, int n)
{
    struct truth x = {.q = (long double)q, .v = (long double)v};
    for (int i = 0; i < n; i++)
        truth_step(paper, (long double)time * i / n, (long double)time / n, &x);
    return x;
}

/* Model energy is 4/9 of the paper's m = 1 energy: lengths are 2/3 of its own. */
#define OF_PAPER (4.0 / 9.0)

TEST(ledger_sums)
{
    struct sum tenths = {0.0, 0.0}, huge = {0.0, 0.0};
    for (int i = 0; i < 10000000; i++)
        sum_add(&tenths, 0.1);
    check_near("1e7 additions of 0.1", sum_of(&tenths), 1e6, 1e-9);
    check_near("the same, relative error", (sum_of(&tenths) - 1e6) / 1e6, 0.0, 1e-15);
    const double x[] = {1.0, 1e16, 3.0, -1e16, 1e-3};
    for (int i = 0; i < 5; i++)
        sum_add(&huge, x[i]);
    check_near("small terms beside large ones that cancel", sum_of(&huge), 4.001, 1e-15);
}

static void all_drives(double *paper, double size)
{
    rig_paper(paper);
    paper[XI] = 0.05;
    paper[SIGMA] = 0.2 * size;
    paper[OMEGA] = 0.8;
    paper[FAST_OMEGA] = 2.4;
    paper[A_FORCE] = 0.5 * size;
    paper[A_BASE] = 0.3 * size;
    paper[A_STIFF] = 0.4 * size;
}

struct gap_of {
    double work[4], damping;
};

/* Errors of works and damping after 20 model times at n ticks, against the truth. */
static struct gap_of errors(const double *paper, const struct truth *truth, int n, uint32_t *switches)
{
    struct gap_of e;
    struct plant pl;
    rig_start(&pl, paper, 20.0 / n, 0.1, -0.2);
    rig_run(&pl, (uint64_t)n);
    *switches = pl.counts.switches;
    for (int i = 0; i < 4; i++)
        e.work[i] = fabs(sum_of(&pl.ledger.work[i]) - OF_PAPER * (double)truth->work[i]);
    e.damping = fabs(sum_of(&pl.ledger.damping) - OF_PAPER * (double)truth->damping);
    return e;
}

/* All four drives at once, contact kept and contact lost. */
TEST(ledger_works)
{
    const char *const name[] = {"work of the force", "of the fast force", "of the base", "of the stiffness"};
    const double size[] = {0.2, 2.0}, allowed[] = {1e-11, 1e-7};
    for (int i = 0; i < 2; i++) {
        double paper[PAPER];
        uint32_t switches;
        all_drives(paper, size[i]);
        struct truth truth = truth_run(paper, 0.1, -0.2, 20.0, 200000);
        struct gap_of e = errors(paper, &truth, 4000, &switches);
        check_is(i ? "contact is lost" : "contact is kept", (switches >= 2), ==, i);
        for (int k = 0; k < 4; k++) {
            check_above("work is done", fabs((double)truth.work[k]), 1e-3);
            check_below(name[k], e.work[k], allowed[i]);
        }
        check_below("damping", e.damping, allowed[i]);
    }
}

/* One piece at a time on states of the truth, so that no method has a part in it: order 4. */
static double quadrature_error(int n, double *damping)
{
    double paper[PAPER], sum = 0.0;
    struct plant pl;
    all_drives(paper, 0.2);
    rig_start(&pl, paper, 10.0 / n, 0.1, -0.2);
    struct truth x = {.q = 0.1L, .v = -0.2L};
    for (int i = 0; i < n; i++) {
        double x0[2] = {1.0 + (double)x.q * 2.0 / 3.0, (double)x.v * 2.0 / 3.0}, x1[2];
        for (int k = 0; k < 20; k++)
            truth_step(paper, (i + k / 20.0L) * 10.0L / n, 0.5L / n, &x);
        x1[0] = 1.0 + (double)x.q * 2.0 / 3.0;
        x1[1] = (double)x.v * 2.0 / 3.0;
        struct segment e = {.length = pl.h, .active = 15};
        for (int k = 0; k < 4; k++) {
            drive_segment(&pl.drive[k], TICK_FRACTIONS, pl.ticks_per_time, &e.wave[k], &e.at[0][k],
                          &e.at[1][k], &e.at[2][k]);
        }
        (void)ledger_piece(&pl.ledger, pl.p, &e, x0, x1);
    }
    for (int k = 0; k < 4; k++)
        sum = fmax(sum, fabs(sum_of(&pl.ledger.work[k]) - OF_PAPER * (double)x.work[k]));
    *damping = fabs(sum_of(&pl.ledger.damping) - OF_PAPER * (double)x.damping);
    return sum;
}

TEST(ledger_order)
{
    double damping[3], work[3];
    for (int i = 0; i < 3; i++)
        work[i] = quadrature_error(100 << i, &damping[i]);
    for (int i = 0; i < 2; i++) {
        check_near("order of the works", log(work[i] / work[i + 1]) / log(2.0), 4.0, 0.25);
        check_near("order of the damping", log(damping[i] / damping[i + 1]) / log(2.0), 4.0, 0.25);
    }
    check_below("error at 400 pieces in 10 model times", work[2], 1e-8);
}

/* A long run with everything on: what does not balance
 * is small beside what flowed, and falls with the step. */
static double residual_share(int n_per_time, uint32_t *switches)
{
    double paper[PAPER], through;
    struct plant pl;
    all_drives(paper, 2.0);
    rig_start(&pl, paper, 1.0 / n_per_time, 0.1, -0.2);
    rig_run(&pl, 500 * (uint64_t)n_per_time);
    *switches = pl.counts.switches;
    through = sum_of(&pl.ledger.damping) * pl.scale.energy_J;
    check_above("energy through the damper, J", through, 100.0);
    return fabs(plant_residual(&pl)) / through;
}

TEST(ledger_residual)
{
    uint32_t switches;
    double coarse = residual_share(250, &switches), fine = residual_share(1000, &switches);
    check_above("switches on the way", switches, 100.0);
    check_below("residual over the energy that flowed, 250 ticks a model time", coarse, 1e-7);
    check_below("the same at 1000 ticks", fine, 1e-9);
}

/* How far the residual of the linear rig goes to and fro once it has settled, of the energy that swings. The
 * method is exact, and the drive has so many ticks a period. */
static double residual_swing(double ticks_a_period)
{
    static double scratch[METHOD_SCRATCH];
    const struct model *m = &hertz_rig_linear;
    double si[MODEL_PARAMETERS], least = 1.0, most = -1.0, speed = 0.0;
    struct plant pl;
    for (int i = 0; i < m->n_parameters; i++)
        si[i] = m->parameter[i].initial;
    const struct plant_config c = {
        .model = m, .si = si, .method = &exact, .tick_s = 1e-4, .dilation = 1.0, .scratch = scratch};
    check_true("begun", !plant_init(&pl, &c));
    plant_drive(&pl, RIG_FORCE, 20.0, 1e4 / ticks_a_period, 0.0, 0.1);
    rig_run(&pl, 20000);
    for (int i = 0; i < 2000; i++) {
        rig_run(&pl, 1);
        least = fmin(least, plant_residual(&pl));
        most = fmax(most, plant_residual(&pl));
        speed = fmax(speed, fabs(pl.x[1]));
    }
    return (most - least) / (0.5 * speed * speed * pl.scale.energy_J);
}

/* Simpson's rule leaves a part of the works where a drive has few ticks a period: accuracy.md has the
 * numbers. */
TEST(ledger_coarse_drives)
{
    static const double ticks[] = {4.013, 6.013, 8.013, 10.013, 14.013};
    static const double share[] = {0.05, 0.01, 2.5e-3, 1e-3, 3e-4};
    for (int i = 0; i < 5; i++) {
        double swing = residual_swing(ticks[i]);
        printf("      %g ticks a period\n", ticks[i]);
        check_below("residual to and fro, of the energy that swings", swing, share[i]);
        check_above("no more than three times what it is", 3.0 * swing, share[i]);
    }
}

/* rk4 that brakes a little after each step: an error that no look at the state would show. */
static enum step_status spoiled_step(const struct model *m, const double *p, double *work,
                                     const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    enum step_status status = rk4.bind(m)(m, p, work, e, regime, x, c);
    x[1] *= 1.0 - 1e-6;
    return status;
}

TEST(ledger_spoiled_method)
{
    double paper[PAPER], residual[2], lost = 0.0;
    rig_paper(paper);
    paper[SIGMA] = 0.05;
    paper[OMEGA] = 0.9;
    for (int spoiled = 0; spoiled < 2; spoiled++) {
        struct plant pl;
        rig_start(&pl, paper, 0.01, 0.3, 0.0);
        if (spoiled) {
            pl.step = spoiled_step;
            pl.bind_run = NULL;
        }
        for (int i = 0; i < 10000; i++) {
            rig_run(&pl, 1);
            lost += spoiled ? 1e-6 * pl.x[1] * pl.x[1] : 0.0;
        }
        residual[spoiled] = plant_residual(&pl) / pl.scale.energy_J;
    }
    check_above("kinetic energy taken by the spoiled method", lost, 1e-5);
    check_near("residual of the spoiled method over what it took", residual[1] / -lost, 1.0, 0.01);
    check_below("residual of the honest method over the same", fabs(residual[0]) / lost, 1e-3);
}

TEST(ledger_free_vibration)
{
    const double top[] = {1.2, 1.9, 3.5}, allowed[] = {1e-11, 3e-9, 3e-8};
    for (int i = 0; i < 3; i++) {
        double paper[PAPER], worst = 0.0;
        struct plant pl;
        rig_paper(paper);
        paper[XI] = 0.0;
        rig_start(&pl, paper, 0.005, 1.5 * (top[i] - 1.0), 0.0);
        double energy = (2.0 / 3.0) * (0.4 * pow(top[i], 2.5) - top[i]);
        for (int k = 0; k < 20000; k++) {
            rig_run(&pl, 1);
            worst = fmax(worst, fabs(plant_energy(&pl) / pl.scale.energy_J - energy));
        }
        check_below("free vibration: energy against that of the start", worst, allowed[i]);
        check_is("no work and no damping", sum_of(&pl.ledger.damping), ==, 0.0);
        check_is("no work and no damping", sum_of(&pl.ledger.work[0]), ==, 0.0);
        check_near("residual is the energy's change", plant_residual(&pl) / pl.scale.energy_J,
                   plant_energy(&pl) / pl.scale.energy_J - energy, 1e-15);
    }
}

/* A state set by hand begins a new balance. */
TEST(ledger_start)
{
    double paper[PAPER];
    struct plant pl;
    all_drives(paper, 1.0);
    rig_start(&pl, paper, 0.005, 0.0, 0.0);
    rig_run(&pl, 3000);
    plant_set_state(&pl, (double[]){2.0, 1.0});
    check_near("residual of a fresh state", plant_residual(&pl), 0.0, 0.0);
    check_near("damping forgotten", sum_of(&pl.ledger.damping), 0.0, 0.0);
    rig_run(&pl, 3000);
    check_near("residual after going on", plant_residual(&pl) / pl.scale.energy_J, 0.0, 1e-7);
}

/* A linear oscillator at resonance, x = a cos(w t) in pieces of `turn`: the force balances the damper. The
 * ledger sees states only, here exact ones. Returns damping (w a)^2, twice what both deliver in the mean. */
static double resonance(struct ledger *l, double a, double turn, int ticks, double *w)
{
    const struct model *m = &hertz_rig_linear;
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], rest[MODEL_STATES];
    struct scale scale;
    struct polynomial_form form;
    for (int i = 0; i < m->n_parameters; i++)
        si[i] = m->parameter[i].initial;
    m->prepare(si, p, &scale);
    m->rest(p, rest);
    m->polynomial_form(p, &form);
    const double damping = form.damping;
    *w = m->eigenfrequency(p);
    ledger_start(l, m, p, (struct input[MODEL_INPUTS]){{0.0, 0.0}}, rest);
    for (int i = 0; i < ticks; i++) {
        struct segment e = {.length = turn / *w, .active = 1u << RIG_FORCE};
        double x[2][2];
        for (int k = 0; k < 3; k++)
            e.at[k][RIG_FORCE].value =
                -damping * *w * a * sin((i + 0.5 * k) * turn) / form.modulation[0][RIG_FORCE];
        for (int k = 0; k < 2; k++) {
            x[k][0] = rest[0] + a * cos((i + k) * turn);
            x[k][1] = -*w * a * sin((i + k) * turn);
        }
        (void)ledger_piece(l, p, &e, x[0], x[1]);
    }
    return damping * (*w * a) * (*w * a);
}

/* Four and a bit ticks in a period. */
TEST(ledger_few_ticks)
{
    enum { TICKS = 4200 };
    const double turn = TWO_PI / 4.2;
    struct ledger l;
    double w, lost = 0.5 * resonance(&l, 0.01, turn, TICKS, &w) * TICKS * turn / w;
    check_near("lost in the damper over its closed form", sum_of(&l.damping) / lost, 1.0, 1e-4);
    check_near("work over its closed form", sum_of(&l.work[RIG_FORCE]) / lost, 1.0, 1e-4);
}

/* A whole period in pieces so small that the errors of Simpson's rule, and of a mean velocity, are
 * rounding. The secant has the rounding of positions over the length of a piece, some 1e-11; it averages
 * out in the sum. */
TEST(ledger_small_pieces)
{
    enum { TICKS = 125664 };
    const double turn = TWO_PI / TICKS; /* 5e-5 */
    struct ledger l;
    double w, lost = 0.5 * resonance(&l, 0.3, turn, TICKS, &w) * TWO_PI / w;
    check_near("lost in the damper over its closed form", sum_of(&l.damping) / lost, 1.0, 3e-12);
    check_near("work over its closed form", sum_of(&l.work[RIG_FORCE]) / lost, 1.0, 3e-12);
}

/* A piece as short as a double can tell apart from nothing: its secant is rounding, its energy is not. */
TEST(ledger_short_piece)
{
    double paper[PAPER];
    struct plant pl;
    rig_paper(paper);
    paper[XI] = 0.05;
    const double length[] = {1e-300, 1e-17, 1e-12, 2e-6};
    for (int i = 0; i < 4; i++) {
        struct segment e = {.length = length[i]};
        const double x0[2] = {1.5, 0.3}, x1[2] = {1.5 + 0.3 * length[i], 0.3};
        rig_start(&pl, paper, 0.01, 0.0, 0.0);
        (void)ledger_piece(&pl.ledger, pl.p, &e, x0, x1);
        double lost = 2.0 * 0.05 * 0.3 * 0.3 * length[i];
        check_near("lost over damper times length", sum_of(&pl.ledger.damping) / lost, 1.0, 1e-6);
    }
}
