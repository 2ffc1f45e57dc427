/* hash_print.c - prints the hashes of tests/hash_run.h, in integers only. usage: hash_print [METHOD][:shaft], rk4
 * unless given; `batch` for batches. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include "tests/hash_batch.h"
#include "tests/hash_run.h"

static void line(uint64_t tick, uint64_t hash)
{
    printf("%" PRIu64 " %016" PRIx64 "\n", tick, hash);
}

int main(int argc, char **argv)
{
    static struct plant pl;
    static double work[METHOD_WORK];
    if (argc > 1 && strcmp(argv[1], "batch") == 0)
        return hash_batch();
    const char *why = hash_run(&pl, work, argc > 1 ? argv[1] : "rk4", line);
    if (why)
        printf("stopped: %s\n", why);
    printf("switches %" PRIu32 " budget %" PRIu32 " residual %" PRIu32 "\n", pl.counts.switches,
           pl.counts.budget, pl.counts.residual);
    return why != NULL;
}
