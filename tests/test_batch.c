/* test_batch.c - batches against the stored reference trajectories, the scalar methods, and themselves in other company. */
#include "tests/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/batch.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"
#include "tests/exact.h"
#include "tests/paper.h"
#include "tests/rig.h"
#include "tests/trajectory.h"

void test_batch_reference(void);
void test_batch_rk4(void);
void test_batch_rk4_split(void);
void test_batch_company(void);
void test_batch_events(void);
void test_batch_grazing(void);
void test_batch_escape(void);
void test_batch_many(void);
void test_batch_refusals(void);

#define TWO_PI 6.283185307179586477

/* One trajectory with what it points to. */
struct one {
    struct batch_trajectory t;
    double p[MODEL_DERIVED];
};

static void inputs_at(const struct batch_trajectory *t, double time, struct input *u)
{
    memset(u, 0, MODEL_INPUTS * sizeof *u);
    for (int i = 0; i < t->model->n_inputs; i++) {
        const struct harmonic *h = &t->drive[i];
        u[i].value = h->amplitude * cos(h->omega * time + h->phase);
        u[i].rate = -h->amplitude * h->omega * sin(h->omega * time + h->phase);
    }
}

/* A trajectory with these paper parameters; the papers' sets are dimensionless. */
static void of_paper(struct one *o, const struct model *m, const double *paper, const double *state,
                     double interval)
{
    struct scale scale;
    struct input u[MODEL_INPUTS];
    double si[MODEL_PARAMETERS];
    memset(o, 0, sizeof *o);
    m->from_paper(paper, si, o->t.drive);
    m->prepare(si, o->p, &scale);
    o->t.model = m;
    o->t.p = o->p;
    o->t.interval = interval;
    inputs_at(&o->t, 0.0, u);
    m->state_from_paper(o->p, u, state, o->t.x);
}

static void *make(struct batch *b, int n)
{
    void *memory = malloc(batch_bytes(n));
    if (!memory)
        abort();
    batch_init(b, n, memory);
    return memory;
}

static void put(struct batch *b, int i, struct one *o)
{
    o->t.p = o->p;
    const char *why = batch_set(b, i, &o->t);
    if (why)
        check_string("batch_set", why, "no refusal");
}

static void no_refusal(const char *why)
{
    if (why)
        check_string("the batch runs", why, "no refusal");
}

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
    struct one o;
    double samples[2 * TRAJECTORY_SAMPLES], worst = 0.0, growth = fmax(r->growth, 1.0);
    char text[160];
    if (!r->model->hertz_form)
        return;
    void *memory = make(&b, 1);
    of_paper(&o, r->model, r->paper, r->start, r->t[r->n_samples - 1] / r->n_samples);
    put(&b, 0, &o);
    no_refusal(batch_taylor(&b, 1e-12, r->n_samples, samples));
    for (int i = 0; i < r->n_samples; i++) {
        struct input u[MODEL_INPUTS];
        double x[2], x_dot[2], state[2], time = o.t.interval * (i + 1);
        batch_state(&o.t, time, samples[2 * i], samples[2 * i + 1], x);
        /* The file's instants are rounded: along the tangent. */
        inputs_at(&o.t, time, u);
        r->model->rhs(o.p, u, x, x_dot);
        inputs_at(&o.t, r->t[i], u);
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

/* ---- random trajectories ---- */

static double between(uint64_t *seed, double a, double b)
{
    return a + (b - a) * exact_uniform(seed);
}

/* A rig with every drive, a rolling contact or a repulsive tip; smooth, or thrown off its contact. */
static void random_one(uint64_t *seed, struct one *o)
{
    double rig[RIG_PAPER] = {between(seed, 0.005, 0.05), between(seed, 0.0, 0.5), between(seed, 0.7, 1.3),
                             between(seed, -3.0, 3.0),   between(seed, 4.0, 9.0), between(seed, 0.0, 5.0),
                             between(seed, 0.0, 1.0),    between(seed, 0.0, 0.4)};
    double rolling[] = {between(seed, 0.01, 0.1), between(seed, 0.0, 0.5), rig[RIG_PAPER_OMEGA],
                        rig[RIG_PAPER_PHI]};
    double tip[TIP_PAPER] = {0.8, 0.02, between(seed, 0.0, 0.5), 5.0, between(seed, 0.0, 0.3), 1.3,
                             0.3, -1.0};
    double state[2] = {between(seed, -2.5, 1.0), between(seed, -0.5, 0.5)};
    double kind = between(seed, 0.0, 3.0), interval = TWO_PI / rig[RIG_PAPER_OMEGA];
    if (kind < 1.0)
        of_paper(o, &rolling_contact, rolling, state, interval);
    else if (kind < 2.0)
        of_paper(o, &afm_tip, tip, state, interval);
    else
        of_paper(o, &hertz_rig, rig, state, interval);
}

/* ---- rk4 ---- */

/* The equation in eta, from the model's form, with drives from libm. */
static double acceleration(const struct one *o, double time, double eta, double rate)
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
static void scalar_rk4(const struct one *o, int steps, int intervals, double *eta, double *rate)
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
static void plant_rk4(const struct one *o, int steps, int intervals, double *x)
{
    const struct model *m = o->t.model;
    struct crossing c;
    struct excitation e = {.length = o->t.interval / steps};
    memcpy(x, o->t.x, 2 * sizeof *x);
    for (int n = 0; n < steps * intervals; n++) {
        for (int k = 0; k < 3; k++)
            inputs_at(&o->t, e.length * (n + 0.5 * k), e.at[k]);
        rk4.bind(m)(m, o->p, NULL, &e, REGIME_ANY, x, &c);
    }
}

/* Over several periods and re-synchronisations; a bounce multiplies what rounding differs in by up to 10. */
void test_batch_rk4(void)
{
    enum { N = 40, STEPS = 600, INTERVALS = 6 };
    static struct one o[N];
    struct batch b;
    uint64_t seed = 11;
    double worst = 0.0, worst_plant = 0.0, eta[N], rate[N];
    int lost = 0;
    void *memory = make(&b, N);
    for (int i = 0; i < N; i++) {
        random_one(&seed, &o[i]);
        put(&b, i, &o[i]);
        eta[i] = b.eta[i];
        rate[i] = b.rate[i];
    }
    no_refusal(batch_rk4(&b, STEPS, INTERVALS, NULL));
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
    struct one o;
    uint64_t seed = 5;
    void *memory[2] = {make(&b[0], 3), make(&b[1], 3)};
    for (int i = 0; i < 3; i++) {
        random_one(&seed, &o);
        put(&b[0], i, &o);
        put(&b[1], i, &o);
    }
    no_refusal(batch_rk4(&b[0], 300, 5, NULL));
    no_refusal(batch_rk4(&b[1], 300, 2, NULL));
    no_refusal(batch_rk4(&b[1], 300, 3, NULL));
    check_int("5 intervals and 2 + 3: the same bits", memcmp(memory[0], memory[1], batch_bytes(3)), 0);
    free(memory[0]);
    free(memory[1]);
}

/* ---- independence ---- */

/* Everything of trajectory i after three intervals. */
struct outcome {
    double eta, rate, samples[6];
    int64_t liftoffs;
};

static const char *run(struct batch *b, bool series, double *samples)
{
    return series ? batch_taylor(b, 1e-8, 3, samples) : batch_rk4(b, 700, 3, samples);
}

static void outcome_of(const struct batch *b, const double *samples, int i, struct outcome *o)
{
    *o = (struct outcome){.eta = b->eta[i], .rate = b->rate[i], .liftoffs = b->liftoffs[i]};
    for (int k = 0; k < 6; k++)
        o->samples[k] = samples[k * b->n + i];
}

/* n trajectories, the same one at `at` and the others random. */
static void in_company(struct one *same, int n, int at, bool series, struct outcome *o)
{
    struct batch b;
    struct one other;
    uint64_t seed = (uint64_t)(n + at);
    double *samples = malloc(6 * (size_t)n * sizeof *samples);
    void *memory = make(&b, n);
    if (!samples)
        abort();
    for (int i = 0; i < n; i++) {
        random_one(&seed, &other);
        put(&b, i, i == at ? same : &other);
    }
    no_refusal(run(&b, series, samples));
    outcome_of(&b, samples, at, o);
    free(memory);
    free(samples);
}

/* A trajectory alone, and in batches of other sizes and places: the same bits. */
void test_batch_company(void)
{
    static const int size[] = {1, 4, 5, 33, 64, 300};
    for (int series = 0; series < 2; series++) {
        int differs = 0;
        uint64_t seed = 3;
        for (int k = 0; k < 12; k++) {
            struct one same;
            struct outcome alone, o;
            random_one(&seed, &same);
            in_company(&same, 1, 0, series, &alone);
            for (size_t i = 1; i < sizeof size / sizeof *size; i++) {
                in_company(&same, size[i], (7 * k + 3) % size[i], series, &o);
                differs += memcmp(&o, &alone, sizeof o) != 0;
            }
        }
        check_int(series ? "batch_taylor: outcomes that depend on the company"
                         : "batch_rk4: outcomes that depend on the company",
                  differs, 0);
    }
}

/* ---- events ---- */

static double work[METHOD_WORK];

/* The plant with the scalar taylor: touchdowns and lift-offs, and the state at the end. */
static int plant_liftoffs(const double *paper, const double *state, double interval, int intervals,
                          double tol, double *q)
{
    struct plant pl;
    struct event e;
    int n = 0;
    trajectory_start(&pl, &hertz_rig, &taylor, tol, work, paper, interval / 64, state);
    for (int i = 0; i < 64 * intervals; i++) {
        rig_run(&pl, 1);
        while (plant_take_event(&pl, &e))
            n += !e.touch;
    }
    paper_now(&pl, q);
    return n;
}

void test_batch_events(void)
{
    enum { N = 60, INTERVALS = 10 };
    struct batch b;
    uint64_t seed = 17;
    int64_t differ = 0, total = 0;
    double worst = 0.0, paper[N][PAPER], state[2] = {0.75, 0.0};
    void *memory = make(&b, N);
    for (int i = 0; i < N; i++) {
        struct one o;
        rig_paper(paper[i]);
        paper[i][SIGMA] = between(&seed, 0.1, 0.4);
        paper[i][OMEGA] = between(&seed, 0.8, 1.1);
        of_paper(&o, &hertz_rig, paper[i], state, TWO_PI / paper[i][OMEGA]);
        put(&b, i, &o);
    }
    no_refusal(batch_taylor(&b, 1e-11, INTERVALS, NULL));
    for (int i = 0; i < N; i++) {
        double q[2];
        int n = plant_liftoffs(paper[i], state, b.interval[i], INTERVALS, 1e-11, q);
        differ += llabs(n - b.liftoffs[i]);
        total += n;
        worst = fmax(worst, fabs(q[0] - (1.5 * b.eta[i] - 1.5)));
    }
    check_int("lift-offs that the plant and the batch do not share", differ, 0);
    check_above("lift-offs in all", (double)total, 200.0);
    check_below("worst difference of the final state", worst, 1e-8);
    free(memory);
}

/* ---- grazing, escape ---- */

/* Started in or just above contact, at rest or slow, and thrown just so high that contact is all but lost: as the scalar
 * method at a tighter tolerance. */
void test_batch_grazing(void)
{
    enum { N = 40, INTERVALS = 3 };
    struct batch b;
    double paper[PAPER], state[N][2], worst = 0.0;
    int64_t differ = 0;
    void *memory = make(&b, N);
    rig_paper(paper);
    for (int i = 0; i < N; i++) {
        struct one o;
        double depth = pow(10.0, -1 - i % 10); /* below eta = 0 or above it */
        state[i][0] = -1.5 + (i % 2 ? depth : -depth);
        state[i][1] = i < 20 ? 0.0 : (i % 3 - 1) * depth;
        of_paper(&o, &hertz_rig, paper, state[i], TWO_PI);
        put(&b, i, &o);
    }
    no_refusal(batch_taylor(&b, 1e-9, INTERVALS, NULL));
    for (int i = 0; i < N; i++) {
        double q[2];
        int n = plant_liftoffs(paper, state[i], b.interval[i], INTERVALS, 1e-12, q);
        differ += llabs(n - b.liftoffs[i]);
        worst = fmax(worst, fmax(fabs(q[0] - (1.5 * b.eta[i] - 1.5)), fabs(q[1] - 1.5 * b.rate[i])));
        differ += b.residuals[i] + b.status[i];
    }
    check_below("grazing starts: worst difference to the scalar method", worst, 1e-7);
    check_int("lift-offs not shared, residuals, failures", differ, 0);
    free(memory);
}

/* Behind the saddle of the attracting tip the motion escapes; its neighbours do not notice. */
void test_batch_escape(void)
{
    enum { N = 9, BAD = 4 };
    for (int series = 0; series < 2; series++) {
        struct batch b;
        struct one tip, o[N];
        struct outcome alone[N], now;
        double paper[TIP_PAPER], state[2] = {-3.0, -1.0}, samples[6 * N];
        uint64_t seed = 23;
        int differs = 0, numbers = 0;
        void *memory = make(&b, N);
        paper_defaults(&afm_tip, paper);
        of_paper(&tip, &afm_tip, paper, state, TWO_PI);
        for (int i = 0; i < N; i++) {
            random_one(&seed, &o[i]);
            in_company(&o[i], 1, 0, series, &alone[i]);
            put(&b, i, i == BAD ? &tip : &o[i]);
        }
        double eta = b.eta[BAD];
        no_refusal(run(&b, series, samples));
        for (int i = 0; i < N; i++) {
            outcome_of(&b, samples, i, &now);
            differs += i != BAD && memcmp(&now, &alone[i], sizeof now) != 0;
        }
        for (int k = 0; k < 6; k++)
            numbers += !isnan(samples[k * N + BAD]);
        check_int("status of the one that escapes", b.status[BAD], BATCH_ESCAPED);
        check_near("it stays where it was", b.eta[BAD], eta, 0.0);
        check_int("samples of it that are numbers", numbers, 0);
        check_int("neighbours that notice", differs, 0);
        no_refusal(run(&b, series, samples));
        check_int("called again, it is still where it was", b.intervals[BAD], 0);
        free(memory);
    }
}

/* ---- many ---- */

/* 10,000 of all models and drives: every root converges, nothing fails; and the error follows the tolerance. */
void test_batch_many(void)
{
    enum { N = 10000, INTERVALS = 4 };
    struct batch b[2];
    uint64_t seed = 41;
    int64_t trouble = 0, liftoffs = 0, beyond = 0;
    void *memory[2] = {make(&b[0], N), make(&b[1], N)};
    for (int i = 0; i < N; i++) {
        struct one o;
        random_one(&seed, &o);
        put(&b[0], i, &o);
        put(&b[1], i, &o);
    }
    no_refusal(batch_taylor(&b[0], 1e-7, INTERVALS, NULL));
    no_refusal(batch_taylor(&b[1], 1e-11, INTERVALS, NULL));
    for (int i = 0; i < N; i++) {
        trouble += b[0].residuals[i] + b[1].residuals[i] + b[0].status[i] + b[1].status[i];
        trouble += b[0].intervals[i] != INTERVALS;
        liftoffs += b[1].liftoffs[i];
        beyond += !(fabs(b[0].eta[i] - b[1].eta[i]) <= 1e-4);
    }
    check_int("residuals, failures in 10,000 trajectories at 1e-7 and 1e-11", trouble, 0);
    check_above("lift-offs", (double)liftoffs, 10000.0);
    check_below("trajectories at 1e-7 more than 1e-4 from those at 1e-11", (double)beyond, N / 1000.0);
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
    struct one o;
    double paper[PAPER], state[2] = {0.0, 0.0};
    void *memory = make(&b, 1), *before = malloc(batch_bytes(1));
    if (!before)
        abort();
    rig_paper(paper);
    paper[SIGMA] = 0.1;
    of_paper(&o, &hertz_rig, paper, state, TWO_PI);
    put(&b, 0, &o);
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
