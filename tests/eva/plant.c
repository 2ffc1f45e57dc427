/* plant.c - one segment of any plant, cut into pieces by
 * any number of switches; and the inputs of any segment. */
#include "tests/eva/any_plant.h"

static void one_segment(const struct model *m)
{
    any_plant(m);
    (void)segment(&pl);
    invariants_hold();
}

/* The inputs of one segment: of the model only the number of inputs matters, and the first has all. */
static void any_inputs(void)
{
    struct instant to = {eva_word(), eva_uint(0, TICK_FRACTIONS - 1)};
    any_plant(model_table[0]);
    (void)segment_length(&pl, to);
    excite(&pl, eva_uint(1, TICK_FRACTIONS));
}

int main(void)
{
    any_inputs();
    /*@ loop unroll 14; */
    for (int i = 0; i < MODELS; i++)
        one_segment(model_table[i]);
    return 0;
}
