/* bench_batch.c - the cost of a batch on this machine, and how near batch_rk4 is to the cost of its square
 * roots alone.
 *
 *   bench_batch OUT.csv [ROUNDS]    10,000 rigs that lose contact in every cycle; interleaved rounds, medians
 *
 * The limit: independent square roots of full vectors, four a step and four trajectories a vector.
 * Numbers, never pass or fail: the machine decides them. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "host_sim/batch/batch_taylor.h"
#include "host_sim/batch/batch_lanes.h"
#include "host_sim/batch/batch_rk4.h"
#include "models/hertz_rig.h"
#include "tests/bench/cost/bench_time.h"

enum { ROUNDS = 9, TRAJECTORIES = 10000, INTERVALS = 20, INDEPENDENT = 8, ROOTS = 200000, WAYS = 5 };
#define TWO_PI 6.283185307179586477

/* ns of one square root of a quad, when many are independent. */
static double time_roots(void)
{
    quad x[INDEPENDENT];
    for (int i = 0; i < INDEPENDENT; i++)
        x[i] = (quad){1.3 + i, 0.7 * i + 0.1, 2.2, 0.01 + i};
    double begin = bench_time_ns();
    for (int n = 0; n < ROOTS; n++) {
        BATCH_UNROLL
        for (int i = 0; i < INDEPENDENT; i++) {
            __asm__ volatile("" : : "m"(x[i]) : "memory");
            quad y = root(x[i]);
            __asm__ volatile("" : : "m"(y));
        }
    }
    return (bench_time_ns() - begin) / ROOTS / INDEPENDENT;
}

/* Rig i: its parameters, drives and start. */
static void rig(int i, struct batch_trajectory *t, double *p)
{
    double paper[RIG_PAPER] = {
        0.01, 0.3 + 0.03 * (i % 101) / 101.0, 0.9 + 0.01 * (i % 13) / 13.0, 0.0, 8.0, 0.0, 0.0, 0.0};
    double si[MODEL_PARAMETERS];
    struct scale scale;
    *t = (struct batch_trajectory){.model = &hertz_rig, .p = p, .x = {1.5 - 0.1 * (i % 7) / 7.0, 0.0}};
    hertz_rig.from_paper(paper, si, t->drive);
    hertz_rig.prepare(si, p, &scale);
    t->interval = TWO_PI / paper[RIG_PAPER_OMEGA];
}

/* A way to run the batch. */
struct way {
    const char *name;
    int steps;
    double tol;
};

/* A period is `steps` steps of each rig. */
static const char *set_rk4(struct batch_rk4 *b, int steps, void *memory)
{
    const struct drive_setting drive[RIG_INPUTS] = {{.turns_per_tick = 1.0 / steps}};
    const char *why = batch_rk4_init(b, TRAJECTORIES, &hertz_rig, drive, memory);
    for (int i = 0; i < TRAJECTORIES && !why; i++) {
        struct batch_trajectory t;
        double p[MODEL_DERIVED];
        rig(i, &t, p);
        struct batch_rk4_lane lane = {
            p, t.interval / steps, {t.drive[RIG_FORCE].amplitude}, {t.x[0], t.x[1]}};
        why = batch_rk4_set(b, i, &lane);
    }
    return why;
}

static const char *set_taylor(struct batch_taylor *b, void *memory)
{
    const char *why = NULL;
    batch_taylor_init(b, TRAJECTORIES, memory);
    for (int i = 0; i < TRAJECTORIES && !why; i++) {
        struct batch_trajectory t;
        double p[MODEL_DERIVED];
        rig(i, &t, p);
        why = batch_taylor_set(b, i, &t);
    }
    return why;
}

/* ns a trajectory and period. */
static double time_way(const struct way *w, void *memory, double *samples)
{
    struct batch_rk4 rk;
    struct batch_taylor series;
    const char *why = w->steps ? set_rk4(&rk, w->steps, memory) : set_taylor(&series, memory);
    double begin = bench_time_ns();
    if (!why)
        why = w->steps ? batch_rk4(&rk, w->steps, INTERVALS, samples)
                       : batch_taylor(&series, w->tol, INTERVALS, samples);
    if (why)
        fprintf(stderr, "%s: %s\n", w->name, why);
    return (bench_time_ns() - begin) / TRAJECTORIES / INTERVALS;
}

static void report(FILE *csv, const struct way *w, double ns, double root_ns)
{
    if (w->steps) {
        double step = ns / w->steps, limit = 4.0 * root_ns / QUAD;
        printf(
            "%-12s %4d steps   %8.0f ns a period  %6.3f ns a step; its four roots %6.3f ns, %.1f %% of it\n",
            w->name, w->steps, ns, step, limit, 100.0 * limit / step);
        fprintf(csv, "%s,%d,%.5g,%.4g,%.4g,%.4g\n", w->name, w->steps, ns, step, limit, limit / step);
    } else {
        printf("%-12s tol %.0e    %8.0f ns a period\n", w->name, w->tol, ns);
        fprintf(csv, "%s,%.0e,%.5g,,,\n", w->name, w->tol, ns);
    }
}

int main(int argc, char **argv)
{
    static const struct way way[WAYS] = {{"batch_rk4", 64, 0.0},
                                         {"batch_rk4", 256, 0.0},
                                         {"batch_taylor", 0, 1e-4},
                                         {"batch_taylor", 0, 1e-7},
                                         {"batch_taylor", 0, 1e-10}};
    static double ns[WAYS][ROUNDS], roots[ROUNDS];
    int rounds = argc == 3 ? atoi(argv[2]) : ROUNDS;
    FILE *csv = (argc == 2 || argc == 3) && rounds >= 1 && rounds <= ROUNDS ? fopen(argv[1], "w") : NULL;
    size_t rk4_bytes = batch_rk4_bytes(TRAJECTORIES), series_bytes = batch_taylor_bytes(TRAJECTORIES);
    void *memory = malloc(rk4_bytes > series_bytes ? rk4_bytes : series_bytes);
    double *samples = malloc(2 * sizeof *samples * TRAJECTORIES * INTERVALS);
    if (!csv || !memory || !samples) {
        fprintf(stderr, "usage: bench_batch OUT.csv [ROUNDS]\n");
        return 2;
    }
    for (int r = 0; r < rounds; r++) {
        roots[r] = time_roots();
        for (int i = 0; i < WAYS; i++)
            ns[i][r] = time_way(&way[i], memory, samples);
    }
    double root_ns = bench_time_median(roots, rounds);
    fprintf(csv, "method,setting,ns_per_period,ns_per_step,root_limit_ns,part_of_limit\n");
    printf("a batch of %d rigs, one thread, compiled by %s\n", TRAJECTORIES, __VERSION__);
    for (int i = 0; i < WAYS; i++)
        report(csv, &way[i], bench_time_median(ns[i], rounds), root_ns);
    free(memory);
    free(samples);
    return fclose(csv) != 0;
}
