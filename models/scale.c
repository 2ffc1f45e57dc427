/* scale.c - see scale_of in model.h; a function, for inlined it is 1 kB more of code in all. */
#include "models/math/elementary.h"
#include "models/model.h"

double scale_of(const struct scale *s, enum quantity q)
{
    /* Apart: with it the switch is a jump table on RISC-V, which the stack's call graph cannot follow. */
    if (q == QUANTITY_TIME)
        return s->time_s;
    switch (q) {
    case QUANTITY_LENGTH:
        return s->length_m;
    case QUANTITY_VELOCITY:
        return s->length_m / s->time_s;
    case QUANTITY_FORCE:
        return s->force_N;
    case QUANTITY_FREQUENCY:
        return 1.0 / (2.0 * ELEMENTARY_PI * s->time_s);
    case QUANTITY_RATIO:
    case QUANTITY_TIME:
        break;
    }
    return 1.0;
}
