/* test_batch_company.c - trajectories of batch_taylor by themselves,
 * in company, and beside the plant: bits, events, failures. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/batch/batch_taylor_set.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "tests/fixture/batch.h"
#include "tests/fixture/paper.h"
#include "tests/fixture/rig.h"
#include "tests/fixture/trajectory.h"

#define TWO_PI 6.283185307179586477

/* ---- independence ---- */

/* Everything of trajectory i after three intervals. */
struct outcome {
    double eta, rate, samples[6];
    int64_t liftoffs;
};

static const char *run(struct batch_taylor *b, double *samples)
{
    return batch_taylor(b, 1e-8, 3, samples);
}

static void outcome_of(const struct batch_taylor *b, const double *samples, int i, struct outcome *o)
{
    *o = (struct outcome){.eta = b->eta[i], .rate = b->rate[i], .liftoffs = b->liftoffs[i]};
    for (int k = 0; k < 6; k++)
        o->samples[k] = samples[k * b->n + i];
}

/* n trajectories, the same one at `at` and the others random. */
static void in_company(struct batch_one *same, int n, int at, struct outcome *o)
{
    struct batch_taylor b;
    struct batch_one other;
    uint64_t seed = (uint64_t)(n + at);
    double *samples = malloc(6 * (size_t)n * sizeof *samples);
    void *memory = batch_make(&b, n);
    if (!samples)
        abort();
    for (int i = 0; i < n; i++) {
        batch_random(&seed, &other);
        batch_put(&b, i, i == at ? same : &other);
    }
    batch_ran(run(&b, samples));
    outcome_of(&b, samples, at, o);
    free(memory);
    free(samples);
}

/* A trajectory alone, and in batches of other sizes and places: the same bits. */
TEST(batch_company)
{
    static const int size[] = {1, 4, 5, 33, 64, 300};
    int differs = 0;
    uint64_t seed = 3;
    for (int k = 0; k < 12; k++) {
        struct batch_one same;
        struct outcome alone, o;
        batch_random(&seed, &same);
        in_company(&same, 1, 0, &alone);
        for (size_t i = 1; i < sizeof size / sizeof *size; i++) {
            in_company(&same, size[i], (7 * k + 3) % size[i], &o);
            differs += memcmp(&o, &alone, sizeof o) != 0;
        }
    }
    check_int("outcomes that depend on the company", differs, 0);
}

/* The kernels that this processor gets and those that every
 * processor takes: the same bits in all that a batch holds. */
TEST(batch_kernels)
{
    enum { N = 301, INTERVALS = 5 };
    static double samples[2][2 * N * INTERVALS];
    struct batch_taylor b[2];
    void *memory[2] = {batch_make(&b[0], N), batch_make(&b[1], N)};
    int64_t liftoffs = 0;
    for (int k = 0; k < 2; k++) {
        uint64_t seed = 29;
        for (int i = 0; i < N; i++) {
            struct batch_one o;
            batch_random(&seed, &o);
            batch_put(&b[k], i, &o);
        }
    }
    batch_ran(batch_taylor(&b[0], 1e-9, INTERVALS, samples[0]));
    batch_ran(batch_taylor_plain(&b[1], 1e-9, INTERVALS, samples[1]));
    check_int("samples that differ", memcmp(samples[0], samples[1], sizeof samples[0]) != 0, 0);
    check_int("and batches", memcmp(memory[0], memory[1], batch_taylor_bytes(N)) != 0, 0);
    for (int i = 0; i < N; i++)
        liftoffs += b[0].liftoffs[i];
    check_above("lift-offs", (double)liftoffs, 1000.0);
    free(memory[0]);
    free(memory[1]);
}

/* ---- events ---- */

static double scratch[METHOD_SCRATCH];

/* The plant with the scalar taylor: touchdowns and lift-offs, and the state at the end. */
static int plant_liftoffs(const double *paper, const double *state, double interval, int intervals,
                          double tol, double *q)
{
    struct plant pl;
    struct event e;
    int n = 0;
    paper_start_by(&pl, &hertz_rig, &taylor, tol, scratch, paper, interval / 64, state);
    for (int i = 0; i < 64 * intervals; i++) {
        rig_run(&pl, 1);
        while (plant_take_event(&pl, &e))
            n += !e.touch;
    }
    paper_now(&pl, q);
    return n;
}

TEST(batch_events)
{
    enum { N = 60, INTERVALS = 10 };
    struct batch_taylor b;
    uint64_t seed = 17;
    int64_t differ = 0, total = 0;
    double worst = 0.0, paper[N][PAPER], state[2] = {0.75, 0.0};
    void *memory = batch_make(&b, N);
    for (int i = 0; i < N; i++) {
        struct batch_one o;
        rig_paper(paper[i]);
        paper[i][SIGMA] = batch_between(&seed, 0.1, 0.4);
        paper[i][OMEGA] = batch_between(&seed, 0.8, 1.1);
        batch_of_paper(&o, &hertz_rig, paper[i], state, TWO_PI / paper[i][OMEGA]);
        batch_put(&b, i, &o);
    }
    batch_ran(batch_taylor(&b, 1e-11, INTERVALS, NULL));
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

/* Started in or just above contact, at rest or slow, and thrown just so high that contact is all but lost: as
 * the scalar method at a tighter tolerance. */
TEST(batch_grazing)
{
    enum { N = 40, INTERVALS = 3 };
    struct batch_taylor b;
    double paper[PAPER], state[N][2], worst = 0.0;
    int64_t differ = 0;
    void *memory = batch_make(&b, N);
    rig_paper(paper);
    for (int i = 0; i < N; i++) {
        struct batch_one o;
        double depth = pow(10.0, -1 - i % 10); /* below eta = 0 or above it */
        state[i][0] = -1.5 + (i % 2 ? depth : -depth);
        state[i][1] = i < 20 ? 0.0 : (i % 3 - 1) * depth;
        batch_of_paper(&o, &hertz_rig, paper, state[i], TWO_PI);
        batch_put(&b, i, &o);
    }
    batch_ran(batch_taylor(&b, 1e-9, INTERVALS, NULL));
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
TEST(batch_escape)
{
    enum { N = 9, BAD = 4 };
    struct batch_taylor b;
    struct batch_one tip, o[N];
    struct outcome alone[N], now;
    double paper[TIP_PAPER], state[2] = {-3.0, -1.0}, samples[6 * N];
    uint64_t seed = 23;
    int differs = 0, numbers = 0;
    void *memory = batch_make(&b, N);
    paper_defaults(&afm_tip, paper);
    batch_of_paper(&tip, &afm_tip, paper, state, TWO_PI);
    for (int i = 0; i < N; i++) {
        batch_random(&seed, &o[i]);
        in_company(&o[i], 1, 0, &alone[i]);
        batch_put(&b, i, i == BAD ? &tip : &o[i]);
    }
    double eta = b.eta[BAD];
    batch_ran(run(&b, samples));
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
    batch_ran(run(&b, samples));
    check_int("called again, it is still where it was", b.intervals[BAD], 0);
    free(memory);
}

/* An interval of many thousand series ends in the budget, not in an endless loop. */
TEST(batch_budget)
{
    struct batch_taylor b;
    struct batch_one o;
    double paper[PAPER], state[2] = {0.5, 0.0}, samples[4];
    void *memory = batch_make(&b, 1);
    rig_paper(paper);
    batch_of_paper(&o, &hertz_rig, paper, state, 1e5);
    batch_put(&b, 0, &o);
    batch_ran(batch_taylor(&b, 1e-9, 2, samples));
    check_int("status", b.status[0], BATCH_BUDGET);
    check_int("intervals completed", b.intervals[0], 0);
    check_nan("no sample is a number", samples[0]);
    check_nan("no sample is a number", samples[3]);
    free(memory);
}

/* ---- many ---- */

/* 10,000 of all models and drives: every root converges,
 * nothing fails; and the error follows the tolerance. */
TEST(batch_many)
{
    enum { N = 10000, INTERVALS = 4 };
    struct batch_taylor b[2];
    uint64_t seed = 41;
    int64_t trouble = 0, liftoffs = 0, beyond = 0;
    void *memory[2] = {batch_make(&b[0], N), batch_make(&b[1], N)};
    for (int i = 0; i < N; i++) {
        struct batch_one o;
        batch_random(&seed, &o);
        batch_put(&b[0], i, &o);
        batch_put(&b[1], i, &o);
    }
    batch_ran(batch_taylor(&b[0], 1e-7, INTERVALS, NULL));
    batch_ran(batch_taylor(&b[1], 1e-11, INTERVALS, NULL));
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
