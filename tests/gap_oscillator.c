/* gap_oscillator.c - see gap_oscillator.h. */
#include "tests/gap_oscillator.h"

#include <stddef.h>
#include <string.h>
#include "tests/test.h"

static double plus(double x)
{
    return x > 0.0 ? x : 0.0;
}

static const char *check(const double *si)
{
    (void)si;
    return NULL;
}

static void take(const double *si, double *p, int n, struct scale *scale)
{
    memcpy(p, si, (size_t)n * sizeof *p);
    *scale = (struct scale){1.0, 1.0, 1.0, 1.0};
}

static void rest(const double *p, double *x)
{
    (void)p;
    memset(x, 0, MODEL_STATES * sizeof *x);
}

static double eigenfrequency(const double *p)
{
    (void)p;
    return 1.0;
}

static void output(const double *p, const struct input *u, const double *x, double *y)
{
    (void)p, (void)u;
    y[0] = x[0];
}

static const struct signal outputs[1] = {{"x", "m", "position", QUANTITY_LENGTH, NULL}};
static const struct signal inputs[3] = {{"u1", "N", "force", QUANTITY_FORCE, NULL},
                                        {"u2", "N", "force", QUANTITY_FORCE, NULL},
                                        {"u3", "N", "force", QUANTITY_FORCE, NULL}};

static void gap_prepare(const double *si, double *p, struct scale *scale)
{
    take(si, p, GAP_PARAMETERS, scale);
}

static double wall(const double *p, double x)
{
    return p[GAP_KAPPA] * (plus(x - p[GAP_G]) - plus(-x - p[GAP_G]));
}

static void gap_rhs(const double *p, const struct input *u, const double *x, double *d)
{
    d[0] = x[1];
    d[1] = u[0].value + u[1].value - 2.0 * p[GAP_ZETA] * (x[1] - u[2].rate) - p[GAP_K] * (x[0] - u[2].value) -
           wall(p, x[0]);
}

static void gap_gap(const double *p, const struct input *u, const double *x, struct input *gap)
{
    (void)u;
    gap[0] = (struct input){p[GAP_G] - x[0], -x[1]};
    gap[1] = (struct input){p[GAP_G] + x[0], x[1]};
}

static double gap_energy(const double *p, const struct input *u, const double *x)
{
    double over = plus(x[0] - p[GAP_G]) + plus(-x[0] - p[GAP_G]);
    (void)u;
    return 0.5 * (x[1] * x[1] + p[GAP_K] * x[0] * x[0] + p[GAP_KAPPA] * over * over);
}

static void gap_flow(const double *p, const struct input *u, const double *x, struct flow *f)
{
    gap_rhs(p, u, x, f->x_dot);
    for (int i = 0; i < 2; i++)
        f->work[i] = u[i].value * x[1];
    f->work[2] = (2.0 * p[GAP_ZETA] * u[2].rate + p[GAP_K] * u[2].value) * x[1];
    f->damping = 2.0 * p[GAP_ZETA] * x[1] * x[1];
    f->force = wall(p, x[0]);
}

static bool gap_linear(const double *p, unsigned regime, struct linear *l)
{
    double side = (regime & 1u ? 1.0 : 0.0) - (regime & 2u ? 1.0 : 0.0);
    if (regime == 3)
        return false;
    memset(l, 0, sizeof *l);
    l->a[0][1] = 1.0;
    l->a[1][0] = -p[GAP_K] - (regime ? p[GAP_KAPPA] : 0.0);
    l->a[1][1] = -2.0 * p[GAP_ZETA];
    l->b[1][0] = l->b[1][1] = 1.0;
    l->b[1][2] = p[GAP_K];
    l->b_rate[1][2] = 2.0 * p[GAP_ZETA];
    l->c[1] = side * p[GAP_KAPPA] * p[GAP_G];
    return true;
}

static const struct signal gap_states[2] = {{"x", "m", "position", QUANTITY_LENGTH, "x"},
                                            {"v", "m/s", "velocity", QUANTITY_VELOCITY, "v"}};
static const struct parameter gap_parameters[GAP_PARAMETERS] = {
    {"zeta", "1", -1.0, 1e6, 0.02, "damping"},
    {"k", "1", -1e6, 1e9, 1.0, "spring"},
    {"kappa", "1", 0.0, 1e9, 50.0, "gap spring"},
    {"g", "m", 1e-9, 1e9, 1.0, "gap"},
};

const struct model gap_oscillator = {
    .name = "gap_oscillator",
    .n_states = 2,
    .n_inputs = 3,
    .n_outputs = 1,
    .n_contacts = 2,
    .n_parameters = GAP_PARAMETERS,
    .state_signal = gap_states,
    .input_signal = inputs,
    .output_signal = outputs,
    .parameter = gap_parameters,
    .check = check,
    .prepare = gap_prepare,
    .rest = rest,
    .eigenfrequency = eigenfrequency,
    .rhs = gap_rhs,
    .gap = gap_gap,
    .flow = gap_flow,
    .energy = gap_energy,
    .output = output,
    .linear = gap_linear,
};

/* ---- a plant with its work memory ---- */

void gap_start(struct gap_run *r, const struct model *m, const struct method *method, const double *si,
               const struct harmonic *drive, double tick_s, const double *x)
{
    struct plant_config c = {.model = m,
                             .si = si,
                             .method = method,
                             .tick_s = tick_s,
                             .dilation = 1.0,
                             .tol = 1e-12,
                             .work = r->work};
    const char *why = plant_init(&r->plant, &c);
    if (why)
        check_string("plant_init", why, "no refusal");
    for (int i = 0; drive && i < m->n_inputs; i++) {
        if (drive[i].amplitude != 0.0)
            plant_drive_start(&r->plant, i, drive[i].amplitude, drive[i].omega / 6.283185307179586477,
                              drive[i].phase);
    }
    plant_set_state(&r->plant, x);
    r->n_events = 0;
}

void gap_advance(struct gap_run *r, uint64_t ticks,
                 void (*seen)(void *context, const struct plant *pl, const struct event *e), void *context)
{
    struct event e;
    for (uint64_t i = 0; i < ticks; i++) {
        if (!plant_run(&r->plant, 1))
            check_true("the plant stays finite", 0);
        while (plant_take_event(&r->plant, &e)) {
            r->n_events++;
            if (seen)
                seen(context, &r->plant, &e);
        }
    }
}
