/* test_batch.c - batches against the stored reference trajectories and the scalar methods. */
#include "tests/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/shaft_bearing.h"
#include "tests/batch.h"
#include "tests/rig.h"
#include "tests/trajectory.h"

void test_batch_reference(void);
void test_batch_rk4(void);
void test_batch_rk4_split(void);
void test_batch_refusals(void);

#define TWO_PI 6.283185307179586477

/* ---- stored trajectories ---- */

static double column_max(const struct trajectory *r, int k)
{
    double m = fabs(r->start[k]);
    for (int i = 0; i < r->n_samples; i++)
        m = fmax(m, fabs(r->state[i][k]));
    return m;
}

static int liftoffs_of(const struct trajectory *r)
{
    int n = 0;
    for (int i = 0; i < r->n_events[0]; i++)
        n += !r->event_touch[0][i];
    return n;
}

static void check_case(const struct trajectory *r)
{
    struct batch b;
    struct batch_one o;
    double samples[2 * TRAJECTORY_SAMPLES], worst = 0.0, growth = fmax(r->growth, 1.0);
    char text[160];
    if (!r->model->hertz_form)
        return;
    void *memory = batch_make(&b, 1);
    batch_of_paper(&o, r->model, r->paper, r->start, r->t[r->n_samples - 1] / r->n_samples);
    batch_put(&b, 0, &o);
    batch_ran(batch_taylor(&b, 1e-12, r->n_samples, samples));
    for (int i = 0; i < r->n_samples; i++) {
        struct input u[MODEL_INPUTS];
        double x[2], x_dot[2], state[2], time = o.t.interval * (i + 1);
        batch_state(&o.t, time, samples[2 * i], samples[2 * i + 1], x);
        /* The file's instants are rounded: along the tangent. */
        batch_inputs(&o.t, time, u);
        r->model->rhs(o.p, u, x, x_dot);
        batch_inputs(&o.t, r->t[i], u);
        for (int k = 0; k < 2; k++)
            x[k] += (r->t[i] - time) * x_dot[k];
        r->model->paper_state(o.p, u, x, state);
        for (int k = 0; k < 2; k++)
            worst = fmax(worst, fabs(state[k] - r->state[i][k]) / column_max(r, k));
    }
    snprintf(text, sizeof text, "%s: worst state error over its column's maximum", r->name);
    check_below(text, worst, growth * 1e-11);
    if (r->n_events_total >= 0 &&
        !strstr(r->name, "graze")) /* a touch without speed is there or not by rounding */
        check_int("lift-offs", b.liftoffs[0], liftoffs_of(r));
    check_int("residuals, status", b.residuals[0] + b.status[0], 0);
    free(memory);
}

/* Multi-precision results made without this code, trusted to 1e-15. */
void test_batch_reference(void)
{
    check_int("cases of the rig", trajectory_each("tests/data/rig_trajectories.txt", check_case), 10);
    check_int("cases of the other models", trajectory_each("tests/data/model_trajectories.txt", check_case),
              18);
}

/* ---- rk4 ---- */

/* The equation in eta, from the model's form, with drives from libm. */
static double acceleration(const struct batch_one *o, double time, double eta, double rate)
{
    const struct model *m = o->t.model;
    struct hertz_form f;
    m->hertz_form(o->p, &f);
    double force = f.constant - f.damping * rate - f.stiffness * eta, hertz = f.hertz;
    for (int i = 0; i < m->n_inputs; i++) {
        const struct harmonic *h = &o->t.drive[i];
        double c = h->amplitude * cos(h->omega * time + h->phase);
        double s = h->amplitude * sin(h->omega * time + h->phase);
        force += (f.force[i] - f.shift[i] * h->omega * h->omega) * c - f.drag[i] * h->omega * s;
        hertz += f.hertz * f.modulation[i] * c;
    }
    return eta > 0.0 ? force - hertz * pow(eta, 1.5) : force;
}

/* The classical method as in every textbook. */
static void scalar_rk4(const struct batch_one *o, int steps, int intervals, double *eta, double *rate)
{
    double h = o->t.interval / steps;
    for (int n = 0; n < steps * intervals; n++) {
        double t = h * n, x = *eta, v = *rate;
        double a1 = acceleration(o, t, x, v), v2 = v + h / 2 * a1;
        double a2 = acceleration(o, t + h / 2, x + h / 2 * v, v2), v3 = v + h / 2 * a2;
        double a3 = acceleration(o, t + h / 2, x + h / 2 * v2, v3), v4 = v + h * a3;
        double a4 = acceleration(o, t + h, x + h * v3, v4);
        *eta = x + h / 6 * (v + 2 * v2 + 2 * v3 + v4);
        *rate = v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
}

/* The plant's rk4 in the model's own coordinate. */
static void plant_rk4(const struct batch_one *o, int steps, int intervals, double *x)
{
    const struct model *m = o->t.model;
    struct crossing c;
    struct excitation e = {.length = o->t.interval / steps};
    memcpy(x, o->t.x, 2 * sizeof *x);
    for (int n = 0; n < steps * intervals; n++) {
        for (int k = 0; k < 3; k++)
            batch_inputs(&o->t, e.length * (n + 0.5 * k), e.at[k]);
        rk4.bind(m)(m, o->p, NULL, &e, REGIME_ANY, x, &c);
    }
}

/* Over several periods and re-synchronisations; a bounce multiplies what rounding differs in by up to 10. */
void test_batch_rk4(void)
{
    enum { N = 40, STEPS = 600, INTERVALS = 6 };
    static struct batch_one o[N];
    struct batch b;
    uint64_t seed = 11;
    double worst = 0.0, worst_plant = 0.0, eta[N], rate[N];
    int lost = 0;
    void *memory = batch_make(&b, N);
    for (int i = 0; i < N; i++) {
        batch_random(&seed, &o[i]);
        batch_put(&b, i, &o[i]);
        eta[i] = b.eta[i];
        rate[i] = b.rate[i];
    }
    batch_ran(batch_rk4(&b, STEPS, INTERVALS, NULL));
    for (int i = 0; i < N; i++) {
        double x[2];
        scalar_rk4(&o[i], STEPS, INTERVALS, &eta[i], &rate[i]);
        worst = fmax(worst, fmax(fabs(eta[i] - b.eta[i]), fabs(rate[i] - b.rate[i])));
        if (o[i].t.model == &afm_tip) { /* its coordinate is eta */
            plant_rk4(&o[i], STEPS, INTERVALS, x);
            worst_plant = fmax(worst_plant, fmax(fabs(x[0] - b.eta[i]), fabs(x[1] - b.rate[i])));
        }
        lost += b.liftoffs[i] > 0;
        if (b.eta[i] < b.lowest[i] || b.eta[i] > b.highest[i])
            check_true("the end is between the extremes", 0);
    }
    check_below("batch_rk4 and the textbook's, worst of 40 trajectories", worst, 1e-11);
    check_below("batch_rk4 and the plant's rk4, worst of the tips among them", worst_plant, 1e-11);
    check_above("of which lost contact", lost, 10.0);
    free(memory);
}

/* Intervals in one call or in several: the same bits. */
void test_batch_rk4_split(void)
{
    struct batch b[2];
    struct batch_one o;
    uint64_t seed = 5;
    void *memory[2] = {batch_make(&b[0], 3), batch_make(&b[1], 3)};
    for (int i = 0; i < 3; i++) {
        batch_random(&seed, &o);
        batch_put(&b[0], i, &o);
        batch_put(&b[1], i, &o);
    }
    batch_ran(batch_rk4(&b[0], 300, 5, NULL));
    batch_ran(batch_rk4(&b[1], 300, 2, NULL));
    batch_ran(batch_rk4(&b[1], 300, 3, NULL));
    check_int("5 intervals and 2 + 3: the same bits", memcmp(memory[0], memory[1], batch_bytes(3)), 0);
    free(memory[0]);
    free(memory[1]);
}

/* ---- refusals ---- */

static void refused(const char *what, const char *why)
{
    char text[200];
    snprintf(text, sizeof text, "%s: %s", what, why ? why : "not refused");
    check_true(text, why != NULL);
}

void test_batch_refusals(void)
{
    struct batch b;
    struct batch_one o;
    double paper[PAPER], state[2] = {0.0, 0.0};
    void *memory = batch_make(&b, 1), *before = malloc(batch_bytes(1));
    if (!before)
        abort();
    rig_paper(paper);
    paper[SIGMA] = 0.1;
    batch_of_paper(&o, &hertz_rig, paper, state, TWO_PI);
    batch_put(&b, 0, &o);
    memcpy(before, memory, batch_bytes(1));
    refused("30 steps a period", batch_rk4(&b, 30, 1, NULL));
    refused("no step", batch_rk4(&b, 0, 1, NULL));
    refused("negative intervals", batch_rk4(&b, 64, -1, NULL));
    refused("negative intervals", batch_taylor(&b, 1e-6, -1, NULL));
    refused("tolerance 0", batch_taylor(&b, 0.0, 1, NULL));
    o.t.interval = 0.0;
    refused("interval 0", batch_set(&b, 0, &o.t));
    o.t.interval = 1.0;
    o.t.drive[RIG_FAST_FORCE] = (struct harmonic){1.0, 8.0, 0.0};
    o.t.drive[RIG_BASE] = (struct harmonic){1.0, 9.0, 0.0};
    refused("three frequencies", batch_set(&b, 0, &o.t));
    o.t.drive[RIG_BASE].omega = (double)NAN;
    refused("a frequency that is no number", batch_set(&b, 0, &o.t));
    o.t.model = &shaft_bearing;
    refused("a shaft", batch_set(&b, 0, &o.t));
    check_int("and nothing has changed", memcmp(before, memory, batch_bytes(1)), 0);
    free(before);
    free(memory);
}
