/* scale.c - SI values of model units (scale_of of model.h). It is a function because inlined it would take 1
 * kB more. */
#include "models/math/elementary.h"
#include "models/model.h"

double scale_of(const struct scale *s, enum quantity q)
{
    /* Time stands apart: with it the switch would be a jump table on RISC-V, which the check of the stack
     * cannot follow. */
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
