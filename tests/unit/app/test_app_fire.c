/* test_app_fire.c - FIRE takes effect at its tick and
 * fraction: the plant against an integration of our own. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/plant/plant_report.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { FINE = 1024, SUB = 4 };
#define TWO_PI 6.283185307179586477

static struct bus bus;

/* One drive as docs/reference/protocol.md defines it. From tick t0, amplitude and phase go linearly to
 * their values over `ramp` ticks. The phase of a silent drive counts from t0, that of a sounding one from
 * `origin`. */
struct drive_law {
    double from, to, ramp, turns_per_tick, t0, origin, phase_from, phase_to;
};

/* The rig in its own units, and four laws; time in ticks. */
struct rig {
    double tick, two_xi; /* model time per tick */
    double unit[MODEL_INPUTS];
    struct drive_law law[MODEL_INPUTS];
};

static void rig_default(struct rig *r)
{
    double si[4];
    for (int i = 0; i < 4; i++)
        si[i] = hertz_rig.parameter[i].initial;
    double zs = pow(si[RIG_PRELOAD] / si[RIG_CONTACT_STIFFNESS], 2.0 / 3.0);
    double nu = sqrt(1.5 * si[RIG_PRELOAD] / (si[RIG_MASS] * zs));
    memset(r, 0, sizeof *r);
    r->tick = nu * 1e-3 / FINE;
    r->two_xi = si[RIG_DAMPING] / (si[RIG_MASS] * nu);
    r->unit[RIG_FORCE] = r->unit[RIG_FAST_FORCE] = si[RIG_PRELOAD];
    r->unit[RIG_BASE] = zs;
    r->unit[RIG_STIFFNESS] = 1.0;
}

/* u and du/dt (per model time) at t ticks. */
static void law_at(const struct rig *r, const struct drive_law *d, double t, double *u, double *rate)
{
    double s = d->ramp > 0.0 ? (t - d->t0) / d->ramp : 1.0;
    bool ramping = s < 1.0;
    s = s < 0.0 ? 0.0 : s > 1.0 ? 1.0 : s;
    double a = d->from + (d->to - d->from) * s;
    double phase =
        TWO_PI * d->turns_per_tick * (t - d->origin) + d->phase_from + (d->phase_to - d->phase_from) * s;
    double a_rate = ramping ? (d->to - d->from) / d->ramp : 0.0;
    double phase_rate =
        TWO_PI * d->turns_per_tick + (ramping ? (d->phase_to - d->phase_from) / d->ramp : 0.0);
    *u = *rate = 0.0;
    if (t < d->t0 && d->from == 0.0)
        return;
    *u = a * cos(phase);
    *rate = (a_rate * cos(phase) - a * phase_rate * sin(phase)) / r->tick;
}

/* `inside`: an instant of the piece, which tells on which side of a corner its ends are meant. */
static void slope(const struct rig *r, double t, double inside, const double *x, double *k)
{
    double u[MODEL_INPUTS], rate[MODEL_INPUTS];
    double eps = 1e-9 * (inside - t);
    for (int i = 0; i < MODEL_INPUTS; i++)
        law_at(r, &r->law[i], t + eps, &u[i], &rate[i]);
    double eta = x[0] - u[RIG_BASE];
    k[0] = x[1];
    k[1] = 2.0 / 3.0 * (1.0 + u[RIG_FORCE] + u[RIG_FAST_FORCE]) -
           2.0 / 3.0 * (1.0 + u[RIG_STIFFNESS]) * pow(eta > 0.0 ? eta : 0.0, 1.5) -
           r->two_xi * (x[1] - rate[RIG_BASE]);
}

/* Classical Runge-Kutta with our own step: SUB steps a tick, cut at the corners by the caller. */
static void integrate(const struct rig *r, double from, double to, double *x)
{
    int n = (int)ceil((to - from) * SUB);
    double dt = n > 0 ? (to - from) / n : 0.0, h = dt * r->tick;
    for (int i = 0; i < n; i++) {
        double t = from + i * dt, m = t + 0.5 * dt, k1[2], k2[2], k3[2], k4[2];
        slope(r, t, m, x, k1);
        slope(r, m, m, (double[]){x[0] + 0.5 * h * k1[0], x[1] + 0.5 * h * k1[1]}, k2);
        slope(r, m, m, (double[]){x[0] + 0.5 * h * k2[0], x[1] + 0.5 * h * k2[1]}, k3);
        slope(r, t + dt, m, (double[]){x[0] + h * k3[0], x[1] + h * k3[1]}, k4);
        for (int j = 0; j < 2; j++)
            x[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]);
    }
}

static void run_law(const struct rig *r, double t0, double ramp, double until, double *x)
{
    integrate(r, t0, t0 + ramp < until ? t0 + ramp : until, x);
    if (t0 + ramp < until)
        integrate(r, t0 + ramp, until, x);
}

static void start_fine(uint64_t frames)
{
    struct app_config c = bus_config();
    c.substeps = FINE;
    bus_start_running(&bus, &c);
    bus_run(&bus, (int)frames);
}

static void check_state(const double *x, double tolerance)
{
    check_near("position / static compression", bus.app.plant.x[0], x[0], tolerance);
    check_near("velocity, rig units", bus.app.plant.x[1], x[1], tolerance);
}

/* The fire is 3 ticks before the end of a frame: that
 * frame ends just behind the ramp; then two frames more. */
TEST(app_fire_exact)
{
    const unsigned fraction[] = {0, 1, 128, 255};
    for (int i = 0; i < 4; i++) {
        struct rig r;
        rig_default(&r);
        start_fine(2);
        uint64_t tick = 3 * FINE - 3;
        double t0 = (double)tick + fraction[i] / 256.0, x[2] = {1.0, 0.0};
        bus_drive(&bus, RIG_FORCE, 32.0, 220.0, 0.75, 0.0);
        bus.counter[WIRE_FIRE] = (uint8_t)(i + 3);
        bus_fire(&bus, 1, false, tick, fraction[i]);
        bus_forget(&bus);
        bus_run(&bus, 1);
        printf("      fraction %u/256\n", fraction[i]);
        r.law[RIG_FORCE] = (struct drive_law){0.0, 0.5, 1.0, 220e-3 / FINE, t0, t0, 0.75, 0.75};
        run_law(&r, t0, 1.0, 3 * FINE, x);
        check_int("tick at the frame's end", (int64_t)bus.app.plant.now.tick, 3 * FINE);
        check_above("force has begun: velocity", fabs(bus.app.plant.x[1]), 1e-5);
        check_state(x, 5e-14);
        check_near("LATENCY: ticks from reception to effect", bus_value(&bus, WIRE_LATENCY, LATENCY_APPLY),
                   FINE - 3, 0);
        check_near("LATENCY: ticks from effect to report", bus_value(&bus, WIRE_LATENCY, LATENCY_SEND), 3, 0);
        check_near("LATENCY: which command", bus_value(&bus, WIRE_LATENCY, LATENCY_MESSAGE), WIRE_FIRE, 0);
        check_near("with this counter", bus_value(&bus, WIRE_LATENCY, LATENCY_COUNTER), i + 3, 0);
        integrate(&r, 3 * FINE, 5 * FINE, x);
        bus_run(&bus, 2);
        check_state(x, 1e-12);
    }
}

/* The base moves by a hundredth of the compression in its one tick of ramp. With more, the plant's own
 * error in that tick (Simpson's rule over eta^{3/2}) would exceed 1e-12. */
TEST(app_fire_together)
{
    const double si[] = {12.8, 6.4, 1e-7, 0.2}, hertz[] = {200.0, 300.0, 350.0, 400.0};
    struct rig r;
    rig_default(&r);
    start_fine(1);
    double t0 = 2 * FINE + 500 + 77.0 / 256.0, x[2] = {1.0, 0.0};
    for (int i = 0; i < MODEL_INPUTS; i++) {
        bus_drive(&bus, i, si[i], hertz[i], 0.3 * i, 0.0);
        r.law[i] =
            (struct drive_law){0.0, si[i] / r.unit[i], 1.0, hertz[i] * 1e-3 / FINE, t0, t0, 0.3 * i, 0.3 * i};
        r.law[i].to = (double)(float)si[i] / r.unit[i];
        r.law[i].phase_from = r.law[i].phase_to = (double)(float)(0.3 * i);
    }
    bus_fire(&bus, 15, false, 2 * FINE + 500, 77);
    bus_run(&bus, 4);
    run_law(&r, t0, 1.0, 5 * FINE, x);
    check_state(x, 1e-12);
    check_int("one fire for four channels", bus.app.count[DIAG_FIRE_APPLIED], 1);
    check_near("DRIVE frequency of the base, turns a tick",
               drive_target(&bus.app.plant.drive[RIG_BASE]).turns_per_tick, 0.35 / FINE, 1e-18);
}

/* A sounding drive changes amplitude and phase over a
 * ramp that begins inside a tick and ends inside another. */
TEST(app_fire_change)
{
    struct rig r;
    rig_default(&r);
    start_fine(0);
    double t0 = 100 + 3.0 / 256.0, t1 = FINE + 10 + 201.0 / 256.0, ramp = 512, x[2] = {1.0, 0.0};
    bus_drive(&bus, RIG_FORCE, 16.0, 220.0, 0.0, 0.0);
    bus_fire(&bus, 1, false, 100, 3);
    bus_run(&bus, 1);
    bus_arm(&bus, RIG_FORCE, ARM_AMPLITUDE, 48.0);
    bus_arm(&bus, RIG_FORCE, ARM_PHASE, 1.5);
    bus_arm(&bus, RIG_FORCE, ARM_RAMP, 0.5e-3);
    bus_fire(&bus, 1, false, FINE + 10, 201);
    bus_run(&bus, 3);
    r.law[RIG_FORCE] = (struct drive_law){0.0, 0.25, 1.0, 220e-3 / FINE, t0, t0, 0.0, 0.0};
    run_law(&r, t0, 1.0, t1, x);
    r.law[RIG_FORCE] = (struct drive_law){0.25, 0.75, ramp, 220e-3 / FINE, t1, t0, 0.0, 1.5};
    run_law(&r, t1, ramp, 4 * FINE, x);
    check_state(x, 1e-12);
}

/* A constant force that begins d earlier has given the mass
 * 2/3 A d more momentum: the fraction counts linearly. */
TEST(app_fire_impulse)
{
    double v[2], h = 0.0;
    for (int i = 0; i < 2; i++) {
        start_fine(1);
        bus_drive(&bus, RIG_FORCE, 0.64, 0.0, 0.0, 0.0);
        bus_fire(&bus, 1, false, 2 * FINE - 4, i == 0 ? 0 : 255);
        bus_run(&bus, 1);
        v[i] = bus.app.plant.x[1];
        h = bus.app.plant.h;
    }
    double expected = 2.0 / 3.0 * 0.01 * h * 255.0 / 256.0;
    check_near("velocity between fraction 0 and 255, over 2/3 A h 255/256", (v[0] - v[1]) / expected, 1.0,
               1e-4);
    check_near("velocity of fraction 0, 3.5 ticks of force, over 2/3 A h", v[0] / (2.0 / 3.0 * 0.01 * h), 3.5,
               1e-3);
}

static uint64_t hash_of_fires(double first, double second)
{
    start_fine(1);
    bus_arm(&bus, RIG_FORCE, ARM_AMPLITUDE, first);
    bus_arm(&bus, RIG_FORCE, ARM_FREQUENCY, 100.0);
    bus_fire(&bus, 1, false, FINE + 50, 9);
    if (second > 0.0) {
        bus_arm(&bus, RIG_FORCE, ARM_AMPLITUDE, second);
        bus_fire(&bus, 1, false, FINE + 50, 9);
    }
    bus_run(&bus, 2);
    check_int("answers to FIRE: ok", bus_cause(&bus, WIRE_FIRE), CAUSE_OK);
    return plant_hash(&bus.app.plant);
}

TEST(app_fire_order)
{
    uint64_t ten = hash_of_fires(10.0, 0.0), twenty = hash_of_fires(20.0, 0.0);
    check_hex("10 N then 20 N at one instant is 20 N", hash_of_fires(10.0, 20.0), twenty);
    check_int("both counted as applied", bus.app.count[DIAG_FIRE_APPLIED], 2);
    check_hex("20 N then 10 N is 10 N", hash_of_fires(20.0, 10.0), ten);
    check_is("and the two differ", ten, !=, twenty);
    /* Sent in any order, taken in the order of time: the later instant wins. */
    start_fine(1);
    bus_drive(&bus, RIG_FORCE, 20.0, 100.0, 0.0, 0.0);
    bus_fire(&bus, 1, false, FINE + 51, 0);
    bus_drive(&bus, RIG_FORCE, 10.0, 100.0, 0.0, 0.0);
    bus_fire(&bus, 1, false, FINE + 50, 255);
    bus_run(&bus, 1);
    check_near("amplitude after both, N", drive_target(&bus.app.plant.drive[0]).amplitude * 64.0, 20.0,
               1e-12);
    /* ARM is copied at the FIRE: what is armed later belongs to the next one. */
    bus_arm(&bus, RIG_FORCE, ARM_AMPLITUDE, 5.0);
    bus_fire(&bus, 1, false, 4 * FINE, 0);
    bus_arm(&bus, RIG_FORCE, ARM_AMPLITUDE, 60.0);
    bus_run(&bus, 3);
    check_near("amplitude, N", drive_target(&bus.app.plant.drive[0]).amplitude * 64.0, 5.0, 1e-12);
}

TEST(app_fire_full)
{
    start_fine(1);
    for (int i = 0; i < MAILBOX_FIRES; i++) {
        bus_arm(&bus, 0, ARM_AMPLITUDE, 1.0 + i);
        bus_fire(&bus, 1, false, 100000 + (uint64_t)i, 0);
    }
    bus_run(&bus, 1);
    check_int("as many fires as there is room for", bus.app.mailbox.n_fires, MAILBOX_FIRES);
    bus_arm(&bus, 0, ARM_AMPLITUDE, 50.0);
    bus_fire(&bus, 1, false, 50000, 0);
    bus_run(&bus, 1);
    check_int("one more", bus_cause(&bus, WIRE_FIRE), CAUSE_FULL);
    check_int("counted", bus.app.count[DIAG_FULL], 1);
    check_int("and still armed", bus.app.mailbox.armed[0].given, 1 << ARM_AMPLITUDE);
    bus_run(&bus, 60);
    check_near("the refused one did not fire: amplitude", bus.app.plant.drive[0].amplitude, 0.0, 0.0);
    bus_run(&bus, 40);
    check_int("the others did", bus.app.count[DIAG_FIRE_APPLIED], MAILBOX_FIRES);
    check_near("the last of them, N", drive_target(&bus.app.plant.drive[0]).amplitude * 64.0, 4.0, 1e-12);
}

TEST(app_fire_refused)
{
    start_fine(1);
    bus_fire(&bus, 1, false, 5000, 0);
    bus_run(&bus, 1);
    check_int("nothing armed", bus_cause(&bus, WIRE_FIRE), CAUSE_INCOMPLETE);
    bus_arm(&bus, 0, ARM_AMPLITUDE, 1.0);
    bus_fire(&bus, 3, false, 5000, 0);
    bus_run(&bus, 1);
    check_int("one of two channels armed", bus_cause(&bus, WIRE_FIRE), CAUSE_INCOMPLETE);
    check_int("it stays armed", bus.app.mailbox.armed[0].given, 1);
    bus_fire(&bus, 0, false, 5000, 0);
    bus_run(&bus, 1);
    check_int("no channel and no parameters", bus_cause(&bus, WIRE_FIRE), CAUSE_INCOMPLETE);
    bus_fire(&bus, 1, true, 5000, 0);
    bus_run(&bus, 1);
    check_int("parameters that nobody committed", bus_cause(&bus, WIRE_FIRE), CAUSE_INCOMPLETE);
    /* Ranges of ARM: the last value that is taken and the first that is not. */
    const double limit_Hz = 1e3 * FINE / 4.0;
    const struct {
        int field;
        double good, bad;
    } edge[] = {{ARM_AMPLITUDE, 6.3e10, 6.5e10},
                {ARM_AMPLITUDE, -6.3e10, -6.5e10},
                {ARM_FREQUENCY, limit_Hz, 1.001 * limit_Hz},
                {ARM_FREQUENCY, 0.0, -1e-3},
                {ARM_PHASE, 1e6, 1.001e6},
                {ARM_PHASE, -1e6, -1.001e6},
                {ARM_RAMP, 1e4, 1.001e4},
                {ARM_RAMP, 0.0, -1e-9}};
    for (int i = 0; i < 8; i++) {
        uint32_t range = bus.app.count[DIAG_RANGE];
        bus_arm(&bus, 1, (enum arm_field)edge[i].field, edge[i].good);
        bus_run(&bus, 1);
        if (bus.app.count[DIAG_RANGE] != range)
            check_near("taken", edge[i].good, (double)NAN, 0);
        bus_arm(&bus, 1, (enum arm_field)edge[i].field, edge[i].bad);
        bus_run(&bus, 1);
        check_int("refused beyond the edge", bus.app.count[DIAG_RANGE], range + 1);
        check_near("the value before stays", bus.app.mailbox.armed[1].value[edge[i].field],
                   (double)(float)edge[i].good, 0.0);
    }
    bus_arm(&bus, 1, ARM_FIELDS, 0.0);
    bus_run(&bus, 1);
    check_int("no such field", bus_cause(&bus, WIRE_ARM + 1), CAUSE_UNKNOWN);
}
