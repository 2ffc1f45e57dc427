/* new_model.c - a new model is a file pair and a row: Duffing's oscillator on a bus.
 *
 * The model is tests/new_model/duffing.h; the Makefile adds its row to the table of instances. Its motion
 * stands beside closed forms, which are independent of all code under test. Free and undamped from rest at A
 * it is x = A cn(w t | k) with w^2 = 1 + A^2 and k^2 = A^2/(2 w^2) (Kovacic & Brennan, The Duffing Equation,
 * 2011, section 4.2). Under a constant force F with damping it settles where x + x^3 = F (Cardano). Its ticks
 * are counted by tests/new_model/new_model.sh.
 *
 * usage: new_model [ticks] */
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "tests/fixture/bus.h"
#include "tests/new_model/duffing.h"
#include "tests/unit/test.h"

enum { TICKS = 1000, SECOND = 1000 }; /* frames in one */

#define TOLERANCE 1e-10 /* taylor's tolerance */

static int passed, failed;
static double scratch[METHOD_SCRATCH];

static void verdict(const char *name, int good, double got, double wanted, const char *relation)
{
    printf("%s  %s: %.17g %s %.17g\n", good ? "ok  " : "FAIL", name, got, relation, wanted);
    passed += good;
    failed += !good;
}

/* ---- what tests/fixture/bus.c needs of tests/unit/test.h ---- */

void check_true_at(struct check_place place, const char *name, int condition)
{
    (void)place;
    verdict(name, condition, condition, 1, "is");
}

void check_near_at(struct check_place place, const char *name, double got, double expected, double tolerance)
{
    (void)place;
    char text[200];
    snprintf(text, sizeof text, "%s, within %.3g", name, tolerance);
    verdict(text, fabs(got - expected) <= tolerance, got, expected, "against");
}

void check_hex_at(struct check_place place, const char *name, uint64_t got, uint64_t expected)
{
    (void)place;
    printf("%s  %s: %016" PRIx64 " is %016" PRIx64 "\n", got == expected ? "ok  " : "FAIL", name, got,
           expected);
    passed += got == expected;
    failed += got != expected;
}

void check_string_at(struct check_place place, const char *name, const char *got, const char *expected)
{
    (void)place;
    printf("%s  %s: %s, expected: %s\n", !strcmp(got, expected) ? "ok  " : "FAIL", name, got, expected);
    passed += !strcmp(got, expected);
    failed += !!strcmp(got, expected);
}

/* ---- closed forms ---- */

/* cn(u | k) and its derivative -sn dn, by the arithmetic-geometric mean (Abramowitz & Stegun 16.4). */
static void jacobi(double u, double k, double *cn, double *slope)
{
    enum { STEPS = 8 };
    double a[STEPS + 1] = {1.0}, c[STEPS + 1] = {k}, b = sqrt(1.0 - k * k);
    for (int i = 0; i < STEPS; i++) {
        a[i + 1] = 0.5 * (a[i] + b);
        c[i + 1] = 0.5 * (a[i] - b);
        b = sqrt(a[i] * b);
    }
    double phi = ldexp(a[STEPS] * u, STEPS);
    for (int i = STEPS; i > 0; i--)
        phi = 0.5 * (phi + asin(c[i] / a[i] * sin(phi)));
    *cn = cos(phi);
    *slope = -sin(phi) * sqrt(1.0 - k * k * sin(phi) * sin(phi));
}

static void free_swing(double A, double t, double *x, double *v)
{
    double w = sqrt(1.0 + A * A), cn, slope;
    jacobi(w * t, A / (sqrt(2.0) * w), &cn, &slope);
    *x = A * cn;
    *v = A * w * slope;
}

static double cardano(double F)
{
    double root = sqrt(0.25 * F * F + 1.0 / 27.0);
    return cbrt(0.5 * F + root) + cbrt(0.5 * F - root);
}

/* ---- on the bus ---- */

static struct bus bus;

/* Frames of 1 ms and 16 ticks: 0.1 of the model's time. */
static void start(const struct method *method)
{
    struct app_config c = bus_config();
    c.model = &duffing;
    c.method = method;
    c.tol = method == &rk4_float32 ? 0.0 : TOLERANCE;
    c.scratch = scratch;
    bus_start_running(&bus, &c);
    bus_run(&bus, 1);
}

/* The error that a method may have after `time`. It is mostly phase, so it grows with the time and with
 * the speed in the plane of position and velocity, here 10 at most. rk4 leaves (w h)^4/120 of the angle w
 * t, w^2 = 13 where the spring is stiffest. A series leaves its tolerance per unit of time. float32
 * increments leave 1e-5 beside what rk4 leaves. */
static double allowed(const struct method *method, double h, double time)
{
    const double speed = 10.0, w = sqrt(13.0), by_rk4 = speed * w * time * pow(w * h, 4.0) / 120.0;
    if (method == &rk4)
        return by_rk4;
    return method == &rk4_float32 ? by_rk4 + speed * 1e-5 : speed * time * TOLERANCE;
}

/* A second, 29 swings, and what MOTION says of them: to half of its last digit. */
static void swing(const struct method *method)
{
    const struct plant *pl = &bus.app.plant;
    const double A = 2.0;
    double worst = 0.0, told = 0.0, x, v;
    start(method);
    plant_set_state(&bus.app.plant, (double[]){A, 0.0});
    uint64_t begin = pl->now.tick;
    for (int i = 0; i < SECOND; i++) {
        bus_forget(&bus);
        bus_run(&bus, 1);
        free_swing(A, (double)(pl->now.tick - begin) * pl->h, &x, &v);
        worst = fmax(worst, hypot(pl->x[0] - x, pl->x[1] - v));
        told = fmax(told, fabs(bus_value(&bus, WIRE_MOTION, MOTION_DISPLACEMENT) / pl->scale.length_m - x));
    }
    double tolerance = allowed(method, pl->h, SECOND * 16 * pl->h);
    printf("      %s, free from x = 2 for 1 s:\n", method->name);
    check_near("position and velocity off cn and its slope", worst, 0.0, tolerance);
    check_near("and the displacement told in MOTION", told, 0.0,
               tolerance + 0.51 * bus.scene.lsb[0] / pl->scale.length_m);
    check_near("energy that does not balance, over that stored", plant_residual(pl) / plant_energy(pl), 0.0,
               tolerance);
    check_near("faults", bus.app.faults, 0.0, 0.0);
}

/* A constant force, ordered over the bus; the damper, too. */
static void settle(const struct method *method, double tolerance)
{
    start(method);
    double unit = bus.app.plant.scale.force_N, F = 10.0;
    bus_set_now(&bus, DUFFING_DAMPING, 50.0);
    bus_drive(&bus, DUFFING_FORCE, F * unit, 0.0, 0.0, 0.1);
    bus_fire(&bus, 1u << DUFFING_FORCE, false, bus.app.plant.now.tick + 64, 0);
    bus_run(&bus, 3000);
    printf("      %s, under 10 times the force of k at the unit length:\n", method->name);
    check_near("it settles at Cardano's root", bus.app.plant.x[0], cardano(F), tolerance);
    check_near("the work of the drive is stored or lost",
               plant_residual(&bus.app.plant) / plant_energy(&bus.app.plant), 0.0, 1e-6);
    check_near("faults", bus.app.faults, 0.0, 0.0);
}

static void on_the_bus(void)
{
    double p[MODEL_DERIVED], si[DUFFING_PARAMETERS];
    struct scale s;
    int takes = 0;
    for (int i = 0; i < DUFFING_PARAMETERS; i++)
        si[i] = duffing.parameter[i].initial;
    duffing.prepare(si, p, &s);
    for (int i = 0; i < METHODS; i++) {
        const struct method *method = method_table[i];
        const char *why = method->refuse(&duffing, p, 1e-3 / 16.0 / s.time_s, 0.0);
        if (why) {
            printf("      %s refuses: %s\n", method->name, why);
            continue;
        }
        takes++;
        swing(method);
        settle(method, method == &rk4_float32 ? 1e-5 : 1e-8);
    }
    check_near("methods that take it: rk4, taylor, auto, rk4_float32", takes, 4, 0.0);
}

/* ---- a tick by hand: rk4 and the ledger with the equation written into them ---- */

static double acceleration(double two_zeta, double u, double x, double v)
{
    return (u - two_zeta * v) - x * (1.0 + x * x);
}

static enum step_status step_by_hand(const struct model *m, const double *p, double *w,
                                     const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    double d = p[DUFFING_P_TWO_ZETA], h = e->length, half = 0.5 * h, x0 = x[0], v0 = x[1];
    double u[3] = {e->at[0][0].value, e->at[1][0].value, e->at[2][0].value};
    (void)m, (void)w, (void)regime, (void)c;
    double k1 = acceleration(d, u[0], x0, v0);
    double k2 = acceleration(d, u[1], x0 + half * v0, v0 + half * k1);
    double k3 = acceleration(d, u[1], (x0 + half * v0) + half * half * k1, v0 + half * k2);
    double k4 = acceleration(d, u[2], (x0 + h * v0) + half * h * k2, v0 + h * k3);
    double sixth = h * (1.0 / 6.0), middle = k2 + k3;
    double x1 = (x0 + h * v0) + h * sixth * (k1 + middle);
    double v1 = v0 + sixth * ((k1 + k4) + 2.0 * middle);
    if (!(fabs(x1) + fabs(v1) <= DBL_MAX))
        return STEP_NOT_FINITE;
    x[0] = x1;
    x[1] = v1;
    return STEP_END;
}

static inline void add(struct sum *s, double x)
{
    double t = s->value + x, part = t - s->value;
    s->carry += (s->value - (t - part)) + (x - part);
    s->value = t;
}

static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

static double piece_by_hand(struct ledger *l, const double *p, const struct input (*at)[MODEL_INPUTS],
                            const double *x0, const double *x1)
{
    double d = p[DUFFING_P_TWO_ZETA], h = l->rule.length, sixth = h * (1.0 / 6.0);
    double u1 = at[0][0].value, u2 = at[1][0].value, gross = l->gross;
    struct flow *b = &l->flow;
    double mean = 0.5 * (x0[1] + x1[1]), secant = h >= 1e-6 ? (x1[0] - x0[0]) * (1.0 / h) : mean;
    double spring = x1[0] * (1.0 + x1[0] * x1[0]), a = (u2 - d * x1[1]) - spring;
    double x =
        (0.5 * (x0[0] + x1[0]) + 5.0 / 32.0 * h * (x0[1] - x1[1])) + 1.0 / 64.0 * (h * h) * (b->x_dot[1] + a);
    double v = (1.875 * secant - 0.875 * mean) + 1.0 / 32.0 * h * (a - b->x_dot[1]);
    double push = u2 * x1[1], lost = d * x1[1] * x1[1], middle = x * (1.0 + x * x);
    if (l->active & 1u) {
        double power = sixth * ((b->work[0] + push) + 4.0 * (u1 * v));
        add(&l->work[0], power);
        gross += fabs(power);
    }
    double damping = sixth * ((b->damping + lost) + 4.0 * (d * v * v));
    add(&l->damping, damping);
    l->gross = gross + damping;
    double force = larger(b->force, larger(middle, spring));
    b->x_dot[0] = x1[1];
    b->x_dot[1] = a;
    b->work[0] = push;
    b->damping = lost;
    b->force = spring;
    return force;
}

/* ---- ticks ---- */

static struct plant by_row, by_hand, by_pointers;

static void begin(struct plant *pl, const struct model *m)
{
    static const double si[DUFFING_PARAMETERS] = {1.0, 1e4, 1e10, 5.0};
    struct plant_config c = {.model = m, .si = si, .method = &rk4, .tick_s = 1e-3 / 16.0, .dilation = 1.0};
    const char *why = plant_init(pl, &c);
    check_string("plant_init", why ? why : "taken", "taken");
    plant_drive_start(pl, DUFFING_FORCE, 5.0, 20.0, 0.0);
}

/* Counted by callgrind under these names. */
__attribute__((noinline)) static bool once_row(void)
{
    return plant_run(&by_row, 1);
}

__attribute__((noinline)) static bool once_hand(void)
{
    return plant_run(&by_hand, 1);
}

__attribute__((noinline)) static bool once_pointers(void)
{
    return plant_run(&by_pointers, 1);
}

static void ticks(void)
{
    struct model copy = duffing; /* at another address, which no row names */
    bool good = true;
    begin(&by_row, &duffing);
    begin(&by_hand, &duffing);
    begin(&by_pointers, &copy);
    by_hand.step = step_by_hand;
    by_hand.bind_run = NULL;
    by_hand.ledger.piece = piece_by_hand;
    check_true("the row is taken: another step and piece than through pointers",
               by_row.step != by_pointers.step && by_row.ledger.piece != by_pointers.ledger.piece);
    for (int i = 0; i < TICKS; i++)
        good = once_row() && once_hand() && once_pointers() && good;
    check_true("finite", good);
    check_hex("state and ledger by the row and by hand", plant_hash(&by_row), plant_hash(&by_hand));
    check_hex("state and ledger by the row and through pointers", plant_hash(&by_row),
              plant_hash(&by_pointers));
    check_near("work by the row and by hand", sum_of(&by_row.ledger.work[0]), sum_of(&by_hand.ledger.work[0]),
               0.0);
}

int main(int argc, char **argv)
{
    (void)argv;
    if (argc == 1)
        on_the_bus();
    ticks();
    printf("%d passed, %d failed\n", passed, failed);
    return failed != 0;
}
