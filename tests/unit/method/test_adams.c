/* test_adams.c - Adams' method with one force a tick: drives in closed form, order, switches, dips, energies,
 * what it forgets, what it refuses. */
#include "tests/unit/test.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/method/adams/adams_kink.h"
#include "firmware/method/adams/adams_wave.h"
#include "firmware/method/adams/adams_weights.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/models.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/free_motion.h"
#include "tests/fixture/paper.h"
#include "tests/fixture/slope.h"
#include "tests/fixture/trajectory.h"

static double scratch[METHOD_SCRATCH];
static struct plant pl;

/* The undamped rig in units of its own, tick h, without drives. */
static void start_rig(double h, double place, double rate)
{
    double paper[MODEL_PARAMETERS];
    paper_defaults(&hertz_rig, paper);
    paper[RIG_PAPER_XI] = paper[RIG_PAPER_SIGMA] = 0.0;
    paper_start_by(&pl, &hertz_rig, &adams, 0.0, scratch, paper, h,
                   (double[]){1.5 * place - 1.5, 1.5 * rate});
}

static void run_ticks(uint64_t ticks)
{
    if (!plant_run(&pl, ticks))
        check_true("the plant stays finite", 0);
}

/* ---- the drives, in closed form ---- */

/* Far from the contact x'' = (2/3)(1 + u): ticks of two radians of the drive, and no error but rounding. */
static void check_flight(const char *name, double t, double way, double speed)
{
    check_near(check_name("%s: place, over 50", name),
               (pl.x[0] - (-50.0 + t * t / 3.0 + way * (2.0 / 3.0))) / 50.0, 0.0, 2e-14);
    check_near(check_name("%s: rate", name), pl.x[1] - ((2.0 / 3.0) * t + speed * (2.0 / 3.0)), 0.0, 2e-13);
}

TEST(adams_flight_drives)
{
    const double h = 0.3, w = 2.0 / h, hz = w / 6.283185307179586, a = 0.5, t = 30 * h, phase = 0.7;
    start_rig(h, -50.0, 0.0);
    plant_drive_start(&pl, RIG_FORCE, a, hz, phase);
    run_ticks(30);
    check_flight("steady drive", t, -a * ((cos(w * t + phase) - cos(phase)) / w + t * sin(phase)) / w,
                 a * (sin(w * t + phase) - sin(phase)) / w);
    start_rig(h, -50.0, 0.0);
    plant_drive(&pl, RIG_FAST_FORCE, a, hz, 0.0, t);
    run_ticks(30);
    check_flight("amplitude that ramps up", t, a / t * (2.0 * sin(w * t) / w - t * cos(w * t) - t) / (w * w),
                 a / t * (t * sin(w * t) + (cos(w * t) - 1.0) / w) / w);
    start_rig(h, -50.0, 0.0);
    plant_sample(&pl, RIG_FORCE, a, 30);
    run_ticks(30);
    check_flight("sample that moves", t, a * t * t / 6.0, a * t / 2.0);
    start_rig(h, -50.0, 0.0);
    run_ticks(10);
    plant_sample(&pl, RIG_FORCE, a, 0);
    run_ticks(20);
    check_flight("sample that jumps", t, 0.5 * a * 400.0 * h * h, a * 20.0 * h);
}

/* A jump inside a tick cuts it in two. */
TEST(adams_flight_parts)
{
    const double h = 0.3, t = 30 * h, left = 24.75 * h;
    start_rig(h, -50.0, 0.0);
    if (!plant_advance(&pl, (struct instant){5, 16384}))
        check_true("the plant stays finite", 0);
    plant_sample(&pl, RIG_FORCE, 0.5, 0);
    run_ticks(24);
    if (!plant_advance(&pl, (struct instant){30, 0}))
        check_true("the plant stays finite", 0);
    check_flight("sample that jumps inside a tick", t, 0.25 * left * left, 0.5 * left);
}

/* ---- order, by the stored trajectories ---- */

enum { WIDTHS = 24 };

static double order_of(const struct trajectory *r, double from, double to, double *last)
{
    double x[WIDTHS], y[WIDTHS];
    for (int i = 0; i < WIDTHS; i++) {
        double steps = from * pow(to / from, (double)i / (WIDTHS - 1));
        *last = trajectory_run(r, &adams, 0.0, scratch, steps).state;
        x[i] = -log(steps);
        y[i] = log(*last);
    }
    return slope(x, y, WIDTHS);
}

/* One that adams takes, whose motion does not multiply errors by much. */
static bool taken(const struct trajectory *r)
{
    return r->model->hertz_form && r->growth < 10.0;
}

static void check_order(const struct trajectory *r)
{
    double last;
    if (!taken(r) || r->n_events_total < 0)
        return;
    bool smooth = r->n_events_total == 0 && r->n_samples > 0;
    double order = order_of(r, smooth ? 80.0 : 120.0, smooth ? 320.0 : 1200.0, &last);
    if (smooth)
        check_near(check_name("%s: order of smooth motion", r->name), order, 5.6, 1.0);
    else /* 2.5 where a sample lies within five ticks of a switch */
        check_above(check_name("%s: order across switches", r->name), order, 2.4);
    check_below(check_name("%s: error at the last", r->name), last, smooth ? 1e-5 : 2e-6);
}

TEST(adams_order)
{
    trajectory_all(check_order);
}

/* The integral of (1 - s) f or of f over 0 <= s <= 1, by Simpson's rule over 2000 parts. */
static double integral_of(double (*f)(double s, double z), double z, int which)
{
    const int n = 2000;
    double sum = 0.0;
    for (int k = 0; k <= n; k++) {
        double s = (double)k / n, weight = k == 0 || k == n ? 1.0 : 2.0 + 2.0 * (k % 2);
        sum += weight * (which == ADAMS_PLACE ? 1.0 - s : 1.0) * f(s, z);
    }
    return sum / (3.0 * n);
}

static double cosine(double s, double z)
{
    return cos(z * s);
}

static double sine(double s, double z)
{
    return sin(z * s);
}

static double square(double s, double z)
{
    (void)z;
    return s * s;
}

static double cube(double s, double z)
{
    (void)z;
    return s * s * s;
}

/* A step of length 1 on f: without and with the force at its end. */
static void check_rule(const struct adams *s, double (*f)(double s, double z), double z, const char *name)
{
    double ahead =
        s->ahead[0] * (f(0.0, z) - f(-3.0, z)) - s->ahead[1] * (f(-1.0, z) - f(-2.0, z)) + f(-4.0, z);
    for (int which = 0; which < 2; which++) {
        double past = which == ADAMS_PLACE ? s->correct[0] + s->correct[1] : s->correct[1];
        double predicted = -past * f(0.0, z);
        for (int j = 0; j < ADAMS_NODES; j++)
            predicted += s->predict[j][which] * f(-j, z);
        double corrected = predicted + s->correct[which] * (f(1.0, z) - ahead);
        double truth = integral_of(f, z, which);
        if (f != cube)
            check_near(check_name("%s at %g, predicted: %s", name, z, which ? "rate" : "place"), predicted,
                       truth, 2e-10);
        check_near(check_name("%s at %g, corrected: %s", name, z, which ? "rate" : "place"), corrected, truth,
                   2e-10);
    }
}

/* Exact for a wave of the angle that they are for, and for polynomials. */
TEST(adams_weights_fit_wave)
{
    static const double ANGLE[] = {0.051, 0.3, 1.0, 1.6, 2.1};
    static struct adams s;
    s.h = 1.0;
    adams_prepare_series(&s);
    for (unsigned i = 0; i < sizeof ANGLE / sizeof ANGLE[0]; i++) {
        check_true("they change", adams_weigh(&s, ANGLE[i]));
        check_true("once", !adams_weigh(&s, ANGLE[i]));
        check_rule(&s, cosine, ANGLE[i], "cosine");
        check_rule(&s, sine, ANGLE[i], "sine");
        check_rule(&s, cosine, 0.0, "constant");
        check_rule(&s, square, ANGLE[i], "square");
        check_rule(&s, cube, ANGLE[i], "cube");
    }
    check_true("beyond the largest they do", adams_weigh(&s, ADAMS_FIT_MOST + 0.1));
    check_rule(&s, cube, 0.0, "cube");
    check_true("and are those of no wave", !adams_weigh(&s, 0.0));
}

static int n_told;

static void check_told(const struct trajectory *r)
{
    if (!taken(r) || r->n_events_total <= 0)
        return;
    struct trajectory_errors worst = trajectory_run(r, &adams, 0.0, scratch, 640.0);
    check_int(check_name("%s: contact switches", r->name), worst.n_events, r->n_events_total);
    check_below(check_name("%s: worst instant, model time", r->name), worst.time, 2e-6);
    check_below(check_name("%s: worst speed, model units", r->name), worst.speed, 2e-4);
    check_int("of the wrong kind", worst.kinds, 0);
    n_told++;
}

TEST(adams_reference_switches)
{
    n_told = 0;
    trajectory_all(check_told);
    check_above("trajectories with switches", n_told, 8);
}

/* ---- switches, in closed form ---- */

/* The largest force behind a state that is put in place, while the rig moves out: that of the state itself,
 * as the predictor has it. */
static double peak_behind_state(uint64_t at_once)
{
    start_rig(0.05, 3.0, 0.0);
    run_ticks(10);
    plant_set_state(&pl, (double[]){pl.x[0], pl.x[1]});
    for (uint64_t k = 0; k < 10; k += at_once)
        run_ticks(at_once);
    return pl.peak_force;
}

TEST(adams_peak_behind_state)
{
    start_rig(0.05, 3.0, 0.0);
    run_ticks(10);
    double force = pow(pl.x[0], 1.5);
    check_near("ten ticks at once", peak_behind_state(10) / force, 1.0, 2e-9);
    check_near("five", peak_behind_state(5) / force, 1.0, 2e-9);
    check_near("one by one", peak_behind_state(1) / force, 1.0, 2e-9);
}

/* From flight at x'' = 2/3 the instant and the speed are exact, for a parabola is its own cubic. Then a
 * bounce: the deepest force, the time in contact and the speed at lift-off from the energy. */
TEST(adams_bounce)
{
    const double h = 0.05, height = 1.3, fall = sqrt(3.0 * height), speed = fall * (2.0 / 3.0);
    struct event touch, loss;
    start_rig(h, -height, 0.0);
    run_ticks((uint64_t)((fall + free_contact_time(speed)) / h) + 2);
    check_true("a touchdown, a lift-off", plant_take_event(&pl, &touch) && plant_take_event(&pl, &loss));
    check_true("in this order", touch.touch && !loss.touch);
    check_near("instant of touchdown, ticks", (double)touch.tick + touch.fraction, fall / h, 2e-6);
    check_near("speed there", touch.speed, speed, 5e-5);
    check_near("largest force over that of the energy", loss.peak_force / pow(free_peak(speed), 1.5), 1.0,
               1e-6);
    check_near("contact time, ticks",
               (double)loss.tick + loss.fraction - ((double)touch.tick + touch.fraction),
               free_contact_time(speed) / h, 5e-6);
    check_near("speed at lift-off", loss.speed, speed, 2e-5);
    check_near("time out of contact, ticks", pl.loss_time / h,
               (double)pl.now.tick - (double)loss.tick - loss.fraction + (double)touch.tick + touch.fraction,
               1e-9);
}

/* The flight behind a bounce, by parabola, energy and time in contact. Over many steps, for the error depends
 * on where in a tick the contact switches, too. */
static double error_behind_bounce(double steps)
{
    const double height = 1.3, fall = sqrt(3.0 * height), speed = fall * (2.0 / 3.0);
    const double up = fall + free_contact_time(speed);
    double h = 1.0 / steps;
    uint64_t ticks = (uint64_t)((up + 2.5) / h);
    double flown = (double)ticks * h - up;
    start_rig(h, -height, 0.0);
    run_ticks(ticks);
    return fmax(fabs(pl.x[0] - flown * (flown / 3.0 - speed)), fabs(pl.x[1] - ((2.0 / 3.0) * flown - speed)));
}

TEST(adams_order_behind_switches)
{
    enum { MANY = 200 };
    double x[MANY], y[MANY], worst = 0.0;
    for (int i = 0; i < MANY; i++) {
        double steps = 5.0 * pow(8.0, (double)i / (MANY - 1)), error = error_behind_bounce(steps);
        x[i] = -log(steps);
        y[i] = log(error);
        worst = fmax(worst, error * pow(steps, 4.5));
    }
    check_near("order: between 6 of the rule and 4.5 of a switch", slope(x, y, MANY), 5.0, 0.5);
    check_below("largest error times steps^4.5", worst, 0.2);
}

/* -zeta(-a, x) of Hurwitz at 0 and 1, and at 1/2, where it is (2^-a - 1) of those. */
TEST(adams_remainders)
{
    const double x[] = {0.0, 0.5, 1.0}, part[] = {1.0, pow(2.0, -1.5) - 1.0, 1.0};
    const double part_by_s[] = {1.0, pow(2.0, -2.5) - 1.0, 1.0};
    for (int i = 0; i < 3; i++) {
        struct adams_remainder r = adams_remainder(x[i]);
        check_near(check_name("of s^1.5, at %g", x[i]), r.of_force, part[i] * 0.025485201889833, 5e-5);
        check_near(check_name("of s^2.5, at %g", x[i]), r.of_force_by_s, -part_by_s[i] * 0.008516928778,
                   5e-5);
    }
}

/* Within a tick the contact opens and closes again, or closes and opens. The motion is a parabola whose apex
 * is 2e-4 beyond, and whose arms are about 0.1 ticks long. */
static void check_dip(const char *name, double push, double side)
{
    const double h = 0.25, bend = (2.0 / 3.0) * (1.0 + push), depth = 2e-4,
                 arm = sqrt(2.0 * depth / fabs(bend));
    const double before = 0.4 * h;
    struct event e[2];
    start_rig(h, side * (depth - 0.5 * fabs(bend) * before * before), side * fabs(bend) * before);
    plant_sample(&pl, RIG_FORCE, push, 0);
    run_ticks(1);
    check_int(check_name("%s: two switches in one tick", name), pl.counts.switches, 2);
    check_true("both told", plant_take_event(&pl, &e[0]) && plant_take_event(&pl, &e[1]));
    check_int("the first one is a touchdown", e[0].touch, side > 0.0);
    check_int("and the second one is not", e[1].touch, side < 0.0);
    check_near("first, ticks", e[0].fraction, (before - arm) / h, 0.01);
    check_near("second, ticks", e[1].fraction, (before + arm) / h, 0.01);
    check_near("speed", e[1].speed, fabs(bend) * arm, 0.1 * fabs(bend) * arm);
    check_int("the contact is as before", (int64_t)pl.regime, side < 0.0);
}

TEST(adams_dips)
{
    check_dip("into contact", -3.0, 1.0);
    check_dip("out of contact", 0.0, -1.0);
}

/* ---- energies ---- */

/* The worst balance at the end of any tick. */
static double imbalance(const struct trajectory *r, double steps, uint64_t *switches)
{
    struct scale scale;
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    paper_prepare(r->model, r->paper, si, p, &scale);
    double h = 6.283185307179586 * scale.time_s / r->model->eigenfrequency(p) / steps;
    paper_start_by(&pl, r->model, &adams, 0.0, scratch, r->paper, h, r->start);
    double worst = 0.0;
    for (uint64_t left = (uint64_t)(r->t[r->n_samples - 1] / h); left > 0; left--) {
        run_ticks(1);
        worst = fmax(worst, fabs(plant_residual(&pl)) / ((pl.ledger.gross + 1.0) * pl.scale.energy_J));
    }
    *switches = pl.counts.switches;
    return worst;
}

static void check_energy(const struct trajectory *r)
{
    uint64_t switches;
    if (!taken(r))
        return;
    double worst = imbalance(r, 480.0, &switches);
    check_below(check_name("%s: residual over gross energy and one, 480 ticks a period", r->name), worst,
                switches ? 1e-4 : 1e-6);
}

/* Forces, a moving base with and without a damper on it, a modulated stiffness. */
TEST(adams_energies)
{
    trajectory_all(check_energy);
}

/* ---- what it forgets ---- */

/* A state that is set, parameters that change, and a run through a part of a tick leave nothing of before. */
TEST(adams_forgets)
{
    static double other[METHOD_SCRATCH];
    static struct plant fresh;
    double x[MODEL_STATES] = {1.7, 0.1}, paper[MODEL_PARAMETERS];
    paper_defaults(&hertz_rig, paper);
    paper_start_by(&fresh, &hertz_rig, &adams, 0.0, other, paper, 0.1, (double[]){0.0, 0.0});
    paper_start_by(&pl, &hertz_rig, &adams, 0.0, scratch, paper, 0.1, (double[]){1.0, 0.3});
    plant_drive_start(&pl, RIG_FORCE, 0.0, 0.0, 0.0);
    plant_drive_start(&fresh, RIG_FORCE, 0.0, 0.0, 0.0);
    run_ticks(50);
    plant_set_state(&pl, x);
    plant_set_state(&fresh, x);
    run_ticks(50);
    check_true("another", plant_run(&fresh, 50));
    check_bytes("state after one that was set", pl.x, fresh.x, 2 * sizeof *x);
    double si[MODEL_PARAMETERS];
    memcpy(si, pl.si, sizeof si);
    si[RIG_DAMPING] *= 2.0;
    check_no_error("parameters", plant_change(&pl, si));
    plant_set_state(&pl, x);
    check_no_error("parameters", plant_change(&fresh, si));
    plant_set_state(&fresh, x);
    run_ticks(1);
    check_true("another", plant_run(&fresh, 1));
    check_bytes("state after new parameters", pl.x, fresh.x, 2 * sizeof *x);
}

/* A plant whose pieces are used up asks for a step through all switches: it is told of none. */
TEST(adams_told_through)
{
    struct segment e = {.length = 0.1, .changed = true};
    struct crossing c = {-1.0, 0, 0, 0.0};
    double x[2] = {0.01, -1.0};
    start_rig(0.1, 1.0, 0.0);
    check_int("lift-off within the step, told", pl.step(pl.model, pl.p, scratch, &e, 1u, x, &c), STEP_SWITCH);
    check_near("at x = 0", x[0], 0.0, 1e-15);
    x[0] = 0.01, x[1] = -1.0;
    check_int("to be run through: not told", pl.step(pl.model, pl.p, scratch, &e, 1u | REGIME_ANY, x, &c),
              STEP_END);
    check_below("apart by now", x[0], 0.0);
    x[0] = x[1] = DBL_MAX;
    check_int("beyond the finite numbers", pl.step(pl.model, pl.p, scratch, &e, 1u, x, &c), STEP_NOT_FINITE);
}

/* ---- refusals ---- */

TEST(adams_refusals)
{
    int n_taken = 0;
    for (int i = 0; i < MODELS; i++) {
        const struct model *m = model_table[i];
        double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
        struct scale scale;
        for (int k = 0; k < m->n_parameters; k++)
            si[k] = m->parameter[k].initial;
        m->prepare(si, p, &scale);
        double h = 0.399 / m->eigenfrequency(p);
        const char *why = adams.refuse(m, p, h, 0.0);
        n_taken += why == NULL;
        if (!m->hertz_form)
            check_contains(m->name, why, "take auto");
        else
            check_contains(m->name, adams.refuse(m, p, 1.01 * h, 0.0), "more substeps");
    }
    check_int("models that it takes", n_taken, 3);
}

/* At the bounds on angle and damping a motion still comes to rest; beyond that on damping it would not. */
TEST(adams_keeps_damping)
{
    static const double XI[] = {0.05, 0.0515}; /* h 2 xi: 0.0399 and 0.0411 */
    const double h = 0.399;
    for (int i = 0; i < 2; i++) {
        double paper[MODEL_PARAMETERS], si[MODEL_PARAMETERS], p[MODEL_DERIVED];
        struct harmonic drive[MODEL_INPUTS];
        struct scale scale;
        paper_defaults(&hertz_rig, paper);
        paper[RIG_PAPER_XI] = XI[i];
        hertz_rig.from_paper(paper, si, drive);
        hertz_rig.prepare(si, p, &scale);
        const char *why = adams.refuse(&hertz_rig, p, h, 0.0);
        if (i > 0) {
            check_contains("too much damping", why ? why : "taken", "less damping");
            continue;
        }
        check_no_error("the most damping", why);
        paper[RIG_PAPER_SIGMA] = 0.0;
        paper_start_by(&pl, &hertz_rig, &adams, 0.0, scratch, paper, h, (double[]){0.3, 0.0});
        run_ticks(2000);
        check_near("at rest", pl.x[0], 1.0, 1e-12);
    }
}
