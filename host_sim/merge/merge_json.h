/* merge_json.h - reports in JSON into the one that a single run writes. */
#ifndef HOST_SIM_MERGE_JSON_H
#define HOST_SIM_MERGE_JSON_H

#include "host_sim/merge/merge.h"

/* Writes the cases of all parts and the requirements that none of them names, and marks parts that are cut.
 * 0, or the exit status after a line. */
int merge_json(struct merge *m);

#endif
