/* cases.c - the motions that are computed, and the equations behind them. */
#include "tests/bench/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"

#define TURN 6.283185307179586476925L

#define RIG(xi, sigma, omega, fast, force, base, stiffness)                                                  \
    {                                                                                                        \
        {"xi", xi}, {"sigma", sigma}, {"omega", omega}, {"phi", 0}, {"Omega", fast}, {"a_force", force},     \
            {"a_base", base},                                                                                \
        {                                                                                                    \
            "a_stiff", stiffness                                                                             \
        }                                                                                                    \
    }
#define TIP(r, fast, f, omega)                                                                               \
    {                                                                                                        \
        {"beta", 0.8}, {"c", 0.02}, {"r", r}, {"Omega", fast}, {"f", f}, {"omega", omega}, {"phi", 0},       \
        {                                                                                                    \
            "sign", -1                                                                                       \
        }                                                                                                    \
    }
#define SHAFT(c, hz)                                                                                         \
    {                                                                                                        \
        {"c1", c}, {"c2", c}, {"c3", c}, {"p2", 25}, {"freq_hz", hz},                                        \
        {                                                                                                    \
            "phi", 0                                                                                         \
        }                                                                                                    \
    }

/* Outputs are at the ends of forcing periods, about one natural period apart: a method without dense output
 * is not made to stop more often than anyone would ask. */
/* clang-format off: a table */
const struct bench_case bench_cases[] = {
    {"A1",
     "rig, contact lost in every cycle",
     &hertz_rig,
     RIG(0.01, 0.3, 0.9, 8, 0, 0, 0),
     {0.75, 0},
     "omega",
     20,
     1,
     0},
    {"A2",
     "rig, smooth, drive at 8",
     &hertz_rig,
     RIG(0.01, 0.04, 8, 8, 0, 0, 0),
     {0.5, 0},
     "omega",
     40,
     8,
     0},
    {"base5", "rig, fast base 5", &hertz_rig, RIG(0.01, 0.04, 0.99, 8, 0, 5, 0), {0, 0}, "Omega", 16, 2, 0},
    {"base8", "rig, fast base 8", &hertz_rig, RIG(0.01, 0.04, 0.99, 8, 0, 8, 0), {0, 0}, "Omega", 16, 2, 0},
    {"force60",
     "rig, fast force 60",
     &hertz_rig,
     RIG(0.01, 0.04, 0.98, 8, 60, 0, 0),
     {0, 0},
     "Omega",
     52,
     4,
     0},
    {"stiff5",
     "rig, stiffness modulation 5",
     &hertz_rig,
     RIG(0.01, 0.04, 1.12, 8, 0, 0, 5),
     {0, 0},
     "Omega",
     40,
     4,
     0},
    {"roll045",
     "rolling contact, waviness 0.45",
     &rolling_contact,
     {{"zeta", 0.05}, {"xi0", 0.45}, {"Omega", 0.8}, {"phi", 0}},
     {1, 0},
     "Omega",
     20,
     1,
     0},
    {"tip", "AFM tip, repulsive, contact lost", &afm_tip, TIP(0, 1, 0.3, 1.3), {0, 0}, "omega", 8, 1, 0},
    {"tip_r05",
     "AFM tip, repulsive, stiffness modulation 0.5",
     &afm_tip,
     TIP(0.5, 5, 0.2, 1.3),
     {0, 0},
     "Omega",
     32,
     2,
     0},
    {"C1",
     "shaft, c = 139, 25 Hz, 46 switches",
     &shaft_bearing,
     SHAFT(139, 25),
     {0.9 * 2.54e-4},
     "freq_hz",
     4,
     1,
     0},
    {"C2",
     "shaft, c = 4, 80 Hz, 4 switches",
     &shaft_bearing,
     SHAFT(4, 80),
     {0.9 * 2.54e-4},
     "freq_hz",
     4,
     1,
     0},
    {"A1held",
     "A1, force held for 1/128 period",
     &hertz_rig,
     RIG(0.01, 0.3, 0.9, 8, 0, 0, 0),
     {0.75, 0},
     "omega",
     20,
     1,
     128},
    {"C1held",
     "C1, force held for 1/128 period",
     &shaft_bearing,
     SHAFT(139, 25),
     {0.9 * 2.54e-4},
     "freq_hz",
     4,
     1,
     128},
    {"C2held",
     "C2, force held for 1/128 period; a longer run grazes a wall",
     &shaft_bearing,
     SHAFT(4, 80),
     {0.9 * 2.54e-4},
     "freq_hz",
     2,
     1,
     128},
};
/* clang-format on */
const int n_bench_cases = sizeof bench_cases / sizeof *bench_cases;

static int paper_index(const struct model *m, const char *name)
{
    for (int i = 0; i < m->n_paper; i++) {
        if (strcmp(m->paper[i].name, name) == 0)
            return i;
    }
    abort();
}

double problem_paper(const struct problem *b, const char *name)
{
    return b->paper[paper_index(b->c->model, name)];
}

static void rig_equation(struct problem *b)
{
    struct equation *e = &b->eq;
    double base = problem_paper(b, "a_base"), fast = problem_paper(b, "Omega");
    double third = 2.0 / 3.0;
    e->c = 2.0 * problem_paper(b, "xi");
    e->b = e->f0 = third;
    e->r = problem_paper(b, "a_stiff");
    e->f1 = third * problem_paper(b, "sigma");
    e->w1 = problem_paper(b, "omega");
    e->f2 = third * (problem_paper(b, "a_force") + base * fast * fast);
    e->w2 = e->r != 0.0 || e->f2 != 0.0 ? fast : 0.0;
    b->y0[0] = 1.0 + third * (b->c->state[0] - base);
    b->y0[1] = third * b->c->state[1];
}

static void rolling_equation(struct problem *b)
{
    struct equation *e = &b->eq;
    double zeta = problem_paper(b, "zeta"), w = problem_paper(b, "Omega"), a = problem_paper(b, "xi0");
    e->c = 2.0 * zeta;
    e->b = e->f0 = 2.0 / 3.0;
    e->w1 = w;
    /* xi'' + 2 zeta xi' = -a w (w cos w t + 2 zeta sin w t) */
    e->f1 = -a * w * hypot(w, 2.0 * zeta);
    e->phase1 = -atan2(2.0 * zeta, w);
    b->y0[0] = b->c->state[0];
    b->y0[1] = b->c->state[1];
}

static void tip_equation(struct problem *b)
{
    struct equation *e = &b->eq;
    e->c = problem_paper(b, "c");
    e->k = 1.0;
    e->b = -problem_paper(b, "sign") * (2.0 / 3.0) * problem_paper(b, "beta");
    e->f0 = 1.0 + e->b;
    e->f1 = -problem_paper(b, "f");
    e->w1 = problem_paper(b, "omega");
    e->r = problem_paper(b, "r");
    e->w2 = e->r != 0.0 ? problem_paper(b, "Omega") : 0.0;
    b->y0[0] = 1.0 - b->c->state[0];
    b->y0[1] = -b->c->state[1];
}

static void shaft_equation(struct problem *b)
{
    struct equation *e = &b->eq;
    static const char *const mass[] = {"m1", "m2", "m3"}, *const damper[] = {"c1", "c2", "c3"};
    double length = problem_paper(b, "L"), kl = problem_paper(b, "kappa") / (length * length);
    e->n = 6;
    e->n_contacts = 4;
    e->time_unit = sqrt(problem_paper(b, "m1") / kl);
    e->length_unit = problem_paper(b, "g1");
    for (int i = 0; i < 3; i++) {
        e->mass[i] = problem_paper(b, mass[i]) / problem_paper(b, "m1");
        e->damper[i] = problem_paper(b, damper[i]) * e->time_unit / problem_paper(b, "m1");
        b->y0[i] = b->c->state[i] / e->length_unit;
        b->y0[3 + i] = b->c->state[3 + i] * e->time_unit / e->length_unit;
    }
    e->support[0] = 2.0 * problem_paper(b, "ks1") / kl;
    e->support[2] = 2.0 * problem_paper(b, "ks3") / kl;
    e->spring = problem_paper(b, "kg1") / kl;
    e->f1 = problem_paper(b, "p2") / (kl * e->length_unit);
    e->w1 = (double)(TURN * (long double)problem_paper(b, "freq_hz")) * e->time_unit;
}

/* The force at the start of each sample, instead of the harmonic one. */
static void hold_force(struct problem *b)
{
    b->holds = b->c->holds > 0 ? b->c->holds : 1;
    b->held = NULL;
    if (b->c->holds == 0)
        return;
    int n = b->n_out * b->holds;
    b->held = bench_alloc((size_t)n * sizeof *b->held);
    for (int i = 0; i < n; i++)
        b->held[i] = b->eq.f1 * (double)cosl(TURN * (long double)(i % b->holds) / (long double)b->holds);
    b->eq.f1 = 0.0;
}

void problem_make(struct problem *b, const struct bench_case *c)
{
    const struct model *m = c->model;
    memset(b, 0, sizeof *b);
    b->c = c;
    for (int i = 0; i < m->n_paper; i++)
        b->paper[i] = m->paper[i].initial;
    for (int i = 0; i < CASE_SETS && c->set[i].name; i++)
        b->paper[paper_index(m, c->set[i].name)] = c->set[i].value;
    b->eq.n = 2;
    b->eq.n_contacts = 1;
    b->eq.time_unit = b->eq.length_unit = 1.0;
    if (m == &hertz_rig)
        rig_equation(b);
    else if (m == &rolling_contact)
        rolling_equation(b);
    else if (m == &afm_tip)
        tip_equation(b);
    else
        shaft_equation(b);
    double omega = problem_paper(b, c->omega);
    b->period = strcmp(c->omega, "freq_hz") == 0 ? 1.0 / omega : (double)(TURN / (long double)omega);
    b->interval = c->stride * b->period / b->eq.time_unit;
    b->n_out = c->periods / c->stride;
    hold_force(b);
}
