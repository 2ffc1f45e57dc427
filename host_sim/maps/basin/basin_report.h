/* basin_report.h - the rows of a basin map as a table of attractors, and what the figure is of. */
#ifndef HOST_SIM_BASIN_REPORT_H
#define HOST_SIM_BASIN_REPORT_H

#include "host_sim/maps/basin/basin.h"

/* The attractors in the rows of `path` (NULL: of this run): a table, --svg and --report. 0, or the exit
 * status after a line. */
int basin_report(const struct basin *b, const char *path);

#endif
