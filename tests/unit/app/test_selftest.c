/* test_selftest.c - the self-test passes, fails at exactly the check whose constant, model or method is
 * broken, runs with what a small image has, and is told on the bus. */
#include <math.h>
#include <string.h>
#include "firmware/app/selftest.h"
#include "models/models.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum {
    PHASE = 1 << 0,
    RK4_RIG = 1 << 1 | 1 << 2,
    RK4_LINEAR = 1 << 3,
    RK4_HASH = 1 << 4,
    TAYLOR_RIG = 1 << 5 | 1 << 6,
    TAYLOR_LINEAR = 1 << 7,
    TAYLOR_HASH = 1 << 8,
    EXACT_LINEAR = 1 << 9,
    EXACT_HASH = 1 << 10,
    FLOAT32_RIG = 1 << 11 | 1 << 12,
    FLOAT32_LINEAR = 1 << 13,
    FLOAT32_HASH = 1 << 14,
    ALL = (1 << SELFTEST_CHECKS) - 1
};

static struct plant pl;
static double selftest_scratch[METHOD_SCRATCH];
static struct bus bus;

/* Everything, with one model or method in place of that of its name. */
static struct selftest_result run_with(const struct model *model, const struct method *method)
{
    const struct model *models[MODELS];
    const struct method *methods[METHODS];
    struct selftest_result r;
    for (int i = 0; i < MODELS; i++)
        models[i] = model && !strcmp(model->name, model_table[i]->name) ? model : model_table[i];
    for (int i = 0; i < METHODS; i++)
        methods[i] = method && !strcmp(method->name, method_table[i]->name) ? method : method_table[i];
    selftest_run(
        &(struct selftest_parts){models, MODELS, methods, METHODS, &pl, selftest_scratch, METHOD_SCRATCH},
        &r);
    return r;
}

TEST(selftest_passes)
{
    struct selftest_result r = run_with(NULL, NULL);
    check_int("checks present", r.present, ALL);
    check_int("checks failed", r.failed, 0);
    for (int i = 0; i < SELFTEST_CHECKS; i++)
        check_below(selftest_table[i].name, (double)r.error[i], selftest_table[i].tolerance);
}

/* A wrong constant in the table is seen: by three tolerances, a hash by one bit. */
TEST(selftest_expected)
{
    const struct selftest_parts parts = {model_table, MODELS,           method_table,  METHODS,
                                         &pl,         selftest_scratch, METHOD_SCRATCH};
    for (int i = 0; i < SELFTEST_CHECKS; i++) {
        struct selftest_check c = selftest_table[i];
        double value;
        c.expected += c.tolerance > 0.0 ? 3.0 * c.tolerance * fabs(c.expected) : 1.0;
        check_true("there is something to measure", selftest_measure(&c, &parts, &value));
        check_above(c.name, selftest_error(&c, value), c.tolerance * 1.5 + 1e-16);
    }
}

/* ---- broken models and methods: a constant that is off by a millionth ---- */

#define OFF (1.0 + 1e-6)

static void rig_rhs(const double *p, const struct input *u, const double *x, double *x_dot)
{
    hertz_rig.rhs(p, u, x, x_dot);
    x_dot[1] += (OFF - 1.0) * (2.0 / 3.0) * hertz_contact_force(x[0]);
}

/* A float32 period is out of tolerance only for three millionths; its hash sees this one too. */
static void rig_form(const double *p, struct hertz_form *f)
{
    hertz_rig.hertz_form(p, f);
    f->hertz *= OFF;
}

static void rig_prepare(const double *si, double *p, struct scale *s)
{
    hertz_rig.prepare(si, p, s);
    s->force_N *= OFF;
}

static const struct model *linear_rung(void)
{
    for (int i = 0; i < MODELS; i++)
        if (!strcmp(model_table[i]->name, "hertz_rig_linear"))
            return model_table[i];
    return &hertz_rig;
}

static bool linear_view(const double *p, unsigned regime, struct linear *l)
{
    bool exists = linear_rung()->linear(p, regime, l);
    l->a[1][0] *= OFF;
    return exists;
}

static void linear_prepare(const double *si, double *p, struct scale *s)
{
    double heavier[MODEL_PARAMETERS];
    memcpy(heavier, si, RIG_PARAMETERS * sizeof *si);
    heavier[RIG_MASS] *= OFF;
    linear_rung()->prepare(heavier, p, s);
}

static bool shaft_view(const double *p, unsigned regime, struct linear *l)
{
    const struct model *shaft = &shaft_bearing;
    bool exists = shaft->linear(p, regime, l);
    for (int i = 0; i < shaft->n_states; i++)
        l->a[shaft->n_states - 1][i] *= OFF;
    return exists;
}

TEST(selftest_models)
{
    struct model m = hertz_rig;
    check_int("a copy of the rig: failed", run_with(&m, NULL).failed, 0);
    m.rhs = rig_rhs;
    check_int("rig, contact force: failed", run_with(&m, NULL).failed, RK4_RIG | RK4_HASH);
    m = hertz_rig;
    m.hertz_form = rig_form;
    check_int("rig, series view: failed", run_with(&m, NULL).failed, TAYLOR_RIG | TAYLOR_HASH | FLOAT32_HASH);
    m = hertz_rig;
    m.prepare = rig_prepare;
    check_int("rig, unit of force: failed", run_with(&m, NULL).failed, RK4_HASH | TAYLOR_HASH | FLOAT32_HASH);
    m = *linear_rung();
    check_int("a copy of the linear model: failed", run_with(&m, NULL).failed, 0);
    m.linear = linear_view;
    check_int("linear model, exact view: failed", run_with(&m, NULL).failed, EXACT_LINEAR);
    m = *linear_rung();
    m.prepare = linear_prepare;
    check_int("linear model, mass: failed", run_with(&m, NULL).failed,
              RK4_LINEAR | TAYLOR_LINEAR | EXACT_LINEAR | FLOAT32_LINEAR);
    m = shaft_bearing;
    m.linear = shaft_view;
    check_int("shaft, stiffness: failed", run_with(&m, NULL).failed, EXACT_HASH);
}

static enum step_status drifting_step(const struct model *m, const double *p, double *w,
                                      const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    enum step_status status = rk4.bind(m)(m, p, w, e, regime, x, c);
    x[0] += 1e-6;
    x[1] += 1e-6;
    return status;
}

static step_function *drifting(const struct model *m)
{
    (void)m;
    return drifting_step;
}

static const char *refusing(const struct model *m, const double *p, double h, double tol)
{
    (void)m, (void)p, (void)h, (void)tol;
    return "no";
}

static enum step_status silent_step(const struct model *m, const double *p, double *w,
                                    const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    return e->active ? STEP_NOT_FINITE : rk4.bind(m)(m, p, w, e, regime, x, c);
}

static step_function *silent_bind(const struct model *m)
{
    (void)m;
    return silent_step;
}

static enum step_status dead_step(const struct model *m, const double *p, double *w, const struct segment *e,
                                  unsigned regime, double *x, struct crossing *c)
{
    (void)m, (void)p, (void)w, (void)e, (void)regime, (void)x, (void)c;
    return STEP_NOT_FINITE;
}

static step_function *dead(const struct model *m)
{
    (void)m;
    return dead_step;
}

/* A plant that stops is a check that failed, with no error to tell. */
TEST(selftest_stops)
{
    struct method broken = rk4;
    broken.bind = dead;
    broken.bind_run = NULL;
    struct selftest_result r = run_with(NULL, &broken);
    check_int("rk4 that stops at once: failed", r.failed, RK4_RIG | RK4_LINEAR | RK4_HASH);
    check_nan("  no error was measured", (double)r.error[1]);
    check_nan("  no error was measured", (double)r.error[4]);
    broken.bind = silent_bind;
    broken.bind_run = NULL;
    check_int("that stops when a drive sounds: failed", run_with(NULL, &broken).failed,
              RK4_LINEAR | RK4_HASH);
}

TEST(selftest_method)
{
    struct method broken = rk4;
    broken.bind = drifting;
    broken.bind_run = NULL;
    check_int("rk4 that drifts by 1e-6 a step: failed", run_with(NULL, &broken).failed,
              RK4_RIG | RK4_LINEAR | RK4_HASH);
    broken = exact;
    broken.refuse = refusing;
    struct selftest_result r = run_with(NULL, &broken);
    check_int("exact that refuses: present", r.present, ALL);
    check_int("failed", r.failed, EXACT_LINEAR | EXACT_HASH);
    check_nan("no error was measured", (double)r.error[9]);
}

/* One model, one method without work: what can be tested there is. */
TEST(selftest_small_image)
{
    static const struct model *const model[] = {&hertz_rig};
    static const struct method *const method[] = {&rk4, &taylor};
    struct selftest_parts parts = {model, 1, method, 1, &pl, NULL, 0};
    struct selftest_result r;
    selftest_run(&parts, &r);
    check_int("rig and rk4: present", r.present, PHASE | RK4_RIG | RK4_HASH);
    check_int("failed", r.failed, 0);
    parts.n_methods = 2;
    parts.scratch = selftest_scratch;
    parts.n_scratch = taylor.n_scratch(&hertz_rig) - 1;
    selftest_run(&parts, &r);
    check_int("taylor without enough memory: present", r.present, PHASE | RK4_RIG | RK4_HASH);
    parts.n_scratch++;
    selftest_run(&parts, &r);
    check_int("taylor with just enough: present", r.present,
              PHASE | RK4_RIG | RK4_HASH | TAYLOR_RIG | TAYLOR_HASH);
    check_int("failed", r.failed, 0);
    parts.n_models = parts.n_methods = 0;
    selftest_run(&parts, &r);
    check_int("nothing but drives: present", r.present, PHASE);
}

/* The runs that are hashed pass through contact loss. */
TEST(selftest_hash_switches)
{
    const struct selftest_parts parts = {model_table, MODELS,           method_table,  METHODS,
                                         &pl,         selftest_scratch, METHOD_SCRATCH};
    for (int i = 0; i < SELFTEST_CHECKS; i++) {
        double value;
        if (strncmp(selftest_table[i].name, "hash_", 5) != 0 ||
            !selftest_measure(&selftest_table[i], &parts, &value))
            continue;
        check_above(selftest_table[i].name, pl.counts.switches, 2);
    }
}

/* ---- on the bus ---- */

/* Compares the SELF_TEST messages since bus_forget with the result: every check once, in order. */
static void check_told(const struct selftest_result *r)
{
    int n = 0, wrong = 0;
    for (int i = 0; i < bus.n_seen; i++) {
        const struct message *m = &bus.seen[i];
        if (m->kind != WIRE_SELF_TEST)
            continue;
        unsigned ran = (r->present >> n) & 1u, failed = (r->failed >> n) & 1u;
        unsigned verdict = !ran ? SELF_TEST_ABSENT : failed ? SELF_TEST_FAILED : SELF_TEST_PASSED;
        wrong += m->value[SELF_TEST_ITEM] != n || m->value[SELF_TEST_VERDICT] != verdict;
        wrong += m->value[SELF_TEST_VALUE] != (double)r->error[n];
        n++;
    }
    check_int("checks told", n, SELFTEST_CHECKS);
    check_int("told otherwise than measured", wrong, 0);
}

TEST(selftest_report)
{
    const struct app_config c = bus_config();
    struct selftest_result r = run_with(NULL, NULL);
    r.present &= (uint16_t)~EXACT_HASH; /* an image without the shaft */
    bus_start(&bus, &c);
    app_take_selftest(&bus.app, &r);
    bus_silent(&bus, 30);
    check_told(&r);
    check_int("state", bus.app.state, STATE_OFF);
    bus_forget(&bus);
    bus_run(&bus, 30);
    check_int("ENABLE", bus_cause(&bus, WIRE_ENABLE), CAUSE_OK);
    check_int("heartbeats are no request", bus_count(&bus, WIRE_SELF_TEST), SELFTEST_CHECKS);
    check_told(&r);
    bus_start(&bus, &c);
    bus_run(&bus, 30);
    check_int("no self-test taken, none told", bus_count(&bus, WIRE_SELF_TEST), 0);
    bus_start(&bus, &c);
    app_take_selftest(&bus.app, &r);
    bus.wires.port[0].tx_limit = 2;
    bus_silent(&bus, 300);
    bus_collect(&bus);
    check_told(&r);                    /* a bus that takes too little delays them, none pushes another out */
    for (unsigned i = 0; i < 4; i++) { /* none is told as its neighbour */
        r.present = (uint16_t)(i < 2 ? 0x5555u << i : 0xFFFFu);
        r.failed = (uint16_t)(0x1111u << i);
        bus_start(&bus, &c);
        app_take_selftest(&bus.app, &r);
        bus_silent(&bus, 30);
        check_told(&r);
    }
}

TEST(selftest_refuses)
{
    const struct app_config c = bus_config();
    struct model m = hertz_rig;
    m.rhs = rig_rhs;
    struct selftest_result r = run_with(&m, NULL);
    bus_start(&bus, &c);
    app_take_selftest(&bus.app, &r);
    bus_silent(&bus, 30);
    check_near("STATUS: state", bus_value(&bus, WIRE_STATUS, STATUS_STATE), STATE_FAULT, 0);
    check_near("STATUS: faults", bus_value(&bus, WIRE_STATUS, STATUS_FAULTS), FAULT_SELF_TEST, 0);
    check_told(&r);
    bus_forget(&bus);
    bus_enable(&bus, true);
    bus_silent(&bus, 30);
    check_int("ENABLE on", bus_cause(&bus, WIRE_ENABLE), CAUSE_SELF_TEST);
    check_told(&r);
    check_true("no session", !bus.app.enabled);
    check_int("no session", bus.app.session, 0);
    bus_order(&bus, CONTROL_RESET);
    bus_silent(&bus, 1);
    check_int("CONTROL reset", bus_cause(&bus, WIRE_CONTROL), CAUSE_SESSION);
    bus_order(&bus, CONTROL_STOP);
    bus_silent(&bus, 1);
    check_int("CONTROL stop is taken", bus_cause(&bus, WIRE_CONTROL), CAUSE_OK);
    bus_enable(&bus, false);
    bus_silent(&bus, 1);
    check_int("ENABLE off", bus_cause(&bus, WIRE_ENABLE), CAUSE_SESSION);
    bus_enable(&bus, true);
    bus_silent(&bus, 300);
    check_int("ENABLE on, again", bus_cause(&bus, WIRE_ENABLE), CAUSE_SELF_TEST);
    check_near("counted", bus_item(&bus, WIRE_HEALTH, DIAG_SELF_TEST), 2, 0);
    check_int("state", bus.app.state, STATE_FAULT);
    check_int("fault", bus.app.faults, FAULT_SELF_TEST);
    check_int("plant time", (int64_t)bus.app.plant.now.tick, 0);
}
