/* merge_map.h - shares of a map into the file that one run writes. */
#ifndef HOST_SIM_MERGE_MAP_H
#define HOST_SIM_MERGE_MAP_H

#include "host_sim/merge/merge.h"

/* Writes the rows of all parts and marks those that are cut. 0, or the exit status after a line. */
int merge_map(struct merge *m);

#endif
