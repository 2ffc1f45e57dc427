/* basin_rows.h - the columns of a basin map: the start, what became of it, its fingerprint, a state of the
 * attractor. */
#ifndef HOST_SIM_BASIN_ROWS_H
#define HOST_SIM_BASIN_ROWS_H

#include "host_sim/maps/basin/basin.h"

/* Makes the table of columns of this scene and plant. */
void basin_describe_rows(struct basin *b);

/* The unit of state i as the scene writes it; "" where the scene's numbers have none. */
const char *basin_unit(const struct basin *b, int i);

/* SI value of a model unit of the observable. */
double basin_peak_unit(const struct basin *b);

/* A state as the scene writes it, at phase 0 of the drives, in model units; and back. */
void basin_show(const struct basin *b, const double *x, double *shown);
void basin_take(const struct basin *b, const double *shown, double *x);

#endif
