/* test_taylor_short.c - one short series a tick: the switch that it must leave to others, the orders that it
 * must reach, and which inputs it takes. */
#include "tests/unit/test.h"

#include <math.h>
#include "firmware/method/taylor/taylor_piece.h"
#include "models/hertz_rig.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "tests/fixture/paper.h"

static double scratch[METHOD_SCRATCH], p[MODEL_DERIVED];

static const struct taylor *state(void)
{
    return (const struct taylor *)(const void *)scratch;
}

/* The undamped defaults of a model. */
static void prepare(const struct model *m, double tick, double tol)
{
    double paper[MODEL_PARAMETERS], si[MODEL_PARAMETERS];
    struct scale scale;
    paper_defaults(m, paper);
    paper[0] = m == &hertz_rig ? 0.0 : paper[0]; /* xi */
    paper_prepare(m, paper, si, p, &scale);
    taylor.prepare(m, p, tick, tol, scratch);
}

/* New: the first input goes on in a straight line from `offset`. */
static struct segment straight(double length, double offset, double slope)
{
    struct segment e = {.length = length, .active = 1, .changed = true};
    e.wave[0] = (struct wave){.offset = offset, .slope = slope, .cosine = 1.0};
    for (int k = 0; k < 3; k++)
        wave_at(&e.wave[0], 0.5 * k * length, &e.at[k][0]);
    return e;
}

/* ---- a switch inside the tick ---- */

/* Far enough from it by the speed alone, but carried there
 * by a force that gives the rig `a` + `jerk` t at first. */
static void check_switch(unsigned regime, double eta, double a, double jerk, double at, double allowed)
{
    enum { FAR = 2 };
    const double h = 0.1, inside[2] = {FAR, 0.0};
    double x[2] = {inside[0], inside[1]};
    struct crossing c;
    step_function *step = taylor.bind(&hertz_rig);
    prepare(&hertz_rig, h, 1e-2);
    struct segment e = straight(h, 0.0, 0.0);
    check_int("a tick in the contact", step(&hertz_rig, p, scratch, &e, 1, x, &c), STEP_END);
    x[0] = eta;
    x[1] = 0.0;
    e = straight(h, 1.5 * a - 1.0, 1.5 * jerk); /* eta'' = 2/3 (1 + force) apart */
    check_int("the switch is seen", step(&hertz_rig, p, scratch, &e, regime, x, &c), STEP_SWITCH);
    check_near("where", c.done, at, allowed);
    check_int("a series that was thrown away is not tried again", state()->brief, false);
}

/* eta = -0.1 + a t^2/2 + jerk t^3/6: beyond zero at the end of the tick, or only inside of it. */
TEST(taylor_short_flight)
{
    check_switch(0, -0.1, 40.0, 0.0, sqrt(0.2 / 40.0), 1e-9);
    double t = 0.06; /* root of -0.1 + 60 t^2 - 550 t^3 */
    for (int i = 0; i < 50; i++)
        t -= (-0.1 + 60.0 * t * t - 550.0 * t * t * t) / (120.0 * t - 1650.0 * t * t);
    check_switch(0, -0.1, 120.0, -3300.0, t, 1e-9);
}

/* The contact, at most 0.1^1.5, moves it by 1.6e-4 in the tick
 * at most, which falls through zero with a speed above 2. */
TEST(taylor_short_lift_off)
{
    check_switch(1, 0.1, -40.0, 0.0, sqrt(0.2 / 40.0), 1e-4);
    double t = 0.09; /* root of 0.1 + 5 t^2 - 200 t^3 */
    for (int i = 0; i < 50; i++)
        t -= (0.1 + 5.0 * t * t - 200.0 * t * t * t) / (10.0 * t - 600.0 * t * t);
    check_switch(1, 0.1, 10.0, -1200.0, t, 1e-4);
}

/* ---- orders ---- */

/* The motion over a tick by rk4 in a thousand parts. */
static void fine(const struct model *m, double tick, double *x)
{
    enum { PARTS = 1000 };
    struct crossing c;
    const struct segment e = {.length = tick / PARTS};
    for (int i = 0; i < PARTS; i++)
        (void)rk4.bind(m)(m, p, NULL, &e, REGIME_ANY, x, &c);
}

/* A free motion by one series, whose error per model time is the tolerance. */
static void check_order(const struct model *m, double tick, double tol)
{
    static const double start[2] = {1.1, 0.05};
    double x[2] = {start[0], start[1]}, y[2] = {start[0], start[1]};
    struct crossing c;
    prepare(m, tick, 8.0 * tol); /* a motion of a tenth is allowed an eighth of it */
    const struct segment e = {.length = tick, .changed = true};
    check_int(m->name, taylor.bind(m)(m, p, scratch, &e, 1, x, &c), STEP_END);
    check_near(check_name("a tick of %g at %g takes one short series", tick, tol), state()->kind, TAYLOR_NONE,
               0.0);
    fine(m, tick, y);
    check_below("its error over the tolerance", fmax(fabs(x[0] - y[0]), fabs(x[1] - y[1])) / (tick * tol),
                1.0);
}

/* Each where the order before leaves more than the tolerance:
 * 8, 10, 12 of the contact, 6, 8, 11, 14 of the cubic force. */
TEST(taylor_short_orders)
{
    static const double contact[][2] = {{0.2, 1e-4},  {0.3, 1e-7}, {0.6, 1e-6}, {0.25, 1e-10},
                                        {0.45, 1e-8}, {0.7, 1e-7}, {0.9, 1e-6}};
    static const double cubic[][2] = {{0.2, 1e-4},  {0.45, 1e-5}, {0.5, 1e-7}, {0.4, 1e-11},
                                      {0.75, 1e-9}, {0.9, 1e-8},  {1.1, 1e-7}};
    for (unsigned i = 0; i < sizeof contact / sizeof *contact; i++)
        check_order(&hertz_rig, contact[i][0], contact[i][1]);
    for (unsigned i = 0; i < sizeof cubic / sizeof *cubic; i++)
        check_order(&hertz_rig_cubic, cubic[i][0], cubic[i][1]);
}

/* ---- whether it is worth it ---- */

/* Does a tick from 40 states around rest say that short series are worth it? How many of them do. */
static int n_brief(const struct model *m, double tick, double tol)
{
    int n = 0;
    const struct segment e = {.length = tick, .changed = true};
    for (int i = 0; i < 40; i++) {
        double angle = i * 0.05 * 3.14159265358979324, x[2] = {1.0 + 0.2 * cos(angle), 0.2 * sin(angle)};
        struct crossing c;
        prepare(m, tick, tol);
        n += taylor.bind(m)(m, p, scratch, &e, 1, x, &c) == STEP_END && state()->brief;
    }
    return n;
}

/* Share of the ticks of a free motion that take one short
 * series, and how many ticks a long one reaches at its begin. */
static double share(const struct model *m, double tick, double tol, double *reach)
{
    enum { TICKS = 400 };
    double x[2] = {1.2, 0.0};
    int n = 0;
    const struct segment e = {.length = tick};
    prepare(m, tick, tol);
    for (int i = 0; i < TICKS; i++) {
        struct crossing c;
        n += taylor.bind(m)(m, p, scratch, &e, 1, x, &c) == STEP_END && state()->kind == TAYLOR_NONE;
        *reach = i == 0 ? state()->end / tick : *reach;
    }
    return (double)n / TICKS;
}

/* A long series over eight ticks and more is never given up, one over less than four always; in between a
 * cubic force has short ones earlier than the contact. */
TEST(taylor_short_worth)
{
    double reach;
    check_near("contact, 7 ticks and more: share of short ones", share(&hertz_rig, 0.25, 1e-4, &reach), 0.0,
               0.0);
    check_above("ticks", reach, 7.0);
    check_int("nor asked for", n_brief(&hertz_rig, 0.25, 1e-4), 0);
    check_near("contact, above 4: share", share(&hertz_rig, 0.43, 1e-4, &reach), 0.0, 0.0);
    check_above("ticks", reach, 4.0);
    check_above("contact, below 4: share", share(&hertz_rig, 0.52, 1e-4, &reach), 0.9);
    check_below("ticks", reach, 4.0);
    check_int("asked for everywhere", n_brief(&hertz_rig, 0.52, 1e-4), 40);
    check_near("cubic, 8 ticks and more: share", share(&hertz_rig_cubic, 0.2, 1e-4, &reach), 0.0, 0.0);
    check_above("ticks", reach, 8.0);
    check_int("nor asked for", n_brief(&hertz_rig_cubic, 0.2, 1e-4), 0);
    double often = share(&hertz_rig_cubic, 0.43, 1e-4, &reach);
    check_above("ticks", reach, 4.0);
    check_above("cubic, above 4: a short one at each end of a long one", often, 1.0 / (reach + 2.0));
    check_above("cubic, below 4: share", share(&hertz_rig_cubic, 0.65, 1e-4, &reach), 0.9);
    check_below("ticks", reach, 4.0);
    check_int("asked for everywhere", n_brief(&hertz_rig_cubic, 0.65, 1e-4), 40);
}

/* ---- a plant of three inputs whose force is a polynomial,
 * x'' = -(1 + u0) x + u2; u1 has no part in it ---- */

static void mathieu_form(const double *prepared, struct polynomial_form *f)
{
    (void)prepared;
    *f = (struct polynomial_form){.constant = {0.0, -1.0, 0.0, 0.0}};
    f->modulation[1][0] = -1.0;
    f->modulation[0][2] = 1.0;
}

static void mathieu_rhs(const double *prepared, const struct input *u, const double *x, double *x_dot)
{
    (void)prepared;
    x_dot[0] = x[1];
    x_dot[1] = u[2].value - (1.0 + u[0].value) * x[0];
}

static void mathieu_rest(const double *prepared, double *x)
{
    (void)prepared;
    x[0] = x[1] = 0.0;
}

static double mathieu_eigenfrequency(const double *prepared)
{
    (void)prepared;
    return 1.0;
}

static const struct model mathieu = {.name = "mathieu",
                                     .n_states = 2,
                                     .n_inputs = 3,
                                     .polynomial_form = mathieu_form,
                                     .rhs = mathieu_rhs,
                                     .rest = mathieu_rest,
                                     .eigenfrequency = mathieu_eigenfrequency};

/* One tick from (1, 0) under a constant input. */
static bool is_short(int input, double value, double tick, double *x)
{
    struct segment e = {.length = tick, .active = 1u << input, .changed = true};
    struct crossing c;
    e.wave[input] = (struct wave){.offset = value, .cosine = 1.0};
    for (int k = 0; k < 3; k++)
        e.at[k][input].value = value;
    x[0] = 1.0;
    x[1] = 0.0;
    check_int("it ends", taylor.bind(&mathieu)(&mathieu, p, scratch, &e, 1, x, &c), STEP_END);
    return state()->kind == TAYLOR_NONE;
}

/* cos t of what has no part, u + (1 - u) cos t of a force, cos (sqrt(1 + u) t) of a stiffness. */
TEST(taylor_short_inputs)
{
    const double tick = 0.7, u = 0.44, tol = 1e-8;
    double x[2];
    taylor.prepare(&mathieu, p, tick, tol, scratch);
    check_true("an input without a part: short", is_short(1, u, tick, x));
    check_near("cosine", x[0], cos(tick), tick * tol);
    check_near("sine", x[1], -sin(tick), tick * tol);
    check_true("a force: short", is_short(2, u, tick, x));
    check_near("cosine", x[0], u + (1.0 - u) * cos(tick), tick * tol);
    check_near("sine", x[1], -(1.0 - u) * sin(tick), tick * tol);
    check_int("worth it", state()->brief, true);
    check_true("a stiffness: short", is_short(0, u, tick, x));
    check_near("cosine", x[0], cos(1.2 * tick), tick * tol);
    check_near("sine", x[1], -1.2 * sin(1.2 * tick), tick * tol);
    check_int("worth it", state()->brief, true);
    check_true("a tick of no length: not", !is_short(2, u, 0.0, x));
    check_near("position", x[0], 1.0, 0.0);
    check_near("velocity", x[1], 0.0, 0.0);
}
