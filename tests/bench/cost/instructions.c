/* instructions.c - the pieces of tests/bench/cost/work_pieces.h, work_models.h and work_microscope.h for
 * tests/bench/cost/test_instructions.sh to count under callgrind: instructions do not depend on what else a
 * machine does. Prints "NAME calls"; stops when a piece of work is not what its name says. */
#include <stdio.h>
#include "tests/bench/cost/work_microscope.h"
#include "tests/bench/cost/work_models.h"

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
    for (int i = 0; i < WORK_MODELS && !work_fault; i++) {
        work_fault = work_models_setup(i);
        for (int k = 0; k < WORK_CALLS && !work_fault; k += work_models_ticks(i))
            work_model[i].once();
        work_fault = work_models_good() ? work_fault : work_model[i].name;
        printf("%s %d\n", work_model[i].name, WORK_CALLS);
    }
    for (int i = 0; i < WORK_MICROSCOPES && !work_fault; i++) {
        work_microscope[i].setup();
        for (int k = 0; k < WORK_CALLS; k += WORK_MICROSCOPE_TICKS)
            work_microscope[i].once();
        work_fault = work_microscope_fault();
        printf("%s %d\n", work_microscope[i].name, WORK_CALLS);
    }
    if (work_fault)
        fprintf(stderr, "instructions: not what it should be: %s\n", work_fault);
    return work_fault != NULL;
}
