/* bench_batch.c - the cost of a batch on this machine.
 *
 *   bench_batch OUT.csv [ROUNDS]    10,000 rigs that lose contact in every cycle; interleaved rounds, medians
 *
 * Numbers, never pass or fail: the machine decides them. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "host_sim/batch/batch_taylor.h"
#include "host_sim/batch/batch_taylor_set.h"
#include "models/hertz_rig.h"
#include "tests/bench/cost/bench_time.h"

enum { ROUNDS = 9, TRAJECTORIES = 10000, INTERVALS = 20, WAYS = 3 };
#define TWO_PI 6.283185307179586477

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
static double time_batch(double tol, void *memory, double *samples)
{
    struct batch_taylor b;
    const char *why = set_taylor(&b, memory);
    double begin = bench_time_ns();
    if (!why)
        why = batch_taylor(&b, tol, INTERVALS, samples);
    if (why)
        fprintf(stderr, "batch_taylor: %s\n", why);
    return (bench_time_ns() - begin) / TRAJECTORIES / INTERVALS;
}

int main(int argc, char **argv)
{
    static const double tol[WAYS] = {1e-4, 1e-7, 1e-10};
    static double ns[WAYS][ROUNDS];
    int rounds = argc == 3 ? atoi(argv[2]) : ROUNDS;
    FILE *csv = (argc == 2 || argc == 3) && rounds >= 1 && rounds <= ROUNDS ? fopen(argv[1], "w") : NULL;
    void *memory = malloc(batch_taylor_bytes(TRAJECTORIES));
    double *samples = malloc(2 * sizeof *samples * TRAJECTORIES * INTERVALS);
    if (!csv || !memory || !samples) {
        fprintf(stderr, "usage: bench_batch OUT.csv [ROUNDS]\n");
        return 2;
    }
    for (int r = 0; r < rounds; r++)
        for (int i = 0; i < WAYS; i++)
            ns[i][r] = time_batch(tol[i], memory, samples);
    fprintf(csv, "method,setting,ns_per_period\n");
    printf("a batch of %d rigs, one thread, compiled by %s\n", TRAJECTORIES, __VERSION__);
    for (int i = 0; i < WAYS; i++) {
        double median = bench_time_median(ns[i], rounds);
        printf("batch_taylor tol %.0e    %8.0f ns a period\n", tol[i], median);
        fprintf(csv, "batch_taylor,%.0e,%.5g\n", tol[i], median);
    }
    free(memory);
    free(samples);
    return fclose(csv) != 0;
}
