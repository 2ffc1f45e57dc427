/* instructions.c - the pieces of tests/work_pieces.h for tests/test_instructions.sh to count under callgrind:
 * instructions do not depend on what else a machine does. Prints "NAME calls"; stops when a piece of work is not what its
 * name says. */
#include <stdio.h>
#include "tests/work_pieces.h"

int main(void)
{
    for (int i = 0; i < WORK_PIECES && !work_fault; i++) {
        work_setup(i);
        for (int k = 0; k < WORK_CALLS && !work_fault; k++) {
            work_piece[i].once();
            work_check(i);
        }
        printf("%s %d\n", work_piece[i].name, WORK_CALLS);
    }
    if (work_fault)
        fprintf(stderr, "instructions: not what it should be: %s\n", work_fault);
    return work_fault != NULL;
}
