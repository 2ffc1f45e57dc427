/* test_plant_trouble.c - methods that give up or break, switches without end, drives that end. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/hertz_rig.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/rig.h"

/* A method that reports a switch at a tenth of whatever it is given, unless told to run through; every other
 * one with a residual. */
static int n_calls, n_any;

static enum step_status rattling_step(const struct model *m, const double *p, double *scratch,
                                      const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    (void)m, (void)p, (void)scratch, (void)x;
    n_calls++;
    if (regime & REGIME_ANY) {
        n_any++;
        return STEP_END;
    }
    *c = (struct crossing){0.1 * e->length, 0, n_calls % 2, 0.0};
    return STEP_SWITCH;
}

/* A method that does not even run through when it is told to. */
static enum step_status deaf_step(const struct model *m, const double *p, double *scratch,
                                  const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    return rattling_step(m, p, scratch, e, regime & ~(unsigned)REGIME_ANY, x, c);
}

TEST(plant_budget)
{
    double paper[PAPER];
    struct plant pl;
    struct event e;
    rig_paper(paper);
    paper[SIGMA] = 0.1;
    rig_start(&pl, paper, 0.01, 0.0, 0.0);
    check_true("one tick in one piece", plant_run(&pl, 1));
    check_int("one tick in one piece", pl.counts.pieces_max, 1);
    rig_start(&pl, paper, 0.01, 0.0, 0.0);
    pl.step = rattling_step;
    pl.bind_run = NULL;
    n_calls = n_any = 0;
    rig_run(&pl, 3);
    check_int("calls of the method in 3 ticks", n_calls, 3 * PLANT_PIECES);
    check_int("of which run through", n_any, 3);
    check_int("ticks out of budget", pl.counts.budget, 3);
    check_int("most pieces", pl.counts.pieces_max, PLANT_PIECES);
    check_int("switches", pl.counts.switches, 3 * (PLANT_PIECES - 1));
    check_int("with a residual, of 7 a tick the odd ones", pl.counts.residual, 3 * 4);
    check_int("tick", (int64_t)pl.now.tick, 3);
    check_near("time of all pieces", pl.total_time, 0.03, 1e-16);
    check_int("regime from the gap afterwards", pl.regime, 1);
    double rest = 1.0;
    for (int i = 0; i < PLANT_PIECES - 1 && plant_take_event(&pl, &e); i++) {
        rest *= 0.9;
        check_near("fraction of the tick", e.fraction, 1.0 - rest, 1e-15);
    }
    pl.step = rk4.bind(&hertz_rig);
    pl.bind_run = NULL;
    rig_run(&pl, 5000);
    check_int("quiet again with a sound method", pl.counts.budget, 3);
    check_int("most pieces so far", pl.counts.pieces_max, PLANT_PIECES);
    pl.step = rattling_step;
    pl.bind_run = NULL;
    check_true("to a fraction", plant_advance(&pl, (struct instant){pl.now.tick, 1 << 15}));
    while (plant_take_event(&pl, &e))
        ;
    rig_run(&pl, 1);
    check_true("first event after half a tick", plant_take_event(&pl, &e));
    check_near("lies at 0.55: a tenth of the rest", e.fraction, 0.55, 1e-15);
    n_calls = 0;
    uint64_t tick = pl.now.tick;
    pl.step = deaf_step;
    pl.bind_run = NULL;
    check_true("a method that does not run through is refused", !plant_run(&pl, 1));
    check_int("after as many calls", n_calls, PLANT_PIECES);
    check_int("and time stands", (int64_t)(pl.now.tick - tick), 0);
}

/* A method that gives up half way, once a segment: its own budget is no switch. */
static enum step_status tired_step(const struct model *m, const double *p, double *scratch,
                                   const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    struct segment half;
    if (n_calls++ % 2)
        return rk4.bind(m)(m, p, scratch, e, regime, x, c);
    segment_head(e, m->n_inputs, 0.5 * e->length, &half);
    enum step_status status = rk4.bind(m)(m, p, scratch, &half, regime, x, c);
    if (status != STEP_END)
        return status;
    c->done = half.length;
    return STEP_BUDGET;
}

TEST(plant_method_budget)
{
    double paper[PAPER];
    struct plant pl, sound;
    rig_paper(paper);
    paper[SIGMA] = 0.1;
    rig_start(&pl, paper, 0.001, 0.1, 0.0);
    sound = pl;
    pl.step = tired_step;
    pl.bind_run = NULL;
    n_calls = 0;
    rig_run(&pl, 2000);
    rig_run(&sound, 2000);
    check_int("counted once a tick", pl.counts.work, 2000);
    check_int("no switch", pl.counts.switches, 0);
    check_int("regime kept", pl.regime, 1);
    check_near("the same motion, position", pl.x[0], sound.x[0], 1e-12);
    check_near("and work", sum_of(&pl.ledger.work[0]), sum_of(&sound.ledger.work[0]), 1e-12);
    check_near("time of all pieces", pl.total_time, 2.0, 1e-12);
}

static enum step_status broken_step(const struct model *m, const double *p, double *scratch,
                                    const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    (void)m, (void)p, (void)scratch, (void)e, (void)regime, (void)c;
    x[0] = (double)NAN;
    return STEP_NOT_FINITE;
}

TEST(plant_not_finite)
{
    double paper[PAPER];
    struct plant pl;
    rig_paper(paper);
    paper[XI] = 0.05;
    rig_start(&pl, paper, 0.01, 0.5, 0.0);
    rig_run(&pl, 100);
    double x[2] = {pl.x[0], pl.x[1]}, damping = sum_of(&pl.ledger.damping);
    pl.step = broken_step;
    pl.bind_run = NULL;
    check_true("refused", !plant_run(&pl, 5));
    check_int("counted", pl.counts.not_finite, 1);
    check_int("stands at the last good tick", (int64_t)pl.now.tick, 100);
    check_is("state kept", pl.x[0], ==, x[0]);
    check_is("state kept", pl.x[1], ==, x[1]);
    check_near("nothing booked", sum_of(&pl.ledger.damping), damping, 0.0);
    pl.step = rk4.bind(&hertz_rig);
    pl.bind_run = NULL;
    rig_run(&pl, 5);
    check_int("goes on with a sound method", (int64_t)pl.now.tick, 105);
    plant_set_state(&pl, (double[]){1e250, 0.0});
    check_true("rk4 refuses a state whose force overflows", !plant_run(&pl, 1));
    check_is("state kept", pl.x[0], ==, 1e250);
    check_is("state kept", pl.x[1], ==, 0.0);
    check_int("counted", pl.counts.not_finite, 2);
    plant_set_state(&pl, (double[]){(double)NAN, 0.0});
    check_true("rk4 refuses a state that is not a number", !plant_run(&pl, 1));
    plant_reset(&pl);
    rig_run(&pl, 10);
    check_near("after a reset all is well", pl.x[0], 1.0, 0.0);
}

/* A method that ends at a state of the test's choice. */
static double far[MODEL_STATES];

static enum step_status far_step(const struct model *m, const double *p, double *scratch,
                                 const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    (void)p, (void)scratch, (void)e, (void)regime, (void)c;
    memcpy(x, far, (size_t)m->n_states * sizeof *x);
    return STEP_END;
}

/* One tick that ends with x[i] = size and x[k] = with, all
 * others 0: is it taken? A refusal must change no state. */
static int taken(struct plant pl, int i, double size, int k, double with)
{
    struct plant before = pl;
    memset(far, 0, sizeof far);
    far[i] = size;
    far[k] += with;
    pl.step = far_step;
    pl.bind_run = NULL;
    if (plant_run(&pl, 1))
        return 1;
    check_bytes("state kept", pl.x, before.x, sizeof pl.x);
    check_int("state kept", pl.counts.not_finite, 1);
    return 0;
}

/* The sizes of all states together may reach PLANT_STATE_LIMIT. */
TEST(plant_far)
{
    struct plant_config c = {.model = &shaft_bearing, .method = &rk4, .tick_s = 1e-5, .dilation = 1.0};
    struct plant pl;
    check_no_error("a shaft", plant_init(&pl, &c));
    plant_set_state(&pl, (double[]){1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3});
    for (int i = 0; i < shaft_bearing.n_states; i++) {
        double sign = i % 2 ? -1.0 : 1.0;
        check_true("at the limit it is taken", taken(pl, i, sign * PLANT_STATE_LIMIT, i, 0.0));
        check_true("beyond it is not", !taken(pl, i, sign * 1.000001 * PLANT_STATE_LIMIT, i, 0.0));
        check_true("not a number is not", !taken(pl, i, (double)NAN, i, 0.0));
        check_true("nor together with another", !taken(pl, i, sign * 0.6 * PLANT_STATE_LIMIT, (i + 1) % 6,
                                                       -sign * 0.6 * PLANT_STATE_LIMIT));
    }
}

/* A base that fell silent is at rest: no rate of its last ramp is left behind. */
TEST(plant_silence)
{
    double paper[PAPER];
    struct plant pl;
    rig_paper(paper);
    paper[XI] = 0.5;
    paper[A_BASE] = 0.3;
    rig_start(&pl, paper, 0.01, 0.0, 0.0);
    rig_run(&pl, 1000);
    plant_drive(&pl, RIG_BASE, 0.0, 0.0, 0.0, 0.0);
    rig_run(&pl, 2);
    double scratch = sum_of(&pl.ledger.work[RIG_BASE]);
    rig_run(&pl, 5000);
    check_near("the mass comes to rest at the static compression", pl.x[0], 1.0, 1e-12);
    check_near("the base does no more work", sum_of(&pl.ledger.work[RIG_BASE]), scratch, 0.0);
    check_near("residual", plant_residual(&pl) / pl.scale.energy_J, 0.0, 1e-7);
}
