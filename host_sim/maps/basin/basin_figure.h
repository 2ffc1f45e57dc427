/* basin_figure.h - a basin map as a picture and a page: its attractors as a table, and a dot for each start,
 * coloured by the attractor that it reached. */
#ifndef HOST_SIM_BASIN_FIGURE_H
#define HOST_SIM_BASIN_FIGURE_H

#include "host_sim/maps/basin/basin.h"

/* "3", "chaos" or "none". */
void basin_period_text(const struct basin_motion *motion, char *text, size_t size);

/* Start positions and velocities, coloured by attractor, and the attractors as a table. NULL, or a reason. */
const char *basin_draw(const struct basin *b, const struct basin_clusters *c, const struct basin_row *row,
                       int n, struct figure *g);

#endif
