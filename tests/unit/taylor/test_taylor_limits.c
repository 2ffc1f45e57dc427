/* test_taylor_limits.c - taylor where methods break: grazing, its own budget, escape, refusals. */
#include "tests/unit/test.h"

#include <math.h>
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/paper.h"
#include "tests/fixture/trajectory.h"

/* Extended precision is the point here. */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdouble-promotion"

static double scratch[METHOD_SCRATCH];

/* The undamped rig, free from eta = eta_max at rest. */
static void free_rig(struct plant *pl, double eta_max, double h, double tol)
{
    double paper[MODEL_PARAMETERS], state[2] = {1.5 * eta_max - 1.5, 0.0};
    paper_defaults(&hertz_rig, paper);
    paper[0] = 0.0; /* xi */
    paper_start_by(pl, &hertz_rig, &taylor, tol, scratch, paper, h, state);
}

static double energy(double eta, double v)
{
    return 0.5 * v * v + (4.0 / 15.0) * eta * eta * sqrt(eta) - (2.0 / 3.0) * eta;
}

/* Worst energy error over `periods`, read where the contact is closed. */
static double worst_energy(struct plant *pl, double h, int periods)
{
    double worst = 0.0, start = energy(pl->x[0], 0.0);
    uint64_t ticks = (uint64_t)(periods * 6.6 / h);
    for (uint64_t i = 0; i < ticks; i++) {
        if (!plant_run(pl, 1))
            check_true("the rig stays finite", 0);
        if (pl->x[0] > 0.0)
            worst = fmax(worst, fabs(energy(pl->x[0], pl->x[1]) - start));
    }
    return worst;
}

/* At loose tolerances a series in time may reach beyond the closest approach. It may come out on the
 * negative branch of eta^{3/2} with a small tail: energy then jumps by far more than the tolerance. */
static void check_branch(double tol)
{
    double limit = pow(2.5, 2.0 / 3.0), worst = 0.0;
    for (int k = 0; k < 60; k++) {
        struct plant pl;
        free_rig(&pl, limit * (1.0 - 1e-4 * (k + 1)), 0.4, tol);
        worst = fmax(worst, worst_energy(&pl, 0.4, 3));
    }
    check_below(check_name("tol %.0e: worst energy error over tol near grazing", tol), worst / tol, 50.0);
}

/* Contact is just lost, or just not: eta_max within 1e-3 .. 1e-12 of (5/2)^{2/3}, where it is. The free
 * period there is 6.59237210, so contact is lost 30 times in 200 time units. */
TEST(taylor_grazing)
{
    double limit = pow(2.5, 2.0 / 3.0);
    for (int k = 2; k <= 6; k++)
        check_branch(pow(10.0, -k));
    for (int k = 3; k <= 12; k++) {
        for (int side = -1; side <= 1; side += 2) {
            struct plant pl;
            double away = side * pow(10.0, -k);
            free_rig(&pl, limit * (1.0 + away), 0.11, 1e-10);
            double error = worst_energy(&pl, 0.11, 30);
            check_below(check_name("eta_max %+.0e from grazing: worst energy error in 30 periods", away),
                        error, 3e-9);
            if (k <= 6) /* nearer than that, the tolerance decides */
                check_int("contact switches", pl.counts.switches, side > 0 ? 60 : 0);
            check_int("roots that did not converge, budgets reached",
                      pl.counts.residual + pl.counts.budget + pl.counts.work, 0);
        }
    }
}

/* A segment far too long: the budget ends it in time, the
 * rest goes on from there, and REGIME_ANY reaches the end. */
TEST(taylor_budget)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], paper[MODEL_PARAMETERS], x[2] = {1.5, 0.0},
                                                                            y[2] = {1.5, 0.0};
    struct scale scale;
    struct segment e = {.length = 40.0};
    struct crossing c;
    int calls = 0;
    enum step_status status;
    paper_defaults(&hertz_rig, paper);
    paper_prepare(&hertz_rig, paper, si, p, &scale);
    step_function *step = taylor.bind(&hertz_rig);
    taylor.prepare(&hertz_rig, p, e.length, 1e-12, scratch);
    struct segment rest = e;
    while ((status = step(&hertz_rig, p, scratch, &rest, 1, x, &c)) == STEP_BUDGET && ++calls < 20) {
        check_is("it stops inside the segment", c.done, >, 0.0);
        check_is("it stops inside the segment", c.done, <, rest.length);
        segment_tail(&rest, hertz_rig.n_inputs, c.done);
    }
    check_int("the end is reached by calling again", status, STEP_END);
    check_above("after the budget ended some calls", calls, 2);
    check_is("damping left less than the start", x[0], <, 1.5);
    taylor.prepare(&hertz_rig, p, e.length, 1e-12, scratch);
    check_int("REGIME_ANY ends at the end", step(&hertz_rig, p, scratch, &e, REGIME_ANY, y, &c), STEP_END);
    check_near("near the other way there, by 64 steps of rk4", y[0], x[0], 0.05);
}

/* Time from rest at eta0 to eta = 1e6 under the pull alone: int d eta/sqrt(2 int a), eta = eta0 + u^6. */
static double escape_time(double eta0, double b)
{
    enum { N = 20000 };
    long double sum = 0.0L, end = powl(1e6L - eta0, 1.0L / 6.0L);
    for (int i = 1; i <= N; i++) {
        long double u = end * i / N, d = powl(u, 6), eta = eta0 + d;
        long double power = 0.4L * powl(eta0, 2.5L) * expm1l(2.5L * log1pl(d / eta0));
        long double v = sqrtl(2.0L * ((1.0L + b) * d - 0.5L * (eta + eta0) * d - b * power));
        long double f = 6.0L * powl(u, 5) / v;
        sum += (i == N ? 1.0L : i % 2 ? 4.0L : 2.0L) * f;
    }
    return (double)(sum * end / (3.0L * N));
}

TEST(taylor_escape)
{
    double paper[MODEL_PARAMETERS], u[2] = {-1.3, 0.0}, h = 0.05;
    struct plant pl;
    uint64_t ticks = 0;
    paper_defaults(&afm_tip, paper);
    paper[TIP_PAPER_BETA] = 0.8;
    paper[TIP_PAPER_C] = 0.0;
    paper[TIP_PAPER_R] = 0.0;
    paper[TIP_PAPER_F] = 0.0;
    paper[TIP_PAPER_SIGN] = 1.0;
    paper_start_by(&pl, &afm_tip, &taylor, 1e-9, scratch, paper, h, u);
    while (ticks < 2000 && plant_run(&pl, 1))
        ticks++;
    double expected = escape_time(2.3, -(2.0 / 3.0) * 0.8);
    check_below("escape is noticed within the tick after eta = 1e6", fabs((double)ticks * h - expected),
                2.0 * h);
    check_true("the last good state is kept", isfinite(pl.x[0]));
    check_true("the last good state is kept", isfinite(pl.x[1]));
    check_is("the last good state is kept", pl.x[0], <=, 1e9);
    check_int("counted", pl.counts.not_finite, 1);
    check_true("and the plant stays there", !plant_run(&pl, 1) && isfinite(pl.x[0]));
    u[0] = -1.1; /* inside the saddle at u = -1.1614: it swings, and stays */
    paper_start_by(&pl, &afm_tip, &taylor, 1e-9, scratch, paper, h, u);
    check_true("inside the saddle the tip stays", plant_run(&pl, 20000));
    plant_set_state(&pl, (double[]){(double)NAN, 0.0});
    check_true("a state that is no number is refused", !plant_run(&pl, 1));
    paper_defaults(&hertz_rig_cubic, paper);
    paper_start_by(&pl, &hertz_rig_cubic, &taylor, 1e-9, scratch, paper, h, (double[]){12.0, 0.0});
    ticks = 0;
    while (ticks < 2000 && plant_run(&pl, 1))
        ticks++;
    check_is("beyond its maximum the cubic force lets go, and that ends cleanly", ticks, <, 2000);
    check_true("beyond its maximum the cubic force lets go, and that ends cleanly", isfinite(pl.x[0]));
    check_true("beyond its maximum the cubic force lets go, and that ends cleanly", isfinite(pl.x[1]));
}

TEST(taylor_refusals)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], paper[MODEL_PARAMETERS];
    struct scale scale;
    paper_defaults(&hertz_rig, paper);
    paper_prepare(&hertz_rig, paper, si, p, &scale);
    check_no_error("the default tolerance is taken", taylor.refuse(&hertz_rig, p, 0.1, 0.0));
    check_no_error("1e-12 is taken", taylor.refuse(&hertz_rig, p, 0.1, 1e-12));
    check_no_error("1e-3 is taken", taylor.refuse(&hertz_rig, p, 0.1, 1e-3));
    check_error("1e-15 is refused: below rounding", taylor.refuse(&hertz_rig, p, 0.1, 1e-15));
    check_no_error("0.1 is taken", taylor.refuse(&hertz_rig, p, 0.1, 0.1));
    check_error("more is refused", taylor.refuse(&hertz_rig, p, 0.1, 0.11));
    check_error("a negative tolerance is refused", taylor.refuse(&hertz_rig, p, 0.1, -1e-9));
    check_error("no number is refused", taylor.refuse(&hertz_rig, p, 0.1, (double)NAN));
    check_error("a step of 50 radians is refused", taylor.refuse(&hertz_rig, p, 50.0, 1e-9));
    paper_defaults(&shaft_bearing, paper);
    paper_prepare(&shaft_bearing, paper, si, p, &scale);
    check_error("a plant with four contacts is refused", taylor.refuse(&shaft_bearing, p, 1e-4, 0.0));
    check_is("scratch memory is within the bound", taylor.n_scratch(&hertz_rig), <=, METHOD_SCRATCH);
}

/* Regime and coordinate disagree: the switch stands at the start and leaves the coordinate alone. */
TEST(taylor_switch_at_start)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], paper[MODEL_PARAMETERS];
    struct scale scale;
    struct segment e = {.length = 0.1, .changed = true};
    struct crossing c = {1.0, 1, 1, 0.0};
    static const struct {
        unsigned regime;
        double x[2];
    } start[4] = {{1, {-0.2, 0.1}}, {0, {0.3, 0.1}}, {1, {0.0, -0.1}}, {0, {0.0, 0.1}}};
    paper_defaults(&hertz_rig, paper);
    paper_prepare(&hertz_rig, paper, si, p, &scale);
    for (int i = 0; i < 4; i++) {
        double x[2] = {start[i].x[0], start[i].x[1]};
        taylor.prepare(&hertz_rig, p, 0.1, 0.0, scratch);
        enum step_status status = taylor.bind(&hertz_rig)(&hertz_rig, p, scratch, &e, start[i].regime, x, &c);
        check_int("a switch", status, STEP_SWITCH);
        check_is("at the start, where it stands, by contact 0", c.done, ==, 0.0);
        check_is("at the start, where it stands, by contact 0", x[0], ==, start[i].x[0]);
        check_is("at the start, where it stands, by contact 0", x[1], ==, start[i].x[1]);
        check_int("at the start, where it stands, by contact 0", c.contact, 0);
    }
}

/* At zero: a contact that begins with neither depth nor speed, a lift-off that ends exactly there, and a
 * regime that the plant turned while the state stayed. */
TEST(taylor_near_zero)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], paper[MODEL_PARAMETERS], x[2] = {0.0, 0.0};
    struct scale scale;
    struct segment e = {.length = 0.1};
    struct crossing c;
    paper_defaults(&hertz_rig, paper);
    paper[0] = 0.0; /* xi */
    paper_prepare(&hertz_rig, paper, si, p, &scale);
    step_function *step = taylor.bind(&hertz_rig);
    taylor.prepare(&hertz_rig, p, e.length, 1e-9, scratch);
    check_int("at rest at zero depth the contact goes on", step(&hertz_rig, p, scratch, &e, 1, x, &c),
              STEP_END);
    check_near("with the acceleration of the preload", x[0], 0.5 * (2.0 / 3.0) * 0.01, 1e-6);
    check_int("another regime with the same state", step(&hertz_rig, p, scratch, &e, 0, x, &c), STEP_SWITCH);
    check_is("is a switch at once", c.done, ==, 0.0);
    x[0] = 0.05;
    x[1] = -1.0;
    check_int("a lift-off", step(&hertz_rig, p, scratch, &e, 1, x, &c), STEP_SWITCH);
    check_is("ends at exactly zero", x[0], ==, 0.0);
    check_is("ends at exactly zero", c.done, >, 0.0);
    check_near("with its energy", energy(0.0, x[1]), energy(0.05, -1.0), 1e-9);
}

/* A contact that has just switched stands at zero to rounding, on whichever side that rounded to, and
 * inputs may change there: it is no second switch. From zero inwards energy stays; outwards it flies, x =
 * v t + t^2/3. A contact further off than rounding has to switch. */
TEST(taylor_just_switched)
{
    static const double off[] = {-1e-15, -1e-17, -0x1p-1074, 0.0, 0x1p-1074, 1e-17, 1e-15};
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], paper[MODEL_PARAMETERS];
    struct scale scale;
    struct segment e = {.length = 0.1, .changed = true};
    struct crossing c = {1.0, 1, 1, 0.0};
    paper_defaults(&hertz_rig, paper);
    paper[0] = 0.0; /* xi */
    paper_prepare(&hertz_rig, paper, si, p, &scale);
    step_function *step = taylor.bind(&hertz_rig);
    for (size_t i = 0; i < sizeof off / sizeof off[0]; i++) {
        double in[2] = {off[i], 0.3}, out[2] = {off[i], -0.3};
        taylor.prepare(&hertz_rig, p, e.length, 1e-12, scratch);
        check_int("on its way in the contact goes on", step(&hertz_rig, p, scratch, &e, 1, in, &c), STEP_END);
        check_near("with its energy", energy(in[0], in[1]), energy(0.0, 0.3), 1e-11);
        taylor.prepare(&hertz_rig, p, e.length, 1e-12, scratch);
        check_int("on its way out the flight goes on", step(&hertz_rig, p, scratch, &e, 0, out, &c),
                  STEP_END);
        check_near("along its parabola", out[0], -0.03 + 0.01 / 3.0, 1e-14);
    }
    double apart[2] = {-1e-12, 0.3}, pressed[2] = {1e-12, -0.3};
    taylor.prepare(&hertz_rig, p, e.length, 1e-12, scratch);
    check_int("apart by more, a switch", step(&hertz_rig, p, scratch, &e, 1, apart, &c), STEP_SWITCH);
    check_is("at once", c.done, ==, 0.0);
    taylor.prepare(&hertz_rig, p, e.length, 1e-12, scratch);
    check_int("pressed by more, a switch", step(&hertz_rig, p, scratch, &e, 0, pressed, &c), STEP_SWITCH);
    check_is("at once", c.done, ==, 0.0);
}

#pragma GCC diagnostic pop
