/* physics.c - see physics.h. The fixtures of the unit tests are
 * used here as well: a failed check of theirs ends the program. */
#include "tests/bench/physics/physics.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include "tests/unit/test.h"

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double physics_quantile(double *x, int n, double q)
{
    qsort(x, (size_t)n, sizeof *x, ascending);
    return x[(int)(q * (n - 1) + 0.5)];
}

double physics_now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

void check_true_at(struct check_place place, const char *name, int condition)
{
    if (!condition) {
        fprintf(stderr, "%s:%d: failed: %s\n", place.file, place.line, name);
        exit(1);
    }
}

void check_string_at(struct check_place place, const char *name, const char *got, const char *expected)
{
    fprintf(stderr, "%s:%d: failed: %s: %s, expected %s\n", place.file, place.line, name, got, expected);
    exit(1);
}
