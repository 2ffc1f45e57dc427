/* board_hash.c - a program for boards: the trajectories of tests/bits/hash_run.h on the console, BOARD_BLOCKS
 * blocks of each, in the lines of tests/data/hash.txt. */
#include "hal/board/board.h"
#include "hal/board/console.h"
#include "tests/bits/hash_peak_force.h"
#include "tests/bits/hash_run.h"

static struct plant pl;
static double scratch[METHOD_SCRATCH];

static void block(uint32_t hash)
{
    console_text(" ");
    console_hex(hash, 8);
    console_flush();
}

static int end(const char *why)
{
    if (why) {
        console_text(" stopped: ");
        console_text(why);
    }
    console_text("\n");
    console_flush();
    return why != NULL;
}

int main(void)
{
    struct hash_case c;
    int status = 0;
    console_text("double:arithmetic");
    hash_arithmetic(BOARD_BLOCKS, block);
    status |= end(NULL);
    for (int i = 0; i < HASH_RUNS; i++) {
        if (!hash_case(i, &c))
            continue;
        console_text(c.plant);
        console_text(":");
        console_text(c.method);
        status |= end(hash_run(&c, BOARD_BLOCKS, &pl, scratch, block));
    }
    console_text("microscope:peak_force");
    status |= end(hash_peak_force(BOARD_BLOCKS, block));
    return status;
}
