/* cell.c - see cell.h. */
#include "host_sim/out/cell.h"

#include <math.h>

void cell_put(FILE *f, double value, int digits)
{
    if (isfinite(value))
        fprintf(f, "%.*g", digits, value + 0.0);
}
