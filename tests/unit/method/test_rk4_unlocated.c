/* test_rk4_unlocated.c - rk4's own steps without a search for
 * contact switches: its bits, its events, its order, its refusals. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/reduced/shaft_mode.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/free_motion.h"
#include "tests/fixture/gap_oscillator.h"
#include "tests/fixture/paper.h"
#include "tests/fixture/slope.h"
#include "tests/fixture/trajectory.h"

/* ---- the bits are those of rk4 that runs through ---- */

static enum step_status through(const struct model *m, const double *p, double *work, const struct segment *e,
                                unsigned regime, double *x, struct crossing *c)
{
    (void)regime;
    return rk4.bind(m)(m, p, work, e, REGIME_ANY, x, c);
}

static step_function *bind_through(const struct model *m)
{
    (void)m;
    return through;
}

/* A drive that opens the contact, or closes the gap, in most of its periods. */
static const struct thrown {
    const struct model *model;
    double force, frequency,
        angle; /* force in units of the model, the others of the eigenfrequency and in a tick of it */
} thrown[] = {
    {&hertz_rig, 0.5, 0.9, 0.1},       {&rolling_contact, 0.5, 0.9, 0.1},      {&afm_tip, 0.5, 0.9, 0.1},
    {&shaft_bearing, 0.3, 0.13, 0.05}, {&shaft_bearing_mode, 0.3, 0.13, 0.05},
};
enum { THROWN = sizeof thrown / sizeof thrown[0], UNLOCATED_TICKS = 20000 };

static double scratch[METHOD_SCRATCH];

static void start_thrown(struct plant *pl, const struct thrown *t, const struct method *method)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct scale scale;
    for (int i = 0; i < t->model->n_parameters; i++)
        si[i] = t->model->parameter[i].initial;
    if (t->model == &afm_tip) /* a sample as soft as the lever, from which this force lifts the tip */
        si[TIP_CONTACT_STIFFNESS] *= 0.05;
    t->model->prepare(si, p, &scale);
    double h = t->angle / t->model->eigenfrequency(p);
    const struct plant_config c = {.model = t->model,
                                   .si = si,
                                   .method = method,
                                   .tick_s = h * scale.time_s,
                                   .dilation = 1.0,
                                   .scratch = scratch};
    check_no_error(t->model->name, plant_init(pl, &c));
    plant_drive_start(pl, 0, t->force * scale.force_N, t->frequency * t->angle / (6.283 * c.tick_s), 0.0);
}

TEST(rk4_unlocated_bits)
{
    struct method run_through = rk4;
    static struct plant a, b, located;
    run_through.bind = bind_through;
    run_through.bind_run = NULL;
    for (int i = 0; i < THROWN; i++) {
        int differ = 0, before = 0;
        start_thrown(&a, &thrown[i], &rk4_unlocated);
        start_thrown(&b, &thrown[i], &run_through);
        start_thrown(&located, &thrown[i], &rk4);
        size_t size = (size_t)a.model->n_states * sizeof *a.x;
        for (int n = 0; n < UNLOCATED_TICKS; n++) {
            bool good = plant_run(&a, 1) && plant_run(&b, 1) && plant_run(&located, 1);
            differ += !good || memcmp(a.x, b.x, size) != 0;
            before += located.counts.switches == 0 && memcmp(a.x, located.x, size) != 0;
        }
        check_int("ticks that differ from rk4 run through", differ, 0);
        check_int("from rk4 before its first switch", before, 0);
        check_above("contact switches", (double)a.counts.switches, 100);
        if (a.model->n_contacts == 1) /* the shaft's motion multiplies what a switch is off by */
            check_near("as many as rk4 locates", (double)a.counts.switches, (double)located.counts.switches,
                       2.0);
        check_int("residuals and budgets", (int64_t)(a.counts.residual + a.counts.budget), 0);
    }
}

/* A plant whose pieces are used up asks for a step through all switches: it is rk4's, and tells of none. */
TEST(rk4_unlocated_told_through)
{
    static struct plant pl;
    double x[2] = {0.01, -1.0}, y[2] = {0.01, -1.0};
    struct segment e = {.length = 0.1};
    struct crossing c = {-1.0, 0, 0, 0.0};
    start_thrown(&pl, &thrown[0], &rk4_unlocated);
    enum step_status told = pl.step(pl.model, pl.p, scratch, &e, 1u, x, &c);
    check_int("lift-off within the step, told", told, STEP_SWITCH);
    x[0] = 0.01, x[1] = -1.0;
    check_int("to be run through: not told", pl.step(pl.model, pl.p, scratch, &e, 1u | REGIME_ANY, x, &c),
              STEP_END);
    check_int("rk4 run through", rk4.bind(pl.model)(pl.model, pl.p, scratch, &e, REGIME_ANY, y, &c),
              STEP_END);
    check_int("the same state", memcmp(x, y, sizeof x), 0);
    check_below("apart by now", x[0], 0.0);
    x[0] = x[1] = 1e300;
    check_int("beyond the finite numbers", pl.step(pl.model, pl.p, scratch, &e, 1u, x, &c), STEP_NOT_FINITE);
}

/* ---- events ---- */

TEST(rk4_unlocated_events)
{
    static struct plant pl;
    struct event e;
    int n = 0, inside = 0, twice = 0, wrong_tick = 0;
    bool touch = true;
    start_thrown(&pl, &thrown[0], &rk4_unlocated);
    for (int tick = 0; tick < UNLOCATED_TICKS; tick++) {
        if (!plant_run(&pl, 1))
            check_true("the rig stays finite", 0);
        for (; plant_take_event(&pl, &e); n++) {
            inside += fabs(e.fraction - 1.0) > 1e-12;
            wrong_tick += e.tick != (uint64_t)tick;
            twice += e.touch == touch;
            touch = e.touch;
        }
    }
    check_above("events", n, 100);
    check_int("not at the end of a tick", inside, 0);
    check_int("not in the tick that has just run", wrong_tick, 0);
    check_int("touch after touch, or loss after loss", twice, 0);
    double share = fabs(plant_residual(&pl)) / (pl.ledger.gross * pl.scale.energy_J);
    check_below("residual over gross energy", share, 1e-3);
}

/* Both bearings of a symmetric shaft touch in one tick: two events, and the regime of both. */
TEST(rk4_unlocated_together)
{
    static struct plant pl;
    struct event e;
    int n = 0, together = 0;
    uint64_t last = 0;
    start_thrown(&pl, &thrown[3], &rk4_unlocated);
    plant_drive_start(&pl, 0, 0.0, 0.0, 0.0);
    plant_drive_start(&pl, 1, 60.0, 25.0, 0.0); /* in the middle */
    for (int tick = 0; tick < UNLOCATED_TICKS; tick++) {
        if (!plant_run(&pl, 1))
            check_true("the shaft stays finite", 0);
        for (; plant_take_event(&pl, &e); n++) {
            together += n > 0 && e.tick == last;
            last = e.tick;
        }
    }
    check_above("events", n, 10);
    check_int("in pairs", 2 * together, n);
    check_int("budgets", (int64_t)pl.counts.budget, 0);
}

/* Both ends of a shaft cross the whole clearance in one tick: lost on one side, touched on the other. The
 * peak force told at the second loss is that since the first one, also where a block goes on through it. */
TEST(rk4_unlocated_crossed)
{
    enum { TICKS = 12 };
    static struct plant one_by_one, at_once;
    static struct plant *const both[] = {&one_by_one, &at_once};
    for (int i = 0; i < 2; i++) {
        start_thrown(both[i], &thrown[3], &rk4_unlocated);
        plant_drive_start(both[i], 0, 0.0, 0.0, 0.0);
        check_true("at rest", plant_run(both[i], TICKS));
        double back = -2.04 / both[i]->h;
        plant_set_state(both[i], (double[]){1.02, 1.02, 1.02, back, back, back});
    }
    for (int k = 0; k < TICKS; k++)
        check_true("tick by tick", plant_run(&one_by_one, 1));
    check_true("at once", plant_run(&at_once, TICKS));
    check_int("events, two losses and two touchdowns at first", (int64_t)one_by_one.event[3].tick, TICKS);
    check_above("peak force at the second loss", one_by_one.event[2].peak_force, 0.0);
    check_bytes("events at once", at_once.event, one_by_one.event, sizeof one_by_one.event);
}

/* ---- order ---- */

enum { WIDTHS = 60 };

/* The undamped rig from its deepest point, contact lost once a
 * period: back there after the period that quadrature gives. */
TEST(rk4_unlocated_order_hertz)
{
    const double eta = 3.0, period = free_period(eta);
    static struct plant pl;
    double paper[MODEL_PARAMETERS], x[WIDTHS], y[WIDTHS], steps = 60.0;
    paper_defaults(&hertz_rig, paper);
    paper[RIG_PAPER_XI] = 0.0;
    for (int i = 0; i < WIDTHS; i++, steps *= 1.04) {
        double h = period / floor(steps);
        paper_start_by(&pl, &hertz_rig, &rk4_unlocated, 0.0, scratch, paper, h,
                       (double[]){1.5 * eta - 1.5, 0.0});
        if (!plant_run(&pl, (uint64_t)steps))
            check_true("the rig stays finite", 0);
        x[i] = log(h);
        y[i] = log(hypot(pl.x[0] - eta, pl.x[1]));
        if (i == 0)
            check_int("contact switches", (int64_t)pl.counts.switches, 2);
    }
    check_near("order over a period of free vibration with contact loss", slope(x, y, WIDTHS), 2.5, 0.4);
    check_below("error at 600 steps a period", exp(y[WIDTHS - 1]), 1e-3);
}

/* The gap oscillator between its walls, beside exact. */
TEST(rk4_unlocated_order_gap)
{
    const double si[GAP_PARAMETERS] = {0.0, 1.0, 20.0, 1.0}, from[2] = {0.0, 2.0}, time = 6.3;
    static struct gap_run r;
    double x[WIDTHS], y[WIDTHS], truth[2], steps = 200.0;
    gap_start(&r, &gap_oscillator, &exact, si, NULL, time / 100.0, from);
    gap_advance(&r, 100, NULL, NULL);
    memcpy(truth, r.plant.x, sizeof truth);
    for (int i = 0; i < WIDTHS; i++, steps *= 1.04) {
        gap_start(&r, &gap_oscillator, &rk4_unlocated, si, NULL, time / floor(steps), from);
        gap_advance(&r, (uint64_t)steps, NULL, NULL);
        x[i] = log(time / floor(steps));
        y[i] = log(hypot(r.plant.x[0] - truth[0], r.plant.x[1] - truth[1]));
    }
    check_above("contact switches", (double)r.plant.counts.switches, 3);
    check_near("order across gap springs", slope(x, y, WIDTHS), 2.0, 0.5);
}

/* ---- refusals ---- */

TEST(rk4_unlocated_refusals)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct scale scale;
    for (int i = 0; i < hertz_rig.n_parameters; i++)
        si[i] = hertz_rig.parameter[i].initial;
    hertz_rig.prepare(si, p, &scale);
    check_no_error("a step of 0.2 rad", rk4_unlocated.refuse(&hertz_rig, p, 0.2, 0.0));
    check_string("a longer one, as rk4", rk4_unlocated.refuse(&hertz_rig, p, 0.21, 0.0),
                 rk4.refuse(&hertz_rig, p, 0.21, 0.0));
    shaft_bearing_linear.prepare((double[MODEL_PARAMETERS]){1, 1, 1, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1}, p,
                                 &scale);
    const char *why = rk4_unlocated.refuse(&shaft_bearing_linear, p, 1e-3, 0.0);
    check_contains("no contact", why, "take rk4");
}
