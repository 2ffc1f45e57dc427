/* test_exact_edges.c - method exact with two degrees of freedom,
 * roots of any polynomial, and what it refuses or gives up. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/method/exact/exact_root.h"
#include "firmware/method/exact/exact_series.h"
#include "firmware/method/exact/exact_tables.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/gap_oscillator.h"

/* ---- two unit masses between three unit springs ---- */

static const char *check(const double *si)
{
    (void)si;
    return NULL;
}

static void prepare(const double *si, double *p, struct scale *scale)
{
    (void)si, (void)p;
    *scale = (struct scale){1.0, 1.0, 1.0, 1.0};
}

static void rest(const double *p, double *x)
{
    (void)p;
    memset(x, 0, 4 * sizeof *x);
}

static double eigenfrequency(const double *p)
{
    (void)p;
    return sqrt(3.0);
}

static void rhs(const double *p, const struct input *u, const double *x, double *d)
{
    (void)p;
    d[0] = x[2];
    d[1] = x[3];
    d[2] = -2.0 * x[0] + x[1] + u[0].value;
    d[3] = x[0] - 2.0 * x[1];
}

static double energy(const double *p, const struct input *u, const double *x)
{
    (void)p, (void)u;
    return 0.5 * (x[2] * x[2] + x[3] * x[3]) + x[0] * x[0] + x[1] * x[1] - x[0] * x[1];
}

static void flow(const double *p, const struct input *u, const double *x, struct flow *f)
{
    rhs(p, u, x, f->x_dot);
    f->work[0] = u[0].value * x[2];
    f->damping = 0.0;
    f->force = 0.0;
}

static void output(const double *p, const struct input *u, const double *x, double *y)
{
    (void)p, (void)u;
    y[0] = x[0];
}

static bool linear(const double *p, unsigned regime, struct linear *l)
{
    (void)p, (void)regime;
    memset(l, 0, sizeof *l);
    l->a[0][2] = l->a[1][3] = l->a[2][1] = l->a[3][0] = l->b[2][0] = 1.0;
    l->a[2][0] = l->a[3][1] = -2.0;
    return true;
}

static const struct signal states[4] = {{"x1", "m", "position", QUANTITY_LENGTH, "x1"},
                                        {"x2", "m", "position", QUANTITY_LENGTH, "x2"},
                                        {"v1", "m/s", "velocity", QUANTITY_VELOCITY, "v1"},
                                        {"v2", "m/s", "velocity", QUANTITY_VELOCITY, "v2"}};
static const struct signal inputs[1] = {{"force", "N", "force on mass 1", QUANTITY_FORCE, NULL}};
static const struct signal outputs[1] = {{"x1", "m", "position", QUANTITY_LENGTH, NULL}};
static const struct model two_masses = {
    .name = "two_masses",
    .title = "two masses between three springs",
    .n_states = 4,
    .n_inputs = 1,
    .n_outputs = 1,
    .state_signal = states,
    .input_signal = inputs,
    .output_signal = outputs,
    .check = check,
    .prepare = prepare,
    .rest = rest,
    .eigenfrequency = eigenfrequency,
    .rhs = rhs,
    .gap = model_no_gap,
    .flow = flow,
    .energy = energy,
    .output = output,
    .linear = linear,
};

/* Let go from (1, 0): x1 = (cos t + cos sqrt(3) t)/2, x2 = (cos
 * t - cos sqrt(3) t)/2. Parts of a tick have their own series. */
TEST(exact_edges_two_masses)
{
    static struct gap_run run;
    const double start[4] = {1.0, 0.0, 0.0, 0.0};
    double error = 0.0;
    gap_start(&run, &two_masses, &exact, NULL, NULL, 0.3, start);
    for (uint64_t tick = 1; tick <= 200; tick++) {
        const struct instant part = {tick - 1, 20000}, end = {tick, 0};
        check_true("part of a tick", plant_advance(&run.plant, part));
        check_true("the rest", plant_advance(&run.plant, end));
        double t = 0.3 * (double)tick, root = sqrt(3.0);
        error = fmax(error, fabs(run.plant.x[0] - 0.5 * (cos(t) + cos(root * t))));
        error = fmax(error, fabs(run.plant.x[1] - 0.5 * (cos(t) - cos(root * t))));
    }
    check_below("200 ticks in two parts each: error", error, 1e-13);
    gap_start(&run, &two_masses, &exact, NULL, NULL, 0.3, start);
    gap_advance(&run, 200, NULL, NULL);
    check_near("200 whole ticks", run.plant.x[0], 0.5 * (cos(60.0) + cos(sqrt(3.0) * 60.0)), 1e-13);
}

/* Ticks of 5 to 50 rad of the faster mode, under a force cos w t on mass 1 from rest: of each mode q'' + k^2
 * q = cos(w t)/2, q = (cos w t - cos k t)/(2 (k^2 - w^2)). Whole ticks by tables that have found the
 * frequency, and parts of ticks. */
static void check_far(double h, double w, bool parts)
{
    static struct gap_run run;
    const double rest_at[4] = {0.0}, root = sqrt(3.0);
    double error = 0.0, largest = 0.0;
    bool good = true;
    gap_start(&run, &two_masses, &exact, NULL, NULL, h, rest_at);
    plant_drive_start(&run.plant, 0, 1.0, w / (2.0 * 3.141592653589793), 0.0);
    for (uint64_t tick = 1; tick <= 200; tick++) {
        const struct instant part = {tick - 1, 20000}, end = {tick, 0};
        good = good && (!parts || plant_advance(&run.plant, part)) && plant_advance(&run.plant, end);
        double t = h * (double)tick, q1 = 0.5 * (cos(w * t) - cos(t)) / (1.0 - w * w);
        double q2 = 0.5 * (cos(w * t) - cos(root * t)) / (3.0 - w * w);
        error = fmax(error, fabs(run.plant.x[0] - (q1 + q2)));
        error = fmax(error, fabs(run.plant.x[1] - (q1 - q2)));
        largest = fmax(largest, fabs(q1) + fabs(q2));
    }
    check_below(parts ? "ticks beyond a series, in two parts" : "ticks beyond a series", error / largest,
                1e-11);
    check_true("every step was valid", good && run.plant.counts.budget == 0);
}

TEST(exact_edges_far)
{
    static const double h[4] = {1.25, 3.0, 11.0, 28.0};
    for (int i = 0; i < 4; i++) {
        check_far(h[i], 0.7 / h[i], false);
        check_far(h[i], 0.7 / h[i], true);
    }
}

/* ---- what the method cannot take ---- */

static bool first_order(const double *p, unsigned regime, struct linear *l)
{
    (void)linear(p, regime, l);
    l->a[0][2] = 2.0;
    return true;
}

/* A gap that follows both positions. */
static void skew_gap(const double *p, const struct input *u, const double *x, struct input *gap)
{
    (void)p, (void)u;
    gap[0] = (struct input){1.0 - x[0] - x[1], -x[2] - x[3]};
}

TEST(exact_edges_refusal)
{
    struct model m = two_masses;
    check_no_error("as it is", exact_refuse(&m, NULL, 0.3, 0.0));
    check_no_error("without contacts, 67 rad", exact_refuse(&m, NULL, 67.0 / sqrt(3.0), 0.0));
    check_error("beyond", exact_refuse(&m, NULL, 67.3 / sqrt(3.0), 0.0));
    m.n_states = 3;
    check_string("three states", exact_refuse(&m, NULL, 0.3, 0.0),
                 "exact needs a model in second-order form");
    m = two_masses;
    m.linear = first_order;
    check_string("positions that are no integrals", exact_refuse(&m, NULL, 0.3, 0.0),
                 "exact needs a model in second-order form");
    m = two_masses;
    m.n_contacts = 1;
    m.gap = skew_gap;
    check_string("a gap between two positions", exact_refuse(&m, NULL, 0.3, 0.0),
                 "exact needs gaps that follow one position each");
}

static enum step_status step_through(const struct model *m, const double *p, double *scratch, double length,
                                     unsigned regime, double *x)
{
    struct segment e;
    struct crossing c = {0.0, 0, 0, 0.0};
    memset(&e, 0, sizeof e);
    e.length = length;
    return exact.bind(m)(m, p, scratch, &e, regime, x, &c);
}

/* The shaft with a system of its own in each regime. */
static bool own_system(const double *p, unsigned regime, struct linear *l)
{
    bool exists = shaft_bearing.linear(p, regime, l);
    l->a[3][0] -= 1e-3 * (double)regime;
    return exists;
}

/* Regimes 0, 1, 2 and 4 take the four tables; the next one, 5, stops the plant. */
TEST(exact_edges_forced)
{
    static double scratch[METHOD_SCRATCH];
    struct model m = shaft_bearing;
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], x[MODEL_STATES] = {0.0};
    struct scale scale;
    for (int i = 0; i < m.n_parameters; i++)
        si[i] = m.parameter[i].initial;
    m.linear = own_system;
    m.prepare(si, p, &scale);
    exact.prepare(&m, p, 0.01, 0.0, scratch);
    check_int("the fourth system", step_through(&m, p, scratch, 0.01, 0, x), STEP_END);
    check_int("the fifth", step_through(&m, p, scratch, 0.01, 5, x), STEP_NOT_FINITE);
}

/* Run through without stops, 256 pieces are the bound: 1000 time units of at most 2.1 are more. */
TEST(exact_edges_any_bound)
{
    static double scratch[METHOD_SCRATCH];
    const double p[MODEL_DERIVED] = {0.0, 1.0, 99.0, 1.0};
    double x[2] = {0.5, 0.0};
    exact.prepare(&gap_oscillator, p, 0.2, 0.0, scratch);
    check_int("500 time units", step_through(&gap_oscillator, p, scratch, 500.0, REGIME_ANY, x), STEP_END);
    check_int("1000", step_through(&gap_oscillator, p, scratch, 1000.0, REGIME_ANY, x), STEP_NOT_FINITE);
}

/* ---- turns inside a tick ---- */

/* x = cos t, let go at t = -before for a tick of h. It turns at t = 0 beyond a wall at 0.9999 (side 1) or
 * -0.9999, and is clear of it at both ends: the switch is at t = -acos 0.9999. Whole ticks by their tables,
 * and parts of a longer one by their series. */
static void check_turn(double h, double before, int side, double tick)
{
    static double scratch[METHOD_SCRATCH];
    const double gap = 0.9999, p[MODEL_DERIVED] = {0.0, 1.0, 99.0, gap};
    double x[2] = {side * cos(before), side * sin(before)};
    struct segment e = {.length = h};
    struct crossing c = {0.0, -1, 0, 0.0};
    exact.prepare(&gap_oscillator, p, tick, 0.0, scratch);
    check_below("both ends are clear of the wall", fmax(cos(before), cos(h - before)), 0.95);
    check_int("a switch", exact.bind(&gap_oscillator)(&gap_oscillator, p, scratch, &e, 0, x, &c),
              STEP_SWITCH);
    check_int("of the wall on that side", c.contact, side > 0 ? 0 : 1);
    check_near("where cos t is 0.9999", c.done, before - acos(gap), 1e-11);
    check_near("and there is the state", x[0], side * gap, 1e-13);
}

TEST(exact_edges_turn)
{
    static const double length[] = {0.8, 1.2, 1.6, 2.0, 2.09};
    for (size_t i = 0; i < sizeof length / sizeof length[0]; i++)
        for (int side = -1; side <= 1; side += 2) {
            check_turn(length[i], 0.5 * length[i], side, length[i]);
            check_turn(length[i], 0.44 * length[i], side, length[i]);
            check_turn(length[i], 0.5 * length[i], side, 2.095);
        }
}

/* ---- roots ---- */

enum { POLYNOMIALS = 20000, DEGREE = 9, TERMS = 10 };

static double uniform(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-52 - 1.0;
}

static double value(const double *c, double t)
{
    double y = 0.0;
    for (int n = DEGREE; n >= 0; n--)
        y = y * t + c[n];
    return y;
}

static bool first_root(const double *c, double end, struct exact_root *root)
{
    static const struct exact_gap gap = {0.0, 1.0, 0};
    struct exact_path path = {.unit = 1.0, .end = end, .n_terms = TERMS};
    struct input last = {value(c, end), 0.0};
    memcpy(path.c[0], c, TERMS * sizeof *c);
    for (int n = DEGREE; n > 0; n--)
        last.rate = last.rate * end + n * c[n];
    return exact_first_root(&path, &gap, true, &last, root);
}

/* Random gaps that begin on their side, large terms of high order among them. A change of side at the end
 * must be found. An instant that is found must be a zero, and on a grid no zero may come before it. An
 * exception are two zeros in one quarter of the span, because the end of the quarter shows nothing of
 * them. */
TEST(exact_edges_roots)
{
    uint64_t seed = 1;
    int missed = 0, early = 0, not_converged = 0;
    double residual = 0.0;
    for (int k = 0; k < POLYNOMIALS; k++) {
        double c[TERMS], size = 0.0;
        struct exact_root root;
        for (int n = 0; n < TERMS; n++)
            c[n] = uniform(&seed) * (k % 3 == 0 && n < DEGREE - 2 ? 1e-4 : 1.0);
        c[0] = -fabs(c[0]) - 1e-6;
        for (int n = 0; n < TERMS; n++)
            size += fabs(c[n]);
        bool found = first_root(c, 1.0, &root);
        missed += !found && value(c, 1.0) > 0.0;
        if (!found)
            continue;
        not_converged += !root.converged;
        residual = fmax(residual, fabs(value(c, root.theta)) / size);
        for (int i = 1; i <= 4; i++)
            early += 0.25 * i < root.theta - 1e-9 && value(c, 0.25 * i) > 1e-12;
    }
    check_int("changes of side missed", missed, 0);
    check_int("quarters that end across before the root told", early, 0);
    check_int("roots that did not converge", not_converged, 0);
    check_below("gap at the roots over its size", residual, 1e-12);
}

/* Numbers that are none end the search within its bound. */
TEST(exact_edges_no_root)
{
    struct exact_root root;
    double c[TERMS] = {-1.0, 0.5};
    check_true("no span", !first_root(c, 0.0, &root));
    c[2] = (double)NAN;
    check_true("a gap that is no number, at an end that is none", !first_root(c, 1e6, &root));
    static const struct exact_gap gap = {0.0, 1.0, 0};
    struct exact_path path = {.unit = 1.0, .end = 1e6, .n_terms = TERMS};
    memcpy(path.c[0], c, sizeof c);
    check_true("on its side at the end",
               !exact_first_root(&path, &gap, true, &(struct input){-1.0, -1.0}, &root));
    check_true("across at the end", exact_first_root(&path, &gap, true, &(struct input){1.0, 1.0}, &root));
    check_true("  and said not to have converged", !root.converged);
}
