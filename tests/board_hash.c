/* board_hash.c - a program for boards: the last tick and hash of tests/hash_run.h for every run there, on the console, in the
 * lines of tests/data/hash.txt. */
#include "hal/board.h"
#include "hal/console.h"
#include "tests/hash_run.h"

static struct plant pl;
static double work[METHOD_WORK];
static uint64_t last_tick, last_hash;

static void line(uint64_t tick, uint64_t hash)
{
    last_tick = tick;
    last_hash = hash;
}

int main(void)
{
    int status = 0;
    for (int i = 0; i < HASH_RUNS; i++) {
        const char *why = hash_run(&pl, work, hash_runs[i], line);
        console_text(hash_runs[i]);
        console_text(" ");
        console_number(last_tick);
        console_text(" ");
        console_hex(last_hash, 16);
        if (why) {
            console_text(" stopped: ");
            console_text(why);
            status = 1;
        }
        console_text("\n");
        console_flush();
    }
    return status;
}
