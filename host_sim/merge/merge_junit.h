/* merge_junit.h - reports in JUnit XML into the one that a single run writes. */
#ifndef HOST_SIM_MERGE_JUNIT_H
#define HOST_SIM_MERGE_JUNIT_H

#include "host_sim/merge/merge.h"

/* Writes the cases of all parts, one suite for each test file, and marks parts that are cut. 0, or the exit
 * status after a line. */
int merge_junit(struct merge *m);

#endif
