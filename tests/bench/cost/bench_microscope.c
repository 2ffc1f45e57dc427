/* bench_microscope.c - time of a lever's tick in a microscope, and how much faster than the true lever that
 * is, for the four levers.
 *
 *   bench_microscope [ROUNDS]
 *
 * Numbers, never pass or fail: the machine decides them. The least of the rounds, for what else the machine
 * does only adds to it; the median beside it. */
#include <stdio.h>
#include <stdlib.h>
#include "tests/bench/cost/bench_time.h"
#include "tests/bench/cost/work_microscope.h"

enum { ROUNDS = 25, SAMPLES = 5000 };

static int rounds = ROUNDS;

static double round_ns(void)
{
    double begin = bench_time_ns();
    for (int k = 0; k < SAMPLES; k++)
        work_microscope_run();
    return (bench_time_ns() - begin) / (SAMPLES * WORK_MICROSCOPE_TICKS);
}

static void print(const char *lever, int modes, const char *name, enum work_place place)
{
    double ns[ROUNDS];
    const char *why = work_microscope_start(lever, modes, place);
    for (int r = 0; r < rounds && !why; r++)
        ns[r] = round_ns();
    why = why ? why : work_microscope_fault();
    if (why) {
        printf("%-8s %5d  %-15s %s\n", lever, modes, name, why);
        return;
    }
    double median = bench_time_median(ns, rounds);
    printf("%-8s %5d  %-15s %6.1f %6.1f %8.2f\n", lever, modes, name, ns[0], median,
           1e9 / (ns[0] * work_microscope_rate()));
}

int main(int argc, char **argv)
{
    static const char *const lever[] = {"soft", "seed", "tapping", "stiff"};
    rounds = argc > 1 ? atoi(argv[1]) : ROUNDS;
    if (rounds < 1 || rounds > ROUNDS) {
        fprintf(stderr, "usage: bench_microscope [ROUNDS], 1 to %d\n", ROUNDS);
        return 2;
    }
    printf("lever    modes  place           least median ns a tick, times real time\n");
    for (unsigned i = 0; i < sizeof lever / sizeof lever[0]; i++) {
        for (int modes = 1; modes <= 4; modes += 3) {
            print(lever[i], modes, "far", WORK_FAR);
            print(lever[i], modes, "far, two tones", WORK_FAR_TWO_TONES);
            print(lever[i], modes, "tapping", WORK_TAPPING);
        }
    }
    return 0;
}
