/* hash_print.c - prints tests/data/hash.txt: a line for every trajectory of tests/bits/hash_run.h, its name
 * and the hash after each block; so for double arithmetic, peak force tapping and batches. */
#include <inttypes.h>
#include <stdio.h>
#include "tests/bits/hash_batch.h"
#include "tests/bits/hash_peak_force.h"
#include "tests/bits/hash_run.h"

static void block(uint32_t hash)
{
    printf(" %08" PRIx32, hash);
}

static int end(const char *why)
{
    if (why)
        printf(" stopped: %s", why);
    printf("\n");
    return why != NULL;
}

int main(void)
{
    static struct plant pl;
    static double scratch[METHOD_SCRATCH];
    struct hash_case c;
    int status = 0;
    printf("double:arithmetic");
    hash_arithmetic(HASH_BLOCKS, block);
    status |= end(NULL);
    for (int i = 0; i < HASH_RUNS; i++) {
        if (!hash_case(i, &c))
            continue;
        printf("%s:%s", c.plant, c.method);
        status |= end(hash_run(&c, HASH_BLOCKS, &pl, scratch, block));
    }
    printf("microscope:peak_force");
    status |= end(hash_peak_force(HASH_BLOCKS, block));
    printf("hertz_rig:batch");
    status |= end(hash_batch(block));
    return status;
}
